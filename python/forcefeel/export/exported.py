"""Object of an export: a law, its loader and the name of the export."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.export.tunable import Tunable, tunable_rows
from forcefeel.laws.law import Law, LawLike
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.feel_settings import check_feel_range, own_feel
from forcefeel.loader.loader import Loader
from forcefeel.units import show

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_LONGEST_NAME = 20
"""C99 guarantees 31 significant characters; suffixes such as ``_law_reset`` are added."""


@dataclass(frozen=True, eq=False)
class Exported:
    """A checked law for one loader.

    Attributes:
        loader: The loader.
        law: Its law, for one setting of the feel or many.
        name: Prefix of file names and C identifiers.
        linked: Whether the law in C takes a force, a spring and a damping beside the feel, as of an electronic link.
        tunable: Rows of the feel that a program with the law in C may tune.
        supervised: Whether law, feel and supervisor are written in C too.

    Raises:
        InputError: If the law was designed for another loader, rate or drive, is an analog law for a digital controller, has a
            setting out of range, or the name is not a C identifier.

    Example:
        >>> loader = ff.digital_elevator()
        >>> ff.export.Exported.of("robust", loader, "pitch").settings.shape
        (1, 3)
    """

    loader: Loader
    law: Law
    name: str = "loader"
    linked: bool = False
    tunable: tuple[Tunable, ...] = ()
    supervised: bool = False

    def __post_init__(self) -> None:
        if not _IDENTIFIER.fullmatch(self.name) or len(self.name) > _LONGEST_NAME:
            raise InputError(
                f"name: expected a C identifier of at most {_LONGEST_NAME} letters, digits and _, such as pitch, "
                f"got {show(self.name)}"
            )
        self.law.check(self.loader)
        if self.law.period_s and self.law.sampled is None:
            # Such gains are neither a sampled law nor a continuous loop.
            raise InputError(
                f"law: {self.law.name} is gains of an analog law, and {self.loader.name} has a digital controller; expected a "
                "sampled law, such as robust"
            )
        check_feel_range(self.settings, lambda setting: f"in setting {setting + 1}")
        if remark := self.law.made_for_another(self.loader):
            raise InputError(f"law: {remark.rstrip('.')}")

    @classmethod
    def of(
        cls,
        law: LawLike,
        loader: Loader,
        name: str = "loader",
        feel: NDArray[np.float64] | None = None,
        *,
        tunable: Sequence[str] = (),
    ) -> "Exported":
        """Make a law with ``Law.of`` for the settings I, B, G in ``feel``, SI units, (settings, 3); default: the loader's own.

        For C, ``tunable`` names rows of the feel, such as ``feel.breakout=0..10 lb``; without a range the parameter table's holds.

        Raises:
            InputError: As in ``Law.of`` and ``Exported``, or if a row cannot be tuned in its range.

        Example:
            >>> feel = np.array([[8.0, 60.0, 325.0], [6.8, 34.0, 1085.0]])
            >>> ff.export.Exported.of("robust", ff.digital_elevator(), "pitch", feel).settings.shape
            (2, 3)
        """
        law = Law.of(law, loader, feel)
        return cls(loader, law, name, tunable=tunable_rows(tunable, loader, law))

    def sampled(self) -> SampledLaw:
        """Numbers of the sampled law, for a digital target.

        Raises:
            InputError: If the law is analog.

        Example:
            >>> ff.export.Exported.of("robust", ff.digital_elevator()).sampled().states
            9
        """
        if self.law.sampled is None:
            raise InputError(
                f"law: {self.law.name} is an analog law, and the target is digital; give the loader a controller.period, such as "
                "--set 'controller.period=0.5 ms', and a sampled law such as robust"
            )
        return self.law.sampled

    @property
    def settings(self) -> NDArray[np.float64]:
        """Settings I, B, G, (settings, 3), of the law; of a law without settings those of the loader."""
        return own_feel(self.loader) if self.law.feel is None else self.law.feel
