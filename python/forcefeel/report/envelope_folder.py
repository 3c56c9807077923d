"""The folder of an envelope: its page, its results, its settings as a table and its maps, whole or not at all."""

import json
from pathlib import Path

from forcefeel.envelopes import Envelope
from forcefeel.envelopes.plain import plain_envelope, settings_csv
from forcefeel.errors import InputError
from forcefeel.files import write_whole
from forcefeel.report.envelope_page import envelope_page
from forcefeel.report.staging import write_together
from forcefeel.units import UnitSystem

PAGE, RESULTS, SETTINGS, MAPS = "envelope.html", "results.json", "settings.csv", "envelope.nc"
"""Names in the folder."""


def write_envelope(found: Envelope, out: Path, units: UnitSystem, *, replace: bool = False) -> Path:
    """Writes ``envelope.nc``, ``settings.csv``, ``results.json`` and ``envelope.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        found: The envelope.
        out: The folder; made if it is not there.
        units: The units of every number but those of ``envelope.nc``, which are SI.
        replace: Whether the new files may take the place of others.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.
    """
    check_envelope_folder(out, replace=replace)
    texts = {
        SETTINGS: settings_csv(found, units),
        RESULTS: json.dumps(plain_envelope(found, units), indent=1, ensure_ascii=False, allow_nan=False) + "\n",
        PAGE: envelope_page(found, units),
    }
    maps = bytes(found.data.to_netcdf(engine="scipy"))
    write_together(out, {name: text for name, text in texts.items() if name != PAGE})
    write_whole(out / MAPS, maps)
    write_together(out, {PAGE: texts[PAGE]})
    return out / PAGE


def check_envelope_folder(out: Path, *, replace: bool) -> None:
    """Refuses what would fail halfway: a file where a folder is wanted, a folder where a file is, files of somebody else.

    Raises:
        InputError: If so.
    """
    if out.exists() and not out.is_dir():
        raise InputError(
            f"{out}: is a file; expected a folder for the envelope; name another one, or move the file away"
        )
    for name in (PAGE, RESULTS, SETTINGS, MAPS):
        if (out / name).is_dir():
            raise InputError(f"{out / name}: is a folder; expected to write a file of that name; move the folder away")
        if (out / name).exists() and not replace:
            raise InputError(f"{out}: holds {name} already; name another folder with --out, or --replace to replace it")
