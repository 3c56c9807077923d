"""The site: it builds without a warning, needs nothing from elsewhere, and its references hold all that there is."""

import html
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from manual.pictures import Camera
from manual.reference import command_names, public_modules
from manual.terminal import Answer, blocks, missing, prepared
from sphinx.errors import ExtensionError

import forcefeel as ff
from forcefeel.loader.parameters import ALTERNATIVES, TABLE

ROOT = Path(__file__).parents[1]

pytestmark = pytest.mark.timeout(300)
"""The site takes some twenty seconds of a core that has nothing else to do."""


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site without what its commands print and without pictures: the blocks run as tests of their own."""
    folder = tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "sphinx", "--quiet", "-W", "-n", "-D", "manual_runs=0"]
    places = os.pathsep.join(filter(None, sys.path))
    said = subprocess.run(
        [*build, ROOT / "docs", folder],
        env={**os.environ, "PYTHONPATH": places},
        capture_output=True,
        text=True,
        check=False,
    )
    assert said.returncode == 0, said.stdout + said.stderr
    return folder


def page(site: Path, name: str) -> str:
    return html.unescape((site / f"{name}.html").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_pages_make_no_external_request(site):
    loads = re.compile(r"""<(?:script|img|link|iframe)[^>]+(?:src|href)=["'](?:https?:)?//[^"']+""")
    found = {path.relative_to(site): loads.findall(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    assert len(found) >= 30
    assert {name: links for name, links in found.items() if links} == {}


@pytest.mark.slow
def test_every_command_is_in_the_reference(site):
    reference = page(site, "reference/commands")
    assert len(command_names()) >= 14
    assert [name for name in command_names() if f'id="command-{name}"' not in reference] == []
    assert "Usage: forcefeel qualify" in reference


@pytest.mark.slow
def test_every_value_of_a_loader_file_is_in_the_reference(site):
    held = set()
    for section in page(site, "reference/loader-file").split('<section id="part-')[1:]:
        part = section.split('"')[0]
        held |= {f"{part}.{name}" for name in re.findall(r'class="pre">(\w+)<', section)}
    assert set(TABLE) | set(ALTERNATIVES) <= held


@pytest.mark.slow
def test_every_public_name_is_in_the_reference(site):
    described = set(re.findall(r'id="(forcefeel\.[\w.]+)"', page(site, "reference/python")))
    assert "forcefeel.qualification" in {module.__name__ for module in public_modules()}
    assert {f"forcefeel.{name}" for name in ff.__all__} <= described


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"])
def test_relative_links_of_root_documents_exist(name):
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", (ROOT / name).read_text(encoding="utf-8"))
    assert [link for link in links if "://" not in link and not (ROOT / link).exists()] == []


def test_code_blocks_are_found_in_order_with_test_changes():
    text = (
        "<!-- console\nforcefeel new a.toml\n-->\n\n<!-- small: --runs 9000 => --runs 2 -->\n"
        "```console\nforcefeel sweep --runs 9000\n```\n\n"
        "<!-- slow -->\n```{terminal}\n:shows: one | two\n\nforcefeel reproduce\n```\n"
    )
    assert prepared(text) == ["forcefeel new a.toml\n"]
    first, second, third = blocks(text)
    assert (first.body, second.body) == ("forcefeel new a.toml\n", "forcefeel sweep --runs 2\n")
    assert (third.language, third.shows, third.body.strip()) == ("terminal", ("one", "two"), "forcefeel reproduce")
    assert [block.slow for block in (first, second, third)] == [False, False, True]
    assert [block.hidden for block in (first, second, third)] == [True, False, False]
    assert missing(third.shows, [Answer("", "on\ne", 0)]) == ["two"]


def test_build_without_chromium_gives_remedy(monkeypatch, tmp_path):
    monkeypatch.setenv("FORCEFEEL_CHROMIUM", str(tmp_path / "none"))
    (tmp_path / "page.html").write_text("<p>seen</p>", encoding="utf-8")
    with pytest.raises(ExtensionError, match="build without pictures: make site PICTURES=0"):
        Camera().take(tmp_path / "page.html", tmp_path / "picture.png", "", 800)
