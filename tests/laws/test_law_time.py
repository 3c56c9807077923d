"""A law runs at the rate and the delay that it was made for, and is refused at any other, wherever it is handed over."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.flight_schedule import ScheduleAxis, design_schedule, second_order_feel
from forcefeel.loader.loader import FEEL_SETTING

FAST = ff.digital_elevator()
OTHERS = {
    "period": FAST.replace({"controller.period": "1 ms", "controller.delay": "0.5 ms"}),
    "delay": FAST.replace({"controller.delay": "0.25 ms"}),
}
GRID = {"stiffness": "10, 100 %", "frequency": "1, 2 Hz", "damping": "0.5, 1"}
RUN = ff.Scenario(ff.Release(0.1), duration_s=0.05)


@pytest.mark.parametrize("row", OTHERS)
def test_python_interface_refuses_a_law_of_another_period(row):
    slow, law = OTHERS[row], ff.Law.of("robust", FAST)
    own = np.array([[FAST[key] for key in FEEL_SETTING]])
    for given in (law, law.numbers, ff.Law.of("published", FAST)):
        for use in (
            lambda given=given: ff.simulate(slow, RUN, given),
            lambda given=given: ff.loops.sampled_loops(slow, given),
            lambda given=given: ff.find_envelope(slow, {"mine": given}, GRID, changes={}, arms=()),
        ):
            with pytest.raises(ff.InputError, match=rf"made for a controller\.{row} of 0\.5 ms, the loader has"):
                use()
    change = ff.simulation.FeelChange(0.01, dict(zip(FEEL_SETTING, own[0].tolist(), strict=True)), 0.01, law.numbers)
    with pytest.raises(ff.InputError, match=f"controller.{row}|period|delay"):
        ff.simulate(slow, ff.Scenario(ff.Release(0.1), duration_s=0.05, feel_changes=(change,)), "robust")


@pytest.mark.parametrize("row", OTHERS)
def test_schedule_refuses_another_loader(row):
    axis = ScheduleAxis("pressure", "lb/ft^2", (50, 100))
    found = design_schedule(FAST, [axis], second_order_feel([500.0, 1000.0], [1.0, 1.5], 0.6))
    with pytest.raises(ff.InputError, match=rf"made for a controller\.{row} of 0\.5 ms"):
        replace(found, loader=OTHERS[row])


@pytest.mark.parametrize(
    "command",
    [
        ("simulate",),
        ("qualify",),
        ("envelope",),
        ("law",),
        ("sweep", "--vary", "valve.damping_ratio=0.8..0.9:2"),
    ],
)
def test_commands_refuse_a_law_file_of_another_period(forcefeel, tmp_path, command):
    path = tmp_path / "law.json"
    ff.Law.of("robust", FAST).save(path)
    status, _, error = forcefeel(
        command[0], "elevator-2khz", "--set", "controller.period=1 ms", "--law", str(path), *command[1:]
    )
    assert status == 2
    assert "made for a controller.period of 0.5 ms, the loader has 1 ms; design it for this loader" in error


@pytest.mark.slow
def test_noise_declared_as_zero_is_reported_with_the_default(forcefeel):
    silent = [f"--set=column_sensor.{row}=0 deg" for row in ("noise", "resolution")]
    status, out, _ = forcefeel("law", "elevator-2khz", *silent, "--law", "robust", "--json")
    assert status == 0
    assert "Sensors without noise or resolution: column_sensor." in out
    assert "deg r.m.s. State noise and resolution in the loader file (column_sensor.noise)" in out
    _, out, _ = forcefeel("law", "elevator-2khz", "--law", "robust", "--json", "--replace")
    assert "Sensors without noise" not in out
