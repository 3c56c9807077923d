"""A live run in virtual time gives the bits of a simulation, and its record replayed gives them again."""

import struct

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.simulation import FeelChange

LOADERS = {
    "elevator-2khz": ff.digital_elevator,
    "sidestick-pitch": lambda: ff.loader.electric("sidestick-pitch"),
    "aileron-wheel": lambda: ff.loader.electric("aileron-wheel"),
}

CASES = [
    ("elevator-2khz", "robust"),
    ("elevator-2khz", "agile"),
    ("elevator-2khz", "load-cell"),
    ("elevator-2khz", "published"),
    ("sidestick-pitch", "robust"),
    ("sidestick-pitch", "torque-mode"),
    ("aileron-wheel", "robust"),
]


def scenarios(loader):
    """A step, a release with noise, a change of the feel on the way."""
    sample_s = loader["controller.period"]
    other = FeelChange(0.1, {"feel.stiffness": 0.5 * loader["feel.stiffness"], "feel.breakout": 3.0}, 0.2)
    yield ff.Scenario(ff.Step(20.0), duration_s=0.5, sample_s=sample_s)
    yield ff.Scenario(ff.Release(0.05, 0.1), duration_s=0.5, sample_s=sample_s, seed=3)
    yield ff.Scenario(ff.Step(20.0), duration_s=0.5, sample_s=sample_s, feel_changes=(other,))


def live(loader, law, scenario, **more):
    """The columns of a run in virtual time."""
    endpoint = ff.live.Simulated(scenario)
    with ff.live.start(loader, law, endpoint=endpoint, real_time=False, supervised=False, **more) as running:
        running.wait(10**6)
        rows = running.history()
    return dict(zip(running.columns, rows.T, strict=True))


@pytest.mark.parametrize(("name", "law"), CASES)
def test_live_run_is_bit_identical_to_simulation(name, law):
    # Dry friction and noise, so that the simulation is the nonlinear one.
    loader = LOADERS[name]().replace({"column.coulomb_friction": 1.0, "load_cell.noise": 0.2}, si=True)
    for scenario in scenarios(loader):
        simulated = ff.simulate(loader, scenario, law)
        assert simulated.method == "stepped"
        columns = live(loader, law, scenario)
        # A row has the feel after its sample, a history the feel before it.
        for column, of_history in (
            ("feel_angle_rad", "feel_position_rad"),
            ("feel_rate_rad_per_s", "feel_velocity_rad_per_s"),
        ):
            expected = simulated.history[of_history].values[1:]
            assert np.array_equal(columns[column][: len(expected)], expected), (scenario, column)
        forces = simulated.history["pilot_force_n"].values[:-1]
        assert np.array_equal(columns["pilot_force_n"], forces), scenario


def test_record_of_live_run_replays_bit_identical(tmp_path):
    loader = ff.digital_elevator()
    scenario = list(scenarios(loader))[2]
    columns = live(loader, "robust", scenario, record=tmp_path / "run.mcap")
    record = ff.live.read_live_record(tmp_path / "run.mcap")
    assert not record.broken
    assert record.about["law"] == "robust"
    assert record.requests[0][:2] == (200, "feel")
    for name, values in columns.items():
        assert np.array_equal(record.column(name), values, equal_nan=True), name
    replayed = ff.live.replay(tmp_path / "run.mcap")
    assert replayed == ff.live.Replayed(1000, None, None, "", "with the run")


def without_sums(data):
    """An MCAP file whose chunks state no check sum: code, length, two times, size, and the sum, whose zero is none."""
    data, at = bytearray(data), len(MAGIC)
    while at < len(data) - len(MAGIC):
        code, length = struct.unpack_from("<BQ", data, at)
        if code == CHUNK:
            data[at + 33 : at + 37] = bytes(4)
        at += 9 + length
    return data


MAGIC, CHUNK = b"\x89MCAP0\r\n", 0x06


def test_replay_detects_one_changed_bit(tmp_path):
    path = tmp_path / "run.mcap"
    live(ff.digital_elevator(), "robust", next(scenarios(ff.digital_elevator())), record=path)
    data = bytearray(path.read_bytes())
    # A bit of one force in the middle: what follows from it is another number.
    number = np.float64(ff.live.read_live_record(path).column("load_cell_force_n")[500]).tobytes()
    at = data.index(number)
    data[at + 6] ^= 1
    path.write_bytes(data)
    damaged = ff.live.replay(path)
    assert "check sum" in damaged.broken
    assert not damaged.same
    path.write_bytes(without_sums(data))
    replayed = ff.live.replay(path)
    assert not replayed.same
    assert replayed.difference[0] <= 501
