"""The page of a qualification, its PDF, and the page in a real browser at the width of a desk and of a phone."""

import json
import re
from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.page.chromium import find_chromium
from forcefeel.qualification import Record
from forcefeel.qualification.page.page import FOLDER
from forcefeel.qualification.page.release_plot import release
from forcefeel.units import UnitSystem
from tests.pages import ROUNDING_PX, EveryPage, OnDemand, views_of, words, words_cut
from tests.parametrization import mostly_slow
from tests.qualification_records import released, second_order

FRICTION = {
    "column.coulomb_friction": "2 lb",
    "feel.breakout": "2 lb",
    "column.stop_low": "-15 deg",
    "column.stop_high": "18 deg",
}
UNSTABLE = {"feel.inertia": "0.6 lb in s^2/rad", "feel.damping": "3.04 lb in s/rad", "feel.stiffness": "96 lb in/rad"}
COMPARED = ("static", "release-25-positive", "release-50-negative", "fast")


SHEET_PX = (297 - 14 - 18) / 25.4 * 96
"""Height of A4 within the page's margins."""


def _small_inputs():
    time = np.arange(0.0, 5.0, 0.02)
    rate = 0.05 * np.sin(2.0 * time)
    return {
        name: Record(time, 0.01 * np.sin(time), body_rate_rad_per_s=scale * rate, name=name)
        for name, scale in (("simulator", 1.05), ("aircraft", 1.0))
    }


def _recorded():
    both = _small_inputs()
    setup = ff.qualification.QualificationSetup(
        records={"small-inputs": both["simulator"]},
        references={"small-inputs": both["aircraft"]},
        system=UnitSystem.SI,
        simulator="FFS 4 <left seat>",
    )
    return ff.qualify_loader(ff.elevator(), setup)


MADE = {
    "friction": lambda: ff.qualify_loader(
        ff.elevator().replace(FRICTION), ff.qualification.QualificationSetup(laws=("published",), system=UnitSystem.SI)
    ),
    "compare": lambda: ff.qualify_loader(
        ff.elevator(), ff.qualification.QualificationSetup(laws=("original", "published", "converged"), tests=COMPARED)
    ),
    "unstable": lambda: ff.qualify_loader(
        ff.elevator().replace(UNSTABLE), ff.qualification.QualificationSetup(rule="cs-fstd-a")
    ),
    "recorded": _recorded,
}
SECTIONS = {
    "compare": ("original", "published", "converged"),
    "friction": ("published",),
    "unstable": ("original",),
    "recorded": ("record",),
}


@pytest.fixture(scope="module")
def made():
    return OnDemand(lambda name: MADE[name]())


