"""A loader as a table, for notebooks."""

from html import escape

from forcefeel.loader import tolerance_text
from forcefeel.loader.contents import Contents
from forcefeel.loader.curves import CURVES
from forcefeel.loader.parameters import OFF, TABLE, is_switch, meaning, parts, with_unit
from forcefeel.units import UnitSystem

_DIGITS = 5
_QUOTE = '"'
_HEAD = ("", "", "meaning", "U.S.", "metric", "tolerance")


def table(contents: Contents) -> str:
    """The numbers that the loader gives, part by part, in both systems of units; a curve by the number of its points."""
    head = "".join(f'<th scope="col">{name}</th>' for name in _HEAD)
    rows = [f"<tr>{head}</tr>"]
    for part, what in parts(contents.drive).items():
        own = contents.values.items()
        given = [key for key, value in own if TABLE[key].part == part and value != OFF.get(key)]
        if given:
            rows.append(f'<tr><th scope="rowgroup" colspan="{len(_HEAD)}">{escape(part)}: {escape(what)}</th></tr>')
            rows += [_row(key, contents) for key in given]
    rows += [
        f"<tr>{_cells('', CURVES[name].key, f'curve of {len(curve.x)} points', '', '', '')}</tr>"
        for name, curve in contents.curves.items()
    ]
    source = f" ({escape(contents.source)})" if contents.source else ""
    return f"<table><caption><b>{escape(contents.name)}</b>{source}</caption>{''.join(rows)}</table>"


def _row(key: str, contents: Contents) -> str:
    row, value, tolerance = TABLE[key], contents.values[key], contents.tolerances.get(key)
    shown = (
        ["yes"] * 2 if is_switch(row) else [with_unit(row, value, it, _DIGITS) for it in (UnitSystem.US, UnitSystem.SI)]
    )
    within = tolerance_text.write(row, tolerance, UnitSystem.US).strip(_QUOTE) if tolerance else ""
    return f"<tr>{_cells(row.symbol, key, meaning(row, contents.drive), *shown, within)}</tr>"


def _cells(*texts: str) -> str:
    return "".join(f"<td>{escape(text)}</td>" for text in texts)
