"""The FMUs in another's hands: FMPy finds nothing wrong with them, and gets a simulation's bits out of them."""

import os
import platform
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

import forcefeel as ff
from forcefeel import _core
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.simulation.scenario import Steps
from tests.export.fmus import STEP_S, Imported, unzipped
from tests.export.toolchain import CONVERTERS, KNOTS, NONLINEAR, needs, run
from tests.pages import OnDemand
from tests.parametrization import mostly_slow

pytestmark = pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"), reason="FMUs are made on Linux x86_64 so far"
)

VERSIONS = ("fmi2", "fmi3")

ROUNDING_OF_DIFFERENCES = 1e-6
"""Relative: what double precision leaves of a difference over a hundredth of what moves the FMU."""
KINDS = ("loader", "law", "machine")
SENSORS = {
    "load_cell.noise": "0.2 lb",
    "load_cell.bandwidth": "200 Hz",
    "potentiometer.noise": "0.0005 in",
    "column_sensor.noise": "0.002 deg",
    "column_sensor.offset": "0.05 deg",
    "linkage.backlash": "0.002 in",
}


def plain():
    return ff.digital_elevator()


def rough():
    return ff.digital_elevator().replace(NONLINEAR | CONVERTERS | SENSORS, si=True)


def motor():
    return ff.loader.electric("elevator-electric").replace(NONLINEAR | {"motor.cogging_torque": "0.1 N m"}, si=True)


LOADERS = {"plain": plain, "rough": rough, "motor": motor}


def smooth(loader):
    """Without the steps of sensors, which have no slope."""
    return loader.replace({key: None for key in loader.given if key.endswith(".resolution")})


SMOOTH = {
    "smooth": lambda: smooth(ff.digital_elevator()),
    "smooth-motor": lambda: smooth(ff.loader.electric("elevator-electric")),
}


def export(out, loader, feel=None):
    exported = ff.export.Exported.of("robust", loader, "pitch", feel)
    ff.export.write_export(exported, ff.export.Target.FMU, out)
    return exported


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """The FMUs of each loader, and its law, designed once."""

    def made(name):
        out = tmp_path_factory.mktemp(name)
        return out, export(out, (LOADERS | SMOOTH)[name]())

    return OnDemand(made)


def opened(fmus, loader, kind, version, **how):
    return Imported(unzipped(fmus[loader][0], f"pitch_{kind}_{version}"), **how)


@pytest.mark.parametrize("loader", mostly_slow(["rough", "motor"]))
@pytest.mark.parametrize("kind", mostly_slow(KINDS))
@pytest.mark.parametrize("version", mostly_slow(VERSIONS))
def test_fmpy_validation_gives_no_errors_and_no_messages(fmus, loader, kind, version):
    path = fmus[loader][0] / f"pitch_{kind}_{version}.fmu"
    assert validate_fmu(str(path)) == []
    messages = []
    found = fmpy.simulate_fmu(
        str(path), stop_time=0.05, output_interval=STEP_S, logger=lambda *it: messages.append(it), debug_logging=True
    )
    assert len(found) == 101
    assert messages == []


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("loader", mostly_slow(LOADERS, 2))
def test_step_matches_simulate_bitwise(fmus, loader, version):
    out, exported = fmus[loader]
    scenario = ff.Scenario(ff.Step(80.0), duration_s=0.5, seed=7)
    history = ff.simulate(exported.loader, scenario, exported.law).history
    found = fmpy.simulate_fmu(
        str(out / f"pitch_loader_{version}.fmu"),
        stop_time=0.5,
        output_interval=1e-3,
        start_values={"pilot_force": 80.0, "seed": 7},
    )
    names = {name: [it for it in history if it.startswith(name)] for name in found.dtype.names[1:]}
    assert {len(of) for of in names.values()} == {1}
    for name, (of,) in names.items():
        assert np.array_equal(found[name], history[of].values), name


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("loader", mostly_slow(["rough", "motor"]))
def test_other_importer_matches_bitwise(fmus, loader, version):
    needs("library tbb")  # of ecos
    out, exported = fmus[loader]
    scenario = ff.Scenario(ff.Step(80.0), duration_s=0.3, seed=7)
    history = ff.simulate(exported.loader, scenario, exported.law).history
    fmu = out / f"pitch_loader_{version}.fmu"
    said = run(out, sys.executable, Path(__file__).with_name("ecos.py"), fmu, 300, "pilot_force=80.0", "seed=7")
    found = [float.fromhex(line.split()[1]) for line in said.splitlines() if line.startswith("angle")]
    assert found == history.column_angle_rad.values[1:].tolist()


