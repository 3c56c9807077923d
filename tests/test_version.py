"""One version: that of Cargo.toml. The change log begins with it, and a tag that is not it is refused."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]


def test_changelog_starts_with_current_version():
    heading = re.search(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert heading[1].split(", ")[0] == VERSION


def test_wheel_version_is_dynamic():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert "version" not in project
    assert project["dynamic"] == ["version"]


@pytest.mark.parametrize(
    ("tag", "heading", "refused"),
    [
        (f"v{VERSION}", f"{VERSION}, 2030-01-31", ""),
        (f"v{VERSION}", f"{VERSION}, unreleased", "the day of its release"),
        ("v9.9.9", f"{VERSION}, 2030-01-31", "The tag is v9.9.9"),
    ],
)
def test_a_tag_is_a_released_version(tmp_path, tag, heading, refused):
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "tag", tmp_path / ".ci" / "tag")
    shutil.copy(ROOT / "Cargo.toml", tmp_path)
    (tmp_path / "CHANGELOG.md").write_text(f"# Changes\n\n## {heading}\n", encoding="utf-8")
    said = subprocess.run([tmp_path / ".ci" / "tag", tag], capture_output=True, text=True, check=False)
    assert said.returncode == bool(refused)
    assert refused in said.stderr
