"""The page of a sweep, the template with plots, tables and text, and its folder with summary and band of responses."""

from dataclasses import replace
from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.picture import Picture
from forcefeel.page.render import render
from forcefeel.simulation import Run, simulate
from forcefeel.simulation.findings import input_text
from forcefeel.simulation.page import tables as simulation_tables
from forcefeel.simulation.programmed_feel import ideal_angle
from forcefeel.sweep import SweepResult
from forcefeel.sweep.as_json import sweep_json, whose_law
from forcefeel.sweep.findings import main_measures, number_of, sweep_conclusions
from forcefeel.sweep.folder import CHUNKS, PLAN, RUNS
from forcefeel.sweep.page import maps as sweep_maps
from forcefeel.sweep.page import plots as sweep_plots
from forcefeel.sweep.page import tables as sweep_tables
from forcefeel.sweep.result import ENVELOPE_RUNS
from forcefeel.sweep.stability import damping_map
from forcefeel.sweep.summary import Spread, Summary
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import ANGLE, UnitSystem

PAGE, SUMMARY, ENVELOPE = "sweep.html", "summary.json", "envelope.csv"

FOLDER = OutputFolder("the sweep", (PAGE, SUMMARY, ENVELOPE))
"""Files of the report."""

RUNS_FOLDER = OutputFolder("the sweep", (PLAN, RUNS), (CHUNKS,), plots=False)
"""Files of the runs."""

_TORNADOS = 4
"""Number of measures with a plot of correlations."""

_SLICED = 2
"""Number of measures drawn over their most important parameter."""

_MAPPED = 5


def sweep_page(
    result: SweepResult, summary: Summary, units: UnitSystem, law: str = "original", *, command: str = ""
) -> str:
    """The whole page."""
    sweep = result.sweep
    nominal = simulate(sweep.loader, sweep.scenario, sweep.nominal_law)
    measures = main_measures(result, summary)
    over_grid = bool(sweep.axes)
    random = bool(sweep.varied)
    return render(
        "sweep/page/sweep.html.j2",
        command=command,
        loader=sweep.loader,
        sweep=sweep,
        kind="Grid over settings" if over_grid else "Monte Carlo over tolerances",
        subject=input_text(sweep.scenario.force, units),
        conclusions=sweep_conclusions(result, summary, units),
        statuses=sweep_tables.statuses(summary),
        responses=None if over_grid else _responses(result, nominal, law),
        distributions=() if over_grid else _distributions(result, summary, measures, units, law),
        influences=() if over_grid else _influences(result, summary, measures, units, law),
        maps=_maps(result, measures, units, law) if over_grid else (),
        correlations=None if over_grid or not measures else sweep_tables.correlations(summary, measures, units),
        spreads=sweep_tables.spreads(summary, measures, units),
        tolerances=sweep_tables.tolerances(result, units) if random else None,
        grid=sweep_tables.grid(result, units) if over_grid else None,
        scenario=simulation_tables.scenario(replace(nominal, method="stepped"), units, law, whose_law(sweep)),
        parameters=machine.parameters(sweep.loader, units),
    )


def _responses(result: SweepResult, nominal: Run, law: str) -> Picture | None:
    """The band of responses; ``None`` if every run of the sample diverged."""
    count = int(result.envelope.attrs["runs"])
    if not count:
        return None
    ideal = ideal_angle(nominal)
    drawn = sweep_plots.band(result, nominal.outputs["column_angle_rad"], ideal, sweep_plots.color(law))
    requested = min(ENVELOPE_RUNS, result.sweep.total)
    whole = "All" if requested == result.sweep.total else "The first"
    sample = (
        f"{whole} {count:,} runs"
        if count == requested
        else f"The {count:,} of the first {requested:,} runs that did not diverge"
    )
    meaning = f"{sample}, at each time by themselves: no single loader need follow an edge of the band."
    if ideal is not None:
        meaning += " Dotted: what I, B and G alone would do under the same force."
    return Picture.of("responses", "Column angle over time", meaning, drawn)


def _distributions(
    result: SweepResult, summary: Summary, measures: tuple[str, ...], units: UnitSystem, law: str
) -> tuple[Picture, ...]:
    pictures = []
    for name in measures:
        spread = summary.spreads[name]
        along = sweep_plots.axis_title(name, spread.unit, units)
        drawn, beyond = sweep_plots.histogram(result.finite(name), spread, along, units, sweep_plots.color(law))
        many = (
            f"{beyond:,} run{'s' if beyond > 1 else ''} farther out, up to the highest of the table" if beyond else ""
        )
        remark = f"Not in view: {many}." if many else ""
        middle = _middle(spread, units)
        pictures.append(Picture.of(f"spread-{name}", sweep_plots.title(name), middle, drawn, remark))
    return tuple(pictures)


