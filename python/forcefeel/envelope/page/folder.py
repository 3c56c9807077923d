"""The folder of an envelope: its page, its results, its settings as a table and its maps, whole or not at all."""

from pathlib import Path

from forcefeel.envelope import Envelope
from forcefeel.envelope.as_json import envelope_json, settings_csv
from forcefeel.envelope.page.page import envelope_page
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS, SETTINGS, MAPS = "envelope.html", "results.json", "settings.csv", "envelope.nc"
"""Names in the folder."""

FOLDER = OutputFolder("the envelope", (PAGE, RESULTS, SETTINGS, MAPS))
"""Checked before the work, written after it."""


def write_envelope(found: Envelope, out: Path, units: UnitSystem, *, replace: bool = False, command: str = "") -> Path:
    """Writes ``envelope.nc``, ``settings.csv``, ``results.json`` and ``envelope.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        found: The envelope.
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
        >>> found = ff.find_envelope(ff.elevator(), ["original"], grid)
        >>> ff.envelope.write_envelope(found, Path("envelope"), ff.UnitSystem.SI).parent.name
        'envelope'
    """
    FOLDER.check(out, replace=replace)
    contents: dict[str, str | bytes] = {
        MAPS: bytes(found.data.to_netcdf(engine="scipy")),
        SETTINGS: settings_csv(found, units),
        RESULTS: json_text(envelope_json(found, units)),
        PAGE: envelope_page(found, units, command=command),
    }
    FOLDER.write(out, contents)
    return out / PAGE
