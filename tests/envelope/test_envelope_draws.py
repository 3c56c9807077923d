"""Machines with all tolerances at once: against a plant and a release test written out by hand, and shares counted by hand."""

import hashlib
import json
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr

import forcefeel as ff
from forcefeel.envelope.cases import Case, Kind
from forcefeel.envelope.deviations import Deviation, Origin
from forcefeel.envelope.draws import Draws
from forcefeel.envelope.machines import machines
from forcefeel.envelope.page.page import PAGE, RESULTS, Files
from forcefeel.envelope.releases import Record
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError
from forcefeel.laws.analog.gain_schedule import schedule_gains
from forcefeel.laws.analog.gains import SettingGains
from forcefeel.laws.analog.recursion import NAMED_DESIGNS
from forcefeel.laws.law import Law
from forcefeel.loader.tolerances import Distribution, Tolerance
from tests import witness
from tests.release_witness import features, ideal, least_margin

GRID = {"stiffness": "5.6, 17.8 %", "frequency": "0.6, 1.2 Hz", "damping": "0.7, 1.2"}
LAW, MACHINES = "converged", 10
NEAR = 0.02  # share of a tolerance by which a spline's and the kernel's features may differ
NAMES = {
    "amplifier.admittance": "K2",
    "valve.current_gain": "CI",
    "valve.pressure_gain": "CP",
    "valve.natural_frequency": "WN",
    "valve.damping_ratio": "ZETA",
    "actuator.area": "A",
    "actuator.oil_volume": "VE",
    "actuator.bulk_modulus": "BETA",
    "linkage.ratio": "ALPHA",
    "linkage.stiffness": "K",
    "linkage.damping": "C",
    "column.inertia": "J",
    "column.base_arm": "RB",
    "column.grip_arm": "RP",
}
"""The plant's parameters and the witness's constants."""

INCH, PSI = witness.INCH, witness.LBF / witness.INCH**2
GAIN_PER_US = np.array([INCH, PSI, 1.0, 1.0, INCH, INCH])
"""Of gains on x_p, p, delta, delta', x_b, x_b'."""

TORQUE = witness.LBF * INCH


@pytest.fixture(scope="module")
def found():
    return ff.find_envelope(ff.elevator(), (LAW,), GRID, arms=(), draws=Draws(MACHINES, 7))


@contextmanager
def built(off):
    """The witness with every parameter off by its share."""
    before = {name: getattr(witness, name) for name in NAMES.values()}
    try:
        for key, share in off.items():
            setattr(witness, NAMES[key], before[NAMES[key]] * (1 + share))
        yield
    finally:
        for name, value in before.items():
            setattr(witness, name, value)


def angle(off, setting, gains, held, time):
    """The column's angle after it was let go, of the machine that was built under the nominal one's law; None if unstable."""
    arm = witness.ALPHA * witness.RB
    with built(off):
        a = witness.jacobian(witness.compliant, 8, setting=setting, gains=gains)
        push = witness.compliant(np.zeros(8), 1.0, setting=setting, gains=gains)
        a[5, 1] = -arm * witness.A / setting[0]  # the feel computer knows the lever of the nominal machine alone
        row = np.eye(8)[6] / witness.RB
    poles, vectors = np.linalg.eig(a)
    if poles.real.max() >= 0:
        return None
    at_rest = np.linalg.solve(a, push)
    modes = (row @ vectors) * np.linalg.solve(vectors, at_rest * held / (row @ at_rest))
    return (modes @ np.exp(np.outer(poles, time))).real


def test_random_machines_match_hand_written_equations(found):
    plan = found.plan
    feel = plan.settings.feel(plan.loader)
    gains = schedule_gains(plan.loader, feel, NAMED_DESIGNS[LAW](plan.loader)).gains * GAIN_PER_US
    outcome = found.data["drawn_outcome"].values[0].reshape(MACHINES, -1)
    seen = {"passes": 0, "fails": 0}
    records = [Record.of(frequency, plan.settings.damping[0]) for frequency in plan.settings.rows[:, 1]]
    asked = [
        features(record.time_s, ideal(one, plan.release_rad, record.time_s))
        for record, one in zip(records, feel, strict=True)
    ]
    for machine in range(MACHINES):
        off = dict(zip(found.data["parameter"].values, found.data["off"].values[machine], strict=True))
        for setting in range(len(feel)):
            time_s = records[setting].time_s
            mine = angle(off, feel[setting] / TORQUE, gains[setting], plan.release_rad, time_s)
            if mine is None:
                assert found.outcomes[outcome[machine, setting]] == "unstable"
                continue
            margin = least_margin(features(time_s, mine), asked[setting])
            if abs(margin) > NEAR:
                assert (margin > 0) == (outcome[machine, setting] == 0), (machine, setting, margin)
                seen["passes" if margin > 0 else "fails"] += 1
    assert min(seen.values()) >= 10  # there are some of each


def test_shares_are_counted(found):
    passes = [
        [bool(code == 0) for code in machine] for machine in found.data["drawn_outcome"].values[0].reshape(MACHINES, -1)
    ]
    settings = list(zip(*passes, strict=True))
    shares = found.drawn_shares(LAW)
    assert shares.settings == sum(sum(one) >= 0.95 * len(one) for one in settings) / len(settings)
    assert shares.good == sum(sum(one) >= 0.95 * len(one) for one in passes) / len(passes)
    assert shares.passes == pytest.approx(sum(map(sum, passes)) / (len(passes) * len(settings)))
    assert shares.least == min(sum(one) for one in passes) / len(settings)
    assert shares.good_low <= shares.good < shares.good_high
    assert 0 < shares.passes < 1


