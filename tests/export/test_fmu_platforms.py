"""An FMU holds each library of the installation in the folder of its platform, and a page that says so."""

import zipfile
from html.parser import HTMLParser

import fmpy
import pytest

import forcefeel as ff
from forcefeel.cli import app
from forcefeel.export import fmu_files

DLL, ARM64 = "forcefeel_fmi.dll", "libforcefeel_fmi_arm64.dylib"
FOLDERS = {  # FMI 2.0.4, 2.1, and FMI 3.0.1, 2.5.1.5
    "fmi2": {"linux64/pitch_law.so", "win64/pitch_law.dll", "darwin64/pitch_law.dylib"},
    "fmi3": {
        "x86_64-linux/pitch_law.so",
        "x86_64-windows/pitch_law.dll",
        "x86_64-darwin/pitch_law.dylib",
        "aarch64-darwin/pitch_law.dylib",
    },
}


def export(out):
    exported = ff.export.Exported.of("robust", ff.digital_elevator(), "pitch")
    ff.export.write_export(exported, ff.export.Target.FMU, out)
    return {version: zipfile.ZipFile(out / f"pitch_law_{version}.fmu") for version in FOLDERS}


@pytest.fixture
def libraries(tmp_path, monkeypatch):
    folder = tmp_path / "libraries"
    folder.mkdir()
    monkeypatch.setattr(fmu_files, "LIBRARIES", folder)
    return folder


def binaries(fmu):
    return {name.removeprefix("binaries/") for name in fmu.namelist() if name.startswith("binaries/")}


def test_each_installed_library_is_in_its_folder(libraries, tmp_path):
    for platform in fmu_files.PLATFORMS:
        (libraries / platform.library).write_bytes(platform.name.encode())
    for version, fmu in export(tmp_path / "all").items():
        assert binaries(fmu) == FOLDERS[version]
    assert fmu.read("binaries/aarch64-darwin/pitch_law.dylib") == b"macOS arm64"
    assert fmu.read("binaries/x86_64-windows/pitch_law.dll") == b"Windows x64"


def test_missing_platforms_are_left_out_and_named(libraries, tmp_path, capsys):
    (libraries / DLL).write_bytes(b"MZ")
    (libraries / ARM64).write_bytes(b"macho")
    fmus = export(tmp_path / "some")
    assert binaries(fmus["fmi2"]) == {"win64/pitch_law.dll"}
    assert "Libraries for Windows x64." in fmus["fmi2"].read("documentation/index.html").decode()
    assert "Libraries for Windows x64, macOS arm64." in fmus["fmi3"].read("documentation/index.html").decode()
    app.run(["export", "elevator-2khz", "--law", "robust", "--to", "fmu", "--out", str(tmp_path / "cli")])
    assert "Libraries for Windows x64, macOS arm64." in " ".join(capsys.readouterr().out.split())


def test_installation_without_library_is_refused(libraries, tmp_path):
    with pytest.raises(ff.InputError, match="install the wheel, or build one with make"):
        export(tmp_path / "none")


class _Page(HTMLParser):
    """Names in the first cell of each row, and whatever the page would load."""

    def __init__(self):
        super().__init__()
        self.codes, self.loads, self._in_code = [], [], False

    def handle_starttag(self, tag, attrs):
        self._in_code = tag == "code"
        self.loads += [value for name, value in attrs if name in {"src", "href"}]

    def handle_data(self, data):
        if self._in_code:
            self.codes.append(data)
        self._in_code = False


def test_documentation_names_every_variable_and_loads_nothing(libraries, tmp_path):
    (libraries / DLL).write_bytes(b"MZ")
    for version, fmu in export(tmp_path / "page").items():
        page = _Page()
        page.feed(fmu.read("documentation/index.html").decode())
        assert page.loads == []
        about = fmpy.read_model_description(str(tmp_path / "page" / f"pitch_law_{version}.fmu"), validate=False)
        stated = {
            variable.name for variable in about.modelVariables if variable.causality in {"input", "output", "parameter"}
        }
        assert stated <= set(page.codes)
