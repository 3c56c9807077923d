"""The file of a law: JSON, every number in SI units and to the last bit, with its settings, its time and whom it was made for.

| kind | numbers |
|---|---|
| original | none: the loader's own position loop, eq. (13) |
| state feedback | gains c_1 .. c_7 for each setting |
| compensator | gains c_1 .. c_7 and the load cell's scale, for any setting |
| sampled | transition, input, command and torque for each setting, as ``SampledLaw`` has them |

A sampled law may have a ``cancellation``, as ``Cancellation`` has it. The units that stand beside the numbers are those that the
numbers are taken in; a file with others, or with a key that is not one of these, is refused.
"""

import json
import math
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.files import Kind, check_output_file, input_kind, read_input, write_whole
from forcefeel.json_values import json_text
from forcefeel.laws.analog.gains import FixedGains, SettingGains
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS
from forcefeel.laws.cancellation import Cancellation
from forcefeel.laws.sampled.sampled_law import CONTACT, FRICTION, NUMBERS, SAMPLED_AT_GRIP, SampledLaw
from forcefeel.loader.parameters import DRIVES, ELECTRIC, HYDRAULIC
from forcefeel.units import as_float, show

LawNumbers = FixedGains | SettingGains | SampledLaw
"""The numbers of a law, of three kinds with one protocol: ``kind``, its name in the file; ``settings``, their number;
``by_machine``, whether each run has its own gains; ``displacement_unit``; ``digital``, the ``SampledLaw`` or ``None``; ``engine``,
the keywords of the engine; ``as_json``; ``some`` settings; ``gain_law`` of one setting."""

LAW_FILE = ".json"
"""How the name of a law's file ends."""

FORMAT = 4
"""Version of the file; a new one where its keys change."""

MOST_BYTES = 2**28
"""Largest file: laws for some 50,000 settings."""

_FEEL_UNITS = ("N m s^2/rad", "N m s/rad", "N m/rad")
_TIME_UNIT = "s"
_XI, _FORCE, _ANGLE = "xi, in coordinates of its own", "load cell force in N", "column angle in rad"
_DRIVEN = {
    HYDRAULIC: ("V", "command in V at the valve's amplifier", "piston displacement in m"),
    ELECTRIC: ("A", "current of the motor in A", "rotor angle times transmission.travel, in m"),
    "": (
        "V of a valve, A of a motor",
        "command in V of a valve, in A of a motor",
        "displacement of the drive's end in m",
    ),
}
"""Of each drive, and of one that is not known: unit of the command, the command, the sampled position."""
_CANCELLATION_UNITS = {
    "per_travel_rad_per_m": "rad/m",
    "lead_s": "s",
    "cogging": ["A", "periods per turn of the motor", "rad"],
    "friction_a": "A",
    "slow_rad_per_s": "rad/s",
}
_AT_GRIP = "force at the grip in N"


def _numbers_units(numbers: LawNumbers, drive: str) -> dict[str, object]:
    """The units of gains, or what the numbers of a sampled law are on."""
    if numbers.digital is None:
        return {symbol: unit.si for symbol, unit in zip(GAIN_SYMBOLS, GAIN_UNITS, strict=True)}
    unit, command, position = _DRIVEN[drive]
    on = [_XI, _FORCE, position, _ANGLE, *([_AT_GRIP] if numbers.digital.sampled == SAMPLED_AT_GRIP else [])]
    feel = ["feel displacement in rad", "its rate in rad/s"]
    known = ["xi on friction in N m", "friction in N m", "margin in N m", "slow rate in rad/s", "leak"]
    learnt = ["least learnt in N m", "most learnt in N m", "learning gain", "torque of a hand in N m", "blur", "trust"]
    return {
        "transition": "xi on xi",
        "input": ["xi on", *on[1:], command],
        "command": [f"{unit} on", *on, *feel],
        "torque": ["N m on", *on, *feel],
        "friction": ["rad/s on", *on, *feel, *known, *learnt],
        "neutral": [f"{unit} per rad of the feel's neutral", "N m per rad"],
        "contact": [
            "travel of the drive in m per rad of the column",
            f"{unit} per m",
            f"{unit} s per m",
            "damping in N m s/rad",
            "fastest feel in rad/s",
            "least torque of a quick turn in N m",
            "least torque in N m",
            "least stiffness in N m/rad",
            "longest time between sides in s",
            "distance in rad",
            "travel in rad",
        ],
    }


def check_law_file(path: Path, *, replace: bool = True) -> None:
    """Refuses a name that is not one of a law's file, and without ``replace`` one that is taken.

    Raises:
        InputError: If it does not end with ``.json``, is a folder, lies in none, or is there and not to be replaced.
    """
    if not path.name.endswith(LAW_FILE):
        raise InputError(f"{path}: expected a file whose name ends with {LAW_FILE}, by which a law's file is known")
    check_output_file(path, replace=replace)
    if input_kind(path.parent) is not Kind.FOLDER:
        raise InputError(f"{path}: expected a file in a folder that is there, such as law{LAW_FILE}")


