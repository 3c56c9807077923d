"""The folder of an export: what each target writes, whole or not at all."""

from pathlib import Path

from forcefeel.export.c_code import c_files
from forcefeel.export.exported import Exported
from forcefeel.export.firmware_code import firmware_files
from forcefeel.export.fmu_files import fmu_files
from forcefeel.export.matlab import matlab_files
from forcefeel.export.parameter_sheet import SHEET, parameter_sheet
from forcefeel.export.target import Target
from forcefeel.page.folder import OutputFolder


def _files(exported: Exported, target: Target, *, single: bool, triple: str | None) -> dict[str, str | bytes]:
    match target:
        case Target.C:
            return c_files(exported, single=single)
        case Target.FIRMWARE:
            return firmware_files(exported, triple, single=single)
        case Target.FMU:
            return fmu_files(exported)
        case Target.MATLAB:
            return matlab_files(exported)
        case Target.TABLE:
            return {SHEET.format(exported.name): parameter_sheet(exported)}


def write_export(
    exported: Exported,
    target: Target,
    out: Path,
    *,
    replace: bool = False,
    single: bool = False,
    triple: str | None = None,
) -> dict[str, Path]:
    """Writes what a target takes; other files in the folder are left alone.

    Args:
        exported: The law with its loader.
        target: Where it goes.
        out: The folder; made if it is not there.
        replace: Whether the new files may take the place of others.
        single: Of C and firmware, whether the target computes in single precision.
        triple: Of firmware, the target as Rust names it; else this machine.

    Returns:
        The path of each file by its name.

    Raises:
        InputError: If the target does not take such a law or is not installed, or ``out`` is a file, holds files of these names
            that are not to be replaced, or cannot be written; nothing is written then.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> exported = ff.export.Exported.of("robust", ff.digital_elevator(), "pitch")
        >>> list(ff.export.write_export(exported, ff.export.Target.TABLE, Path("sheet")))
        ['pitch_parameters.csv']
    """
    files = _files(exported, target, single=single, triple=triple)
    folder = OutputFolder("the export", tuple(files), plots=False)
    folder.check(out, replace=replace)
    folder.write(out, files)
    return {name: out / name for name in files}