@pytest.fixture(scope="module")
def pages(made, tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("qualifications")
    return OnDemand(lambda name: ff.qualification.write_qualification(made[name], folder / name))


def _told(page: Path) -> str:
    return " ".join(" ".join(words(page).words).split())


@pytest.mark.parametrize("name", mostly_slow(MADE))
def test_the_page_has_every_section_and_loads_nothing(pages, name):
    text = pages[name].read_text(encoding="utf-8")
    sections = {"conclusions", "conditions", "numbers", *(f"law-{law}" for law in SECTIONS[name])}
    assert text.startswith("<!DOCTYPE html>")
    assert set(re.findall(r'<section id="([\w-]+)"', text)) == sections
    within = {f"#{section}" for section in sections} | {f"#{test}" for test in _articles(text)}
    assert set(words(pages[name]).references) == {"plotly.min.js", "results.json", "data:,"} | within


def _articles(text):
    return re.findall(r'<article class="test" id="([\w-]+)"', text)


@pytest.mark.parametrize("name", mostly_slow(MADE))
def test_summary_links_every_test_and_names_missing_tests(pages, made, name):
    text, found = pages[name].read_text(encoding="utf-8"), made[name]
    (table,) = re.findall(r'<table class="outcomes">.*?</table>', text, flags=re.DOTALL)
    assert sorted(re.findall(r'<a href="#([\w-]+)">', table)) == sorted(_articles(text))
    assert table.count("not requested") == len(found.sections) * (
        len(found.test_plan.trials) - len(found.test_plan.made)
    )
    for trial in found.test_plan.outside:
        assert trial.title.replace("'", "&#39;") in table
    assert table.count("cannot be simulated: ") == len(found.test_plan.outside) * len(found.sections)
    for section in found.sections:
        assert f">{section.status}<" in table


@pytest.mark.parametrize("name", mostly_slow(MADE))
def test_the_verdict_is_the_second_column(pages, made, name):
    text = pages[name].read_text(encoding="utf-8")
    heads = [
        re.findall(r"<th(?: [^>]*)?>(.*?)</th>", head)
        for head in re.findall(r"<thead>.*?</thead>", text, flags=re.DOTALL)
    ]
    assert heads[0][:2] == ["Test", made[name].sections[0].title]
    features = [head for head in heads if head[0] == "Feature"]
    results = [result for section in made[name].sections for result in section.results]
    assert len(features) == sum(bool(result.verdicts) for result in results)
    assert all(head[1] == "Verdict" for head in features)


@pytest.mark.slow
def test_page_has_lines_for_simulator_operator_date_signature(pages):
    for name, simulator in (("friction", ""), ("recorded", "FFS 4 &lt;left seat&gt;")):
        text = pages[name].read_text(encoding="utf-8")
        lines = dict(re.findall(r"<dt>(\w+)</dt><dd>(.*?)</dd>", text))
        assert lines == {"Simulator": simulator, "Operator": "", "Date": "", "Signature": ""}


@pytest.mark.parametrize("edition", ["cs-fstd-a", "icao-9625", "part60-a-2016"])
def test_unverified_rows_are_named_on_page_and_each_sheet(tmp_path, edition):
    frequency, damping = 2.0, 0.2
    records = {"release-25-positive": released(damping, frequency, 200, way=0.1, name="mine")}
    setup = ff.qualification.QualificationSetup(rule=edition, records=records, references=records, tests=tuple(records))
    text = ff.qualification.write_qualification(ff.qualify_loader(ff.elevator(), setup), tmp_path).read_text(
        encoding="utf-8"
    )
    (under,) = re.findall(r"@bottom-left \{.*?content: (.*?); \}", text, flags=re.DOTALL)
    for place in (under, *re.findall(r'<section id="conclusions">.*?</section>', text, flags=re.DOTALL)):
        assert "unverified" in place
        assert "2.b.1" in place
    assert "the rule's rows are not verified" in text


@pytest.mark.parametrize("name", mostly_slow(MADE))
def test_no_number_on_the_page_has_more_than_six_digits(pages, name):
    numbers = re.findall(r"(?<![\w.])\d[\d.]*(?![\w])", "\n".join(words(pages[name]).words))
    assert numbers
    assert [text for text in numbers if len(text.replace(".", "").strip("0")) > 6] == []


@pytest.mark.parametrize("name", mostly_slow(("friction", "compare")))
def test_every_test_has_a_plot_and_a_table(pages, made, name):
    text = pages[name].read_text(encoding="utf-8")
    drawn = set(re.findall(r'<div id="plot-([\w-]+)"', text))
    keys = [trial.key for trial in made[name].test_plan.made]
    assert drawn == {f"{law}-{key}" for law in SECTIONS[name] for key in keys}
    tests = sum(len(section.results) for section in made[name].sections)
    assert text.count('<article class="test"') == tests


@pytest.mark.slow
def test_page_states_qualifying_laws_and_reasons_against_others(pages):
    told = {name: _told(pages[name]) for name in MADE}
    assert (
        "By 14 CFR Part 60, Appendix A (2014) none of 3 laws qualifies (requested: static, release-25-positive, "
        in told["compare"]
    )
    assert "frequency 1.58 Hz, 1.97 Hz programmed" in told["compare"]
    assert "assumed, because the loader has no stops" in told["compare"]
    assert re.search(r"the programmed feel alone: I ?, B ?, G ?, feel breakout F b", told["friction"])
    assert "diverged at" in told["unstable"]
    assert "the rule's rows are not verified" in told["unstable"]
    assert "Small control inputs passed" in told["recorded"]
    assert "cannot be simulated: a control loader has no surface" in told["compare"]
    assert "incomplete 1 of 9 tests passed, 8 not evaluated." in told["recorded"]


def test_page_states_rule_conditions_versions_and_date(pages, made):
    told = _told(pages["friction"])
    assert "14 CFR Part 60, Appendix A, edition 2014, aeroplane" in told
    assert "take-off" in told
    assert made["friction"].day.isoformat() in told
    assert date.fromisoformat(json.loads((pages["friction"].parent / "results.json").read_text())["date"])


def test_names_are_text_not_markup(made, tmp_path):
    found = made["unstable"]
    named = replace(found.loader, name="<script>alert(1)</script>", source="a & b < c")
    text = ff.qualification.write_qualification(replace(found, loader=named), tmp_path).read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "a &amp; b &lt; c" in text


@pytest.mark.slow
def test_equal_qualifications_give_equal_bytes(made, tmp_path):
    first, second = (ff.qualification.write_qualification(made["friction"], tmp_path / name) for name in "ab")
    for name in ("qualification.html", "results.json"):
        assert (first.parent / name).read_bytes() == (second.parent / name).read_bytes()


@pytest.mark.slow
def test_failed_write_leaves_folder_unchanged(made, tmp_path, monkeypatch):
    out = ff.qualification.write_qualification(made["unstable"], tmp_path).parent
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    write = Path.write_bytes

    def full_disk(self, data):
        if self.name == "qualification.html":
            raise OSError(28, "No space left on device")
        return write(self, data)

    monkeypatch.setattr(Path, "write_bytes", full_disk)
    with pytest.raises(InputError, match="No space left on device"):
        ff.qualification.write_qualification(made["friction"], out)
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


@pytest.mark.parametrize("name", ["qualification.html", "results.json", "qualification.pdf"])
def test_folder_in_place_of_file_is_refused(tmp_path, name):
    (tmp_path / name).mkdir()
    with pytest.raises(InputError, match=f"{name}: is a folder; expected to write a file"):
        FOLDER.check(tmp_path)


def test_chromium_without_pdf_output_raises_input_error(made, tmp_path, monkeypatch):
    dumb = tmp_path / "browser"
    dumb.write_text("#!/bin/sh\necho cannot print >&2\nexit 3\n", encoding="utf-8")
    dumb.chmod(0o755)
    monkeypatch.setenv("FORCEFEEL_CHROMIUM", str(dumb))
    assert find_chromium() == str(dumb)
    with pytest.raises(InputError, match=r"printed no PDF \(cannot print\)"):
        ff.qualification.write_qualification(made["unstable"], tmp_path / "out", pdf=True)
    assert not (tmp_path / "out").exists()


# What is marked on a release.

DAMPED = {"swings": (0.2, "fall time"), "creeps": (1.5, "fall time"), "creeps, from the release": (1.5, "rise time")}
RATE = 1000.0
MARK_S = 1 / RATE  # times are drawn from the release, which is found within a sample


@pytest.mark.parametrize("case", DAMPED)
def test_release_plot_marks_judged_features(case):
    """Arrow heads and circles beside the closed form of a column of second order."""
    damping, overdamped = DAMPED[case]
    hertz, way, held = 2.0, 0.1, 0.5037
    records = {"release-25-positive": released(damping, hertz, RATE, way=way, held_s=held)}
    setup = ff.qualification.QualificationSetup(
        records=records, references=records, tests=tuple(records), overdamped=overdamped
    )
    found = ff.qualify_loader(ff.elevator(), setup)
    picture = release(found.sections[0].results[0], found, "#009E73")
    when = {share: _falls_to(share, damping, hertz) for share in (0.9, 0.1)}
    if damping < 1:
        turn = 2 * np.pi * hertz * np.sqrt(1 - damping**2)
        passes = (np.pi / 2 + np.arcsin(damping) + np.pi * np.arange(5)) / turn
        ends = [(when[0.9], passes[0]), (passes[0], passes[2]), (passes[2], passes[4])]
        tops = np.pi * np.arange(1, 5) / turn
        names = ["P0", "P1", "P2"], [f"A{k}" for k in range(1, 5)]
        circles = sorted([when[0.9], *passes[:5], *tops])
    else:
        begin = when[0.9] if overdamped == "fall time" else 0.0
        ends, tops, names = [(begin, when[0.1])], [], ([overdamped], [])
        circles = sorted({begin, when[0.1]} - {0.0})
    marks = picture.layout.annotations
    arrows = [(one.ax, one.x) for one in marks if one.arrowside == "end+start"]
    np.testing.assert_allclose(arrows, ends, atol=MARK_S)
    texts = [one.text for one in marks if one.text]
    assert (sorted(texts), len(arrows)) == (sorted([*names[0], *names[1]]), len(names[0]))
    tall = {one.text: one.x for one in marks}
    np.testing.assert_allclose([tall[name] for name in names[1]], tops, atol=MARK_S)
    for trace in picture.data:
        if trace.mode == "markers" and not trace.name:
            np.testing.assert_allclose(sorted(trace.x), circles, atol=MARK_S)


def _falls_to(share, damping, hertz):
    return brentq(lambda t: float(second_order(damping, hertz, t)) - share, 0.0, 1.5, xtol=1e-12)


# In a browser.


page = views_of(MADE)
TestPage = EveryPage


@pytest.mark.browser
def test_every_release_shows_its_residual_band(page):
    bands = page.evaluate(
        """() => [...document.querySelectorAll('[id*=release].plotly-graph-div')].map(plot =>
            [...plot.querySelectorAll('.shapelayer path')].filter(path => path.getBoundingClientRect().height > 2).length)"""
    )
    assert all(count == 1 for count in bands)


@pytest.mark.browser
def test_every_curve_is_drawn(page):
    plots = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].map(plot =>
            [plot.id, plot.data.length, plot.querySelectorAll('.scatterlayer .trace').length])"""
    )
    assert [one for one in plots if one[1] != one[2]] == []


@pytest.mark.browser
def test_plot_text_is_not_clipped(page):
    """Titles, legend and ticks lie inside their plot; the legend lies above the curves."""
    selector = ".legendtext, .annotation-text, [class*=title] text, [class*=tick] text"
    assert words_cut(page, selector, ROUNDING_PX) == []


@pytest.mark.browser
def test_heading_is_not_separated_from_its_text_in_print(page):
    """Each stands in a block that is not broken, with what follows it, and that fits on a sheet of A4 within its margins."""
    page.emulate_media(media="print")
    loose = page.evaluate(
        """sheet => [...document.querySelectorAll('main h2, main h3')].filter(heading => {
            let block = heading;
            while (block && getComputedStyle(block).breakInside !== 'avoid') block = block.parentElement;
            const begins = heading.closest('.law') && heading.tagName === 'H2';  // a law begins a sheet
            const follows = block && [...block.querySelectorAll('p, figure, table')].some(
                one => heading.compareDocumentPosition(one) & Node.DOCUMENT_POSITION_FOLLOWING);
            return !begins && !(follows && block.getBoundingClientRect().height < sheet);
        }).map(heading => heading.textContent)""",
        SHEET_PX,
    )
    page.emulate_media(media="screen")
    assert loose == []


@pytest.mark.slow
@pytest.mark.browser
def test_the_pdf_holds_the_plots(browser, made, tmp_path, monkeypatch):
    """Printed by the same Chromium; as vectors the plots make it larger than the words alone would."""
    monkeypatch.setenv("FORCEFEEL_CHROMIUM", find_chromium())
    page = ff.qualification.write_qualification(made["friction"], tmp_path, pdf=True)
    data = (page.parent / "qualification.pdf").read_bytes()
    assert data.startswith(b"%PDF")
    assert len(re.findall(rb"/Type\s*/Page\b", data)) >= 4
    assert "qualification.pdf" in words(page).references
