"""``forcefeel run``."""

import json

import pytest

import forcefeel as ff
from tests.command_line import runs

run = runs("run")


def test_run_prints_summary_and_writes_record(run, tmp_path):
    status, out, err = run(
        "elevator-2khz", "--law", "robust", "--headless", "--duration", "0.2", "--out", "live", "--json"
    )
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["law"] == "robust"
    assert found["cycles"] + found["missed"] >= 400
    assert found["trips"] == []
    assert ff.live.replay(tmp_path / "live" / "record.mcap").same
    status, _, err = run("elevator-2khz", "--headless", "--duration", "0.5", "--out", "live")
    assert status == 2
    assert "--replace" in err


def test_run_prints_timing_and_record(run):
    status, out, _ = run("elevator-2khz", "--headless", "--duration", "50 ms", "--out", "live")
    assert status == 0
    for part in ("Timing", "p99.9", "cycles", "record: live/record.mcap"):
        assert part in out


STIFF = ("sidestick-pitch", "--set", "feel.stiffness=900 lb*in/rad", "--headless", "--duration", "0.1")


def test_run_softens_a_feel_beyond_the_drive_and_states_it(run, tmp_path):
    status, out, err = run(*STIFF, "--soften", "--out", "live", "--json")
    found = json.loads(out)
    stated = "Feel softened: stiffness 672 of 900 lb in/rad, the motor's torque."
    assert (status, err.strip()) == (0, stated)
    assert found["findings"] == [stated]
    assert found["softened"]["stiffness"]["value"] < found["softened"]["programmed_stiffness"]["value"]
    record = tmp_path / "live" / "record.mcap"
    assert "the motor's torque" in ff.live.read_live_record(record).about["softened"]
    assert ff.live.replay(record).same


def test_run_without_soften_keeps_the_feel(run):
    status, out, err = run(*STIFF, "--json")
    assert (status, err, json.loads(out)["softened"]) == (0, "", None)


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("elevator-1974", "--headless"), "controller.period"),
        (("elevator-2khz", "--headless", "--duration", "-1"), "--duration"),
        (("elevator-2khz", "--headless", "--machine", "nowhere"), "host:port"),
        (("elevator-2khz", "--headless", "--law", "magic"), "--law"),
    ],
)
def test_bad_input_is_refused(run, words, part):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert part in err
