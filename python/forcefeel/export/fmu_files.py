"""FMUs of a law and its loader: zipped description, library, resources and icon of each."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from forcefeel.errors import InputError
from forcefeel.export.exported import Exported
from forcefeel.export.fmu_description import description
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.timing import controller_steps

KINDS = {
    "loader": "the loader with its law: force in, position out",
    "law": "the law alone: sensors in, command out",
    "machine": "the machine alone: force and command in, sensors out",
}
"""Kinds of FMU, with their descriptions."""

LONGEST_STEP_S = 1e-3
"""Step of the machine, as in ``Scenario.step_s``."""

_FILE = "{}_{}_fmi{}.fmu"
_ICON = Path(__file__).parent / "fmu" / "icon.png"
_ICONS = {"2.0": "model.png", "3.0": "terminalsAndIcons/icon.png"}
_WHEN = (1980, 1, 1, 0, 0, 0)
"""Date of every file in the zip, so that equal exports have equal bytes."""


def fmu_names(name: str) -> tuple[str, ...]:
    """File names of :func:`fmu_files`."""
    return tuple(_FILE.format(name, kind, version[0]) for kind in KINDS for version in _ICONS)


def fmu_files(exported: Exported) -> dict[str, str | bytes]:
    """FMUs by file name, of each kind one for FMI 2.0 and one for FMI 3.0.

    Raises:
        InputError: If the law is not a sampled one, or this installation has no library for FMUs.
    """
    numbers = exported.sampled()
    binaries, icon = libraries(), _ICON.read_bytes()
    files: dict[str, str | bytes] = {}
    for kind, what in KINDS.items():
        resources = _resources(exported, numbers, kind)
        token = sha256(resources.encode()).hexdigest()
        identifier = f"{exported.name}_{kind}"
        step_s, (period, _) = controller_steps(exported.loader, LONGEST_STEP_S)
        for version, icon_name in _ICONS.items():
            about = description(
                exported,
                kind,
                version,
                {
                    "identifier": identifier,
                    "token": token,
                    "what": what,
                    "step_s": step_s * period if kind == "law" else step_s,
                    "delay_s": numbers.delay_s,
                    "platforms": [platform.name for platform in binaries if version in platform.folders],
                },
            )
            contents = {
                "modelDescription.xml": about.xml.encode(),
                "documentation/index.html": about.page.encode(),
                **{
                    f"binaries/{platform.folders[version]}/{identifier}{platform.suffix}": binary
                    for platform, binary in binaries.items()
                    if version in platform.folders
                },
                "resources/loader.txt": f"token {token}\n{resources}".encode(),
                icon_name: icon,
            }
            files[_FILE.format(exported.name, kind, version[0])] = _zipped(contents)
    return files


def _resources(exported: Exported, numbers: SampledLaw, kind: str) -> str:
    """A line for each list of numbers, in the format of ``crates/fmu/src/resources.rs``."""
    loader, law = exported.loader, exported.law
    step_s, timing = controller_steps(loader, LONGEST_STEP_S)
    feel = exported.settings
    curve = loader.force_curve
    lists = {
        "values": loader.rows(FEEL_SETTING, feel)[0],
        "gains": [0.0] * 9,  # those of a law with an observer: none, and its displacement is an angle
        "timing": [step_s, *timing],
        "supervised": [0.0],
        "feel": feel,
        "observers": numbers.rows(),
    }
    if law.cancellation is not None:
        lists["cancellation"] = law.cancellation.numbers
    if curve is not None:
        lists |= {"curve_knots": curve.x, "curve_coefficients": curve.coefficients}
    rows = (f"{name} {' '.join(map(repr, np.ravel(values).astype(float).tolist()))}" for name, values in lists.items())
    return "\n".join((f"kind {kind}", *rows, ""))


def _zipped(contents: dict[str, bytes]) -> bytes:
    written = BytesIO()
    with ZipFile(written, "w", ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(ZipInfo(name, _WHEN), content, ZIP_DEFLATED)
    return written.getvalue()


@dataclass(frozen=True)
class Platform:
    """A platform for which an FMU may hold a library.

    Attributes:
        name: As people say it.
        library: Name of its file in the package.
        suffix: How its name ends in an FMU.
        folders: Its folder in an FMU, by version of FMI.
    """

    name: str
    library: str
    suffix: str
    folders: Mapping[str, str] = field(compare=False)


PLATFORMS = (
    Platform("Linux x86-64", "libforcefeel_fmi.so", ".so", {"2.0": "linux64", "3.0": "x86_64-linux"}),
    Platform("Windows x64", "forcefeel_fmi.dll", ".dll", {"2.0": "win64", "3.0": "x86_64-windows"}),
    Platform("macOS x64", "libforcefeel_fmi_x64.dylib", ".dylib", {"2.0": "darwin64", "3.0": "x86_64-darwin"}),
    Platform("macOS arm64", "libforcefeel_fmi_arm64.dylib", ".dylib", {"3.0": "aarch64-darwin"}),
)
"""FMI 2.0 has one folder for macOS, and no word for its processor."""

LIBRARIES = Path(__file__).parent / "fmu"
"""Folder of the libraries in the package: ``make`` builds that of the machine, ``make platforms`` all."""


def libraries() -> dict[Platform, bytes]:
    """The libraries of this installation.

    Raises:
        InputError: If it has none.
    """
    paths = {platform: LIBRARIES / platform.library for platform in PLATFORMS}
    installed = {platform: path.read_bytes() for platform, path in paths.items() if path.is_file()}
    if not installed:
        raise InputError(
            "to: no library that goes into an FMU is in this installation; install the wheel, or build one with make"
        )
    return installed
