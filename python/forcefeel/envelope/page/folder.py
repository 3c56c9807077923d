"""Folder of an envelope: page, results, table of settings and maps, written completely or not at all."""

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
"""File names in addition to those of ``Files``."""

FOLDER = OutputFolder(
    "the envelope",
    (PAGE, RESULTS, *(name for axis in ("", *PROJECT_AXES) for name in Files.of(axis).names)),
)
"""Checked before the computation, written after it; a loader's folder and a cockpit's replace each other."""


def write_envelope(
    envelope: Envelope, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``envelope.nc``, ``settings.csv``, ``results.json`` and ``envelope.html``, the page last.

    Existing files stay until the new ones are complete; other files in the folder are not touched.

    Args:
        envelope: The envelope.
        out: The folder; created if missing.
        units: Units of all numbers except those of ``envelope.nc``, which are SI.
        replace: Whether existing files may be replaced.
        command: Command line to show on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains such files and ``replace`` is false, or cannot be written.

    Example:
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
    r"""Write the files of each axis, such as ``envelope-roll.html``, then the cockpit's ``results.json`` and ``envelope.html``.

    Args:
        cockpit: The envelope of each axis.
        out: The folder; created if missing.
        units: Units of all numbers except those of the netCDF files, which are SI.
        replace: Whether existing files may be replaced.
        command: Command line to show on the pages.

    Returns:
        The path of the cockpit's page.

    Raises:
        InputError: As ``write_envelope``.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator-1974"\n', encoding="utf-8")
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
