"""Folder of an export, written completely or not at all."""

from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.export.axis_code import axis_fields, axis_files, axis_names
from forcefeel.export.c_code import c_files, c_names
from forcefeel.export.drive_sheet import DRIVE, DRIVE_PAGE, drive_csv, drive_page, drive_settings
from forcefeel.export.exported import Exported
from forcefeel.export.firmware_code import firmware_files, firmware_names
from forcefeel.export.fmu_files import fmu_files, fmu_names
from forcefeel.export.matlab import matlab_files, matlab_names
from forcefeel.export.openffboard import COMMANDS, README, openffboard_files
from forcefeel.export.pair_code import PairExport, pair_files, pair_names
from forcefeel.export.parameter_sheet import OBSERVER, SHEET, observer_sheet, parameter_sheet
from forcefeel.export.structured_text import st_files, st_names
from forcefeel.export.target import Target
from forcefeel.page.folder import OutputFolder


def export_folder(target: Target, name: str, *, triple: str | None = None, supervised: bool = False) -> OutputFolder:
    """Folder of an export with the file prefix ``name``; it checks for existing files before the computation.

    Example:
        >>> ff.export.export_folder(ff.export.Target.TABLE, "pitch").files
        ('pitch_drive.csv', 'pitch_drive.html', 'pitch_parameters.csv', 'pitch_observer.csv')
    """
    match target:
        case Target.C:
            names = (*c_names(name), *(axis_names(name) if supervised else ()))
        case Target.FIRMWARE:
            names = firmware_names(name, triple)
        case Target.FMU:
            names = fmu_names(name)
        case Target.MATLAB:
            names = matlab_names(name)
        case Target.OPENFFBOARD:
            names = (COMMANDS.format(name), README.format(name))
        case Target.ST:
            names = st_names(name)
        case Target.TABLE:
            names = tuple(file.format(name) for file in (DRIVE, DRIVE_PAGE, SHEET, OBSERVER))
    return OutputFolder("the export", names, plots=False)


def _files(
    exported: Exported, target: Target, *, single: bool, measure: bool, triple: str | None
) -> dict[str, str | bytes]:
    match target:
        case Target.C:
            axis = axis_fields(exported, single=single, measure=measure) if exported.supervised else None
            files = c_files(exported, single=single, measure=measure, axis=axis)
            return files | (axis_files(axis) if axis else {})
        case Target.FIRMWARE:
            return firmware_files(exported, triple, single=single)
        case Target.FMU:
            return fmu_files(exported)
        case Target.MATLAB:
            return matlab_files(exported)
        case Target.OPENFFBOARD:
            return openffboard_files(exported)
        case Target.ST:
            return st_files(exported)
        case Target.TABLE:
            settings, name = drive_settings(exported.loader), exported.name
            return {
                DRIVE.format(name): drive_csv(settings),
                DRIVE_PAGE.format(name): drive_page(exported.loader, settings, name),
                SHEET.format(name): parameter_sheet(exported),
                OBSERVER.format(name): observer_sheet(exported),
            }


def write_export(
    exported: Exported,
    target: Target,
    out: Path,
    *,
    replace: bool = False,
    single: bool = False,
    measure: bool = False,
    triple: str | None = None,
) -> dict[str, Path]:
    """Write the files of a target; other files in the folder are not touched.

    Args:
        exported: The law with its loader.
        target: Where it goes.
        out: The folder; made if it is not there.
        replace: Whether the new files may take the place of others.
        single: Of C and firmware, whether the target computes in single precision.
        measure: Of C, whether README and header state stack and instructions of a step on each installed target.
        triple: Of firmware, the target as Rust names it, or the board ``stm32f405``; else this machine.

    Returns:
        The path of each file by its name.

    Raises:
        InputError: If the target does not take such a law or is not installed, or ``out`` is a file, holds files of these names
            that are not to be replaced, or cannot be written; nothing is written then.

    Example:
        >>> exported = ff.export.Exported.of("robust", ff.digital_elevator(), "pitch")
        >>> list(ff.export.write_export(exported, ff.export.Target.TABLE, Path("sheet")))
        ['pitch_drive.csv', 'pitch_drive.html', 'pitch_parameters.csv', 'pitch_observer.csv']
    """
    if exported.tunable and target is not Target.C:
        raise InputError(f"tunable: is for the target c, and the target is {target}; leave it out")
    if exported.supervised and target is not Target.C:
        raise InputError(f"supervisor: is for the target c, and the target is {target}; leave it out")
    folder = export_folder(target, exported.name, triple=triple, supervised=exported.supervised)
    folder.check(out, replace=replace)
    files = _files(exported, target, single=single, measure=measure, triple=triple)
    folder.write(out, files)
    return {name: out / name for name in files}


def write_pair(pair: PairExport, out: Path, *, replace: bool = False, single: bool = False) -> dict[str, Path]:
    """Write the C of a link beside the folders of its axes; of a shaft a note.

    Args:
        pair: The link with the exported laws of its sides.
        out: The folder.
        replace: Whether the new files may take the place of others.
        single: Whether the target computes in single precision.

    Raises:
        InputError: If the pair cannot be simulated, or as ``write_export``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> laws = [ff.export.Exported.of("robust", loader, f"side_{k}") for k, loader in enumerate(project.loaders.values())]
        >>> pair = ff.export.PairExport.of(project, project.links["pitch"], "cockpit", tuple(laws))
        >>> list(ff.export.write_pair(pair, Path("pitch-link")))
        ['README.md']
    """
    folder = OutputFolder("the export", pair_names(pair.name, electronic=pair.electronic), plots=False)
    folder.check(out, replace=replace)
    files = pair_files(pair, single=single)
    folder.write(out, files)
    return {name: out / name for name in files}
