"""Settings that a motor cannot hold are counted apart: no law renders them."""

import json
from math import radians

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.as_json import envelope_json
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.result import Failure

ANGLE = radians(10)
GRID = {"stiffness": "10, 40, 70, 100 %", "frequency": "1, 2 Hz", "damping": "0.5, 1"}
WEAK = ff.loader.electric("aileron-wheel").replace({"current_loop.current_limit": 2.0}, si=True)


@pytest.fixture(scope="module")
def found():
    return ff.find_envelope(WEAK, ["robust"], GRID, changes={}, arms=(), angle_rad=ANGLE)


def test_settings_above_the_current_limit_exceed_the_motor_torque(found):
    """G theta > K_t i_max alpha R_b / r: without friction and losses."""
    row = WEAK.__getitem__
    most = (
        row("motor.torque_constant") * 2.0 * row("linkage.ratio") * row("column.base_arm") / row("transmission.travel")
    )
    shares = np.array([0.1, 0.4, 0.7, 1.0])
    expected = shares * row("feel.maximum_stiffness") * ANGLE > most
    assert 0 < expected.sum() < 4
    assert found.forbidden.beyond.settings.reshape(found.plan.settings.shape).tolist() == [[expected.tolist()] * 2] * 2
    assert found.forbidden.beyond.gives_n == pytest.approx(most / row("column.grip_arm"))
    assert found.forbidden.beyond.torque_n_m / (WEAK["motor.torque_constant"] * 2.0) == pytest.approx(
        row("feel.maximum_stiffness") * ANGLE / most
    )


def test_torque_limit_is_a_separate_failure(found):
    beyond = found.forbidden.settings
    count = int(beyond.sum())
    assert not found.passes("robust")[0][beyond].any()
    assert found.failure_shares("robust")[Failure.DRIVE] == count / 16
    assert found.failure_shares("robust")[Failure.UNSTABLE] == 0
    said = envelope_conclusions(found, ff.UnitSystem.SI).findings[0]
    assert said.startswith(f"No law renders {count} of 16 settings because of the motor's torque")
    assert "Remedy: a motor of" in said
    assert envelope_json(found, ff.UnitSystem.SI)["forbidden"] == {"the motor's torque": count}


def test_valve_and_strong_motor_have_no_forbidden_settings():
    for loader, law in ((ff.elevator(), "published"), (ff.loader.electric("aileron-wheel"), "robust")):
        grid = {"stiffness": "50, 100 %", "frequency": "1, 2 Hz", "damping": "0.5, 1"}
        other = ff.find_envelope(loader, [law], grid, changes={}, arms=())
        assert not other.forbidden.settings.any()
        assert other.failure_shares(law)[Failure.DRIVE] == 0


@pytest.mark.parametrize(
    ("command", "more"), [("law", ("--law", "robust")), ("qualify", ("--test", "release-25-positive"))]
)
def test_other_commands_state_the_remedy_for_holding_force(forcefeel, command, more):
    status, out, _ = forcefeel(command, "aileron-wheel", "--set", "current_loop.current_limit=2 A", "--json", *more)
    findings = json.loads(out)["conclusions"]["findings"]
    (said,) = (line for line in findings if line.startswith("The motor is too small for the programmed feel"))
    assert "Remedy: a motor of that torque, or a transmission.travel of" in said
    assert status in {0, 1}


def test_run_at_the_current_limit_states_the_remedy(forcefeel):
    _, out, _ = forcefeel(
        "simulate", "aileron-wheel", "--set", "current_loop.current_limit=2 A", "--json", "--duration", "0.5 s"
    )
    assert any(
        "To check holding force, run forcefeel size." in line for line in json.loads(out)["conclusions"]["findings"]
    )
