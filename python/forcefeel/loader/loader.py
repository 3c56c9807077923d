"""A loader: the machine of one axis, as a frozen set of checked numbers in SI units."""

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError, UnknownKeyError, expect, expect_number
from forcefeel.loader import tolerance_text
from forcefeel.loader.bus import Bus
from forcefeel.loader.contents import Contents, misfits
from forcefeel.loader.curves import CURVES, Curve
from forcefeel.loader.curves import check as check_curve
from forcefeel.loader.parameters import (
    ELECTRIC,
    HYDRAULIC,
    INDEX,
    OFF,
    TABLE,
    a_drive,
    absent,
    did_you_mean,
    drive_of,
    has,
    in_range,
    is_switch,
    parts,
    range_text,
    required,
    stands,
    table,
    unit,
    value_text,
    without,
)
from forcefeel.loader.tolerances import Tolerance, beyond, nothing
from forcefeel.units import ANGLE, FORCE, HERTZ, Json, UnitSystem, parse, quantity, show, to_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OFF = "give None, or off on the command line,"
"""How one switches an optional row off who changes a loader."""


_READ = 4
"""Digits of a value that people read in a line."""

FEEL_SETTING = ("feel.inertia", "feel.damping", "feel.stiffness")
"""The computer setting I, B, G."""


_Matrix = NDArray[np.float64]
_Matrices = tuple[_Matrix, _Matrix, _Matrix, _Matrix]
"""A, B, C, D of a linear model."""


