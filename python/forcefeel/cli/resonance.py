"""``forcefeel resonance``."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.bench_data import DATA, BenchOptions
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import LoaderFile, LoaderOptions, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json, titled
from forcefeel.errors import InputError
from forcefeel.units import HERTZ, Json, UnitSystem, parse, quantity, show, to_text

if TYPE_CHECKING:
    from forcefeel.bench.records import BenchRecord
    from forcefeel.bench.resonance import Reading, Resonance
    from forcefeel.bench.responses import Response
    from forcefeel.loader.loader import Loader

_HOLDS_FOR = {
    "hydraulic": "k and c assume a column that oscillates on the link with the piston held, as in the 1974 report. On a bench the "
    "piston moves; forcefeel identify fits the whole servo instead and gives standard errors.",
    "electric": "k and c assume a column that oscillates on the link with the rotor held, for example by its brake. A free rotor "
    "turns, and the resonance is higher; forcefeel identify fits motor, link and column together and gives standard errors.",
}
"""What the reading of the link holds for, by the loader's drive."""

_LINK = ("linkage.stiffness", "linkage.damping")
_STATED = ("linkage.resonance_frequency", "linkage.resonance_damping_ratio")
_METHODS = {"half_power": "half power", "circle": "circle fit"}
_NONE = "-"
_DIGITS = 4
_NUMBER = re.compile(r"[-+0-9.eE]+")


RESONANCE = Group("Resonance", sort_key=20)


@dataclass(frozen=True, kw_only=True)
class ResonanceOptions(BenchOptions, LoaderOptions, OutputOptions):
    """The options of ``forcefeel resonance``."""

    data: Annotated[
        Path,
        option("A frequency response (CSV) or a time record (CSV, Parquet, MATLAB).", DATA, metavar="FILE"),
    ]
    band: Annotated[
        str | None,
        option(
            "Frequency band of the resonance, such as '8..16 Hz'.",
            RESONANCE,
            default="all of the data",
            metavar="FREQUENCIES",
        ),
    ] = None
    channel: Annotated[
        str | None,
        option(
            "Channel of a record whose response to the drive is used.",
            RESONANCE,
            default="column_angle",
            metavar="CHANNEL",
        ),
    ] = None


def run(path: LoaderFile = None, /, *, options: ResonanceOptions) -> None:
    """Read a resonance from a measured response, and the link's k and c from it, as in the 1974 report.

    Exit status 1 if no resonance can be read.

    Example: forcefeel resonance my.toml --data closed.csv --band '8..16 Hz'
    """
    from forcefeel.bench.resonance import read_resonance

    loader = options.loader(path)
    band_hz = read_band(options.band)
    with all_or_nothing("resonance", silent=options.json):
        response = _response(options.read((options.data,))[0], options.channel)
        resonance = read_resonance(response, band_hz)
    if options.json:
        print_json(_resonance_json(response, resonance, loader, options.units))
    else:
        _show(Terminal(), response, resonance, loader, options.units)
    if resonance.frequency_hz is None:
        raise SystemExit(BAD_ANSWER)


def read_band(given: str | None) -> tuple[float, float] | None:
    """The band of ``8..16 Hz`` or ``8 Hz..16 Hz`` in Hz; ``None`` if none is given.

    Raises:
        InputError: If it is not two rising frequencies.
    """
    if given is None:
        return None
    low, dots, high = (part.strip() for part in given.partition(".."))
    if _NUMBER.fullmatch(low):
        low = f"{low} {_NUMBER.sub('', high, count=1)}"
    try:
        ends = [parse(end, HERTZ.si, "8 Hz") / (2 * math.pi) for end in (low, high)] if dots else []
    except InputError as error:
        raise InputError(f"--band: {error}") from error
    if len(ends) != 2 or not 0 <= ends[0] < ends[1]:
        raise InputError(f"--band: expected two rising frequencies such as '8..16 Hz', got {show(given)}")
    return ends[0], ends[1]


def _response(data: "Response | BenchRecord", measured: str | None) -> "Response":
    """The response that was given, or that of a record's channel to its drive."""
    from forcefeel.bench.channels import OUTPUTS, channel
    from forcefeel.bench.estimate import estimate_response
    from forcefeel.bench.responses import Response

    if isinstance(data, Response):
        if measured is not None:
            raise InputError("--channel: is for a record, and the data are a frequency response; leave it out")
        return data
    if measured is not None:
        return estimate_response(data, channel(measured))
    names = [name for name in OUTPUTS if name in data.channels]
    if "column_angle" not in names and len(names) > 1:
        raise InputError(f"--channel: expected {' or '.join(names)}, got none; name the channel to read")
    return estimate_response(data, "column_angle" if "column_angle" in names else names[0])


