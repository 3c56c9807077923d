"""Cogging fed forward: what is added, by closed form and by the witness, what it buys, and its file."""

import math
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.laws.cancellation import Cancellation
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded, Release
from tests import electric_witness as witness

QUIET = {
    f"{part}.{row}": None for part in ("load_cell", "potentiometer", "column_sensor") for row in ("noise", "resolution")
}
COGGING = {
    "motor.cogging_torque": 0.2,
    "motor.cogging_phase": 0.4,
    "motor.cogging_torque_2": 0.05,
    "motor.cogging_phase_2": -1.1,
}
SMOOTH = BUILT_IN["desktop-yoke"]().replace(QUIET, si=True)
YOKE = SMOOTH.replace(COGGING, si=True)

AGREES = 1e-4
"""Of the travel."""
CANCELLED = 0.02
"""Of what cogging does to a release. Measured: 0.001."""
ROUNDING = 1e-9
STEEP = 1e-6
"""Relative: the phase of 24 periods a turn, from a position to rounding."""


def torque(loader, position):
    """Of the cogging, written down once more."""
    phi = position / loader["transmission.travel"]
    g = loader.__getitem__
    return sum(
        g(f"motor.cogging_torque{n}") * math.sin(g(f"motor.cogging_periods{n}") * phi + g(f"motor.cogging_phase{n}"))
        for n in ("", "_2")
    )


def test_design_takes_cogging_from_the_loader_file():
    assert Law.of("robust", SMOOTH).cancellation is None
    assert Law.of("robust", ff.digital_elevator()).cancellation is None
    found = Law.of("robust", YOKE).cancellation
    assert found.lead_s == pytest.approx(0.5e-3 + 0.25e-3 + 1 / (2 * math.pi * 500))
    assert found.cogging[0] == pytest.approx((-0.2 / 0.456, 24.0, 0.4))


@pytest.mark.parametrize("name", ["torque-mode", "load-cell", "robust"])
def test_motor_cancels_cogging_at_rest(name):
    """Held by a hand the loader rests where it would without cogging, and the current differs by the cogging over K_t."""
    scenario = Scenario(Recorded([0.0, 1.0], [6.0, 6.0]), 0.01)
    smooth, cogging = (simulate(loader, scenario, name).history for loader in (SMOOTH, YOKE))
    position = smooth["drive_position_m"].values[0]
    assert cogging["drive_position_m"].values[0] == pytest.approx(position, rel=ROUNDING)
    more = cogging["motor_current_a"].values[0] - smooth["motor_current_a"].values[0]
    assert abs(more) > 0.02
    assert more == pytest.approx(-torque(YOKE, position) / YOKE["motor.torque_constant"], rel=STEEP)


def test_engine_cancellation_matches_the_reference():
    law, time = Law.of("robust", YOKE), np.linspace(0.0, 0.16, 321)
    force = 12 * np.sin(2 * math.pi * 4 * time)
    lead = 0.5e-3 + 0.25e-3 + 1 / YOKE["current_loop.bandwidth"]

    def added(position, velocity):
        return -torque(YOKE, position + velocity * lead) / YOKE["motor.torque_constant"]

    run = simulate(YOKE, Scenario(Recorded(time, force), 0.15, 1e-4, 0.5e-3), law)
    start = simulate(YOKE, Scenario(Recorded(time, 0 * force), 0.01, 1e-4, 0.5e-3), law)
    assert np.abs(start.history["drive_position_m"].values).max() < 1e-12  # where the witness begins
    found = witness.simulate(YOKE, law.numbers, lambda t: np.interp(t, time, force), 0.15, added=added)
    angle = found["column_angle_rad"]
    assert np.abs(run.history["column_angle_rad"].values - angle).max() < AGREES * np.ptp(angle)


@pytest.mark.parametrize("name", ["torque-mode", "robust"])
def test_release_matches_one_without_cogging(name):
    law, scenario = Law.of(name, YOKE), Scenario(Release(0.15), 1.0)
    smooth = simulate(SMOOTH, scenario, name).history["column_angle_rad"].values
    fed, left = (
        simulate(YOKE, scenario, one).history["column_angle_rad"].values
        for one in (law, replace(law, cancellation=None))
    )
    size = min(map(len, (smooth, fed, left)))
    off = [np.abs(angle[:size] - smooth[:size]).max() for angle in (fed, left)]
    assert off[0] < CANCELLED * off[1]


def test_cancellation_is_saved_and_loaded_with_its_law(tmp_path):
    law = Law.of("torque-mode", YOKE)
    law.save(tmp_path / "law.json")
    again = Law.of(tmp_path / "law.json", YOKE)
    assert again.cancellation == law.cancellation
    Law.of("torque-mode", SMOOTH).save(tmp_path / "smooth.json")
    assert "cancellation" not in (tmp_path / "smooth.json").read_text()


@pytest.mark.parametrize(
    ("numbers", "wrong"),
    [
        ((50.0, 1e-3, ((1.0, 24.0, 0.0),)), "expected 2 harmonics"),
        ((50.0, 0.0, ((1.0, 24.0, 0.0),) * 2), "slow rate above 0"),
        ((50.0, 1e-3, ((math.nan, 24.0, 0.0),) * 2), "expected finite numbers"),
    ],
)
def test_invalid_numbers_raise_input_error(numbers, wrong):
    with pytest.raises(ff.InputError, match=wrong):
        Cancellation(*numbers)


def test_law_with_cancellation_is_refused_for_a_valve():
    valve = ff.digital_elevator()
    law = replace(Law.of("robust", valve), cancellation=Cancellation.of(YOKE))
    with pytest.raises(ff.InputError, match="is a law for a motor, and elevator-2khz has a valve"):
        law.check(valve)


def test_motor_dry_friction_is_fed_forward(tmp_path):
    """A release with the motor's friction is nearer to that without."""
    bare = BUILT_IN["elevator-electric"]().replace(QUIET, si=True)
    dry = bare.replace({"motor.coulomb_friction": 0.4, "motor.static_friction": 0.45}, si=True)
    law = Law.of("robust", dry)
    assert law.cancellation.friction_a == pytest.approx(0.8 * 0.4 / dry["motor.torque_constant"])
    law.save(tmp_path / "law.json")
    assert Law.of(tmp_path / "law.json", dry).cancellation == law.cancellation
    scenario = Scenario(Release(0.1), 2.0)
    smooth, known, unknown = (
        simulate(loader, scenario, one).history.column_angle_rad.values
        for loader, one in ((bare, "robust"), (dry, law), (dry, replace(law, cancellation=None)))
    )
    off, left = (np.sqrt(np.mean((one - smooth) ** 2)) for one in (unknown, known))
    assert left < 0.6 * off  # r.m.s.
