"""The folder of an identification: page, results, the new loader file, responses estimated from records; whole or not at all."""

import dataclasses
import re
from collections.abc import Sequence
from pathlib import Path

from forcefeel.bench.identification.as_json import FitSettings, identification_json, response_csv
from forcefeel.bench.identification.page.page import identification_page
from forcefeel.bench.identification.result import Identification
from forcefeel.bench.responses import Response
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS, LOADER, RESPONSES = "identification.html", "results.json", "loader.toml", "responses"
"""Names in the folder."""

FOLDER = OutputFolder("the identification", (PAGE, RESULTS, LOADER), (RESPONSES,))
"""Files checked before the work and written after it."""

_NAME = re.compile(r"[^\w.-]+")


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