@pytest.mark.parametrize("loader", mostly_slow(LOADERS, 2))
def test_release_matches_simulate_bitwise(fmus, loader):
    out, exported = fmus[loader]
    scenario = ff.Scenario(ff.simulation.inputs.Release(0.05, start_s=0.1), duration_s=0.6)
    history = ff.simulate(exported.loader, scenario, exported.law).history
    given = {"start_angle": 0.05, "held_until": 0.1}
    found = fmpy.simulate_fmu(
        str(out / "pitch_loader_fmi2.fmu"), stop_time=0.6, output_interval=1e-3, start_values=given
    )
    assert np.array_equal(found["column_angle"], history.column_angle_rad.values)


@pytest.mark.parametrize("loader", LOADERS)
def test_changed_inputs_hold_through_each_step(fmus, loader):
    _, exported = fmus[loader]
    random = np.random.default_rng(3)
    steps = Steps.of(ff.Scenario(duration_s=0.2), exported.loader)
    count = round(0.2 / steps.step_s)
    force = 60 * random.standard_normal(count).cumsum() / 10
    trim = 0.02 * np.sin(np.arange(count) / 40)
    factor = 1 + 0.3 * random.uniform(-1, 1, count)
    both = {"force": force, "trim": trim, "stiffness_factor": factor}
    engine = _core.Simulation(
        {name: np.stack([values, values], axis=1) for name, values in both.items()},
        steps.step_s,
        outputs=[0, 5],
        timing=steps.timing,
        cancellation=None if exported.law.cancellation is None else exported.law.cancellation.numbers,
    )
    _, (expected,) = engine.run(exported.loader.si_values[np.newaxis], **exported.law.engine(exported.loader))
    with opened(fmus, loader, "loader", "fmi3") as run:
        # The run begins at rest under the first trim.
        run.begin(trim=trim[0], stiffness_factor=factor[0])
        found = []
        for k in range(count):
            run.set(pilot_force=force[k], trim=trim[k], stiffness_factor=factor[k])
            found.append(run.get("column_angle", "load_cell_force"))
            run.fmu.doStep(currentCommunicationPoint=k * steps.step_s, communicationStepSize=steps.step_s)
    assert np.array_equal(np.array(found).T, expected[:, :-1])


@pytest.mark.parametrize(("loader", "version"), [("plain", "fmi3"), ("rough", "fmi2"), ("motor", "fmi3")])
def test_law_and_machine_form_the_loop_of_the_loader(fmus, loader, version):
    begin = {"start_angle": 0.05}
    step_s = float(
        fmpy.read_model_description(str(fmus[loader][0] / "pitch_machine_fmi3.fmu")).defaultExperiment.stepSize
    )
    period = fmus[loader][1].law.period_s
    sensed = ("load_cell_force", "drive_position", "column_base", "grip_force")
    with (
        opened(fmus, loader, "loader", version) as whole,
        opened(fmus, loader, "law", version) as law,
        opened(fmus, loader, "machine", version) as machine,
    ):
        whole.begin(held_until=40 * period, seed=2, **begin)
        machine.begin(held_until=40 * period, seed=2, **begin)
        law.begin(**begin)
        for k in range(400):
            shown = dict(zip(sensed, machine.get(*(f"sensed_{name}" for name in sensed)), strict=True))
            law.set(**{f"sensed_{name}": value for name, value in shown.items()})
            at = k * period
            law.fmu.doStep(currentCommunicationPoint=at, communicationStepSize=period)
            machine.set(command=law.get("command")[0])
            for run in (whole, machine):
                run.fmu.doStep(currentCommunicationPoint=at, communicationStepSize=period)
            assert machine.get("column_angle", "load_cell_force") == whole.get("column_angle", "load_cell_force")
            assert law.get("feel_position") == whole.get("feel_position")
    assert step_s <= period


