"""A bench signal on a drive's bus: the record of a machine that only the emulator has."""

from dataclasses import replace

import pytest

import forcefeel as ff
from forcefeel.bench.identification.fit import identify
from tests.command_line import runs
from tests.live.test_bus import KINDS, emulated, yoke

excite = runs("excite")

FIT = ("motor.inertia", "linkage.stiffness", "linkage.damping", "column.inertia")
NEAR = 0.01
"""The sensors have noise, and an ODrive's board 16 bits of force."""

HIDDEN = dict(zip(FIT, (1.1, 0.85, 1.15, 1.15), strict=True))
"""What the machine has of the file's values."""


def signal(loader, **changes):
    plan = {"time_s": 4.0, "rate_hz": 2000.0, "from_hz": 4.0, "to_hz": 60.0, "measured": ff.bus.PLAYED}
    return ff.bench.excite(loader, "J_m,k,c,J", "motor-open", ff.bench.ExcitationPlan(**(plan | changes)))


@pytest.mark.parametrize("kind", KINDS)
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


def test_signal_that_cannot_be_played_is_refused(excite, tmp_path):
    loader = yoke()
    with pytest.raises(ff.InputError, match="use --rate 2000"):
        ff.bus.play(signal(loader, rate_hz=1000.0))
    with pytest.raises(ff.InputError, match="load_cell"):
        ff.bus.play(signal(yoke(load_cell_n=None)))
    with pytest.raises(ff.InputError, match="add the table"):
        ff.bus.play(signal(ff.loader.electric("desktop-yoke")))
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
