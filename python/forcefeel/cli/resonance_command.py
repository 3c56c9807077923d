"""What ``forcefeel resonance`` does."""

import math
import re
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.bench.channels import OUTPUTS, channel
from forcefeel.bench.estimate import estimate_response
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.resonance import Reading, Resonance, link_from_resonance, read_resonance
from forcefeel.bench.responses import Response
from forcefeel.cli.bench_data import BenchData
from forcefeel.cli.given_loader import given_loader
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.errors import InputError
from forcefeel.json_values import Json, quantity
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ALTERNATIVES, TABLE, unit, with_unit
from forcefeel.units import HERTZ, UnitSystem, parse, show, to_text

HOLDS_FOR = (
    "k and c are those of a column that swings on the link while the piston is held, as the 1974 report took it. On a bench the "
    "piston gives way; forcefeel identify fits the whole servo instead, and says how sure each number is."
)

_LINK = ("linkage.stiffness", "linkage.damping")
_STATED = ("linkage.resonance_frequency", "linkage.resonance_damping_ratio")
_METHODS = {"half_power": "half power", "circle": "circle fit"}
_NONE = "-"
_DIGITS = 4
_NUMBER = re.compile(r"[-+0-9.eE]+")


def run_resonance(
    path: Path | None,
    bench: BenchData,
    measured: str | None,
    band: str | None,
    changes: list[str] | None,
    units: UnitSystem,
    *,
    as_json: bool,
) -> None:
    """Reads a resonance off a response and shows the link that has it."""
    loader = given_loader(path, changes)
    band_hz = read_band(band)
    response = _response(bench.read()[0], measured)
    found = read_resonance(response, band_hz)
    if as_json:
        print_json(_resonance_json(response, found, loader, units))
    else:
        _show(Terminal(), response, found, loader, units)
    if found.frequency_hz is None:
        raise typer.Exit(1)


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


def _response(data: Response | BenchRecord, measured: str | None) -> Response:
    """The response that was given, or that of a record's channel to its drive."""
    if isinstance(data, Response):
        if measured is not None:
            raise InputError("--channel: is for a record, and the data are a frequency response; leave it out")
        return data
    if measured is not None:
        return estimate_response(data, channel(measured))
    names = [name for name in OUTPUTS if name in data.channels]
    if "column_angle" not in names and len(names) > 1:
        raise InputError(f"--channel: expected which channel is read, {' or '.join(names)}; give one")
    return estimate_response(data, "column_angle" if "column_angle" in names else names[0])


def _link(reading: Reading, loader: Loader) -> tuple[float, float] | None:
    if not reading.frequency_hz or not reading.damping_ratio or reading.damping_ratio < 0:
        return None
    return link_from_resonance(loader, reading.frequency_hz, reading.damping_ratio)


def _lines(found: Resonance, units: UnitSystem) -> dict[str, str]:
    """What a loader file may state in place of k and c, as it states it."""
    if not found.frequency_hz or not found.damping_ratio or found.damping_ratio < 0:
        return {}
    values = (2 * math.pi * found.frequency_hz, found.damping_ratio)
    rows = (ALTERNATIVES[key] for key in _STATED)
    return {row.name: with_unit(row, value, units, _DIGITS) for row, value in zip(rows, values, strict=True)}


def _verdict(response: Response, found: Resonance) -> str:
    if found.frequency_hz is None or found.damping_ratio is None:
        return f"No resonance can be read off {response.name}: {found.circle.note.removeprefix('not read: ')}."
    return f"{response.name} resonates at {_text(found.frequency_hz)} Hz with a damping ratio of {_text(found.damping_ratio)}."


def _show(console: Console, response: Response, found: Resonance, loader: Loader, units: UnitSystem) -> None:
    heads = [f"{TABLE[key].symbol}, {unit(TABLE[key]).shown(units)}" for key in _LINK]
    table = Table(title=f"{response.name}, {response.experiment}", title_justify="left", title_style="bold")
    table.add_column("method")
    for name in ("frequency, Hz", "damping ratio", *heads):
        table.add_column(name, justify="right")
    table.add_column("how")
    for name, words in _METHODS.items():
        reading: Reading = getattr(found, name)
        link = _link(reading, loader)
        numbers = [_NONE if it is None else _text(it) for it in (reading.frequency_hz, reading.damping_ratio)]
        numbers += [_NONE, _NONE] if link is None else _link_texts(link, units)
        table.add_row(words, *numbers, reading.note)
    console.print(table)
    good = found.frequency_hz is not None
    console.print(_verdict(response, found), style="bold" if good else "bold red", highlight=False)
    console.print(f"- {found.note}.", highlight=False)
    if lines := _lines(found, units):
        console.print(f"- {HOLDS_FOR}", highlight=False)
        print("\nIn [linkage] of the loader file, in place of stiffness and damping:")
        for name, text in lines.items():
            print(f'{name} = "{text}"')


def _link_texts(link: tuple[float, float], units: UnitSystem) -> list[str]:
    pairs = zip(_LINK, link, strict=True)
    return [_text(unit(TABLE[key]).from_si(value, units)) for key, value in pairs]


def _resonance_json(response: Response, found: Resonance, loader: Loader, units: UnitSystem) -> dict[str, Json]:
    return {
        "data": response.name,
        "experiment": str(response.experiment),
        "input": response.input,
        "output": response.output,
        "sha256": response.data_hash,
        "loader": loader.name,
        "verdict": _verdict(response, found),
        "kind": found.kind,
        "note": found.note,
        "holds_for": HOLDS_FOR,
        **{name: _reading_json(getattr(found, name), loader, units) for name in _METHODS},
        "loader_file": _lines(found, units) or None,
    }


def _reading_json(reading: Reading, loader: Loader, units: UnitSystem) -> dict[str, Json]:
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