def test_feel_change_is_smooth_and_matches_simulation(fmus):
    _, exported = fmus["rough"]
    changes = {"feel.stiffness": 1500.0, "feel.damping": 60.0, "feel.breakout": 2.0}
    scenario = ff.Scenario(
        ff.Step(60.0),
        duration_s=0.5,
        sample_s=STEP_S,
        feel_changes=(ff.simulation.FeelChange(0.1, changes, fade_s=0.2),),
    )
    history = ff.simulate(exported.loader, scenario, exported.law).history
    with opened(fmus, "rough", "loader", "fmi3") as run:
        run.begin(pilot_force=60.0, feel_change_time=0.2)
        found = run.get("column_angle")
        for k in range(1000):
            if k == 200:
                run.set(feel__stiffness=1500.0, feel__damping=60.0, feel__breakout=2.0)
            run.step()
            found += run.get("column_angle")
        assert run.get("feel.stiffness") == [1500.0]
    assert np.array_equal(found, history.column_angle_rad.values)


@pytest.mark.slow
def test_setting_selects_its_feel_and_law(tmp_path):
    feel = ff.flight_schedule.read_knots(KNOTS).feel[:2]
    exported = export(tmp_path, plain(), feel)
    loader = exported.loader.replace(dict(zip(FEEL_SETTING, feel[0], strict=True)), si=True)
    to = dict(zip(FEEL_SETTING, feel[1], strict=True))
    change = ff.simulation.FeelChange(0.05, to, fade_s=0.1, law=exported.law.some([1]))
    scenario = ff.Scenario(ff.Step(60.0), duration_s=0.2, sample_s=STEP_S, feel_changes=(change,))
    history = ff.simulate(loader, scenario, exported.law.some([0])).history
    with Imported(unzipped(tmp_path, "pitch_loader_fmi2")) as run:
        run.begin(pilot_force=60.0, feel_change_time=0.1)
        found = run.get("column_angle")
        for k in range(400):
            if k == 100:
                run.set(setting=2)
            run.step()
            found += run.get("column_angle")
    assert np.array_equal(found, history.column_angle_rad.values)


def test_law_clock_ticks_in_event_mode(fmus):
    """A command follows its sample at once; the bits are those of a law that samples at the start of each step."""
    heard = 1e-6 * np.random.default_rng(4).standard_normal(50).cumsum()
    with opened(fmus, "plain", "law", "fmi3") as plain, opened(fmus, "plain", "law", "fmi3", events=True) as ticking:
        plain.begin()
        ticking.begin()
        clock = [ticking.variables["sample"].valueReference]
        for k, base in enumerate(heard):
            ticking.fmu.setClock(clock, [True])
            ticking.set(sensed_column_base=0.1)
            other = ticking.get("command")
            ticking.set(sensed_column_base=base)  # until it is settled, the last one counts
            early = ticking.get("command")
            assert other != early
            assert not ticking.fmu.updateDiscreteStates()[0]
            assert ticking.get("time") == [k * STEP_S]
            with pytest.raises(FMICallException):
                ticking.fmu.setClock(clock, [True])
            ticking.fmu.enterStepMode()
            plain.set(sensed_column_base=base)
            for run in (plain, ticking):
                run.fmu.doStep(currentCommunicationPoint=k * STEP_S, communicationStepSize=STEP_S)
            assert plain.get("command") == ticking.get("command") == early
            ticking.fmu.enterEventMode()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("version", VERSIONS)
def test_restored_state_continues_identically(fmus, kind, version):
    drive = {"law": "sensed_column_base"}.get(kind, "pilot_force")
    names = ("feel_position", "command") if kind == "law" else ("column_angle", "load_cell_force")

    def go(run, steps):
        for k in range(steps):
            run.fmu.doStep(currentCommunicationPoint=run.time + k * STEP_S, communicationStepSize=STEP_S)
        return run.get(*names)

    with opened(fmus, "rough", kind, version) as run, opened(fmus, "rough", kind, version) as other:
        run.begin(seed=5) if kind != "law" else run.begin()
        run.set(**{drive: 0.01 if kind == "law" else 50.0})
        if kind != "machine":
            run.set(feel__damping=50.0)
        go(run, 40)
        state = run.fmu.getFMUState()
        written = run.fmu.serializeFMUState(state)
        run.time = 40 * STEP_S
        after = go(run, 60)
        run.fmu.setFMUState(state)
        assert go(run, 60) == after
        run.fmu.freeFMUState(state)
        # Another instance, which was not even initialized, goes on from the bytes.
        state = (other.fmu.deSerializeFMUstate if other.two else other.fmu.deserializeFMUState)(written)
        other.fmu.setFMUState(state)
        other.time = run.time
        assert go(other, 60) == after
        other.fmu.freeFMUState(state)