def test_random_deviations_are_keyed_and_follow_the_tolerance():
    low, high = -0.1, 0.3
    spread = {
        "linkage.ratio": Deviation(Tolerance(Distribution.UNIFORM, low, high), Origin.FILE),
        "column.inertia": Deviation(Tolerance(Distribution.NORMAL, -0.09, 0.09, peak=0.0, deviation=0.03), Origin.FILE),
    }
    many = Draws(1000, 3).machines(spread)
    key = int.from_bytes(hashlib.sha256(b"3 linkage.ratio").digest()[:16], "little")
    raw = np.random.Philox(key=key).random_raw(1000)
    assert [one.off["linkage.ratio"] for one in many] == pytest.approx(low + (high - low) * raw / 2.0**64)
    inertia = np.array([one.off["column.inertia"] for one in many])
    assert inertia.std() == pytest.approx(0.03, rel=0.1)  # of a thousand numbers
    assert np.abs(inertia).max() < 0.09
    few = Draws(10, 3).machines(spread)
    assert [one.off for one in few] == [one.off for one in many[:10]]
    assert few[0].off != Draws(10, 4).machines(spread)[0].off


def test_corners_combine_the_ends_of_the_cases():
    spread = {"column.inertia": Deviation(Tolerance(Distribution.NORMAL, -0.09, 0.09, 0.0, 0.03), Origin.FILE)}
    found = {one.off["column.inertia"] for one in Draws(30, corners=True).machines(spread)}
    assert found == {-0.06, 0.06}


def test_joint_lever_deviations_scale_the_feel():
    """A feel computer that hears a torque 1.1 * 0.95 times too large, and has I, B, G so much larger, moves as it should."""
    off = Case("", Kind.DRAWN, {"linkage.ratio": 0.1, "column.base_arm": -0.05})
    feel = np.array([[1.0, 2.0, 3.0]])
    row = machines(ff.elevator(), off, feel, Law("none", SettingGains(np.zeros((1, 7)))))[0]
    assert row[:3] == pytest.approx(feel[0] * 1.1 * 0.95)


def test_log_weights_match_the_setting_spacing():
    settings = Settings.of({"stiffness": "1, 10, 100 %", "frequency": "1, 2 Hz", "damping": "0.1, 0.2, 0.8"})
    weights = settings.weights.reshape(settings.shape)
    assert weights.sum() == pytest.approx(1)
    assert weights.sum(axis=(0, 1)) == pytest.approx([0.25, 0.5, 0.25])
    assert weights.sum(axis=(1, 2)) == pytest.approx(
        [1 / 6, 1 / 2, 1 / 3]
    )  # of three octaves: a half, one and a half, one


def test_log_weighted_shares_match_the_weighted_sum(found):
    passes = found.passes(LAW)
    even = found.even_shares(LAW)
    assert even.nominal_share == pytest.approx(float((found.plan.settings.weights * passes[0]).sum()))
    assert even.worst_case_share == pytest.approx(float((found.plan.settings.weights * passes.all(axis=0)).sum()))


@pytest.mark.slow
def test_random_draws_appear_on_page_terminal_and_in_files(forcefeel, tmp_path):
    words = ("--law", LAW, *(word for name, it in GRID.items() for word in ("--grid", f"{name}={it}")))
    status, out, err = forcefeel("envelope", *words, "--draws", "5", "--seed", str(2**62), "--corners")
    assert (status, err) == (0, "")
    assert "All tolerances at once, 5 machines at the corners" in " ".join(out.split())
    assert "Every point of the grid counts the same" in " ".join(out.split())
    folder = tmp_path / "forcefeel-envelope"
    stored = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    assert stored["draws"] == {"count": 5, "seed": 2**62, "corners": True}
    assert stored["laws"][LAW]["joint_tolerances"]["machines"] == 5
    with xr.open_dataset(folder / Files.of().maps, engine="scipy") as maps:
        assert maps["drawn_outcome"].shape == (1, 5, 2, 2, 2)
        assert maps["off"].shape == (5, len(NAMES))
    page = (folder / PAGE).read_text(encoding="utf-8")
    assert "All tolerances at once" in page
    forcefeel("envelope", *words, "--draws", "0", "--replace")
    assert "All tolerances at once" not in (folder / PAGE).read_text(encoding="utf-8")
    assert json.loads((folder / RESULTS).read_text(encoding="utf-8"))["laws"][LAW]["joint_tolerances"] is None


@pytest.mark.parametrize("given", [{"count": -1}, {"count": 1001}, {"count": 2.0}, {"seed": 2**63}, {"seed": True}])
def test_invalid_draws_raise_input_error(given):
    with pytest.raises(InputError, match="expected a whole number from 0"):
        Draws(**given)


def test_zero_draws_have_no_shares():
    few = ff.find_envelope(ff.elevator(), ("original",), GRID, changes={}, arms=())
    with pytest.raises(InputError, match="draws: expected drawn machines, got none"):
        few.drawn_shares("original")
