"""What an FMU's description says of its variables, held against what the FMU does: ranges, clocks, dependencies, states."""

import platform
import sys

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

import forcefeel as ff
from tests.export.fmus import STEP_S, Imported, unzipped
from tests.export.toolchain import NONLINEAR
from tests.pages import OnDemand
from tests.parametrization import mostly_slow

pytestmark = pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"), reason="FMUs are made on Linux x86_64 so far"
)

VERSIONS = ("fmi2", "fmi3")
KINDS = ("loader", "law", "machine")
GRIP = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.05 lb"}
LAWS = {
    "valve": lambda: ("robust", ff.digital_elevator()),
    "valve, every part": lambda: (
        "robust",
        ff.digital_elevator().replace(NONLINEAR | {"controller.antiwindup": "50 1/s"}, si=True),
    ),
    "motor, cogging": lambda: (
        "robust",
        ff.loader.electric("elevator-electric").replace({"motor.cogging_torque": "0.1 N m"}),
    ),
    "grip": lambda: ("grip", ff.digital_elevator().replace(GRIP, si=True)),
}
CONTACT = {"sensed_drive_position"}
CONTACT_AT_GRIP = CONTACT | {"sensed_load_cell_force", "sensed_column_base"}
"""What counts only while the column touches something."""

ASIDE = {
    "sensed_load_cell_force": 20.0,
    "sensed_drive_position": 1e-4,
    "sensed_column_base": 1e-4,
    "sensed_grip_force": 5.0,
    "trim": 0.05,
    "stiffness_factor": 2.0,
    "shaker": 1.0,
}
"""What each input of a law is moved by: enough to be seen, and not to meet a limit."""


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    def made(name):
        law, loader = LAWS[name]()
        out = tmp_path_factory.mktemp(name.split(",", maxsplit=1)[0])
        ff.export.write_export(ff.export.Exported.of(law, loader, "pitch"), ff.export.Target.FMU, out)
        return out, loader

    return OnDemand(made)


def opened(fmus, name, kind, version, **how):
    return Imported(unzipped(fmus[name][0], f"pitch_{kind}_{version}"), **how)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_fmpy_validation_finds_no_errors(fmus, kind):
    assert validate_fmu(str(fmus["grip"][0] / f"pitch_{kind}_fmi3.fmu")) == []


@pytest.mark.slow
def test_law_variables_belong_to_its_clock(fmus):
    """FMI 3.0.1, 2.4.7.4 and 2.4.8: clocked variables change where their clock ticks, and are no initial unknowns."""
    about = fmpy.read_model_description(str(fmus["valve"][0] / "pitch_law_fmi3.fmu"))
    for variable in about.modelVariables:
        signal = variable.causality in {"input", "output"} and variable.type == "Float64"
        assert [clock.name for clock in variable.clocks or []] == (["sample"] if signal else []), variable.name
    assert about.initialUnknowns == []
    for kind in ("loader", "machine"):
        about = fmpy.read_model_description(str(fmus["valve"][0] / f"pitch_{kind}_fmi3.fmu"))
        assert not any(variable.clocks for variable in about.modelVariables)
        assert {it.variable.name for it in about.initialUnknowns} == {it.variable.name for it in about.outputs}


def in_one_event(run, **aside):
    """The law's outputs after a tick of its clock."""
    run.fmu.setClock([run.variables["sample"].valueReference], [True])
    run.set(**aside)
    run.fmu.updateDiscreteStates()
    return {it.variable.name: run.get(it.variable.name)[0] for it in run.about.outputs}


@pytest.mark.parametrize("name", mostly_slow(LAWS))
def test_event_outputs_depend_only_on_the_declared_inputs(fmus, name):
    """Each input is moved by itself, from a slow and a quick motion: whatever output then is another depends on it."""
    follows = {}
    for aside, by in ASIDE.items():
        for moving in (0.3, 3.0):
            found = []
            for value in (0.0, by):
                with opened(fmus, name, "law", "fmi3", events=True) as run:
                    start = run.variables[aside].start
                    run.begin()
                    for k in range(20):
                        in_one_event(run, sensed_load_cell_force=moving * k, sensed_column_base=1e-6 * moving * k**2)
                        run.fmu.enterStepMode()
                        run.fmu.doStep(currentCommunicationPoint=k * STEP_S, communicationStepSize=STEP_S)
                        run.fmu.enterEventMode()
                    found.append(in_one_event(run, **{aside: float(start) + value}))
            one, two = found
            for output in one:
                if one[output] != two[output]:
                    follows.setdefault(output, set()).add(aside)
    about = fmpy.read_model_description(str(fmus[name][0] / "pitch_law_fmi3.fmu"))
    named = {it.variable.name: {known.name for known in it.dependencies} for it in about.outputs}
    assert "sensed_load_cell_force" in named["command"] or name == "grip"
    assert all(follows.get(output, set()) <= inputs for output, inputs in named.items())
    # More may be named of the feel, a shaker that has no force, a command that meets no limit here; and the drive of a contact.
    for output in ("command", "feel_torque"):
        more = CONTACT_AT_GRIP if name == "grip" else CONTACT
        assert follows[output] - more == named[output] - more