def test_invalid_state_bytes_are_refused(fmus):
    with opened(fmus, "plain", "loader", "fmi3") as run:
        run.begin()
        for written in (b"", b"nonsense", bytes(5000), b"\xff" * 5000):
            with pytest.raises(FMICallException):
                run.fmu.deserializeFMUState(written)
        assert all(message.startswith("state: ") for message in run.messages)


@pytest.mark.parametrize(
    ("loader", "kind", "known", "unknown", "version"),
    mostly_slow(
        [
            ("smooth", "loader", "pilot_force", "column_angle", "fmi2"),
            ("smooth", "loader", "pilot_force", "load_cell_force", "fmi3"),
            ("smooth", "law", "sensed_column_base", "feel_velocity", "fmi3"),
            ("smooth-motor", "loader", "pilot_force", "column_velocity", "fmi3"),
            ("smooth", "machine", "command", "load_cell_force", "fmi2"),
            ("smooth", "law", "sensed_load_cell_force", "command", "fmi2"),
        ],
        3,
    ),
)
def test_derivatives_match_differences(fmus, loader, kind, known, unknown, version):
    by = 1e-5 if known.endswith("base") else 1e-2
    with opened(fmus, loader, kind, version) as run:
        run.begin()
        step_s = fmus[loader][1].law.period_s
        if kind != "law":
            run.set(pilot_force=40.0)
        if kind == "machine":
            run.set(command=0.3)  # at none, the flow through the orifice has a slope to each side
        run.fmu.doStep(currentCommunicationPoint=0.0, communicationStepSize=20 * step_s)
        state, (at,) = run.fmu.getFMUState(), run.get(known)

        def after(value):
            run.fmu.setFMUState(state)
            run.set(**{known: value})
            run.fmu.doStep(currentCommunicationPoint=20 * step_s, communicationStepSize=4 * step_s)
            return run.get(unknown)[0]

        # The central difference of fourth order leaves rounding alone.
        difference = (8 * (after(at + by) - after(at - by)) - (after(at + 2 * by) - after(at - 2 * by))) / (12 * by)
        after(at)
        assert run.derivative(unknown, known) == pytest.approx(difference, rel=ROUNDING_OF_DIFFERENCES)
        assert difference != 0
        run.fmu.freeFMUState(state)


def test_two_instances_are_independent(fmus):
    with opened(fmus, "rough", "loader", "fmi2") as one, opened(fmus, "rough", "loader", "fmi2") as two:
        one.begin(pilot_force=50.0)
        two.begin(pilot_force=-20.0, seed=3)
        for _ in range(100):
            one.step()
            two.step()
        both = one.get("column_angle"), two.get("column_angle")
    for force, seed, found in ((50.0, 0, both[0]), (-20.0, 3, both[1])):
        with opened(fmus, "rough", "loader", "fmi2") as alone:
            alone.begin(pilot_force=force, seed=seed)
            alone.step(100 * STEP_S)
            assert alone.get("column_angle") == found


@pytest.mark.parametrize("version", VERSIONS)
def test_refusals_are_sent_to_the_logger(fmus, version):
    def refused(run, what, *words, **values):
        with pytest.raises(FMICallException) as caught:
            what(*words, **values)
        assert caught.value.status == 3
        return run.messages[-1]

    with opened(fmus, "plain", "loader", version) as run:
        assert "held_until: expected a multiple" in refused(run, run.begin, held_until=1.23e-4)
    with opened(fmus, "plain", "loader", version) as run:
        assert "is not initialized" in refused(run, run.step)
        run.begin()
        assert "expected a multiple of the internal step of 0.0005 s, got 0.0007 s" in refused(run, run.step, 7e-4)
        assert "expected a multiple" in refused(run, run.step, 0.0)
        assert "expected a multiple" in refused(run, run.step, -STEP_S)
        assert "expected a multiple" in refused(run, run.step, float("nan"))
        run.time = 1.0
        assert "communication point: expected 0 s" in refused(run, run.step)
        run.time = 0.0
        assert "pilot_force: expected a number" in refused(run, run.set, pilot_force=float("nan"))
        assert "feel.stiffness: expected" in refused(run, run.set, feel__stiffness=-1.0)
        assert "column.inertia: is fixed" in refused(run, run.set, column__inertia=2.0)
        assert "trim: has no derivative" in refused(run, run.derivative, "column_angle", "trim")
        run.step()  # and nothing of it went amiss