def _link(reading: "Reading", loader: "Loader") -> tuple[float, float] | None:
    from forcefeel.bench.resonance import link_from_resonance

    if not reading.frequency_hz or not reading.damping_ratio or reading.damping_ratio < 0:
        return None
    return link_from_resonance(loader, reading.frequency_hz, reading.damping_ratio)


def _lines(resonance: "Resonance", units: UnitSystem) -> dict[str, str]:
    """What a loader file may state in place of k and c, as it states it."""
    from forcefeel.loader.parameters import ALTERNATIVES, with_unit

    if not resonance.frequency_hz or not resonance.damping_ratio or resonance.damping_ratio < 0:
        return {}
    values = (2 * math.pi * resonance.frequency_hz, resonance.damping_ratio)
    rows = (ALTERNATIVES[key] for key in _STATED)
    return {row.name: with_unit(row, value, units, _DIGITS) for row, value in zip(rows, values, strict=True)}


def _verdict(response: "Response", resonance: "Resonance") -> str:
    if resonance.frequency_hz is None or resonance.damping_ratio is None:
        return f"No resonance can be read off {response.name}: {resonance.circle.note.removeprefix('not read: ')}."
    frequency, ratio = _text(resonance.frequency_hz), _text(resonance.damping_ratio)
    return f"{response.name} resonates at {frequency} Hz with a damping ratio of {ratio}."


def _show(console: Terminal, response: "Response", resonance: "Resonance", loader: "Loader", units: UnitSystem) -> None:
    from forcefeel.loader.parameters import TABLE, unit

    heads = [f"{TABLE[key].symbol}, {unit(TABLE[key]).shown(units)}" for key in _LINK]
    title = f"{response.name}, {response.experiment}"
    table = titled(title, "method", numbers=("frequency, Hz", "damping ratio", *heads))
    table.add_column("how")
    for name, words in _METHODS.items():
        reading: Reading = getattr(resonance, name)
        link = _link(reading, loader)
        numbers = [_NONE if it is None else _text(it) for it in (reading.frequency_hz, reading.damping_ratio)]
        numbers += [_NONE, _NONE] if link is None else _link_texts(link, units)
        table.add_row(words, *numbers, reading.note)
    console.show(table)
    good = resonance.frequency_hz is not None
    console.print(_verdict(response, resonance), style="bold" if good else "bold red", highlight=False)
    console.print(f"- {resonance.note}.", highlight=False)
    if lines := _lines(resonance, units):
        console.print(f"- {_HOLDS_FOR[loader.drive]}", highlight=False)
        print("\nIn [linkage] of the loader file, in place of stiffness and damping:")
        for name, text in lines.items():
            print(f'{name} = "{text}"')


def _link_texts(link: tuple[float, float], units: UnitSystem) -> list[str]:
    from forcefeel.loader.parameters import TABLE, unit

    pairs = zip(_LINK, link, strict=True)
    return [_text(unit(TABLE[key]).from_si(value, units)) for key, value in pairs]


def _resonance_json(
    response: "Response", resonance: "Resonance", loader: "Loader", units: UnitSystem
) -> dict[str, Json]:
    return {
        "data": response.name,
        "experiment": str(response.experiment),
        "input": response.input,
        "output": response.output,
        "sha256": response.data_hash,
        "loader": loader.name,
        "verdict": _verdict(response, resonance),
        "kind": resonance.kind,
        "note": resonance.note,
        "holds_for": _HOLDS_FOR[loader.drive],
        **{name: _reading_json(getattr(resonance, name), loader, units) for name in _METHODS},
        "loader_file": _lines(resonance, units) or None,
    }


def _reading_json(reading: "Reading", loader: "Loader", units: UnitSystem) -> dict[str, Json]:
    from forcefeel.loader.parameters import TABLE, unit

    link = _link(reading, loader)
    values = (None, None) if link is None else link
    return {
        "frequency": None if reading.frequency_hz is None else {"value": reading.frequency_hz, "unit": "Hz"},
        "damping_ratio": reading.damping_ratio,
        **{
            key: None if value is None else quantity(value, unit(TABLE[key]), units)
            for key, value in zip(_LINK, values, strict=True)
        },
        "note": reading.note,
    }


def _text(value: float) -> str:
    return to_text(value, _DIGITS)
