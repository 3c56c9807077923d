"""The wheel: one for every Python from 3.11 on, and it runs where nothing else of the project is.

``make validate`` tests the one that it builds from the extension's own crates, ``make wheel`` and ``make platforms`` those
for others.
"""

import json
import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel() -> Path:
    folder = ROOT / os.environ.get("FORCEFEEL_WHEELS", "target/wheel")
    found = sorted(folder.glob("*linux*.whl" if sys.platform == "linux" else "*.whl"))
    if not found and not int(os.environ.get("FORCEFEEL_REQUIRE_WHEEL", "0")):
        pytest.skip("no wheel in target/wheel/: make target/wheel/built builds it")
    (only,) = found
    return only


def audited(tool: str, *words: str | Path) -> str:
    said = subprocess.run([sys.executable, "-m", tool, *words], capture_output=True, text=True, check=False)
    assert said.returncode == 0, said.stdout + said.stderr
    # It breaks its lines at a width, within what is looked for if the wheel has a long name.
    return " ".join((said.stdout + said.stderr).split())


def test_wheel_uses_only_stable_python_abi(wheel):
    assert "-cp311-abi3-" in wheel.name
    assert "0 ABI version mismatches and 0 ABI violations" in audited("abi3audit", "--strict", "--summary", wheel)


@pytest.mark.skipif(sys.platform != "linux", reason="auditwheel reads Linux wheels")
def test_wheel_symbols_match_its_manylinux_tag(wheel):
    tag = re.search(r'following platform tag: "(\w+)"', audited("auditwheel", "show", wheel))[1]
    assert tag.startswith("manylinux_")
    assert tag in wheel.stem.split("-")[-1].split(".")


def test_wheel_contains_every_package_file(wheel):
    package = ROOT / "python"
    sources = {path for path in (package / "forcefeel").rglob("*") if path.is_file()}
    # The libraries of firmware come with ``make wheel``; ``make validate`` builds them beside its wheel.
    sources -= set() if "FORCEFEEL_WHEELS" in os.environ else set(package.glob("forcefeel/export/firmware/libraries/*"))
    wanted = {path.relative_to(package).as_posix() for path in sources if path.suffix not in {".pyc", ".so", ".pyd"}}
    held = set(zipfile.ZipFile(wheel).namelist())
    assert wanted - held == set()
    assert sys.platform != "linux" or "forcefeel/export/fmu/libforcefeel_fmi.so" in held
    assert not any(name.endswith(".pyc") for name in held)


@pytest.fixture(scope="module")
def clean(wheel, tmp_path_factory) -> Path:
    """A new environment with the wheel, which sees the dependencies of the tests' own, but nothing of the project."""
    folder = tmp_path_factory.mktemp("clean")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    places = {"base": str(folder), "platbase": str(folder)}
    packages = Path(sysconfig.get_path("purelib", "venv", places))
    # A .pth of a folder that is added by a .pth is not read: an editable forcefeel stays out.
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")
    pip = [sys.executable, "-m", "pip", "--python", folder, "install", "--quiet", "--no-index", "--no-deps"]
    subprocess.run([*pip, "--disable-pip-version-check", wheel], check=True)
    return Path(sysconfig.get_path("scripts", "venv", places))


def ran(clean: Path, *words: str, folder: Path) -> str:
    alone = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    said = subprocess.run(
        [clean / words[0], *words[1:]], cwd=folder, env=alone, capture_output=True, text=True, check=False
    )
    assert said.returncode == 0, said.stdout + said.stderr
    return said.stdout.strip()


def test_installed_wheel_designs_built_in_loader(clean, wheel, tmp_path):
    place = ran(clean, "python", "-c", "import forcefeel; print(forcefeel.__file__)", folder=tmp_path)
    assert Path(place).is_relative_to(clean.parent)
    ran(clean, "forcefeel", "design", "--out", "report", folder=tmp_path)
    found = json.loads((tmp_path / "report" / "results.json").read_text(encoding="utf-8"))
    assert found
    assert (tmp_path / "report" / "report.html").stat().st_size > 100_000
    assert wheel.name.split("-")[1] in ran(clean, "forcefeel", "--version", folder=tmp_path)
