"""The law: what drives a loader, analog or sampled, named or given, for one setting of the feel or for many.

Laws are designed for the nominal plant and each setting I, B, G of the feel; a perturbed plant meets the law of the nominal one.
Time is part of a law: one that was made for a controller's period and delay runs on no other, and an analog one on an analog
loader alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isclose
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import GainLaw
from forcefeel.errors import InputError, suggestion
from forcefeel.laws.analog.gain_schedule import schedule_gains
from forcefeel.laws.analog.gains import FixedGains, SettingGains, analog
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, NAMED_DESIGNS, DesignSettings, design_gains
from forcefeel.laws.cancellation import Cancellation
from forcefeel.laws.law_file import LAW_FILE, LawNumbers, check_law_file, read_law, write_law
from forcefeel.laws.made_for import design_rows, differing
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS, LawDesign
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.units import show

NAMED_LAWS = (*NAMED_DESIGNS, *LAW_DESIGNS)
"""The names of laws: the report's, then those that are made for a digital controller."""

ORIGINAL = "original"
"""The loader's own position loop, eq. (13)."""

ROBUST = "robust"


def default_law(loader: Loader) -> str:
    """The law of a loader where none is named: ``robust`` with a digital controller, else the original loop.

    Example:
        >>> ff.laws.default_law(ff.digital_elevator()), ff.laws.default_law(ff.elevator())
        ('robust', 'original')
    """
    return ROBUST if loader["controller.period"] else ORIGINAL


_SAME = 1e-9
"""Relative; a number that went through a file or another unit is still the same."""


_NAMED = 3
"""Rows that a sentence names."""