@dataclass(frozen=True)
class Loader(Mapping[str, float]):
    """The numbers of one loader.

    Attributes:
        name: What the loader is called in results.
        source: Where its numbers come from.
        si_values: SI values, one per row of ``forcefeel.loader.parameters.TABLE``, in that order; read-only.
        force_curve: Force at the grip in N over angle in rad, in place of the straight line of ``feel.stiffness``;
            straight beyond its ends. ``None`` for none, as below.
        stiffness_factor: Factor on the spring over dynamic pressure in Pa; beyond its ends as at the nearest end.
        tolerances: How far values of the machine that was built may lie from these, by ``part.name``; read-only.
        bus: The bus that its drive is on, for a live loop; ``None`` where the file has none.

    A loader is a mapping from the rows that a loader of its drive has to their SI values: ``loader["linkage.stiffness"]``,
    ``list(loader)``, ``dict(loader)``, ``"linkage.stiffness" in loader``.

    Raises:
        InputError: If the number of values is not that of the rows; if a value is out of its row's range, except that of
            an optional row that is off; if a curve leaves the limits of its axes; if values or tolerances contradict each
            other. The message has a line for each.

    Example:
        >>> loader = ff.elevator().replace({"linkage.stiffness": "7000 lb/in"})
        >>> f"{loader['linkage.stiffness']:.0f} N/m"
        '1225888 N/m'
    """

    name: str
    source: str
    si_values: NDArray[np.float64] = field(repr=False)
    force_curve: Curve | None = field(default=None, repr=False)
    stiffness_factor: Curve | None = field(default=None, repr=False)
    tolerances: Mapping[str, Tolerance] = field(default_factory=dict, repr=False)
    bus: Bus | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        expect("name", self.name, str, "text")
        expect("source", self.source, str, "text")
        try:
            values = np.array(self.si_values, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"si_values: expected {len(TABLE)} numbers, one per parameter ({error})") from error
        if values.shape != (len(TABLE),):
            raise InputError(f"si_values: expected {len(TABLE)}, one per parameter, got shape {values.shape}")
        drive = drive_of(values)
        for key, value in zip(TABLE, values.tolist(), strict=True):
            _check_range(key, value, drive)
        if not isinstance(self.tolerances, Mapping):
            raise InputError(f"tolerances: expected a mapping by part.name, got {show(self.tolerances)}")
        _freeze(self, si_values=values, tolerances=self.tolerances)
        for name, curve in self.curves.items():
            try:
                check_curve(CURVES[name], curve)
            except InputError as error:
                raise InputError(f"{CURVES[name].key}: {error}") from error
        if wrong := misfits(self._contents()):
            raise InputError("\n".join(wrong))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Loader) and self._parts() == other._parts()

    def __hash__(self) -> int:
        name, source, values, *curves, tolerances, bus = self._parts()
        return hash((name, source, *values, *curves, frozenset(tolerances.items()), bus))

    def __repr__(self) -> str:
        frequency, ratio = _core.feel_frequency(self.si_values)
        stiffness = value_text(TABLE["feel.stiffness"], self["feel.stiffness"], _READ)
        feel = f"G = {stiffness}, {HERTZ.from_si(frequency, UnitSystem.SI):.3g} Hz, damping ratio {ratio:.2g}"
        period = self["controller.period"]
        law = f"digital, {1e3 * period:g} ms" if period else "analog"
        return f"<Loader {self.name!r}: feel {feel}; {law}; {len(self.tolerances)} tolerances>"

    def _repr_html_(self) -> str:
        from forcefeel.loader.html import table  # noqa: PLC0415  for notebooks

        return table(self._contents())

    def plot_bode(
        self,
        law: GainLaw | None = None,
        *,
        frequency_hz: Sequence[float] | NDArray[np.float64] | None = None,
        units: UnitSystem = UnitSystem.SI,
        ax: "Sequence[Axes] | None" = None,
    ) -> NDArray[np.object_]:
        """Draws gain and phase from the pilot's force to the column's angle, beside those of the programmed feel.

        Of the linear model with a compliant link, eq. (17), and of eq. (11). Of a motor: what its rotor and link do to the hand
        with no current.

        Args:
            law: The analog law; the original position loop, eq. (13), if not given. A motor has none.
            frequency_hz: Frequencies in Hz, above 0; a tenth of the feel's to 100 Hz if not given.
            units: Units of the labels.
            ax: Two Matplotlib axes to draw on, for gain and phase; of a figure of their own if not given.

        Returns:
            The two axes.

        Raises:
            InputError: If the law or the frequencies are none, or there is a law for a motor.

        Example:
            >>> gain, phase = ff.elevator().plot_bode()
            >>> gain.get_ylabel()
            'Angle per force, deg/N'
        """
        from forcefeel.plots.draw import bode  # noqa: PLC0415  Matplotlib, for whoever plots

        if law is not None and not isinstance(law, GainLaw):
            raise InputError(f"law: expected an analog law, a GainLaw, got {show(law)}")
        feel_hz = HERTZ.from_si(_core.feel_frequency(self.si_values)[0], UnitSystem.SI)
        given = np.geomspace(feel_hz / 10, 100.0, 1000) if frequency_hz is None else frequency_hz
        try:
            at = np.atleast_1d(np.asarray(given, dtype=np.float64))
        except (TypeError, ValueError):
            at = np.empty(0)
        if at.ndim != 1 or not len(at) or not np.all((at > 0) & np.isfinite(at)):
            raise InputError(f"frequency_hz: expected frequencies above 0 Hz, got {show(given)}")
        models: dict[str, _Matrices] = {
            **self._without_sampling(law),
            "programmed feel": _core.ideal_feel(self.si_values),
        }
        scale = ANGLE.from_si(1.0, units) / FORCE.from_si(1.0, units)
        return bode(
            {name: (at, scale * _angle_per_force(*matrices, 2 * np.pi * at)) for name, matrices in models.items()},
            f"Angle per force, {ANGLE.shown(units)}/{FORCE.shown(units)}",
            f"{self.name}: from the pilot's force to the column",
            ax,
        )

    def _without_sampling(self, law: GainLaw | None) -> dict[str, _Matrices]:
        """Matrices from the pilot's force to the angle under an analog law, or of a motor without current, by what they show."""
        if self.drive == HYDRAULIC:
            return {"loader": _core.compliant(self.si_values, law or GainLaw.original(self.si_values))}
        if law is not None:
            check_hydraulic(self, "an analog law", "without a law its motor has no current in this plot")
        return {"loader without current": _core.electric_plant(self.si_values)}

    def __reduce__(self) -> tuple[Callable[..., "Loader"], tuple[Any, ...]]:
        return _unchecked, self._parts()  # so that a copy is read-only too

    def _parts(self) -> tuple[Any, ...]:
        """Everything that the loader holds, as plain data."""
        held = self.force_curve, self.stiffness_factor, dict(self.tolerances), self.bus
        return self.name, self.source, self.si_values.tolist(), *held

    def _contents(self) -> Contents:
        return Contents(self.name, self.source, self._by_key(), self.curves, self.tolerances, self.bus)

    def _by_key(self) -> dict[str, float]:
        own = table(self.drive)
        return {key: value for key, value in zip(TABLE, self.si_values.tolist(), strict=True) if key in own}

    @property
    def curves(self) -> dict[str, Curve]:
        """The curves that the loader has, by name."""
        return {name: curve for name in CURVES if (curve := getattr(self, name)) is not None}

    def __getitem__(self, key: str) -> float:
        return float(self.si_values[self._position(key)])

    def __contains__(self, key: object) -> bool:
        return key in table(self.drive)

    def __iter__(self) -> Iterator[str]:
        return iter(table(self.drive))

    def __len__(self) -> int:
        return len(table(self.drive))

    @property
    def fingerprint(self) -> str:
        """SHA-256 of the values and curves, to the last bit: by it a law knows the loader that it was made for."""
        curves = repr([(name, curve.x, curve.y) for name, curve in self.curves.items()])
        # What no law asks for, the limits of a supervisor and the rows of a sensor that is not there, is left out.
        absent = ("safety.",) if self["grip_sensor.gain"] else ("safety.", "grip_sensor.")
        # A row that is off says nothing, so that a law keeps its loader when the table gets a row.
        rows = [
            (key, value)
            for key, value in self._by_key().items()
            if value != OFF.get(key) and not key.startswith(absent)
        ]
        return hashlib.sha256(f"{rows}{curves}".encode()).hexdigest()

    @property
    def drive(self) -> str:
        """What moves the linkage: ``hydraulic`` or ``electric``."""
        return drive_of(self.si_values)

    def _position(self, key: str) -> int:
        try:
            return INDEX[key]
        except KeyError:
            raise UnknownKeyError(f"unknown parameter {show(key)}; {did_you_mean(key, table(self.drive))}") from None

    def _row_of_drive(self, key: str, of: str = "") -> int:
        """Position of a row that a loader of this drive has."""
        position = self._position(key)
        if not has(self.drive, TABLE[key]):
            raise InputError(
                f"{of}{key}: is of a loader with {a_drive(str(TABLE[key].drive))}; {self.name} has {a_drive(self.drive)}, with the "
                f"parts {', '.join(parts(self.drive))}"
            )
        return position

    @property
    def given(self) -> tuple[str, ...]:
        """The optional rows that differ from what stands where a loader file does not give them."""
        own = table(self.drive)
        return tuple(key for key, off in OFF.items() if key in own and self[key] != off)

    def rows(self, keys: Sequence[str], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """SI values of many loaders that differ from this one in some rows, a row each in the order of ``parameters.TABLE``.

        Args:
            keys: The rows ``part.name`` that differ.
            values: Their SI values, (loaders, keys); not checked.
        """
        rows = np.tile(self.si_values, (len(values), 1))
        rows[:, [self._position(key) for key in keys]] = values
        return rows

    def replace(self, changes: Mapping[str, str | float | bool | None], *, si: bool = False) -> "Loader":
        """A copy with some values changed.

        Args:
            changes: New values by ``part.name``, as text with a unit; ``True`` or ``False`` for a switch; ``None`` switches
                an optional row off. Without a unit: numbers of rows that have none, zero, and infinity.
            si: Take numbers without a unit as SI values.

        Raises:
            InputError: If a key is unknown, or a value is bad or has no unit.

        Tolerances that are shares of a value follow it, if need be out of its range; where it becomes zero or is switched off, they
        go. Curves stay.

        Example:
            ``loader.replace({"linkage.stiffness": "7000 lb/in", "valve.orifice": True, "feel.breakout": None})``
        """
        expect("changes", changes, Mapping, 'values by part.name such as {"linkage.stiffness": "7000 lb/in"}')
        values = self.si_values.copy()
        tolerances = dict(self.tolerances)
        for key, given in changes.items():
            position = self._row_of_drive(key)
            values[position] = _value(key, given, si=si)
            if key in tolerances:
                tolerance = _tolerance_about(key, tolerances.pop(key), float(values[position]))
                tolerances |= {} if tolerance is None else {key: tolerance}
        return replace(self, si_values=values, tolerances=tolerances)

    def with_tolerances(self, changes: Mapping[str, Tolerance | str | Mapping[str, Any] | None]) -> "Loader":
        """A copy with some tolerances changed.

        Args:
            changes: Tolerances by ``part.name``: as objects, as a loader file states them, or ``None`` for none.

        Raises:
            InputError: If a key is unknown or a tolerance bad.

        Example:
            ``loader.with_tolerances({"linkage.stiffness": "10 %", "column.coulomb_friction": {"uniform": ["1 lb", "5 lb"]}})``
        """
        expect("changes", changes, Mapping, 'tolerances by part.name such as {"linkage.stiffness": "10 %"}')
        tolerances = dict(self.tolerances)
        for key, given in changes.items():
            position = self._row_of_drive(key, "tolerances.")
            tolerances.pop(key, None)
            if isinstance(given, Tolerance):
                tolerances[key] = given
            elif given is not None:
                tolerances[key] = tolerance_text.read(key, given, float(self.si_values[position]), table(self.drive))
        loader = replace(self, tolerances=tolerances)
        if wrong := beyond({key: tolerances[key] for key in changes if key in tolerances}):
            raise InputError("\n".join(wrong))
        return loader

    def scale_feel(self, scale: float) -> "Loader":
        """I, B, G and the pilot's force multiplied by ``scale``: frequency, damping ratio and programmed deflection stay.

        Unlike ``replace`` this does not check the range, for settings beyond what one would build.
        """
        expect_number("scale", scale)
        values, tolerances = self.si_values.copy(), dict(self.tolerances)
        for key in (*FEEL_SETTING, "pilot.force"):
            values[INDEX[key]] *= scale
            if key in tolerances:
                tolerances[key] = tolerances[key].about(float(values[INDEX[key]]))
        force = self.force_curve and Curve(self.force_curve.x, tuple(scale * y for y in self.force_curve.y))
        return _unchecked(self.name, self.source, values, force, self.stiffness_factor, tolerances, self.bus)

    def as_json(self, system: UnitSystem) -> dict[str, Json]:
        """The numbers by ``part.name``; optional rows and curves only where given."""
        shown = {*required(self.drive), *self.given}
        return {
            "name": self.name,
            "source": self.source,
            **({} if self.drive == HYDRAULIC else {"drive": self.drive}),
            "values": {key: quantity(self[key], unit(row), system) for key, row in TABLE.items() if key in shown},
            "curves": {CURVES[name].key: CURVES[name].as_json(curve, system) for name, curve in self.curves.items()},
            "tolerances": {key: it.as_json(unit(TABLE[key]), system) for key, it in self.tolerances.items()},
        }

    def to_toml(self, units: UnitSystem = UnitSystem.US) -> str:
        """The loader as a commented loader file."""
        from forcefeel.loader.text import write  # noqa: PLC0415  Jinja, which few loaders need

        return write(self._contents(), units)


def _angle_per_force(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    d: NDArray[np.float64],
    w: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """``C (jw - A)^-1 B + D`` at ``w`` in rad/s, from the first input, the force, to the first output, the angle."""
    points = np.asarray(1j * w, dtype=np.complex128)
    return np.asarray(_core.frequency_response(a, b[:, 0], c[0], points) + d[0, 0])


def _unchecked(name: str, source: str, values: Any, *others: Any) -> Loader:
    """A loader whose values may lie beyond the ranges of the parameter table."""
    loader = object.__new__(Loader)
    force_curve, stiffness_factor, tolerances, bus = others
    _freeze(
        loader,
        name=name,
        source=source,
        si_values=np.array(values, dtype=np.float64),
        force_curve=force_curve,
        stiffness_factor=stiffness_factor,
        tolerances=tolerances,
        bus=bus,
    )
    return loader


def _freeze(loader: Loader, **attributes: Any) -> None:
    """Sets attributes of a frozen loader, arrays and mappings read-only."""
    for name, value in attributes.items():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
        object.__setattr__(loader, name, MappingProxyType(dict(value)) if isinstance(value, Mapping) else value)


def load(path: str | Path) -> Loader:
    """Reads a loader file.

    Args:
        path: A TOML file as ``forcefeel new`` writes it.

    Raises:
        InputError: With a line for each thing that is wrong: the file, the key, what was expected and what came.

    Example:
        >>> size = Path("my.toml").write_text(ff.elevator().to_toml(), encoding="utf-8")
        >>> ff.load("my.toml").name
        'elevator-1974'
    """
    from forcefeel.loader.file import read  # noqa: PLC0415  pydantic, which a built-in loader does not need

    expect("path", path, (str, Path), "the path of a loader file")
    return of_contents(read(Path(path)))


def of_contents(contents: Contents) -> Loader:
    """The loader with the contents of a loader file."""
    values = np.array([contents.values.get(key, absent(row)) for key, row in TABLE.items()])
    return Loader(
        contents.name, contents.source, values, **contents.curves, tolerances=contents.tolerances, bus=contents.bus
    )


def _check_range(key: str, value: float, drive: str) -> None:
    """Refuses a value (SI) that is neither in the range of the parameter table nor the one of a row not given."""
    row = TABLE[key]
    if not has(drive, row):
        if value != absent(row):
            raise InputError(
                f"{key}: expected {absent(row):g}, as a loader with {a_drive(drive)} has no such row, got {value:g}"
            )
    elif not stands(row, value):
        raise InputError(f"{key}: expected {range_text(row)}, got {value_text(row, value)}")


def _value(key: str, given: str | float | bool | None, *, si: bool) -> float:
    """``given`` in SI units."""
    row = TABLE[key]
    if given is None and row.off_si is not None:
        return row.off_si
    if is_switch(row):
        return _switch(key, given)
    example = f"{to_text(row.default_us)} {row.unit_us}".strip()
    number = (
        isinstance(given, int | float) and not isinstance(given, bool) and not _same_in_every_unit(row.unit_si, given)
    )
    if number and row.unit_si and not si:
        raise InputError(
            f"{key}: expected a value with its unit, such as {example!r}, got {show(given)}; add the unit, or pass si=True for "
            f"a value in {row.unit_si}"
        )
    try:
        value = parse(given, row.unit_si if isinstance(given, str) else "", example)
    except InputError as error:
        raise InputError(f"{key}: {error}") from error
    if value == row.off_si and not in_range(row, value):
        raise InputError(f"{key}: expected {range_text(row)}, got {value_text(row, value)}; {without(row, _OFF)}")
    return value


def _same_in_every_unit(unit_si: str, number: float) -> bool:
    """Whether a number means the same in each unit of a kind."""
    return (number == 0 and unit_si != "degC") or abs(number) == inf


def _switch(key: str, given: object) -> float:
    """A yes or a no as 1 or 0; 1 and 0, which a loader holds, mean the same."""
    if not isinstance(given, bool | int | float) or given not in {0, 1}:
        raise InputError(f"{key}: expected true or false, got {show(given)}")
    return float(given)


def _tolerance_about(key: str, tolerance: Tolerance, value: float) -> Tolerance | None:
    """The tolerance of a value that changes; ``None`` where it was in shares and there is nothing left to share."""
    if tolerance.nominal is not None and (value == 0 or nothing(TABLE[key], value)):
        return None
    return tolerance.about(value)


def check_loader(given: object) -> None:
    """Refuses what is no loader.

    Raises:
        InputError: If so.
    """
    expect("loader", given, Loader, "a Loader, as elevator() makes it or load(path) reads it")


INSTEAD = (
    "for that there are analyze, design, law, simulate, qualify, envelope, "
    "frontier, sweep, schedule, excite and identify"
)
"""What is made for an electric loader too."""


def check_hydraulic(given: object, what: str, instead: str = INSTEAD) -> None:
    """Refuses what is no loader, and one with an electric drive where something is made for a valve alone.

    Args:
        given: The loader.
        what: The requested thing, as the subject of a sentence.
        instead: What there is for an electric one.

    Raises:
        InputError: If so, with what an electric loader is to be asked instead.
    """
    _check_drive(given, HYDRAULIC, what, instead)


def check_electric(given: object, what: str, instead: str) -> None:
    """Refuses what is no loader, and one with a valve where something is made for a motor alone; arguments as ``check_hydraulic``.

    Raises:
        InputError: If so, with what a hydraulic loader is to be asked instead.
    """
    _check_drive(given, ELECTRIC, what, instead)


def _check_drive(given: object, drive: str, what: str, instead: str) -> None:
    check_loader(given)
    if isinstance(given, Loader) and given.drive != drive:
        raise InputError(
            f"{what} takes a loader with {a_drive(drive)}, and {given.name} has {a_drive(given.drive)}; {instead}"
        )
