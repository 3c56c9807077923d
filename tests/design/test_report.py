"""The report's folder: what is in it, and that a failure leaves what was there."""

import csv
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from forcefeel.design.figure_data import Figure, figures
from forcefeel.design.page import page as report_page
from forcefeel.design.page.page import write_report
from forcefeel.design.page.plots import draw
from forcefeel.design.workflow import Design, design_loader
from forcefeel.errors import InputError
from forcefeel.loader.built_in import elevator
from forcefeel.page.typography import number_text, percent_text, prose_html, split_symbol, symbol_html, unit_text
from forcefeel.units import UnitSystem, factor
from tests.pages import words
from tests.parametrization import mostly_slow

KEYS = ("figure-02", "figure-08", "figure-09", "figure-10", "figure-11a", "figure-11b", "figure-14")
ROUNDING = 1e-14  # relative; two factors of one conversion
NINE_DIGITS = 1e-8  # relative rounding of nine significant digits
ANCHORS = ("conclusions", "loader", "feel", "loops", "stability", "gains", "dropped", "sensitivity", "numbers")


@pytest.fixture(scope="module")
def designed() -> Design:
    return design_loader(elevator())


@pytest.fixture(scope="module")
def drawn(designed: Design) -> dict[str, Figure]:
    """The figures by their key."""
    return {figure.key: figure for figure in figures(designed)}