def write_law(path: Path, **law: Any) -> None:
    """Writes the fields of a ``Law``.

    Raises:
        InputError: If the file cannot be written.
    """
    period, feel, rows = law["period_s"], law["feel"], law["numbers"].as_json()
    document = {
        "forcefeel": version("forcefeel"),
        "format": FORMAT,
        "law": law["name"],
        "made_for": {"loader": law["loader"], "drive": law["drive"], "rows": dict(law["loader_rows"])},
        "time": None if period is None else {"unit": _TIME_UNIT, "period": period, "delay": law["delay_s"]},
        "settings": None
        if feel is None
        else {"units": list(_FEEL_UNITS), "inertia, damping, stiffness": feel.tolist()},
        "kind": law["numbers"].kind,
        **({"units": _numbers_units(law["numbers"], law["drive"])} if rows else {}),
        **rows,
        **_cancellation_json(law["cancellation"]),
    }
    write_whole(path, json_text(document))


def _cancellation_json(cancellation: Cancellation | None) -> dict[str, Any]:
    return {} if cancellation is None else {"cancellation": {"units": _CANCELLATION_UNITS, **vars(cancellation)}}


def read_law(path: Path) -> dict[str, Any]:
    """The fields of the ``Law`` in a file.

    Raises:
        InputError: If the file cannot be read, or is not a law file.
    """
    data = read_input(path, MOST_BYTES, "the file of a law, as --save-law writes it")
    try:
        document = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: expected the file of a law: JSON, as --save-law writes it ({error})") from error
    try:
        keys = _Keys(document)
        law = _fields(keys)
        keys.all_known()
        return law
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _fields(keys: "_Keys") -> dict[str, Any]:
    if (version_number := keys.get("format", int)) != FORMAT:
        raise InputError(
            f"format: expected {FORMAT}, got {show(version_number)}; save the law anew with this forcefeel"
        )
    time, made_for, settings = keys.part("time"), keys.part("made_for"), keys.part("settings")
    kind = keys.get("kind", str)
    if kind not in _READ:
        raise InputError(f"kind: expected {', '.join(_READ)}, got {show(kind)}")
    if kind == "sampled" and time is None:
        raise InputError("time: expected period and delay of a sampled law, got none")
    period = None if time is None else time.positive("period")
    delay = 0.0 if time is None else time.get("delay", float)
    numbers = _READ[kind](keys, period, delay)
    drive = "" if made_for is None else made_for.get("drive", str)
    if drive not in _DRIVEN:
        raise InputError(
            f"made_for.drive: expected {', '.join(DRIVES)}, or nothing where it is not known, got {show(drive)}"
        )
    if time is not None:
        time.units("unit", _TIME_UNIT)
    if kind != "original":
        keys.units("units", _numbers_units(numbers, drive))
    keys.get("forcefeel", str)
    return {
        "name": keys.get("law", str),
        "numbers": numbers,
        "period_s": period,
        "delay_s": delay,
        "feel": None if settings is None else _feel(settings, numbers.settings),
        "loader": "" if made_for is None else made_for.get("loader", str),
        "loader_rows": {} if made_for is None else made_for.numbers("rows"),
        "drive": drive,
        "cancellation": _cancellation(keys.part("cancellation")) if "cancellation" in keys else None,
    }


def _cancellation(keys: "_Keys | None") -> Cancellation | None:
    if keys is None:
        return None
    keys.units("units", _CANCELLATION_UNITS)
    cogging = tuple(tuple(row) for row in keys.array("cogging", 2).tolist())
    names = ("per_travel_rad_per_m", "lead_s", "friction_a", "slow_rad_per_s")
    per_travel, lead, friction, slow = (keys.get(name, float) for name in names)
    return Cancellation(per_travel, lead, cogging, friction, slow)


def _feel(settings: "_Keys", count: int) -> NDArray[np.float64]:
    feel = settings.array("inertia, damping, stiffness", 2)
    if feel.shape != (count, 3):
        raise InputError(f"settings: expected I, B, G for each of {count} laws, got the shape {feel.shape}")
    settings.units("units", list(_FEEL_UNITS))
    return feel


def _state_feedback(keys: "_Keys", *_: float | None) -> SettingGains:
    gains = keys.array("gains", 2)
    if gains.shape[1] != len(GAIN_SYMBOLS) or not len(gains):
        raise InputError(f"gains: expected {len(GAIN_SYMBOLS)} for each setting, got the shape {gains.shape}")
    return SettingGains(gains)