@pytest.mark.parametrize(("known", "by"), [("sensed_load_cell_force", 1.0), ("sensed_column_base", 1e-5)])
def test_derivative_in_an_event_is_that_of_the_event(fmus, known, by):
    """While the clock ticks: of the command on what is sampled now, not of the step before."""
    with opened(fmus, "valve", "law", "fmi3", events=True) as run:
        run.begin()
        sample = [run.variables["sample"].valueReference]
        for k in range(5):
            run.fmu.setClock(sample, [True])
            commands = []
            for value in (-by, by, 0.0):
                run.set(**{known: value})
                commands += run.get("command")
            expected = pytest.approx(
                (commands[1] - commands[0]) / (2 * by), rel=1e-9
            )  # it is linear: rounding alone is left
            assert run.derivative("command", known) == expected != 0.0
            run.fmu.updateDiscreteStates()
            assert run.derivative("command", known) == expected
            run.fmu.enterStepMode()
            run.fmu.doStep(currentCommunicationPoint=k * STEP_S, communicationStepSize=STEP_S)
            run.fmu.enterEventMode()


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_input_out_of_range_is_refused(fmus, kind, version):
    loader = fmus["valve"][1]
    expected = {
        "sensed_load_cell_force": (-loader["safety.force_range"], loader["safety.force_range"]),
        "sensed_drive_position": (-loader["safety.position_range"], loader["safety.position_range"]),
        "stiffness_factor": (0.0, 100.0),
        "shaker": (0.0, 1.0),
        "trim": (-np.pi, np.pi),
    }
    with opened(fmus, "valve", kind, version) as run:
        run.begin()
        inputs = [it for it in run.about.modelVariables if it.causality == "input" and it.name != "sample"]
        for it in inputs:
            low, high = float(it.min), float(it.max)
            assert (low, high) == expected.get(it.name, (low, high))
            for value in (low, high, float(it.start)):
                run.set(**{it.name: value})
            for value in (low - abs(low) * 0.01 - 0.01, high * 1.01, float("nan"), float("inf")):
                with pytest.raises(FMICallException):
                    run.set(**{it.name: value})
                assert f"{it.name}: expected a number from" in run.messages[-1]
                assert run.get(it.name) == [float(it.start)]


@pytest.mark.parametrize("drive", ["valve", "motor, cogging"])
def test_command_range_is_the_drive_limit(fmus, drive):
    loader = fmus[drive][1]
    most = loader["current_loop.current_limit"]
    if drive == "valve":
        most = loader["amplifier.current_limit"] / loader["amplifier.admittance"]
    with opened(fmus, drive, "law", "fmi3") as run:
        run.begin()
        largest = 0.0
        for k in range(100):
            run.set(sensed_load_cell_force=(-1) ** (k // 8) * 1e4)
            run.step()
            largest = max(largest, abs(run.get("command")[0]))
    assert largest == pytest.approx(
        most, rel=4e-16
    )  # a rounding or two, for the amplifier to meet its own limit to the bit


def test_law_and_machine_match_the_loader_bitwise_at_the_limit(fmus):
    """A hand that throws the column about: the valve's current is at its limit for much of it."""
    sensed = ("load_cell_force", "drive_position", "column_base", "grip_force")
    with (
        opened(fmus, "valve", "loader", "fmi3") as whole,
        opened(fmus, "valve", "law", "fmi3") as law,
        opened(fmus, "valve", "machine", "fmi3") as machine,
    ):
        for run in (whole, law, machine):
            run.begin()
        limited = 0
        for k in range(400):
            law.set(
                **dict(
                    zip(
                        (f"sensed_{name}" for name in sensed),
                        machine.get(*(f"sensed_{name}" for name in sensed)),
                        strict=True,
                    )
                )
            )
            law.step()
            machine.set(command=law.get("command")[0])
            for run in (whole, machine):
                run.set(pilot_force=(-1) ** (k // 20) * 3000.0)
                run.step()
            limited += abs(whole.get("valve_current")[0]) == fmus["valve"][1]["amplifier.current_limit"]
            assert machine.get("column_angle", "valve_current") == whole.get("column_angle", "valve_current")
    assert limited > 20


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_corrupted_state_is_refused(fmus, kind, version):
    random = np.random.default_rng(6)
    with opened(fmus, "valve", kind, version) as run:
        run.begin()
        run.step()
        state = run.fmu.getFMUState()
        written = run.fmu.serializeFMUState(state)
        read = run.fmu.deSerializeFMUstate if run.two else run.fmu.deserializeFMUState
        read(written)
        for place in [*random.integers(0, len(written), 40).tolist(), 0, len(written) - 1]:
            damaged = bytearray(written)
            damaged[place] ^= 1 << int(random.integers(8))
            with pytest.raises(FMICallException):
                read(bytes(damaged))
            assert run.messages[-1].startswith("state: ")
        for short in (written[:-1], written[: len(written) // 2], written + b"\0"):
            with pytest.raises(FMICallException):
                read(short)


def test_state_of_another_fmu_is_refused(fmus):
    with opened(fmus, "valve", "loader", "fmi3") as one, opened(fmus, "grip", "loader", "fmi3") as other:
        one.begin()
        written = one.fmu.serializeFMUState(one.fmu.getFMUState())
        with pytest.raises(FMICallException):
            other.fmu.deserializeFMUState(written)
        assert "that of another FMU" in other.messages[-1]


@pytest.mark.parametrize("name", ["valve", "motor, cogging"])
def test_every_signal_has_its_own_description(fmus, name):
    about = fmpy.read_model_description(str(fmus[name][0] / "pitch_machine_fmi3.fmu"))
    told = [it.description for it in about.modelVariables if it.causality == "output"]
    assert len(set(told)) == len(told)
    assert all(told)
