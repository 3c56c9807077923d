"""The plots of a run: the motion, the demand on the valve, force over position."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from forcefeel.page.canvas import add_curve, drawn, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.typography import parameter_text
from forcefeel.simulation import Run, RunStatus
from forcefeel.simulation.demanded import demanded
from forcefeel.simulation.inputs import Chirp, Multisine, Recorded, StopToStop
from forcefeel.simulation.outcome import feel_position, per_feel_angle
from forcefeel.units import FORCE, UnitSystem

MOST_POINTS = 4000
"""Most points of a drawn curve; of a longer one the lowest and the highest of each stretch are drawn."""

MOST_LOOP_POINTS = 20_000
"""Most points of a loop; of a longer one every other sample is drawn, or fewer."""

_COLUMN, _FEEL, _PILOT, _CELL = (
    LineStyle(COMPLIANT, "solid", 2.4),
    LineStyle(COMPENSATED, "dash"),
    LineStyle(IDEAL),
    LineStyle(RIGID, "dash"),
)
_IDEAL, _LOOP = LineStyle(IDEAL, "dot"), LineStyle(COMPLIANT, "solid", 1.8)
_LIMIT, _VEIL = "#B3261E", "rgba(255,255,255,0.75)"
_NEAR = 0.6
"""A limit is drawn once the curve comes within this share of it."""

_ROOM, _LEAST_DEG = 0.05, 0.01
"""Share of a loop's width that is left free to either side, and the least width."""

_VIEW_DEG = 90.0
"""A run that diverged is in view until its column is so far off."""

_VIEW_PERCENT = 140.0


@dataclass(frozen=True)
class Level:
    """A thin line at a value that matters.

    Attributes:
        at: Where, in the unit of the panel.
        name: What is written on it.
    """

    at: float
    name: str


def motion(run: Run, ideal: NDArray[np.float64] | None, system: UnitSystem) -> go.Figure:
    """Column angle with that of the ideal feel, velocity, and the forces at the grip, over time."""
    picture = make_subplots(rows=3, cols=1, shared_xaxes=True, vertical_spacing=0.05, row_heights=[0.5, 0.25, 0.25])
    angle = np.degrees(_values(run, "column_angle_rad"))
    _curve(picture, run, 1, "column", angle, _COLUMN, "%{y:.2f}°")
    feel = np.degrees(_values(run, feel_position(run)) / per_feel_angle(run))
    _curve(picture, run, 1, "programmed control", feel, _FEEL, "%{y:.2f}°")
    if ideal is not None:
        _curve(picture, run, 1, "ideal feel", np.degrees(ideal[: len(angle)]), _IDEAL, "%{y:.2f}°")
    velocity = np.degrees(_values(run, "column_velocity_rad_per_s"))
    _curve(picture, run, 2, "column", velocity, _COLUMN, "%{y:.3~g}°/s")
    unit, forces = FORCE.shown(system), _forces(run, system)
    for (name, force), look in zip(forces.items(), (_PILOT, _CELL), strict=True):
        _curve(picture, run, 3, name, force, look, f"%{{y:.3~g}} {unit}")
    frame(picture, 720)
    _time_axis(picture, run, rows=3)
    picture.update_yaxes(title_text="Column angle, deg", row=1, col=1)
    picture.update_yaxes(title_text="Velocity, deg/s", row=2, col=1)
    picture.update_yaxes(title_text=f"Force at grip, {unit}", row=3, col=1)
    _levels(picture, 1, angle, stops(run))
    if run.status is RunStatus.DIVERGED:
        early = _early(angle)
        _view(picture, 1, angle[:early])
        _view(picture, 2, velocity[:early])
        _view(picture, 3, *(force[:early] for force in forces.values()))
    return picture


def demand(run: Run, system: UnitSystem) -> go.Figure:
    """What the drive gives as percent of what there is, over time: of a valve current, flow and pressure."""
    quantities = demanded(run.loader)
    picture = make_subplots(rows=len(quantities), cols=1, shared_xaxes=True, vertical_spacing=0.06)
    for row, quantity in enumerate(quantities, start=1):
        share = 100 * _values(run, quantity.output) / run.loader[quantity.whole]
        _curve(picture, run, row, quantity.title.lower(), share, _COLUMN, "%{y:.1f} %")
        text = f"{quantity.title}, % of<br>{parameter_text(run.loader, quantity.whole, system)}"
        picture.update_yaxes(title_text=text, row=row, col=1)
        full = "rating" if quantity.whole_name.startswith("the rated") else quantity.whole_name.split()[1]
        bounds = [
            Level(100.0, full),
            Level(100 * run.loader[quantity.limit] / run.loader[quantity.whole], quantity.limit_name),
        ]
        _levels(picture, row, share, [Level(sign * bound.at, bound.name) for bound in bounds for sign in (1, -1)])
        if run.status is RunStatus.DIVERGED:
            _view(picture, row, np.clip(share, -_VIEW_PERCENT, _VIEW_PERCENT))
    frame(picture, 560, top=16)
    picture.update_layout(showlegend=False)
    _time_axis(picture, run, rows=len(quantities))
    return picture


def has_loop(run: Run) -> bool:
    """Whether force over position is worth a plot: the force goes to and fro."""
    return isinstance(run.scenario.force, StopToStop | Chirp | Multisine | Recorded)