def _compensator(keys: "_Keys", *_: float | None) -> FixedGains:
    gains = keys.array("gains", 1)
    if len(gains) != len(GAIN_SYMBOLS):
        raise InputError(f"gains: expected {len(GAIN_SYMBOLS)}, got {len(gains)}")
    unit = keys.get("displacement_unit", str)
    if unit not in {"rad", "V"}:
        raise InputError(f"displacement_unit: expected rad or V, got {show(unit)}")
    return FixedGains(GainLaw(gains.tolist(), keys.get("load_cell_arm", float), unit))


def _sampled(keys: "_Keys", period: float | None, delay: float | None) -> SampledLaw:
    dimensions = dict(zip(NUMBERS, (3, 3, 2, 2, 2, 2, 2), strict=True))
    optional = (FRICTION, CONTACT)
    arrays = {
        name: keys.array(name, count) for name, count in dimensions.items() if name in keys or name not in optional
    }
    return SampledLaw(period or 0.0, delay or 0.0, **arrays)


_READ: Mapping[str, Callable[["_Keys", float | None, float | None], LawNumbers]] = {
    "original": lambda *_: FixedGains(),
    "state feedback": _state_feedback,
    "compensator": _compensator,
    "sampled": _sampled,
}


_NOTHING = "nothing"
"""Instead of a unit that is missing."""


class _Keys:
    """A JSON object, at a place in the file, whose values are asked for by key and kind."""

    def __init__(self, given: object, place: str = "") -> None:
        if not isinstance(given, dict):
            raise InputError(f"{place.rstrip('.')}: " * bool(place) + f"expected a JSON object, got {show(given)}")
        self._given, self._place = given, place
        self._asked: set[str] = set()
        self._parts: list[_Keys] = []

    def __contains__(self, key: str) -> bool:
        return key in self._given

    def _value(self, key: str) -> Any:
        if key not in self._given:
            raise InputError(f"{self._place}{key}: missing; save the law anew with --save-law")
        self._asked.add(key)
        return self._given[key]

    def all_known(self) -> None:
        """Refuses unknown keys: such a key may change the meaning of the numbers."""
        for key, value in self._given.items():
            if key not in self._asked:
                known = ", ".join(sorted(self._asked))
                raise InputError(
                    f"{self._place}{key}: expected {known}, got this key with {show(value)}; remove it, or save the law anew "
                    "with --save-law"
                )
        for part in self._parts:
            part.all_known()

    def units(self, key: str, expected: object) -> None:
        """Refuses units that are not those in which the numbers are taken."""
        actual = self._value(key)
        if actual == expected:
            return
        name = f"{self._place}{key}"
        if isinstance(expected, dict) and isinstance(actual, dict):
            of = {row: (expected.get(row, _NOTHING), actual.get(row, _NOTHING)) for row in (*expected, *actual)}
            name, expected, actual = next((f"{name}.{row}", *pair) for row, pair in of.items() if pair[0] != pair[1])
        stated, shown = (
            show(", ".join(map(str, units_of)) if isinstance(units_of, list) else units_of)
            for units_of in (expected, actual)
        )
        raise InputError(
            f"{name}: expected {stated}, in which the numbers are taken, got {shown}; convert the numbers and write these "
            "units, or save the law anew with --save-law"
        )

    def get(self, key: str, kind: type[Any]) -> Any:
        """The value of a key, of this kind; a whole number is a number."""
        value = self._value(key)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = as_float(value)
        good = isinstance(value, kind) and not isinstance(value, bool)
        if not good or (kind is float and not math.isfinite(value)):
            expected = "a finite number" if kind is float else kind.__name__
            raise InputError(f"{self._place}{key}: expected {expected}, got {show(self._given[key])}")
        return value

    def positive(self, key: str) -> float:
        """A number above 0."""
        value: float = self.get(key, float)
        if value <= 0:
            raise InputError(f"{self._place}{key}: expected a number above 0, got {show(value)}")
        return value

    def numbers(self, key: str) -> dict[str, float]:
        """The finite numbers of an object."""
        part = _Keys(self._value(key), f"{self._place}{key}.")
        return {name: part.get(name, float) for name in part._given}

    def part(self, key: str) -> "_Keys | None":
        """The object of a key; ``None`` where it is null."""
        value = self._value(key)
        if value is None:
            return None
        self._parts.append(_Keys(value, f"{self._place}{key}."))
        return self._parts[-1]

    def array(self, key: str, dimensions: int) -> NDArray[np.float64]:
        """The finite numbers of a key."""
        try:
            numbers = np.array(self.get(key, list), dtype=np.float64)
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"{self._place}{key}: expected numbers in rows of one length ({error})") from error
        if numbers.ndim != dimensions or not np.all(np.isfinite(numbers)):
            raise InputError(
                f"{self._place}{key}: expected finite numbers in {dimensions} dimensions, got the shape {numbers.shape}"
            )
        return numbers