def _influences(
    result: SweepResult, summary: Summary, measures: tuple[str, ...], units: UnitSystem, law: str
) -> tuple[Picture, ...]:
    pictures = [
        Picture.of(f"influence-{name}", sweep_plots.title(name), "", sweep_plots.tornado(name, summary, units))
        for name in measures[:_TORNADOS]
    ]
    for name in measures[:_SLICED]:
        if ranking := summary.ranking(name):
            key = ranking[0][0]
            drawn = sweep_plots.slices(result, name, key, units, sweep_plots.color(law))
            title = f"{sweep_plots.title(name)} over {key}"
            pictures.append(
                Picture.of(
                    f"slices-{name}", title, "The parameter with the largest effect, while all others vary too.", drawn
                )
            )
    return tuple(pictures)


def _maps(result: SweepResult, measures: tuple[str, ...], units: UnitSystem, law: str) -> tuple[Picture, ...]:
    hue = sweep_plots.color(law)
    if len(result.sweep.axes) == 1:
        lines = [
            Picture.of(f"line-{name}", sweep_plots.title(name), "", sweep_maps.measure_line(result, name, units, hue))
            for name in measures[:_MAPPED]
        ]
        return (*lines, Picture.of("line-status", "How the runs ended", "", sweep_maps.status_lines(result, units)))
    damping = damping_map(result.sweep)
    pictures = [
        Picture.of(f"map-{name}", sweep_plots.title(name), "", *sweep_maps.measure_map(result, name, damping, units))
        for name in measures[:_MAPPED]
    ]
    if damping is not None:
        meaning = (
            "The least damped mode of the linear model at each setting: red is unstable. Optional effects and the sampling of a "
            "digital controller are left out, so that a run may end otherwise."
        )
        pictures.insert(
            0,
            Picture.of("map-stability", "Linear stability", meaning, sweep_maps.stability_map(result, damping, units)),
        )
    several = result.sweep.machines > 1
    drawn = (sweep_maps.share_map if several else sweep_maps.status_map)(result, units)
    return (Picture.of("map-status", "Runs that settle" if several else "How the runs ended", "", drawn), *pictures)


def _middle(spread: Spread, units: UnitSystem) -> str:
    """Range of nine of ten runs, and the nominal loader."""
    low, high, nominal = (
        number_of(spread.unit, value, units) for value in (spread.quantile(0.05), spread.quantile(0.95), spread.nominal)
    )
    return f"{low} to {high} {spread.unit.shown(units)} for nine of ten; nominal {nominal}."


def write_sweep(
    result: SweepResult, summary: Summary, out: Path, units: UnitSystem, law: str = "original", *, command: str = ""
) -> Path:
    """Write ``sweep.html``, ``summary.json`` and, for a sweep without grid, ``envelope.csv``.

    Existing files stay until the new ones are complete; other files in the folder are kept.

    Args:
        result: The sweep.
        summary: Its summary.
        out: The folder; created if missing.
        units: The units of every number.
        law: Name of the law.
        command: The command, for the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> found = ff.run_sweep(ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), runs=32))
        >>> ff.sweep.write_sweep(found, ff.sweep.summarize(found), Path("sweep"), ff.UnitSystem.SI).parent.name
        'sweep'
    """
    FOLDER.check(out)
    contents = {
        SUMMARY: json_text(sweep_json(result, summary, units)),
        PAGE: sweep_page(result, summary, units, law, command=command),
    }
    if not result.sweep.axes:
        contents = {ENVELOPE: _envelope(result, units), **contents}
    FOLDER.write(out, contents)
    return out / PAGE


def _envelope(result: SweepResult, units: UnitSystem) -> str:
    """The edges of the band over time."""
    band = result.envelope
    heads = ["time (s)", *(f"{edge} ({ANGLE.shown(units)})" for edge in band["edge"].values)]
    columns = band["column_angle_rad"].values * ANGLE.from_si(1.0, units)
    return csv_text(heads, zip(band["time_s"].values.tolist(), *columns.tolist(), strict=True), ".9g")