@dataclass(frozen=True, eq=False)
class Law:
    """What drives a loader.

    Attributes:
        name: What it is called.
        numbers: One of three kinds: ``FixedGains``, a ``GainLaw`` for all settings or the original loop of each loader's own
            parameters, eq. (13); ``SettingGains``, gains c_1 .. c_7 in SI units for each setting; a ``SampledLaw``.
        period_s: Sample period of the controller that it was made for; ``None`` for an analog one.
        delay_s: From the sample to its command.
        feel: Settings I, B, G in SI units that the numbers belong to, (settings, 3); ``None`` where they hold for any.
        loader: Name of the loader that it was made for; empty where that is not known.
        loader_rows: What a design depends on of that loader: ``design_rows``; empty where it is not known.
        drive: What drives that loader, one of ``DRIVES``; empty where that is not known. It says what command and position are.
        cancellation: What a sampled law adds to its command against a known disturbance of the drive, its cogging; ``None`` for
            nothing. A design takes it from the loader file; ``dataclasses.replace(law, cancellation=None)`` leaves it out.

    Example:
        >>> law = ff.Law.of("robust", ff.digital_elevator())
        >>> law.name, law.period_s
        ('robust', 0.0005)
    """

    name: str
    numbers: LawNumbers = field(default=FixedGains(), repr=False)
    period_s: float | None = None
    delay_s: float = 0.0
    feel: NDArray[np.float64] | None = field(default=None, repr=False)
    loader: str = ""
    loader_rows: Mapping[str, float] = field(default_factory=dict, repr=False)
    drive: str = field(default="", repr=False)
    cancellation: Cancellation | None = field(default=None, repr=False)

    @classmethod
    def of(
        cls,
        given: "LawLike",
        loader: Loader,
        feel: NDArray[np.float64] | None = None,
        name: str | None = None,
    ) -> "Law":
        """The law that ``given`` means for a loader.

        Args:
            given: A law; a name of ``NAMED_LAWS``, or ``DesignSettings`` or a ``LawDesign``, which design one; the file of a law;
                numbers; ``None`` for that of ``default_law``.
            loader: The loader; its controller's period and delay are the law's, unless it has its own.
            feel: Settings I, B, G in SI units, (settings, 3), each of which gets a law; the loader's own if not given.
            name: What to call it; by itself if not given.

        Raises:
            InputError: If the name is unknown, the file is not a law file, the design fails, or the law was made for another
                controller or for other settings.
        """
        check_given(given)
        check_loader(loader)
        if isinstance(given, Law):
            given.check(loader)
            return given if feel is None else given.at(feel)
        if isinstance(given, str | Path) and str(given).endswith(LAW_FILE):
            law = cls(**read_law(Path(given)))
            named_so = name or f"{law.name} ({Path(given).name})"
            return cls.of(replace(law, name=named_so), loader, own_feel(loader) if feel is None else feel)
        if given is None:
            given = default_law(loader)
        if isinstance(given, str | Path):
            name = name or str(given)
            given = named((str(given),), loader)[str(given)]
        designed = isinstance(given, DesignSettings | LawDesign)
        numbers = _designed(given, loader, feel, name or ORIGINAL)
        made_for = (own_feel(loader) if feel is None else feel) if designed else None
        called = given.name if isinstance(given, LawDesign) else ORIGINAL if numbers.kind == ORIGINAL else "given"
        period, delay = loader["controller.period"] or None, loader["controller.delay"]
        if numbers.digital is not None:
            period, delay = numbers.digital.period_s, numbers.digital.delay_s
        time = period, delay if period else 0.0
        cancels = Cancellation.of(loader) if designed else None
        law = cls(name or called, numbers, *time, made_for, loader.name, design_rows(loader), loader.drive, cancels)
        law.check(loader)
        return law

    def check(self, loader: Loader) -> None:
        """Refuses a loader whose drive or time is another than the law's; the original loop has each loader's own.

        Raises:
            InputError: If so.
        """
        if (self.drive or loader.drive) != loader.drive or (loader.drive == ELECTRIC and self.sampled is None):
            raise of_another_drive(self.name, loader)
        if loader.drive != ELECTRIC and self.cancellation is not None:
            raise of_another_drive(self.name, loader)
        if self.numbers.kind == ORIGINAL:
            return
        period, delay = loader["controller.period"], loader["controller.delay"]
        if self.period_s is None:
            if period:
                raise InputError(
                    f"law: {self.name} is an analog law, the loader has a controller.period of {1e3 * period:.6g} ms; "
                    "design it for this loader"
                )
            return
        for key, made_for, own in (
            ("controller.period", self.period_s, period),
            ("controller.delay", self.delay_s, delay),
        ):
            if not isclose(own, made_for, rel_tol=_SAME):
                raise InputError(
                    f"law: made for a {key} of {1e3 * made_for:.6g} ms, the loader has {1e3 * own:.6g} ms; "
                    "design it for this loader"
                )

    def made_for_another(self, loader: Loader) -> str:
        """What to conclude where the loader is another than the law was made for; empty where it is that one, or none is known.

        The original loop has each loader's own numbers.
        """
        rows = () if self.numbers.kind == ORIGINAL or not self.loader_rows else differing(self.loader_rows, loader)
        if not rows:
            return ""
        others = f"{', '.join(rows[:_NAMED])}{f' and {len(rows) - _NAMED} more rows' * (len(rows) > _NAMED)}"
        return (
            f"{self.name} was made for {self.loader}, and runs here on {loader.name} with other values of {others}: design it for "
            "this loader, or give the one that it was made for."
        )

    def engine(self, loader: Loader) -> dict[str, Any]:
        """The law as the keywords by which the engine takes it.

        Raises:
            InputError: As ``check``.
        """
        self.check(loader)
        return self.numbers.engine()

    @property
    def sampled(self) -> SampledLaw | None:
        """The numbers of a sampled law; ``None`` of any other."""
        return self.numbers.digital

    def some(self, which: slice | Sequence[int] | NDArray[np.intp]) -> "Law":
        """The laws of some settings; itself where one holds for all."""
        feel, numbers = None if self.feel is None else self.feel[which], self.numbers.some(which)
        return self if numbers is self.numbers else replace(self, numbers=numbers, feel=feel)

    def at(self, feel: NDArray[np.float64]) -> "Law":
        """The laws of these settings I, B, G, a row each; itself where one holds for any.

        Raises:
            InputError: If it has none for one of them.
        """
        if self.feel is None:
            return self
        if self.feel.shape == feel.shape and np.array_equal(self.feel, feel):
            return self
        near = np.all(np.isclose(feel[:, np.newaxis], self.feel[np.newaxis], rtol=_SAME, atol=0.0), axis=2)
        known = np.any(near, axis=1)
        if not np.all(known):
            missing = ", ".join(f"{value:.6g}" for value in feel[int(np.argmin(known))])
            made_for = f", made for {self.loader}," if self.loader else ""
            settings = "1 setting" if len(self.feel) == 1 else f"{len(self.feel)} settings"
            raise InputError(
                f"law: {self.name}{made_for} has laws for {settings} of the feel, "
                f"none for I, B, G = {missing} (SI units); save it for the requested settings, or name a design"
            )
        return self.some(np.argmax(near, axis=1))

    def single(self, loader: Loader, setting: int = 0) -> "Law":
        """The law of one setting, its gains with the load cell's scale of ``loader``."""
        law = self.some([setting])
        return replace(law, numbers=FixedGains(law.numbers.gain_law(loader))) if self.numbers.by_machine else law

    def without_contact(self) -> "Law":
        """The law without its part for contact (``laws.sampled.contact_law``), for a column that nothing stiff can touch.

        Example:
            >>> law = ff.Law.of("robust", ff.digital_elevator())
            >>> law.sampled.knows_contact, law.without_contact().sampled.knows_contact
            (True, False)
        """
        law = self.sampled
        return self if law is None else replace(self, numbers=replace(law, contact=np.empty(0)))

    def save(self, path: str | Path) -> None:
        """Writes the law to a file that ``Law.of`` reads: numbers, settings, time, units and the loader that it was made for.

        Raises:
            InputError: If the file cannot be written, or its name does not end with ``.json``.
        """
        check_law_file(Path(path))
        write_law(Path(path), **vars(self))


