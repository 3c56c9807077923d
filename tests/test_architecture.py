"""Imports of the package: layers without cycles, and no subpackage that imports its own page."""

import importlib.util
import sys
from pathlib import Path

import pytest

from .rust_files import CRATES, uses

DOCS = Path(__file__).parents[1] / "docs"

MOST_LAYERS = 12
"""The longest chain of imports; `commission` runs the other commands one after the other, and has a page."""
MOST_TOP_MODULES = 12
"""Modules that lie in the package itself."""


@pytest.fixture(scope="module")
def layers():
    """``docs/layers.py``, which draws the picture."""
    spec = importlib.util.spec_from_file_location("layers", DOCS / "layers.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where its data classes look for their module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.fixture(scope="module")
def package(layers):
    return layers.Package.of()


def test_modules_have_no_import_cycle(layers, package):
    assert layers.cycles(package.imports) == []


@pytest.mark.parametrize("crate", sorted(path.parents[1].name for path in CRATES.glob("*/src/lib.rs")))
def test_crate_files_have_no_import_cycle(layers, crate):
    assert layers.cycles(uses(CRATES / crate / "src")) == []


RUST = {
    "lib.rs": "mod base; mod drive; mod machine; pub use base::Number;",
    "base.rs": "pub struct Number; // crate::machine::Machine is no use in a comment",
    "drive.rs": "pub mod hydraulic; mod kind; pub use kind::Kind; trait Drive { fn run(settings: crate::machine::Settings); }",
    "drive/hydraulic.rs": "use super::{Drive, Kind as Sort}; use crate::Number;",
    "drive/kind.rs": "pub enum Kind { A }",
    "machine.rs": "mod settings; pub use settings::{Settings, Unused}; use crate::drive::{self, Drive};"
    'const NAME: &str = "crate::Number"; fn new(settings: Settings) { drive::hydraulic::Hydraulic::new() }',
    "machine/settings.rs": "pub struct Settings; pub struct Unused;",
}


def test_no_rust_test_is_in_a_library_without_tests():
    """These libraries are not compiled for tests: one in their source would never run."""
    crates = [path.parent for path in CRATES.rglob("Cargo.toml") if "test = false" in path.read_text()]
    assert len(crates) > 10
    assert not [str(file) for crate in crates for file in crate.glob("src/**/*.rs") if "#[test]" in file.read_text()]


def test_path_resolves_to_declaring_file(tmp_path):
    for name, text in RUST.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert uses(tmp_path) == {
        "lib.rs": set(),
        "base.rs": set(),
        "drive.rs": {"machine/settings.rs"},
        "drive/hydraulic.rs": {"drive.rs", "drive/kind.rs", "base.rs"},
        "drive/kind.rs": set(),
        "machine.rs": {"machine/settings.rs", "drive.rs", "drive/hydraulic.rs"},
        "machine/settings.rs": set(),
    }


def test_subpackages_form_layers(layers, package):
    assert layers.cycles(package.arrows) == []
    assert len(package.layers) <= MOST_LAYERS
    assert [] not in package.layers


def test_package_has_few_top_level_modules(layers):
    top_modules = [path.name for path in layers.PACKAGE.glob("*.py")]
    assert len(top_modules) <= MOST_TOP_MODULES


def test_subpackage_does_not_import_its_own_page(package):
    own = [
        (module, other)
        for module, others in package.imports.items()
        for other in others
        if package.subpackage(other) == f"{package.subpackage(module)}/page"
    ]
    assert own == []


def test_picture_matches_imports(layers, package):
    assert layers.PICTURE.read_text(encoding="utf-8") == layers.drawing(package), "make docs draws it anew"


def test_cycles_are_detected(layers):
    assert layers.cycles({"a": {"b"}, "b": {"c", "e"}, "c": {"b"}, "d": {"d"}, "e": set()}) == [["b", "c"], ["d"]]


def test_layer_is_above_its_imports(package):
    level = {name: k for k, names in enumerate(package.layers) for name in names}
    assert all(level[name] > level[other] for name, others in package.arrows.items() for other in others)
    assert level["cli"] == len(package.layers) - 1
    assert level["errors"] == 0


def test_page_explains_every_subpackage(package):
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    names = [name for name in package.arrows if not name.endswith("/page")]
    assert [name for name in names if f"`{name}`" not in page] == []
