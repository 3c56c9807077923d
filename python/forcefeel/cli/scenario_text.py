"""What the options of a scenario say, read: values, lists over time, assignments."""

from math import isfinite

from forcefeel.errors import InputError
from forcefeel.units import parse, show

Value = str | float | bool | None
"""What ``Loader.replace`` takes."""

_WORDS: dict[str, Value] = {"true": True, "false": False, "off": None}


def value(option: str, text: str, unit_si: str, example: str) -> float:
    """``text`` in SI units.

    Raises:
        InputError: Naming the option, if it is no number with a unit of the right kind.
    """
    try:
        return parse(text, unit_si, example)
    except InputError as error:
        raise InputError(f"{option}: {error}") from error


def speed_and_altitude(speed: str | None, altitude: str | None) -> tuple[float | None, float | None]:
    """``--speed``, m/s, and ``--altitude``, m, of a trimmed flight; ``None`` where not given.

    Raises:
        InputError: If the speed is not above 0.
    """
    at = None if speed is None else value("--speed", speed, "m/s", "100 kt")
    if at is not None and not at > 0:
        raise InputError(f"--speed: expected a speed above 0, got {speed}")
    return at, None if altitude is None else value("--altitude", altitude, "m", "3000 ft")


def seconds(option: str, text: str) -> float:
    """A time; a number without a unit is in seconds."""
    return value(option, f"{text} s" if _is_number(text) else text, "s", "0.5 s")


def size(option: str, text: str) -> int:
    """A size in MB or GB, in bytes.

    Raises:
        InputError: If it has no number or another unit.
    """
    number, _, unit = text.strip().partition(" ")
    if unit not in _BYTES or not _is_number(number):
        raise InputError(f"{option}: expected a size such as '200 MB' or '1 GB', got {show(text)}")
    return round(float(number) * _BYTES[unit])


_BYTES = {"MB": 1e6, "GB": 1e9}


def values(option: str, text: str, unit_si: str, example: str) -> tuple[float, ...]:
    """Values that commas part, in SI units."""
    return tuple(value(option, part, unit_si, example) for part in text.split(","))


def over_time(option: str, text: str, unit_si: str, example: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times and values of ``0 s: 0 deg, 1 s: 5 deg``; one value without a time holds all the run.

    Raises:
        InputError: If a point is not a time, a colon and a value.
    """
    if ":" not in text and "," not in text:
        return (0.0,), (value(option, text, unit_si, example),)
    points = []
    for point in text.split(","):
        time, colon, height = point.partition(":")
        if not colon:
            raise InputError(
                f"{option}: expected times and values such as '0 s: {example}, 1 s: {example}', got {show(point.strip())}"
            )
        points.append((seconds(option, time.strip()), value(option, height, unit_si, example)))
    times, heights = zip(*points, strict=True)
    if len(times) == 1 and times[0] != 0:
        raise InputError(
            f"{option}: one point holds for all the run, got {show(text)}; leave its time out, or give the point before it too"
        )
    return times, heights


def assignments(option: str, texts: tuple[str, ...]) -> dict[str, Value]:
    """Values of ``part.name=value``, by key, as ``Loader.replace`` takes them.

    Raises:
        InputError: If one is not a name, an equals sign and a value, or a name stands twice.
    """
    from forcefeel.loader.parameters import TABLE

    values: dict[str, Value] = {}
    for text in texts:
        key, equals, given = (part.strip() for part in text.partition("="))
        if not (key and equals and given):
            raise InputError(
                f"{option}: expected a parameter and its value such as 'linkage.stiffness=7000 lb/in', got {show(text)}"
            )
        if key in values:
            raise InputError(f"{option}: {key} is given twice; give it once")
        values[key] = _WORDS.get(given.lower(), given)
        if values[key] is None and key in TABLE and TABLE[key].off_si is None:
            raise InputError(f"{option}: {key} is required in every loader; expected a value, got {show(given)}")
    return values


def _is_number(text: str) -> bool:
    try:
        return isfinite(float(text))
    except ValueError:
        return False
