"""A bench signal on a drive's bus: the record of a machine that only the emulator has."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Drive
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.record_run import driven
from forcefeel.bench.record_csv import record_csv
from forcefeel.bench.run_law import law_of_runs
from forcefeel.bus import bench_record
from forcefeel.simulation.inputs import Schedule
from tests.command_line import runs
from tests.live.test_bus import KINDS, NEEDS_ROOT, emulated, until, yoke
from tests.parametrization import mostly_slow

excite = runs("excite")

FIT = ("motor.inertia", "linkage.stiffness", "linkage.damping", "column.inertia")
NEAR = 0.01
"""The sensors have noise, and an ODrive's board 16 bits of force."""

ROUNDED = 1e-9
"""Of sums of some thousand numbers."""

UNDER_LAW = 0.02
"""The law turns the sensors' noise into motion."""

SENSED = {"load_cell_n": 10_000.0, "column_gear": 1.0}
DRY, FRICTION_N = ("column.coulomb_friction", "column.static_friction"), 4.448

HIDDEN = dict(zip(FIT, (1.1, 0.85, 1.15, 1.15), strict=True))
"""What the machine has of the file's values."""


def signal(loader, **changes):
    plan = {"time_s": 4.0, "rate_hz": 2000.0, "from_hz": 4.0, "to_hz": 60.0, "measured": ff.bus.PLAYED}
    return ff.bench.excite(loader, "J_m,k,c,J", "motor-open", ff.bench.ExcitationPlan(**(plan | changes)))


@pytest.mark.slow
@pytest.mark.parametrize("kind", mostly_slow(["moteus", KINDS[-1]]))
def test_identification_finds_the_hidden_machine(kind):
    loader = yoke(kind)
    truth = loader.replace({key: share * loader[key] for key, share in HIDDEN.items()}, si=True)
    with emulated(truth) as (there, emulator):
        wired = replace(loader, bus=there.bus)
        record = ff.bus.play(signal(wired), real_time=False)
        assert emulator.commands == [0.0]
    found = identify(wired, [record], "J_m,k,c,J")
    for estimate in found.estimates:
        key = estimate.unknown.key
        assert estimate.value == pytest.approx(truth[key], rel=NEAR), key


def under_law(loader, time_s=3.0, **limits):
    plan = ff.bench.ExcitationPlan(
        time_s=time_s,
        rate_hz=2000.0,
        to_hz=60.0,
        measured=("column_angle", "drive_position", "load_cell_force"),
        limits={"voltage": loader["current_loop.voltage_limit"], **limits},
    )
    return ff.bench.excite(loader, "J_m,k,c,J", "loader command_current", plan)


@pytest.mark.parametrize(
    ("kind", "near"),
    mostly_slow([("moteus", 1e-5), ("odrive", 0.02), pytest.param("ethercat", 0.02, marks=NEEDS_ROOT)]),
)
def test_record_under_the_law_lies_on_the_simulation(kind, near):
    """Without noise; an ODrive's board has 16 bits of force, an EtherCAT drive thousandths of its rated torque."""
    loader = yoke(kind, quiet=True)
    signal = under_law(loader, travel=0.01)
    with emulated(loader) as (there, _):
        record = ff.bus.play(replace(signal, loader=there), real_time=False)
    steps = Schedule(tuple(np.repeat(signal.time_s, 2)[1:].tolist()), tuple(np.repeat(signal.signal, 2)[:-1].tolist()))
    scenario = replace(driven(Drive.COMMAND_CURRENT, steps), duration_s=2.9, sample_s=1 / 2000)
    run = ff.simulate(loader, scenario, signal.law).history
    for channel, column in (
        ("column_angle", "column_angle_rad"),
        ("drive_position", "drive_position_m"),
        ("load_cell_force", "load_cell_force_n"),
    ):
        expected = run[column].to_numpy()
        off = record.channels[channel][: len(expected)] - expected
        assert np.std(off) < near * np.std(expected), channel


@pytest.mark.slow
def test_identification_finds_the_hidden_machine_and_its_friction_under_the_law():
    """Friction holds the column anywhere within it as the signal begins, which no simulation from rest knows."""
    loader = replace(ff.loader.electric("elevator-electric"), bus=ff.loader.Bus("moteus", "pty", **SENSED)).replace(
        {"controller.period": 5e-4, "controller.delay": 5e-4}, si=True
    )
    hidden = {key: share * loader[key] for key, share in HIDDEN.items()} | dict.fromkeys(DRY, FRICTION_N)
    truth = loader.replace(hidden, si=True)
    with ff.live.BusEmulator([truth], real_time=False) as emulator:
        wired = replace(loader, bus=replace(loader.bus, port=emulator.port))
        record = ff.bus.play(under_law(wired, 16.0), real_time=False)
    assert record.run == {"law": "torque-mode"}
    found = identify(loader.replace({DRY[0]: "2 lb"}), [record], [*FIT, DRY[0]], starts=1)
    for estimate in found.estimates:
        key = estimate.unknown.key
        assert estimate.value == pytest.approx(truth[key], rel=UNDER_LAW), key


def test_signal_under_the_law_ends_with_the_supervisor():
    loader = yoke()
    with emulated(loader) as (wired, emulator):
        signal = under_law(wired, travel=0.01)
        with pytest.raises(ff.InputError, match=r"the signal ended early: .*; lower the limits"):
            ff.bus.play(replace(signal, signal=np.full_like(signal.signal, 20.0)), real_time=False)
        until(lambda: emulator.commands == [0.0])  # the last telegram may be under way


