"""The page of a run of two linked loaders, and its folder."""

from pathlib import Path

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from forcefeel.conclusions import capital
from forcefeel.linked.findings import hands_text, linked_conclusions
from forcefeel.linked.result import SIDES, LinkedRun
from forcefeel.linked.tables import columns, linked_json, measure_rows
from forcefeel.loader.links import LINK_TABLE
from forcefeel.loader.parameters import with_unit
from forcefeel.page.canvas import add_curve, drawn, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, RIGID, LineStyle
from forcefeel.page.picture import Picture
from forcefeel.page.render import render
from forcefeel.page.table import Cell, Table, number, words
from forcefeel.page.typography import unit_text
from forcefeel.simulation.page.page import FOLDER, write_run
from forcefeel.units import ANGLE, FORCE, TORQUE, Unit, UnitSystem

_MOST_POINTS = 4000
"""Most points of a drawn curve."""

_LOOKS = (LineStyle(COMPLIANT, "solid", 2.4), LineStyle(COMPENSATED, "dash", 2.4))
_LINK = (LineStyle(RIGID, "solid"), LineStyle(RIGID, "dot"))

_MEANING = "Both sides over one another. A hand's force includes that of its arm."


def write_linked(run: LinkedRun, out: Path, units: UnitSystem, *, command: str = "") -> Path:
    """Writes ``simulation.html``, ``history.csv`` and ``results.json``, whole or not at all.

    Args:
        run: What to report.
        out: The folder; made if it is not there.
        units: The units of every number.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> run = ff.linked.simulate_linked(project, "pitch", ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb"))), "robust")
        >>> ff.linked.write_linked(run, Path("pair"), ff.UnitSystem.US).name
        'simulation.html'
    """
    FOLDER.check(out)
    page = render(
        "linked/page/linked.html.j2",
        command=command,
        run=run,
        subject=hands_text(run, units),
        conclusions=linked_conclusions(run, units),
        motion=Picture.of("motion", "", _MEANING, _motion(run, units)),
        measures=_measured(run, units),
        link=_link(run, units),
    )
    return write_run(out, columns(run, units), linked_json(run, units), page)


def _motion(run: LinkedRun, units: UnitSystem) -> go.Figure:
    """Angles of both columns, forces of both hands, torque of the link on each."""
    picture = make_subplots(rows=3, cols=1, shared_xaxes=True, vertical_spacing=0.05, row_heights=[0.5, 0.25, 0.25])
    panels = (("column_angle_rad", ANGLE, "Column angle"), ("hand_force_n", FORCE, "Force of hand"))
    for row, (output, measured_in, title) in enumerate((*panels, ("link_torque_n_m", TORQUE, "Link torque")), start=1):
        for side, axis, look in zip(SIDES, run.link.between, _LINK if row == 3 else _LOOKS, strict=True):
            name = f"link on {axis}" if row == 3 else axis
            _curve(picture, run, row, (f"{side}_{output}", name), look, measured_in, units)
        picture.update_yaxes(title_text=f"{title}, {measured_in.shown(units)}", row=row, col=1)
    frame(picture, 720)
    picture.update_xaxes(title_text="Time, s", row=3, col=1)
    return picture


def _curve(
    picture: go.Figure,
    run: LinkedRun,
    row: int,
    names: tuple[str, str],
    look: LineStyle,
    measured_in: Unit,
    units: UnitSystem,
) -> None:
    output, name = names
    values = run.outputs[output]
    values = values[np.isfinite(values)] * measured_in.from_si(1.0, units)
    kept = drawn(values, _MOST_POINTS)
    hover = f"%{{y:.4~g}} {measured_in.shown(units)}"
    add_curve(
        picture,
        run.outputs["time_s"][kept],
        values[kept],
        name,
        look,
        hover,
        row=row,
        col=1,
        showlegend=row != 2,
    )


def _measured(run: LinkedRun, units: UnitSystem) -> Table:
    rows = [
        (words(capital(name)), number(value.replace("-", "\N{MINUS SIGN}")), Cell(unit_text(unit)))
        for name, value, unit in measure_rows(run, units)
    ]
    return Table((Cell("Measure"), Cell("Value", "number"), Cell("Unit")), tuple(rows))


def _link(run: LinkedRun, units: UnitSystem) -> Table:
    link = run.link
    rows = [(words("Kind"), number(str(link.kind))), (words("After the breakout"), number(str(link.after_breakout)))]
    rows += [
        (words(capital(row.meaning)), number("none" if link[name] == np.inf else with_unit(row, link[name], units)))
        for name, row in LINK_TABLE.items()
        if link[name] != 0
    ]
    return Table((Cell("Link"), Cell("Value", "number")), tuple(rows))
