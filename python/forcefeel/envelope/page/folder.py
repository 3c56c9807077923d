"""The folder of an envelope: its page, its results, its settings as a table and its maps, whole or not at all."""

from pathlib import Path

from forcefeel.envelope.as_json import cockpit_json, envelope_json, settings_csv
from forcefeel.envelope.cockpit import CockpitEnvelope
from forcefeel.envelope.page.page import Files, cockpit_page, envelope_page
from forcefeel.envelope.result import Envelope
from forcefeel.json_values import json_text
from forcefeel.loader.axes import PROJECT_AXES
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS = "envelope.html", "results.json"
"""Names in the folder, beside those of ``Files``."""

FOLDER = OutputFolder(
    "the envelope",
    (PAGE, RESULTS, *(name for axis in ("", *PROJECT_AXES) for name in Files.of(axis).names)),
)
"""Checked before the work, written after it; a loader's and a cockpit's take one another's place."""


def write_envelope(
    envelope: Envelope, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Writes ``envelope.nc``, ``settings.csv``, ``results.json`` and ``envelope.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        envelope: The envelope.
        out: The folder; made if it is not there.
        units: The units of every number but those of ``envelope.nc``, which are SI.
        replace: Whether the new files may take the place of others.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> envelope = ff.find_envelope(ff.elevator(), ["original"], grid)
        >>> ff.envelope.write_envelope(envelope, Path("envelope"), ff.UnitSystem.SI).parent.name
        'envelope'
    """
    FOLDER.check(out, replace=replace)
    files = Files.of()
    contents = {
        **_maps(envelope, units, files),
        RESULTS: json_text(envelope_json(envelope, units)),
        PAGE: envelope_page(envelope, units, files, command=command),
    }
    FOLDER.write(out, contents)
    return out / PAGE


def write_cockpit(
    cockpit: CockpitEnvelope, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    r"""Writes the files of each axis, such as ``envelope-roll.html``, then ``results.json`` and ``envelope.html`` of the whole.

    Args:
        cockpit: The envelope of each axis.
        out: The folder; made if it is not there.
        units: The units of every number but those of the netCDF files, which are SI.
        replace: Whether the new files may take the place of others.
        command: The command that asked for it, to stand on the pages.

    Returns:
        The path of the page over the axes.

    Raises:
        InputError: As ``write_envelope``.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator"\n', encoding="utf-8")
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> def plan(loader):
        ...     return ff.envelope.make_plan(loader, ["original"], grid)
        >>> cockpit = ff.envelope.find_cockpit(ff.loader.read_project("cockpit.toml"), plan)
        >>> ff.envelope.write_cockpit(cockpit, Path("envelopes"), ff.UnitSystem.SI).name
        'envelope.html'
    """
    FOLDER.check(out, replace=replace)
    contents: dict[str, str | bytes] = {}
    for axis, envelope in cockpit.axes.items():
        files = Files.of(axis)
        contents |= _maps(envelope, units, files)
        contents[files.page] = envelope_page(envelope, units, files, command=command)
    contents[RESULTS] = json_text(cockpit_json(cockpit, units))
    contents[PAGE] = cockpit_page(cockpit, units, command=command)
    FOLDER.write(out, contents)
    return out / PAGE


def _maps(envelope: Envelope, units: UnitSystem, files: Files) -> dict[str, str | bytes]:
    return {files.maps: bytes(envelope.data.to_netcdf(engine="scipy")), files.settings: settings_csv(envelope, units)}
