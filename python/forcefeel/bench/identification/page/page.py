"""The page of an identification and its folder: results, the new loader file, responses estimated from records."""

import dataclasses
import re
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from forcefeel.bench.identification.as_json import FitSettings, identification_json, response_csv
from forcefeel.bench.identification.digits import title_of
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.bench.identification.misfit import size_text, stated_noise
from forcefeel.bench.identification.page import plots as identification_plots
from forcefeel.bench.identification.page import tables as identification_tables
from forcefeel.bench.identification.result import Fitted, Identification, Status
from forcefeel.bench.responses import Response
from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.picture import Picture
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import number_text, prose_html
from forcefeel.units import UnitSystem

PAGE, RESULTS, LOADER, RESPONSES = "identification.html", "results.json", "loader.toml", "responses"

FOLDER = OutputFolder("the identification", (PAGE, RESULTS, LOADER), (RESPONSES,))

_NAME = re.compile(r"[^\w.-]+")


def identification_page(
    identification: Identification,
    units: UnitSystem,
    settings: FitSettings | None = None,
    estimated: Sequence[str] = (),
    *,
    command: str = "",
) -> str:
    """The whole page, numbers in ``units``; ``estimated`` are the files with responses estimated from records."""
    responses = [fitted for fitted in identification.fitted if isinstance(fitted.data, Response)]
    return render(
        "bench/identification/page/identification.html.j2",
        command=command,
        loader=identification.before,
        identification=identification,
        conclusions=identification_conclusions(identification, units),
        glance=identification_tables.glance(identification),
        estimates=identification_tables.estimates(identification, units),
        estimates_drawing=_estimates(identification),
        inseparable=[
            (group.sentence, identification_tables.inseparable(group) if len(group.keys) > 1 else None)
            for group in identification.inseparable
        ],
        advice=identification_tables.advice(identification),
        responses=[
            _response(k, fitted, fitted.data, units)
            for k, fitted in enumerate(responses)
            if isinstance(fitted.data, Response)
        ],
        bars=any(stated_noise(fitted) for fitted in responses),
        records=[
            _record(k, fitted, units)
            for k, fitted in enumerate(fitted for fitted in identification.fitted if fitted not in responses)
        ],
        several=len(identification.estimates) > 1,
        correlations=identification_tables.correlations(identification),
        rigid=identification.rigid and identification_tables.rigid(identification.rigid),
        level=number_text(identification.rigid.level) if identification.rigid else "",
        data=identification_tables.data(identification, units),
        estimated=estimated,
        settings=settings and identification_tables.settings(settings),
        ends=identification_tables.ends(identification, units),
        parameters=machine.parameters(identification.loader or identification.before, units),
    )


def _estimates(identification: Identification) -> Markup:
    """The plot of the estimates; empty without determined ones."""
    if all(estimate.status is Status.UNDETERMINED for estimate in identification.estimates):
        return Markup("")
    return drawing(identification_plots.estimates(identification), "estimates-plot")


def _response(k: int, fitted: Fitted, data: Response, units: UnitSystem) -> Picture:
    drawn = identification_plots.response(fitted, data, units)
    return Picture.of(f"response-{k}", title_of(fitted), _meaning(fitted, units), drawn)


def _record(k: int, fitted: Fitted, units: UnitSystem) -> Picture:
    drawn = identification_plots.record(fitted, units)
    return Picture.of(f"record-{k}", title_of(fitted), _meaning(fitted, units), drawn)


def _meaning(fitted: Fitted, units: UnitSystem) -> Markup:
    experiment = str(fitted.data.experiment).replace("_", " ")
    return prose_html(
        f"Experiment {experiment}; the fit leaves {size_text(fitted, fitted.residual_rms, units)} (root mean square)."
    )


def write_identification(  # noqa: PLR0913  keywords of what is asked
    identification: Identification,
    out: Path,
    units: UnitSystem,
    settings: FitSettings | None = None,
    *,
    estimated: Sequence[Response] = (),
    inputs: Sequence[Path] = (),
    replace: bool = False,
    command: str = "",
) -> Path:
    """Write ``loader.toml``, ``results.json`` and ``identification.html``, the page last.

    ``loader.toml`` is written only if every parameter is determined and the model explains the data; an earlier one is removed.
    Other files in the folder are kept.

    Args:
        identification: The identification.
        out: The folder; created if missing.
        units: The units of every number.
        settings: Settings of the fit, for the page.
        estimated: Responses estimated from records; a file each in ``responses``.
        inputs: Input files, which are not overwritten.
        replace: Whether to replace existing files.
        command: The command, for the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file or cannot be written, holds files of these names without ``replace``, or one of ``inputs``
            has such a name.

    Example:
        >>> data = [ff.read_bench_data("examples/bench/servo-closed.csv")]
        >>> found = ff.identify(ff.load("examples/bench/loader.toml"), data, "k,c", starts=1)
        >>> ff.bench.write_identification(found, Path("found"), ff.UnitSystem.US).parent.name
        'found'
    """
    tables = {f"{RESPONSES}/{name}": response for name, response in zip(_names(estimated), estimated, strict=True)}
    dataclasses.replace(FOLDER, files=(*FOLDER.files, *tables)).check(out, replace=replace, inputs=inputs)
    contents = {name: response_csv(response, units) for name, response in tables.items()}
    if identification.loader is not None:
        contents[LOADER] = identification.loader.to_toml(units)
    results = identification_json(identification, units, settings)
    contents[RESULTS] = json_text(results)
    contents[PAGE] = identification_page(identification, units, settings, tuple(tables), command=command)
    FOLDER.write(out, contents)
    return out / PAGE


def _names(estimated: Sequence[Response]) -> list[str]:
    """A file name for each response, the channel in it where a record has several."""
    names = [_NAME.sub("-", response.name) for response in estimated]
    full = [
        f"{name}-{response.output}" if names.count(name) > 1 else name
        for name, response in zip(names, estimated, strict=True)
    ]
    return [f"{name}.csv" for name in full]