@pytest.fixture(scope="module")
def out(designed: Design, tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = write_report(designed, tmp_path_factory.mktemp("reports") / "elevator-1974", UnitSystem.US)
    assert written.name == "report.html"
    return written.parent


def _files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_report_contains_exactly_the_expected_files(out):
    assert set(_files(out)) == {
        "report.html",
        "plotly.min.js",
        "results.json",
        *(f"responses/{key}.csv" for key in KEYS),
    }
    assert [path.name for path in out.iterdir() if path.name.startswith(".")] == []


def test_page_has_every_section_and_plot(out):
    text = (out / "report.html").read_text(encoding="utf-8")
    assert all(f'<section id="{anchor}">' in text for anchor in ANCHORS)
    assert all(f'id="{key}" class="plotly-graph-div"' in text for key in KEYS)


def test_only_the_tangent_of_figure_2_is_dashed(designed, drawn):
    plot = draw(drawn["figure-02"], designed, UnitSystem.US)
    dashes = {trace.name.partition(" at")[0]: trace.line.dash for trace in plot.data}
    assert dashes.pop("tangent") == "dash"
    assert set(dashes.values()) == {"solid"}


def test_page_loads_no_external_resources(out):
    beside = {"plotly.min.js", "results.json", "data:,", *(f"responses/{key}.csv" for key in KEYS)}
    references = set(words(out / "report.html").references)
    assert references == beside | {f"#{anchor}" for anchor in ANCHORS}


def test_page_numbers_have_at_most_six_digits(out):
    numbers = re.findall(r"\d[\d.]*", "\n".join(words(out / "report.html").words))
    long = [text for text in numbers if len(text.replace(".", "").strip("0")) > 6]
    assert numbers
    assert long == []


def test_page_states_its_conclusions(out, designed):
    text = " ".join(" ".join(words(out / "report.html").words).split())
    assert "The compensated loader is stable" in text
    found = designed.configuration("compensated").programmed.assessment
    assert percent_text(found.tracking_error) in text
    assert number_text(designed.feel_frequency_rad_per_s / (2 * np.pi), 3) in text


@pytest.mark.parametrize(("system", "unit"), mostly_slow([(UnitSystem.SI, "N/cm"), (UnitSystem.US, "lb/in")]))
def test_json_contains_every_number_with_its_unit(designed, tmp_path, system, unit):
    write_report(designed, tmp_path, system)
    found = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    value = found["design"]["loader"]["values"]["linkage.stiffness"]
    assert value == {"value": pytest.approx(6107.86 * factor("lb/in", unit), rel=ROUNDING), "unit": unit}
    assert re.fullmatch(r"\d+\.\d+\.\d+", found["forcefeel"])
    assert found["units"] == str(system)
    assert found["conclusions"]["verdict"]
    assert [entry["file"] for entry in found["figures"]] == [f"responses/{key}.csv" for key in KEYS]
    assert all(entry["meaning"] and len(entry["columns"]) > 1 for entry in found["figures"])


@pytest.mark.parametrize("key", KEYS)
def test_value_tables_match_the_figures(out, drawn, key):
    rows = list(csv.reader((out / "responses" / f"{key}.csv").read_text(encoding="utf-8").splitlines()))
    header, values = rows[0], np.array(rows[1:], dtype=float)
    figure = drawn[key]
    assert header[0] in {"time_s", "frequency_hz", "load_pressure [lb/in^2]"}
    labels = {name.rpartition(": ")[0] for name in header[1:]}
    assert labels == set(figure.curves)
    for position, name in enumerate(header[1:], start=1):
        label, _, shown = name.rpartition(": ")
        quantity, unit = re.fullmatch(r"(\w+) \[(.+)\]", shown).groups()
        curve = figure.curves[label]
        variable = next(name for name in curve if name.startswith(quantity))
        scale = 1.0 if unit == "dB" else factor(curve.unit(variable), unit)
        np.testing.assert_allclose(values[:, position], curve[variable] * scale, rtol=NINE_DIGITS)


def test_angles_are_in_degrees_and_currents_in_milliamperes(out):
    header = (out / "responses" / "figure-14.csv").read_text(encoding="utf-8").splitlines()[0]
    for name in ("ideal feel: column_angle [deg]", "compensated: valve_current [mA]", "rigid: actuator_flow [in^3/s]"):
        assert name in header


def test_out_that_is_a_file_is_refused(designed, tmp_path):
    occupied = tmp_path / "report"
    occupied.write_text("mine")
    with pytest.raises(InputError, match=r"report: is a file; expected a folder for the report; name another one"):
        write_report(designed, occupied, UnitSystem.US)
    assert _files(tmp_path) == {"report": b"mine"}


def test_out_below_a_file_is_refused(designed, tmp_path):
    (tmp_path / "report").write_text("mine")
    with pytest.raises(InputError, match="cannot be written"):
        write_report(designed, tmp_path / "report" / "below", UnitSystem.US)
    assert _files(tmp_path) == {"report": b"mine"}


@pytest.mark.parametrize("name", ["report.html", "results.json"])
def test_folder_in_place_of_a_file_is_refused(designed, tmp_path, name):
    (tmp_path / name).mkdir()
    with pytest.raises(InputError, match=f"{name}: is a folder; expected to write a file"):
        write_report(designed, tmp_path, UnitSystem.US)
    assert _files(tmp_path) == {}


def test_file_in_place_of_the_responses_folder_is_refused(designed, tmp_path):
    (tmp_path / "responses").write_text("mine")
    with pytest.raises(InputError, match="responses: is a file; expected a folder"):
        write_report(designed, tmp_path, UnitSystem.US)
    assert _files(tmp_path) == {"responses": b"mine"}


def test_unwritable_out_is_refused(designed):
    with pytest.raises(InputError, match="cannot be written"):
        write_report(designed, Path(os.devnull) / "report", UnitSystem.US)  # not even root makes a folder in a device


def test_failure_during_computation_keeps_the_old_report(out, designed, monkeypatch):
    before = _files(out)
    monkeypatch.setattr(report_page, "_page", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_report(designed, out, UnitSystem.SI)
    assert _files(out) == before


@pytest.mark.slow
def test_report_is_reproducible(out, designed, tmp_path):
    write_report(designed, tmp_path, UnitSystem.US)
    assert _files(tmp_path) == _files(out)


@pytest.mark.slow
def test_names_are_escaped(tmp_path):
    loader = replace(elevator(), name="<script>alert(1)</script>", source="a & b < c")
    text = write_report(design_loader(loader), tmp_path, UnitSystem.US).read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in text
    assert "a &amp; b &lt; c" in text


@pytest.mark.parametrize(
    ("given", "shown"),
    [("lb in s^2/rad", "lb·in·s²/rad"), ("V cm^2/N", "V·cm²/N"), ("", ""), ("cm^5/(N s)", "cm⁵/(N·s)")],
)
def test_units_are_formatted(given, shown):
    assert unit_text(given) == shown


@pytest.mark.parametrize(
    ("value", "shown"), [(-4.9287, "−4.929"), (-2.596e-5, "−2.596×10⁻⁵"), (6107.86, "6108"), (float("inf"), "infinite")]
)
def test_numbers_are_formatted(value, shown):
    assert number_text(value) == shown


@pytest.mark.parametrize(
    ("share", "shown"),
    [(0.19184, "+19.2 %"), (-0.44, "−44.0 %"), (0.00731, "+0.73 %"), (44.1, "+4410 %"), (float("nan"), "–")],
)
def test_percentages_are_formatted(share, shown):
    assert percent_text(share, signed=True) == shown


@pytest.mark.parametrize(
    ("given", "parts"),
    [
        ("w_n", ("ω", "n", "")),
        ("x_b'", ("x", "b", "′")),
        ("delta'", ("δ", "", "′")),
        ("G_max", ("G", "max", "")),
        ("w_c / 2 pi", ("ω", "c", " / 2π")),
    ],
)
def test_symbols_are_split_into_base_and_subscript(given, parts):
    assert split_symbol(given) == parts


def test_prose_is_formatted_and_escaped():
    html = prose_html("G < G_max: the worst is linkage.ratio at -20 %, 320 lb in/rad.")
    assert symbol_html("G_max") in html
    assert "&lt;" in html
    assert f"linkage ratio {symbol_html('alpha')} at −20\N{NO-BREAK SPACE}%, 320 lb·in/rad." in html