@pytest.mark.slow
def test_signal_that_cannot_be_played_is_refused(excite, tmp_path):
    loader = yoke()
    with pytest.raises(ff.InputError, match="use --rate 2000"):
        ff.bus.play(signal(loader, rate_hz=1000.0, time_s=2.0))
    with pytest.raises(ff.InputError, match="load_cell"):
        ff.bus.play(signal(yoke(load_cell_n=None), time_s=2.0))
    with pytest.raises(ff.InputError, match="add the table"):
        ff.bus.play(signal(ff.loader.electric("desktop-yoke"), time_s=2.0))
    (tmp_path / "yoke.toml").write_text(loader.to_toml().replace('"pty"', '"./nowhere"'), encoding="utf-8")
    words = ("--fit", "J_m", "--experiment", "motor-open", "--rate", 2000, "--time", 2, "--machine", "bus")
    status, out, err = excite("yoke.toml", *words, "--out", "bench.csv")
    assert (status, out) == (2, "")
    assert "./nowhere" in err
    assert not (tmp_path / "bench.csv").exists()


@pytest.mark.parametrize(
    ("harm", "part"),
    [
        (lambda emulator: emulator.push(60.0), "moved by more than"),
        (lambda emulator: emulator.fail(33), "motor driver fault"),
        (lambda emulator: emulator.break_wire("gone"), "did not answer"),
    ],
)
def test_drive_that_leaves_its_limits_is_stopped(harm, part, monkeypatch):
    loader = yoke()
    with ff.live.BusEmulator([loader], real_time=False) as emulator:
        wired = replace(loader, bus=replace(loader.bus, port=emulator.port))
        core = ff.bus.bench_record._core
        drive = core.BusDrive

        def harmed(*given, **options):
            made = drive(*given, **options)
            harm(emulator)
            return made

        monkeypatch.setattr(core, "BusDrive", harmed)
        with pytest.raises(ff.InputError, match=part):
            ff.bus.play(signal(wired), real_time=False)
        emulator.break_wire(None)
    assert abs(emulator.commands[0]) < 1.0  # A; the last of a signal that nobody could stop


@pytest.mark.parametrize("late", [2, 3])
def test_record_with_a_late_command_is_made_anew_twice_at_most(monkeypatch, late):
    loader = yoke()
    signal, made = under_law(loader, travel=0.01), []

    def recorded(excitation, law, *, real_time):
        time_s = excitation.time_s + (0.01 if len(made) < late else 0.0) * (excitation.time_s > 1.0)
        made.append(time_s)
        return time_s, dict.fromkeys(
            ("command_current", "column_angle", "drive_position", "load_cell_force", "grip_force"), excitation.signal
        )

    monkeypatch.setattr(bench_record, "_under_law", recorded)
    if late < 3:
        assert len(ff.bus.play(signal).time_s) == len(signal.time_s)
    else:
        with pytest.raises(ff.InputError, match=r"in 3 records a command came late, in the last 10\.5 ms after"):
            ff.bus.play(signal)
    assert len(made) == 3


def test_commands_that_were_late_or_missed_are_the_mean_of_each_period():
    """A late step and a late sample of a known motion: the record has both at whole periods."""
    rng, period, count = np.random.default_rng(7), 5e-4, 4000
    sent_s = (np.arange(count) + np.cumsum(rng.random(count) < 0.002)) * period + rng.uniform(0, 0.3, count) * period
    sent_s -= sent_s[0]
    signal = rng.normal(size=count)
    swing = {"column_angle": np.sin(2 * np.pi * 40 * sent_s)}
    time_s, even = bench_record._evenly(sent_s, {"command_current": signal, **swing}, "command_current", period)
    assert np.allclose(np.diff(time_s), period, rtol=ROUNDED)
    # Nothing of the commands is lost: their integral is the staircase's, at any period.
    for k in (1, 777, len(time_s) - 1):
        ends = np.minimum(np.append(sent_s[1:], np.inf), time_s[k])
        held = signal * np.maximum(ends - np.minimum(sent_s, time_s[k]), 0.0)
        assert even["command_current"][:k].sum() * period == pytest.approx(held.sum(), rel=ROUNDED)
    # A cubic spline through 50 samples of a swing and less where they are missing.
    assert np.abs(even["column_angle"] - np.sin(2 * np.pi * 40 * time_s)).max() < 2e-4


def test_samples_that_a_held_up_drive_sends_again_are_left_out():
    count = 40
    rows = {name: np.arange(count) * 1.0 for name in ("column_angle_rad", "drive_position_m", "load_cell_force_n")}
    for row in rows.values():
        row[10:13] = row[9]  # three of them
        row[20:] = row[19]  # at rest
    assert np.flatnonzero(bench_record._stale(rows)).tolist() == [10, 11, 12]


def test_record_of_a_file_states_its_law(tmp_path):
    loader = yoke(quiet=True)
    with emulated(loader) as (there, _):
        record = ff.bus.play(under_law(there, travel=0.01), real_time=False)
    path = tmp_path / "bench.csv"
    path.write_text(record_csv(record), encoding="utf-8")
    assert "# law: torque-mode\n" in path.read_text(encoding="utf-8")
    read = ff.bench.read_bench_record(path)
    assert read.run == {"law": "torque-mode"}
    assert law_of_runs([read], loader).name == "torque-mode"
    # The fit takes it: under the default law of a motor the model would miss.
    begin = loader.replace({"column.inertia": 1.1 * loader["column.inertia"]}, si=True)
    found = identify(begin, [read], "J", starts=1)
    assert found.loader["column.inertia"] == pytest.approx(loader["column.inertia"], rel=NEAR)
