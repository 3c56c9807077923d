"""The page of a fitted feel, the template filled with plots, tables and texts, and its folder."""

from pathlib import Path

from forcefeel.feel.as_json import feel_json
from forcefeel.feel.findings import feel_conclusions, row_cells
from forcefeel.feel.page import plots
from forcefeel.feel.result import FeelFit
from forcefeel.json_values import json_text
from forcefeel.loader.parameters import TABLE
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import heading_text, number_text, parameter_name, unit_text
from forcefeel.units import ANGLE, FORCE, UnitSystem

PAGE, RESULTS = "feel.html", "results.json"

FOLDER = OutputFolder("the feel", (PAGE, RESULTS))

_MOST_ROWS = 60
"""Points that the table of the page has; more are in the results."""


def feel_page(fit: FeelFit, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
    return render(
        "feel/page/feel.html.j2",
        command=command,
        loader=fit.loader,
        points=fit.points,
        conclusions=feel_conclusions(fit, units),
        force=drawing(plots.force_over_angle(fit, units), "force-angle"),
        rows=_rows(fit, units),
        release=fit.release and drawing(plots.release_over_time(fit.release, units), "release-time"),
        residuals=_residuals(fit, units),
        parameters=machine.parameters(fit.loader, units),
    )


def _rows(fit: FeelFit, units: UnitSystem) -> Table:
    """A row for each number of the feel."""
    rows = tuple(
        (
            words(parameter_name(key) if key in TABLE else key.replace(".", " ").replace("_", " ")),
            number(value.replace("-", "\N{MINUS SIGN}")),
            number(f"± {half}" if half and half[0] != "a" else half),
            words(unit_text(unit)),
            words(source),
        )
        for key, value, half, unit, source in row_cells(fit, units)
    )
    return Table((*heads("Row", "Value", "95 % interval"), Cell("Unit"), Cell("From")), rows)


def _residuals(fit: FeelFit, units: UnitSystem) -> Table | None:
    """Each point beside the feel; none for a record."""
    points = fit.points
    if len(points.force_n) > _MOST_ROWS:
        return None
    order = points.position.argsort()
    rows = tuple(
        (
            number(number_text(ANGLE.from_si(x, units), 4)),
            words({1.0: "rising", -1.0: "falling"}.get(direction, "")),
            *(number(number_text(FORCE.from_si(value, units), 4)) for value in (force, force - missed, missed)),
        )
        for x, direction, force, missed in zip(
            *(
                values[order].tolist()
                for values in (points.position, points.directions, points.force_n, fit.residual_n)
            ),
            strict=True,
        )
    )
    first = Cell(heading_text("Position", ANGLE, units), "number")
    forces = (Cell(heading_text(name, FORCE, units), "number") for name in ("Measured", "Feel", "Difference"))
    return Table((first, Cell("Direction"), *forces), rows)


def write_feel(fit: FeelFit, out: Path, units: UnitSystem, *, replace: bool = False, command: str = "") -> Path:
    """Writes ``results.json`` and ``feel.html``, the page last; other files in the folder are left alone.

    Args:
        fit: The fitted feel.
        out: The folder; created if it does not exist.
        units: The units of every number.
        replace: Whether existing files may be replaced.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains files of these names without ``replace``, or cannot be written.

    Example:
        >>> angle = np.radians([-8, -6, -4, -2, 2, 4, 6, 8])
        >>> points = ff.qualification.ForcePoints(angle, 300 * angle + 10 * np.sign(angle))
        >>> fit = ff.feel.fit_feel(points, ff.feel.FeelPlan(ff.digital_elevator()))
        >>> ff.feel.write_feel(fit, Path("feel"), ff.UnitSystem.SI).name
        'feel.html'
    """
    FOLDER.check(out, replace=replace)
    FOLDER.write(out, {RESULTS: json_text(feel_json(fit, units)), PAGE: feel_page(fit, units, command=command)})
    return out / PAGE
