"""Records of bounded size: a rate below the loop's, and a ring that drops its oldest rows."""

import json

import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader

import forcefeel as ff
from tests.command_line import runs

run = runs("run")

LOADER = ff.digital_elevator()
LOOP_HZ = 1 / LOADER["controller.period"]
EVERY = 20


@pytest.fixture(scope="module")
def thinned(tmp_path_factory):
    """A record at a twentieth of the loop's rate, with a stop on the way, and the history of all cycles."""
    path = tmp_path_factory.mktemp("thinned") / "run.mcap"
    with ff.live.start(LOADER, real_time=False, record=path, record_rate_hz=LOOP_HZ / EVERY) as running:
        running.on()
        running.wait(15_000)
        running.stop()
        running.wait(15_000)
    return path, running.history(), running.columns


def test_record_with_rate_has_its_rows_and_all_around_a_trip(thinned):
    path, history, columns = thinned
    record = ff.live.read_live_record(path)
    trips = history[:, columns.index("trips")]
    time_s = history[:, columns.index("time_s")]
    (stop,) = np.flatnonzero(np.diff(trips)) + 1
    discrete = history[:, [columns.index(name) for name in ("state", "enable", "emergency_stop", "sampled")]]
    event = np.r_[False, (np.diff(discrete, axis=0) != 0).any(axis=1)]
    around = np.abs(time_s - time_s[stop]) < 1.0 + 1e-9  # rounding of times, by which a row at 1 s may be in or out
    chosen = (history[:, columns.index("cycle")] % EVERY == 0) | event | around
    at_edge = np.abs(np.abs(time_s - time_s[stop]) - 1.0) < 1e-9  # the same
    within = ~np.isin(record.column("time_s"), time_s[at_edge])
    assert np.array_equal(record.rows[within], history[chosen & ~at_edge], equal_nan=True)
    assert around.sum() == 2 * LOOP_HZ + 1
    assert [name for _, name, _ in record.requests] == ["on", "stop"]
    with path.open("rb") as file:
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages(topics="/cycle")) == len(record.rows)


def test_bench_data_of_record_with_rate_are_evenly_spaced(thinned):
    path, _, _ = thinned
    assert np.allclose(
        np.diff(ff.qualification.read_record(path).time_s), EVERY / LOOP_HZ, rtol=1e-9
    )  # rounding of differences of times


def test_record_without_every_cycle_is_not_replayed(thinned):
    with pytest.raises(ff.InputError, match="a row each 20 cycles"):
        ff.live.replay(thinned[0])


@pytest.mark.parametrize(
    ("rate_hz", "part"),
    [(300.0, "use 285.7142857 Hz or 333.3333333 Hz"), (3000.0, "at most the loop's 2000 Hz"), (0.0, "above 0 Hz")],
)
def test_impossible_rate_is_refused_with_the_nearest(tmp_path, rate_hz, part):
    path = tmp_path / "run.mcap"
    with pytest.raises(ff.InputError, match=part):
        ff.live.start(LOADER, real_time=False, record=path, record_rate_hz=rate_hz)
    assert not path.exists()


def test_size_an_hour_is_as_documented(tmp_path):
    path = tmp_path / "run.mcap"
    sizes = []
    for cycles in (4000, 24_000):
        with ff.live.start(LOADER, real_time=False, record=path) as running:
            running.wait(cycles)
        sizes.append((running.state.cycle, path.stat().st_size))
    (cycles, size), (more_cycles, larger) = sizes
    row_bytes = (larger - size) / (more_cycles - cycles)
    documented = {250: 0.31, 400: 0.50, 1000: 1.25, 2000: 2.50, 5000: 6.2}  # docs/how-to/run.md, GB
    for rate_hz, gigabytes in documented.items():
        assert row_bytes * rate_hz * 3600 / 1e9 == pytest.approx(gigabytes, rel=0.02)  # of two digits


def test_ring_keeps_the_newest_rows_in_two_parts(tmp_path):
    path, previous, most = tmp_path / "run.mcap", tmp_path / "run-previous.mcap", 2**21
    previous.write_bytes(b"of another run")
    with ff.live.start(LOADER, real_time=False, record=path, most_bytes=most, ring=True) as running:
        running.on()
        running.feel = {"feel.stiffness": 1.5 * LOADER["feel.stiffness"]}
        running.wait(25_000)
        assert running.state.recorded <= most
    state, parts = running.state, [ff.live.read_live_record(part) for part in (previous, path)]
    assert (state.record_ended, state.unrecorded_rows) == ("", 0)
    assert [part.ended for part in parts] == ["continued in the next part", "with the run"]
    cycles = np.concatenate([part.column("cycle") for part in parts])
    assert np.array_equal(cycles, np.arange(cycles[0], state.cycle))
    assert cycles[0] > 10_000
    assert most / 3 < previous.stat().st_size + path.stat().st_size <= most
    for part in parts:
        assert {"on", "feel"} <= {name for _, name, _ in part.requests}
    for part in (previous, path):
        with part.open("rb") as file:
            rows = sum(1 for _ in NonSeekingReader(file, validate_crcs=True).iter_messages(topics="/cycle"))
        assert rows == len(ff.live.read_live_record(part).rows)
        ff.qualification.read_record(part)
        with pytest.raises(ff.InputError, match="begins at cycle"):
            ff.live.replay(part)


def test_run_writes_a_ring_at_a_rate(run, tmp_path):
    words = ("elevator-2khz", "--headless", "--duration", "0.3", "--out", "live", "--json")
    status, out, err = run(*words, "--record-rate", "100 Hz", "--max-size", "20 MB")
    assert (status, err) == (0, "")
    assert "previous_record" not in json.loads(out)
    record = ff.live.read_live_record(tmp_path / "live" / "record.mcap")
    assert record.about["record_every"] == "20"
    assert len(record.rows) < json.loads(out)["cycles"]


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("--record-rate", "100 Hz"), "--out"),
        (("--max-size", "20 MB"), "--out"),
        (("--out", "live", "--record-rate", "300 Hz"), "use 285.7142857 Hz or 333.3333333 Hz"),
        (("--out", "live", "--record-rate", "fast"), "--record-rate"),
        (("--out", "live", "--max-size", "20"), "--max-size"),
        (("--out", "live", "--max-size", "1 MB"), "2,097,152"),
        (("--out", "live", "--max-size", "3 GB"), "2,147,483,648"),
    ],
)
def test_invalid_record_limits_are_refused(run, words, part):
    status, out, err = run("elevator-2khz", "--headless", *words)
    assert (status, out) == (2, "")
    assert part in err
