"""The one page of a commissioning, with the result, the steps and the numbers, and its folder, which holds the steps' folders."""

import json
from collections.abc import Sequence
from pathlib import Path

from forcefeel.commission.as_json import commission_json
from forcefeel.commission.findings import GOOD_LAW, OTHER_LAW, commission_conclusions, glance
from forcefeel.commission.page import plots, tables
from forcefeel.commission.result import Commission
from forcefeel.commission.steps import ENVELOPE, IDENTIFICATION, LAW, STATE, TESTS
from forcefeel.errors import InputError
from forcefeel.files import check_output_file, check_output_folder, output_kind
from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.setting_maps import picture

PAGE, RESULTS, LOADER = "commission.html", "results.json", "loader.toml"
"""Names in the folder, besides those of the law."""

FOLDER = OutputFolder("the commissioning", (PAGE, RESULTS, LOADER, GOOD_LAW, OTHER_LAW))

_STEPS = (IDENTIFICATION, LAW, ENVELOPE, TESTS)


def commission_page(commission: Commission, *, command: str = "") -> str:
    """The whole page, numbers in the plan's units."""
    units, curve = commission.plan.units, commission.identified.curve
    maps = (
        commission.envelope
        and commission.chosen
        and plots.outcome_maps(commission.envelope, commission.chosen.name, commission.loader or commission.before)
    )
    return render(
        "commission/page/commission.html.j2",
        command=command,
        loader=commission.loader or commission.before,
        commission=commission,
        conclusions=commission_conclusions(commission),
        curve=drawing(plots.curve(curve, units), "curve") if curve else None,
        maps=picture(maps, units) if maps else None,
        steps=tables.steps(glance(commission)),
        estimates=tables.estimates(commission, units) if commission.identified.parameters else None,
        tests=tables.tests(commission.tested) if commission.tested else None,
        what_ifs=tables.what_ifs(commission.envelope) if commission.envelope and commission.envelope.what_ifs else None,
        shares=tables.shares(commission.envelope, commission.plan.share) if commission.envelope else None,
        parameters=machine.parameters(commission.loader or commission.before, units),
    )


def check_folder(out: Path, command: str, *, replace: bool = False, inputs: Sequence[Path] = ()) -> None:
    """Refuse an unusable folder before the work. A folder of the same command, complete or interrupted, is resumed.

    Args:
        out: The folder.
        command: The command that is asked.
        replace: Whether results may be replaced.
        inputs: Files that the work is made from.

    Raises:
        InputError: If it holds results of another command that are not to be replaced, or a file where a folder is wanted.
    """
    same = _command_of_results(out) == command
    FOLDER.check(out, replace=replace or same, inputs=inputs)
    check_output_file(out / STATE)
    for name in _STEPS:
        folder = out / name
        check_output_folder(folder, "a folder of that name")
        if any(path.resolve().is_relative_to(folder.resolve()) for path in inputs):
            raise InputError(f"{folder}: holds what the commissioning is made from; name another folder with --out")
        if output_kind(folder) and not (replace or same or output_kind(out / STATE)):
            raise InputError(f"{out}: holds {name} already; name another folder with --out, or --replace to replace it")


def _command_of_results(out: Path) -> str | None:
    """The command whose results a folder holds."""
    try:
        return str(json.loads((out / RESULTS).read_text(encoding="utf-8"))["command"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def write_commission(commission: Commission, out: str | Path, *, command: str = "") -> Path:
    """Write ``loader.toml``, the law, ``results.json`` and ``commission.html``, the page last.

    The law is ``law.json`` if it is accepted, else ``law-rejected.json``; that of an earlier run is removed.

    Args:
        commission: The commissioning result.
        out: The folder of the run.
        command: The command, for the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If the folder cannot be written.

    Example:
        >>> from forcefeel.commission.result import Identified
        >>> nothing = Identified(False, "nothing was measured")
        >>> commission = ff.commission.Commission(ff.commission.CommissionPlan(), ff.elevator(), nothing)
        >>> ff.commission.write_commission(commission, "commissioned").name
        'commission.html'
    """
    out = Path(out)
    contents: dict[str, str | bytes] = {}
    if commission.loader is not None:
        contents[LOADER] = (out / IDENTIFICATION / LOADER).read_bytes()
    if commission.law is not None:
        contents[GOOD_LAW if commission.ok else OTHER_LAW] = (out / LAW / GOOD_LAW).read_bytes()
    contents[RESULTS] = json_text({"command": command, **commission_json(commission)})
    contents[PAGE] = commission_page(commission, command=command)
    FOLDER.write(out, contents)
    return out / PAGE
