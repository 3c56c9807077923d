"""Bad input ends with status 2, says what to do, and leaves no folder behind."""

from pathlib import Path

import pytest

import forcefeel as ff

RECORD = str(Path(__file__).parents[2] / "examples" / "bench" / "servo-closed.csv")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("elevator-2khz", "--simulate-bench", "wheel.toml"),
            "has an electric drive, and elevator-2khz a hydraulic drive",
        ),
        (("wheel.toml", "--data", RECORD), "is made for a hydraulic drive"),
        (("elevator-2khz", "--data", RECORD, "--simulate-bench", "wheel.toml"), "leave the others out"),
        (("elevator-2khz", "--data", RECORD, "--machine", "bus"), "leave the others out"),
        (("elevator-2khz",), "give one"),
        (("wheel.toml", "--machine", "bus"), "expected a drive on a bus; add the table [bus]"),
        (("elevator-2khz", "--simulate-bench", "none.toml"), "none.toml: cannot be read"),
        (
            ("elevator-2khz", "--data", RECORD, "--required-share", "120 %"),
            "share: expected a share above 0 % and up to 100 %",
        ),
    ],
)
def test_invalid_input_is_named_and_nothing_is_written(forcefeel, tmp_path, words, message):
    (tmp_path / "wheel.toml").write_text(ff.loader.electric("aileron-wheel").to_toml(), encoding="utf-8")
    status, out, err = forcefeel("commission", *words, "--out", "made")
    assert (status, out) == (2, "")
    assert message in err
    assert not (tmp_path / "made").exists()
