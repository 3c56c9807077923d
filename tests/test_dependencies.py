"""What the locked dependencies may bring: licenses of ``deny.toml``, one registry for crates, a hash for each Python package.

``make audit`` asks for advisories too, which takes a network.
"""

import json
import re
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALLOWED = set(tomllib.loads((ROOT / "deny.toml").read_text())["licenses"]["allow"])
CRATES = tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]


def allows(expression):
    """Whether an expression of SPDX, or the older form with a slash, can be met by allowed licenses alone."""
    words = re.findall(r"\(|\)|\bAND\b|\bOR\b|[^()\s]+(?: WITH \S+)?", expression.replace("/", " OR "))
    python = {"(": "(", ")": ")", "AND": "and", "OR": "or"}
    return bool(eval(" ".join(python.get(word, str(word in ALLOWED)) for word in words)))


@pytest.mark.parametrize(
    ("expression", "allowed"),
    [
        ("MIT", True),
        ("MIT/Apache-2.0", True),
        ("GPL-3.0-only", False),
        ("MIT OR LGPL-2.1-or-later", True),
        ("MIT AND GPL-2.0-only", False),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", True),
        ("Apache-2.0 WITH LLVM-exception", True),
        ("GPL-2.0-only WITH Classpath-exception-2.0", False),
    ],
)
def test_expression_is_met_by_allowed_licenses(expression, allowed):
    assert allows(expression) is allowed


def test_crates_have_allowed_licenses():
    words = ("cargo", "metadata", "--format-version", "1", "--locked")
    packages = json.loads(subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout)[
        "packages"
    ]
    assert len(packages) == len(CRATES)
    assert [package["name"] for package in packages if not allows(package["license"] or "none")] == []


def test_crates_come_from_one_registry_with_a_checksum():
    foreign = [crate for crate in CRATES if "source" in crate]
    assert {crate["source"].partition("+")[0] for crate in foreign} == {"registry"}
    assert len({crate["source"] for crate in foreign}) == 1
    assert [crate["name"] for crate in foreign if "checksum" not in crate] == []


@pytest.mark.parametrize("name", ["requirements.lock", "requirements-dev.lock", "tests/platforms/requirements.lock"])
def test_python_packages_are_locked_to_a_version_and_hashes(name):
    entries = re.split(r"\n(?=[a-z0-9])", (ROOT / name).read_text())
    bad = [entry.split("\n")[0] for entry in entries if "==" not in entry or "--hash=sha256:" not in entry]
    assert bad == []