@pytest.mark.parametrize("version", VERSIONS)
def test_description_of_another_fmu_is_refused(fmus, version):
    with pytest.raises(Exception, match="instantiate"):
        opened(fmus, "plain", "loader", version, token="another")


def test_corrupted_resources_are_refused(fmus, tmp_path):
    fmu = fmus["plain"][0] / "pitch_loader_fmi3.fmu"
    for place, broken in enumerate(("", "token x\n", "values 1 2 3\n", "observers nan\nvalues\n", "\0")):
        folder = tmp_path / str(place)
        fmpy.extract(str(fmu), str(folder))
        (folder / "resources" / "loader.txt").write_text(broken, encoding="utf-8")
        with pytest.raises(Exception, match="instantiate"):
            Imported(folder)


@pytest.mark.slow
def test_export_is_reproducible(fmus, tmp_path):
    out, exported = fmus["plain"]
    ff.export.write_export(exported, ff.export.Target.FMU, tmp_path)
    for path in sorted(tmp_path.iterdir()):
        assert path.read_bytes() == (out / path.name).read_bytes()
        names = set(zipfile.ZipFile(path).namelist())
        assert {"modelDescription.xml", "resources/loader.txt"} <= names


def test_analog_law_is_refused_and_nothing_is_written(tmp_path):
    exported = ff.export.Exported.of("converged", ff.elevator(), "pitch")
    with pytest.raises(ff.InputError, match="converged is an analog law, and the target is digital"):
        ff.export.write_export(exported, ff.export.Target.FMU, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_law_and_machine_qualify_under_another_master(fmus, tmp_path, forcefeel):
    """Let go from a quarter of the throw of 20 degrees, as the rule asks; the loop is closed by FMPy alone."""
    sensed = [f"sensed_{name}" for name in ("load_cell_force", "drive_position", "column_base", "grip_force")]
    rows = []
    with opened(fmus, "plain", "law", "fmi3") as law, opened(fmus, "plain", "machine", "fmi3") as machine:
        held = np.radians(5.0)
        law.begin(start_angle=held)
        machine.begin(start_angle=held, held_until=0.5)
        shown, heard = ([run.variables[name].valueReference for name in sensed] for run in (machine, law))
        (angle,), (given,), (command,) = (
            [run.variables[name].valueReference]
            for run, name in ((machine, "column_angle"), (law, "command"), (machine, "command"))
        )
        for k in range(8_000):
            *sensors, theta = machine.fmu.getFloat64([*shown, angle])
            rows.append((k * STEP_S, np.degrees(theta)))
            law.fmu.setFloat64(heard, sensors)
            law.fmu.doStep(k * STEP_S, STEP_S)
            machine.fmu.setFloat64([command], law.fmu.getFloat64([given]))
            machine.fmu.doStep(k * STEP_S, STEP_S)
    np.savetxt(tmp_path / "seen.csv", rows[::4], delimiter=",", header="time (s),position (deg)", comments="")
    test = "release-25-positive"
    status, out, _ = forcefeel(
        "qualify", "elevator-2khz", "--test", test, "--record", f"{test}=seen.csv", "--out", "page"
    )
    assert status == 0
    assert "1 of 1 tests passed" in out


@pytest.mark.slow
@pytest.mark.skipif(
    not (shutil.which("cc") and shutil.which("valgrind")) and not int(os.environ.get("FORCEFEEL_REQUIRE_TARGETS", "0")),
    reason="no C compiler or no valgrind on the machine: what an FMU does not give back is not looked for",
)
def test_fmu_releases_all_its_memory(fmus, tmp_path):
    """A hundred lives here; ``fmu_life`` takes any number, and a thousand were counted when this was written."""
    source = Path(__file__).with_name("fmu_life.c")
    strict = ("-std=c99", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
    subprocess.run(["cc", *strict, "-o", tmp_path / "life", source, "-ldl"], check=True)
    folder = unzipped(fmus["rough"][0], "pitch_loader_fmi2")
    token = fmpy.read_model_description(str(folder)).guid
    words = (tmp_path / "life", folder / "binaries/linux64/pitch_loader.so", folder / "resources", token, "100")
    checked = ("valgrind", "--leak-check=full", "--errors-for-leak-kinds=all", "--show-leak-kinds=all")
    done = subprocess.run([*checked, "--error-exitcode=9", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "no leaks are possible" in done.stderr