def loop(run: Run, system: UnitSystem) -> go.Figure:
    """The pilot's force over the column's angle."""
    picture = make_subplots(rows=1, cols=1)
    angle = np.degrees(_values(run, "column_angle_rad"))
    force = FORCE.from_si(1.0, system) * _values(run, "pilot_force_n")
    every = -(-len(angle) // MOST_LOOP_POINTS) or 1
    angle, force = angle[::every], force[::every]
    unit = FORCE.shown(system)
    add_curve(picture, angle, force, "run", _LOOP, f"%{{x:.2f}}°, %{{y:.3~g}} {unit}")
    spring = _spring(run, angle, system)
    if spring is not None:
        add_curve(picture, spring[0], spring[1], "programmed spring", _IDEAL, hoverinfo="skip")
    frame(picture, 480, hover="closest")
    if len(angle):
        low, high = float(angle.min()), float(angle.max())
        room = _ROOM * max(high - low, _LEAST_DEG)
        picture.update_xaxes(range=[low - room, high + room])
    picture.update_xaxes(title_text="Column angle, deg")
    picture.update_yaxes(title_text=f"Pilot force, {unit}")
    for level in _near(angle, stops(run)):
        picture.add_vline(
            level.at,
            line={"color": _LIMIT, "width": 1},
            annotation={
                "text": level.name,
                "font": {"size": 11.5, "color": _LIMIT},
                "textangle": -90,
                "yanchor": "bottom",
            },
            annotation_position="bottom right" if level.at < 0 else "bottom left",
        )
    return picture


def stops(run: Run) -> list[Level]:
    """The end stops of the column and the programmed ones, deg."""
    names = {
        "column.stop_low": "end stop",
        "column.stop_high": "end stop",
        "feel.hard_stop_low": "programmed hard stop",
        "feel.hard_stop_high": "programmed hard stop",
        "feel.soft_stop_low": "soft stop",
        "feel.soft_stop_high": "soft stop",
    }
    return [Level(float(np.degrees(run.loader[key])), name) for key, name in names.items() if isfinite(run.loader[key])]


def _spring(
    run: Run, angle: NDArray[np.float64], system: UnitSystem
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """The programmed spring over the angles of the run; none where its factor or its neutral changes."""
    loader, scenario = run.loader, run.scenario
    if not len(angle) or scenario.trim_rad is not None or scenario.feel_changes or loader.stiffness_factor is not None:
        return None
    along = np.linspace(angle.min(), angle.max(), 201)
    radians = np.radians(along)
    curve = loader.force_curve
    force = loader["feel.stiffness"] * radians / loader["column.grip_arm"] if curve is None else curve.at(radians)
    return along, force * FORCE.from_si(1.0, system)


def _values(run: Run, name: str) -> NDArray[np.float64]:
    """An output up to where the run diverged."""
    known = np.isfinite(run.outputs["column_angle_rad"])
    return np.asarray(run.outputs[name][known])


def _curve(
    picture: go.Figure, run: Run, row: int, name: str, values: NDArray[np.float64], look: LineStyle, hover: str
) -> None:
    time = run.outputs["time_s"][: len(values)]
    kept = drawn(values, MOST_POINTS)
    add_curve(
        picture,
        time[kept],
        values[kept],
        name,
        look,
        hover,
        legendgroup=name,
        showlegend=all(trace.name != name for trace in picture.data),
        row=row,
        col=1,
    )


def _near(values: NDArray[np.float64], levels: Iterable[Level]) -> list[Level]:
    """Those that the curve comes near to."""
    low, high = float(np.min(values, initial=0.0)), float(np.max(values, initial=0.0))
    return [
        level
        for level in levels
        if isfinite(level.at) and (level.at * _NEAR <= high if level.at > 0 else level.at * _NEAR >= low)
    ]


def _levels(picture: go.Figure, row: int, values: NDArray[np.float64], levels: Iterable[Level]) -> None:
    for level in _near(values, levels):
        picture.add_hline(
            level.at,
            row=row,
            col=1,
            line={"color": _LIMIT, "width": 1},
            annotation={"text": level.name, "font": {"size": 11.5, "color": _LIMIT}, "bgcolor": _VEIL},
            annotation_position="bottom left" if level.at > 0 else "top left",
        )


def _forces(run: Run, system: UnitSystem) -> dict[str, NDArray[np.float64]]:
    """The pilot's force, and the load cell's, turned round and referred to the grip by ``alpha R_b / R_p``."""
    loader = run.loader
    to_grip = -loader["linkage.ratio"] * loader["column.base_arm"] / loader["column.grip_arm"]
    forces = {"pilot": _values(run, "pilot_force_n"), "load cell": to_grip * _values(run, "load_cell_force_n")}
    return {name: FORCE.from_si(1.0, system) * force for name, force in forces.items()}


def _early(angle: NDArray[np.float64]) -> int:
    """How many samples there are before a run that diverges leaves the view."""
    beyond = np.flatnonzero(np.abs(angle) > _VIEW_DEG)
    return int(beyond[0]) if len(beyond) else len(angle)


def _view(picture: go.Figure, row: int, *curves: NDArray[np.float64]) -> None:
    """Gives a panel the scale of these values, whatever else is in it."""
    reach = max(float(np.max(np.abs(curve), initial=0.0)) for curve in curves)
    if reach:
        picture.update_yaxes(range=[-1.1 * reach, 1.1 * reach], row=row, col=1)


def _time_axis(picture: go.Figure, run: Run, rows: int) -> None:
    diverged = run.status is RunStatus.DIVERGED
    end = run.measures.diverged_at_s if diverged else run.scenario.duration_s
    picture.update_xaxes(range=[0, end], unifiedhovertitle={"text": "%{x:.3f} s"})
    picture.update_xaxes(title_text="Time, s", row=rows, col=1)