LawLike = Law | str | Path | DesignSettings | LawDesign | LawNumbers | GainLaw | NDArray[np.float64] | None
"""What ``Law.of`` makes a law of."""


def check_given(given: object, name: str = "law") -> None:
    """Refuses what ``Law.of`` makes no law of; ``name`` is what the message calls it.

    Raises:
        InputError: If it is of another kind.
    """
    kinds = Law | str | Path | DesignSettings | LawDesign | LawNumbers | GainLaw | np.ndarray | None
    if not isinstance(given, kinds):
        raise InputError(f"{name}: expected a law, its name, its file, its design or its numbers, got {show(given)}")
    if isinstance(given, np.ndarray) and given.shape[1:] != (len(GAIN_SYMBOLS),):
        raise InputError(
            f"{name}: expected gains c_1 .. c_7, a row for each setting or run, got an array of shape {given.shape}"
        )


def of_another_drive(name: str, loader: Loader) -> InputError:
    """What is wrong with a law for a valve on an electric loader, or for a motor on a hydraulic one."""
    made_for, has = ("valve", "motor") if loader.drive == ELECTRIC else ("motor", "valve")
    return InputError(
        f"law: {name} is a law for a {made_for}, and {loader.name} has a {has}; expected one of "
        f"{', '.join(names_for(loader))}"
    )


def drives_of(name: str) -> tuple[str, ...]:
    """The drives that a law of this name is made for."""
    return LAW_DESIGNS[name].drives if name in LAW_DESIGNS else (HYDRAULIC,)


def names_for(loader: Loader) -> tuple[str, ...]:
    """The names of all laws that a loader can run: the sampled ones need a digital controller, the report's a valve."""
    sampled = tuple(name for name, design in LAW_DESIGNS.items() if design.serves(loader))
    if loader.drive == ELECTRIC:
        return sampled
    return (*NAMED_DESIGNS, *(sampled if loader["controller.period"] else ()))


def named(names: Sequence[str], loader: Loader) -> dict[str, LawLike]:
    """What these names of designs, or files of laws, mean for a loader.

    Raises:
        InputError: If a name is unknown, given twice, or missing.
    """
    for name in names:
        if name not in NAMED_LAWS and not str(name).endswith(LAW_FILE):
            raise InputError(
                f"law: expected {', '.join(NAMED_LAWS)} or a law file ({LAW_FILE}), got {show(name)}"
                f"{suggestion(str(name), NAMED_LAWS)}"
            )
    if not names or len(set(names)) < len(names):
        raise InputError(f"law: expected different ones of {', '.join(NAMED_LAWS)}, got {show(list(names))}")
    for name in names:
        if name in NAMED_LAWS and loader.drive not in drives_of(name):
            raise of_another_drive(name, loader)
    return {name: _design(name, loader) for name in names}


def _design(name: str, loader: Loader) -> LawLike:
    if name in LAW_DESIGNS:
        return LAW_DESIGNS[name]
    return NAMED_DESIGNS[name](loader) if name in NAMED_DESIGNS else Path(name)


def _designed(given: LawLike, loader: Loader, feel: NDArray[np.float64] | None, name: str) -> LawNumbers:
    """The numbers of a design, or those that are given."""
    if isinstance(given, LawDesign):
        return given.design(loader, own_feel(loader) if feel is None else feel)
    if isinstance(given, DesignSettings):
        if feel is None:
            return FixedGains(_gains(given, loader, name))
        # No gain on the pilot force, which is not measured.
        return SettingGains(np.pad(schedule_gains(loader, feel, given).gains, ((0, 0), (0, 1))))
    return given if isinstance(given, LawNumbers) else analog(cast("GainLaw | NDArray[np.float64]", given))


def _gains(design: DesignSettings, loader: Loader, name: str) -> GainLaw:
    """Gains for the loader's own setting, by the recursion itself."""
    gain_design = design_gains(loader, design)
    if not gain_design.reached:
        raise InputError(f"law: the recursion does not give the {name} gains for this loader: {gain_design.note}")
    return gain_design.law(loader)
