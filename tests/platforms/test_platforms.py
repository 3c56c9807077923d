"""The libraries and wheels of ``make platforms``: for whom each is, what it needs, and the bits that it gives where it runs.

They run where ``make platforms`` says so: not in ``make test``, as they take a cross compiler each. macOS is not run.
"""

import os
import re
import shutil
import struct
import subprocess
import zipfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.fmu_files import LIBRARIES, PLATFORMS
from tests.wheel.test_wheel import audited

pytestmark = pytest.mark.skipif("FORCEFEEL_PLATFORMS" not in os.environ, reason="make platforms builds and tests them")

MOST_ZIPPED = 700_000
"""Bytes of one library in an FMU."""
OLDEST_GLIBC = (2, 17)
DLLS_OF_WINDOWS = {"kernel32.dll", "msvcrt.dll", "ntdll.dll", "bcryptprimitives.dll", "userenv.dll", "ws2_32.dll"}


WHEELS = Path(__file__).parents[2] / "dist" / "platforms"
MACHO = {"x64": 0x01000007, "arm64": 0x0100000C}
"""Numbers of the processors."""


def library(name):
    return LIBRARIES / name


def said(*words):
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, check=True, timeout=100).stdout


@pytest.mark.parametrize("platform", PLATFORMS, ids=lambda platform: platform.name)
def test_library_is_small(platform, tmp_path):
    with zipfile.ZipFile(tmp_path / "zipped", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(library(platform.library))
        (entry,) = archive.infolist()
    assert entry.compress_size < MOST_ZIPPED


def test_linux_library_runs_on_glibc_2_17():
    text = said("objdump", "-T", library("libforcefeel_fmi.so"))
    needed = {tuple(map(int, version)) for version in re.findall(r"GLIBC_(\d+)\.(\d+)", text)}
    assert needed
    assert max(needed) <= OLDEST_GLIBC


def test_windows_library_needs_windows_alone():
    text = said("x86_64-w64-mingw32-objdump", "-p", library("forcefeel_fmi.dll"))
    needed = {name.lower() for name in re.findall(r"DLL Name: (\S+)", text)}
    assert needed
    assert {name for name in needed if not name.startswith("api-ms-win-")} <= DLLS_OF_WINDOWS
    assert "fmi3InstantiateCoSimulation" in text


def is_macho(binary, processor):
    return struct.unpack("<II", binary[:8]) == (0xFEEDFACF, MACHO[processor])  # Mach-O, 64 bits


@pytest.mark.parametrize("processor", MACHO)
def test_macos_library_is_for_its_processor(processor):
    assert is_macho(library(f"libforcefeel_fmi_{processor}.dylib").read_bytes(), processor)


def wheel(system):
    (path,) = WHEELS.glob(f"*-cp311-abi3-{system}.whl")
    return path


@pytest.mark.parametrize("system", ["manylinux*_2_17_x86_64*", "win_amd64", "macosx_*_arm64", "macosx_*_x86_64"])
def test_wheel_has_the_libraries_of_every_platform_and_uses_only_stable_python_abi(system, tmp_path):
    """Of a wheel as a whole the audit would read the FMUs' libraries, too, in the format of its own platform."""
    archive = zipfile.ZipFile(wheel(system))
    held = set(archive.namelist())
    assert {f"forcefeel/export/fmu/{platform.library}" for platform in PLATFORMS} <= held
    assert any(name.startswith("forcefeel/export/firmware/libraries/") for name in held)
    (extension,) = (name for name in held if name in {"forcefeel/_core.pyd", "forcefeel/_core.abi3.so"})
    path = archive.extract(extension, tmp_path)
    audit = audited("abi3audit", "--strict", "--summary", "--assume-minimum-abi3", "3.11", path)
    assert "0 ABI version mismatches and 0 ABI violations" in audit


def test_windows_extension_needs_python_and_windows_alone(tmp_path):
    extension = Path(zipfile.ZipFile(wheel("win_amd64")).extract("forcefeel/_core.pyd", tmp_path))
    text = said("x86_64-w64-mingw32-objdump", "-p", extension)
    needed = {name.lower() for name in re.findall(r"DLL Name: (\S+)", text)}
    assert {name for name in needed if not name.startswith("api-ms-win-")} <= DLLS_OF_WINDOWS | {"python3.dll"}
    assert "PyInit__core" in text


@pytest.mark.parametrize(("system", "processor"), [("macosx_*_arm64", "arm64"), ("macosx_*_x86_64", "x64")])
def test_macos_extension_is_for_its_processor(system, processor):
    assert is_macho(zipfile.ZipFile(wheel(system)).read("forcefeel/_core.abi3.so"), processor)


@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_another_importer_gets_a_simulations_bits_under_wine(version, tmp_path):
    """ecos, built for Windows by its authors."""
    if not shutil.which("wine"):
        pytest.skip("wine is not installed")
    exported = ff.export.Exported.of("robust", ff.digital_elevator(), "pitch")
    folder = tmp_path / "a folder"
    ff.export.write_export(exported, ff.export.Target.FMU, folder)
    fmu, importer, here = folder / f"pitch_loader_{version}.fmu", tmp_path / "ecos_step.exe", Path(__file__).parent
    for program in ("ecos_step", "tar"):
        said("x86_64-w64-mingw32-gcc", "-O1", "-o", tmp_path / f"{program}.exe", here / f"{program}.c")
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path / "unpacked")
    # Used by Wine only where it has none of its own.
    said("x86_64-w64-mingw32-gcc", "-shared", "-o", tmp_path / "bcryptprimitives.dll", here / "bcryptprimitives.c")
    ecos = Path(find_spec("ecospy").origin).with_name("binaries") / "libecosc.dll"
    *paths, unpacked = ["Z:" + str(path).replace("/", "\\") for path in (ecos, fmu, tmp_path / "unpacked")]
    env = {"WINEPREFIX": str(tmp_path / "wine"), "WINEDEBUG": "-all", "PATH": os.environ["PATH"], "HOME": str(tmp_path)}
    env |= {"UNPACKED": unpacked}
    command = ["wine", importer, *paths, "80.0", "300", "0.001"]
    done = subprocess.run(command, capture_output=True, text=True, env=env, cwd=tmp_path, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    angles = np.array([float.fromhex(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("angle")])
    run = ff.simulate(exported.loader, ff.Scenario(ff.Step(80.0), duration_s=0.3), exported.law)
    assert np.array_equal(angles, run.outputs["column_angle_rad"][1:])
