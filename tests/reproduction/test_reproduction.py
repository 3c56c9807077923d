"""The comparison with the 1974 report: complete, explained, and able to fail."""

from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.loader.parameters import HYDRAULIC, TABLE, required
from forcefeel.reproduction import markdown
from forcefeel.reproduction.appendix import printed
from forcefeel.reproduction.table import Reason, Verdict, agrees_to_digits, number

VALIDATION = Path(__file__).parents[2] / "docs" / "reference" / "validation.md"


@pytest.fixture(scope="module")
def sections():
    return ff.reproduction.reproduce()


@pytest.fixture(scope="module")
def rows(sections):
    return {row.item: row for section in sections for row in section.rows}


def test_no_number_differs_without_a_reason(rows):
    assert [row.item for row in rows.values() if row.verdict is Verdict.OPEN] == []
    assert all(row.reason for row in rows.values() if row.verdict in {Verdict.EXPLAINED, Verdict.REFUTED})


def test_every_constant_of_the_appendix_is_in_the_parameter_table_and_the_comparison(rows):
    assert set(printed()["appendix"]) == set(required(HYDRAULIC))
    for key, entry in printed()["appendix"].items():
        assert TABLE[key].symbol in rows
        assert TABLE[key].default_us == float(entry["us"])


@pytest.mark.parametrize(
    ("item", "value", "tolerance"),
    [
        # Digits of the independent rebuilding that the project began with.
        ("fig. 8: resonance of the servo", 11.8, 0.05),
        ("fig. 9: resonance of the servo", 11.4, 0.05),
        ("fig. 11(b): the compliant model oscillates with growing amplitude", 14, 0.5),
        ("the printed digits settle the column right", 0.3157, 5e-5),
        ("fig. 14: the compensated column moves as programmed", 1.6, 0.05),
        ("c_1, recursion converged", -6.34, 0.005),
        ("c_7 with -alpha R_b / I", -0.0065, 5e-5),
        ("the original system renders the deflection R_p F_p / G (rigid link)", 0.56, 0.005),
        ("c_3", 22.03, 0.005),
    ],
)
def test_known_figures_are_reproduced(rows, item, value, tolerance):
    assert rows[item].value == pytest.approx(value, abs=tolerance)


@pytest.mark.parametrize(
    ("printed_digits", "value", "agrees"),
    [
        ("22.02", 22.0249, True),
        ("22.02", 22.033, False),
        ("-0.0065", -0.00654, True),
        ("-0.0065", -0.00656, False),
        ("377", 376.99, True),
    ],
)
def test_agreement_is_to_the_printed_digits(printed_digits, value, agrees):
    assert agrees_to_digits(printed_digits, value) is agrees
    assert (number("x", "y", printed_digits, value, "").verdict is Verdict.OPEN) is not agrees


def test_reason_explains_only_predicted_value():
    def judged(predicts):
        return number("x", "y", "15.22", 15.226, "cm^2", Reason("why", predicts)).verdict

    assert judged(2.36 * 6.45) is Verdict.EXPLAINED
    assert judged(15.4) is Verdict.OPEN


def test_validation_page_matches_program_output(sections):
    assert markdown(sections) in VALIDATION.read_text(encoding="utf-8")
