"""The options that describe a scenario: what they become, and what is refused."""

import math
from dataclasses import replace

import pytest

import forcefeel as ff
from forcefeel.cli.scenario_inputs import DURATION_S, OPTIONS, InputKind, Spacing
from forcefeel.cli.scenario_options import MOST_STEPS, ScenarioOptions
from forcefeel.cli.scenario_text import assignments, over_time, seconds
from forcefeel.errors import InputError
from forcefeel.laws.analog import recursion as compensation
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm, arm_of
from forcefeel.loader.parameters import TABLE, in_range
from forcefeel.simulation.inputs import StopToStop
from forcefeel.units import factor

LB = factor("lb", "N")
EXACT = {"rel": 1e-12}  # rounding of a few operations


def scenario(loader=None, **options):
    loader = loader or ff.elevator()
    return ScenarioOptions(**options).scenario(loader)


def test_default_input_is_step_of_pilot_force():
    loader = ff.elevator()
    found = scenario(loader)
    assert found.force == ff.Step(loader["pilot.force"], 0.1)
    assert (found.duration_s, found.step_s, found.sample_s, found.seed) == (2.0, 1e-3, 1e-3, 0)
    assert ScenarioOptions().changed(loader) is loader
    assert ScenarioOptions().law_of(loader).numbers.kind == "original"


@pytest.mark.parametrize(
    ("options", "force"),
    [
        ({"input": InputKind.STEP, "force": "20 lb", "start": "0.25 s"}, ff.Step(20 * LB, 0.25)),
        ({"input": InputKind.PULSE, "force": "-50 N", "width": "0.2"}, ff.simulation.Pulse(-50.0, 0.1, 0.2)),
        ({"input": InputKind.DOUBLET, "force": "20 lb", "start": "0"}, ff.simulation.Doublet(20 * LB, 0.0, 0.5)),
        ({"input": InputKind.STOP_TO_STOP, "force": "60 lb"}, StopToStop(60 * LB, 100.0)),
        (
            {"input": InputKind.STOP_TO_STOP, "force": "60 lb", "input_duration": "4", "duration": "5"},
            StopToStop(60 * LB, 4.0),
        ),
        (
            {"input": InputKind.CHIRP, "force": "10 N", "from_": "0.5 Hz", "to": "1 kHz", "step": "0.4 ms"}
            | {"spacing": Spacing.LOGARITHMIC, "sample": "0.8 ms"},
            ff.simulation.Chirp(10.0, 0.5, 1000.0, 20.0, "logarithmic"),
        ),
        (
            {"input": InputKind.MULTISINE, "force": "10 N", "lines": "0.5 Hz, 1.5 Hz", "input_duration": "2 s"},
            ff.simulation.Multisine(10.0, (0.5, 1.5), 2.0),
        ),
        (
            {"input": InputKind.MULTISINE, "force": "10 N", "from_": "0.9 Hz", "to": "2 Hz", "input_duration": "2 s"},
            ff.simulation.Multisine(10.0, (1.0, 1.5, 2.0), 2.0),
        ),
        ({"input": InputKind.RELEASE, "angle": "10 deg"}, ff.Release(math.radians(10))),
        ({"input": InputKind.RELEASE, "angle": "10 deg", "start": "0.5 s"}, ff.Release(math.radians(10), 0.5)),
        ({"input": InputKind.HANDS_OFF}, ff.simulation.HandsOff()),
    ],
)
def test_every_input_option_gives_its_input(options, force):
    found = scenario(**options).force
    assert type(found) is type(force)
    numbers, expected = (list(vars(one).values()) for one in (found, force))
    for number, wanted in zip(numbers, expected, strict=True):
        assert number == (pytest.approx(wanted, **EXACT) if isinstance(wanted, float | tuple) else wanted)


@pytest.mark.parametrize("kind", InputKind)
def test_default_duration_covers_input(kind):
    angle = {"angle": "1 deg"} if kind is InputKind.RELEASE else {}
    assert scenario(input=kind, **angle).duration_s == pytest.approx(DURATION_S[kind], **EXACT)


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("kind", InputKind)
def test_an_option_for_another_input_is_refused(option, kind):
    if kind in OPTIONS[option]:
        return
    field = {"--from": "from_"}.get(option, option[2:].replace("-", "_"))
    with pytest.raises(InputError, match=f"{option}: is for --input .*; the input is {kind}, so leave it out"):
        scenario(input=kind, **{field: "1"})


def test_digital_controller_times_are_multiples_of_period():
    loader = ScenarioOptions(set_=["controller.period=0.3 ms"]).changed(ff.elevator())
    found = scenario(loader, input=InputKind.DOUBLET)
    steps = [time / 3e-4 for time in (found.duration_s, found.sample_s, found.force.start_s, found.force.width_s)]
    assert steps == pytest.approx([round(step) for step in steps], **EXACT)
    assert found.duration_s == pytest.approx(2.0, abs=found.sample_s)
    assert (
        ff.simulate(loader, found, "original").history.sizes["time_s"] == round(found.duration_s / found.sample_s) + 1
    )


def test_recording_starts_at_first_point_and_plays_completely(tmp_path):
    path = tmp_path / "force.csv"
    path.write_text("time (s),force (lb)\n12.0,0\n12.5,10\n13.0004,0\n", encoding="utf-8")
    found = scenario(record=path)
    assert found.force.time_s[0] == 0
    assert found.duration_s == pytest.approx(1.0, **EXACT)  # the last whole sample
    assert scenario(record=path, duration="0.5 s").duration_s == 0.5
    with pytest.raises(InputError, match="expected a recording of all the run"):
        ff.simulate(ff.elevator(), scenario(record=path, duration="2 s"))
    with pytest.raises(InputError, match="--force: given with --record"):
        scenario(record=path, force="3 lb")
    with pytest.raises(InputError, match="--input: given with --record"):
        scenario(record=path, input=InputKind.STEP)


def test_set_and_arm_change_the_loader():
    options = ScenarioOptions(
        set_=["column.coulomb_friction = 3 lb", "valve.orifice=true", "feel.breakout=off"], arm=Arm.LOOSE
    )
    found = options.changed(ff.elevator().replace({"feel.breakout": "2 lb"}))
    assert found["column.coulomb_friction"] == pytest.approx(3 * LB, **EXACT)
    assert found["valve.orifice"] == 1
    assert found["feel.breakout"] == 0
    assert [found[f"pilot.arm_{name}"] for name in ("mass", "damping", "stiffness")] == list(ARMS[Arm.LOOSE])
    assert ScenarioOptions(arm=Arm.HANDS_OFF).changed(found).given == ("valve.orifice", "column.coulomb_friction")


@pytest.mark.parametrize("arm", Arm)
def test_arm_values_are_within_parameter_ranges(arm):
    assert all(in_range(TABLE[row], value) for row, value in zip(ARM_ROWS, ARMS[arm], strict=True))
    assert arm_of(ScenarioOptions(arm=arm).changed(ff.elevator())) is arm


def test_laws_are_designed_for_the_changed_loader():
    loader = ff.elevator().replace({"linkage.stiffness": "9000 lb/in"})
    published = ScenarioOptions(law="published").law_of(loader).numbers.gain_law(loader)
    converged = ScenarioOptions(law="converged").law_of(loader).numbers.gain_law(loader)
    assert published == ff.design_gains(loader).law(loader)
    assert converged == ff.design_gains(loader, ff.laws.DesignSettings()).law(loader)
    assert ScenarioOptions(law="original").law_of(loader).numbers.kind == "original"


def test_schedule_options_are_read():
    shaken = ff.elevator().replace({"feel.shaker_force": "10 lb"})
    found = scenario(shaken, trim="0 s: 0 deg, 1 s: 5 deg", shaker="1: 0, 1: 0.5")
    assert found.trim_rad.times_s == (0.0, 1.0)
    assert found.trim_rad.values == pytest.approx((0.0, math.radians(5)), **EXACT)
    assert (found.shaker.times_s, found.shaker.values) == ((1.0, 1.0), (0.0, 0.5))
    assert scenario(shaken, trim="3 deg").trim_rad.values == pytest.approx((math.radians(3),), **EXACT)


def test_feel_with_stiffness_factor_requires_dynamic_pressure():

    loader = replace(ff.elevator(), stiffness_factor=ff.loader.Curve((0.0, 5000.0), (0.5, 1.5)))
    assert scenario(loader, dynamic_pressure="2 kPa").dynamic_pressure_pa.values == (2000.0,)
    with pytest.raises(InputError, match=r"feel.stiffness_factor depends on it; give it"):
        ff.simulate(loader, scenario(loader))


def test_feel_change_options_are_read():
    found = scenario(change=["1 s: feel.stiffness=5000 lb in/rad, feel.damping=200 lb in s/rad"], fade_time="0.25 s")
    assert found.feel_changes == (
        ff.simulation.FeelChange(1.0, {"feel.stiffness": "5000 lb in/rad", "feel.damping": "200 lb in s/rad"}, 0.25),
    )
    assert scenario(change=["1: feel.breakout=off"]).feel_changes == (
        ff.simulation.FeelChange(1.0, {"feel.breakout": None}),
    )


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"duration": "x"}, "--duration: expected a number with its unit"),
        ({"duration": "nan"}, "--duration: .* not finite"),
        ({"duration": "0"}, "duration_s: expected a time above 0"),
        ({"duration": "-1 s"}, "duration_s: expected a time above 0"),
        ({"duration": "2 lb"}, "--duration: .* measures a force, not a time"),
        ({"duration": f"{MOST_STEPS * 1e-3 + 1}"}, "--duration: expected at most 2000000 steps of 0.001 s"),
        ({"step": "1 s"}, "step_s: expected 1e-05 to 0.002 s"),
        ({"sample": "0"}, "sample_s: expected a time above 0"),
        ({"sample": "1.5 ms"}, "--sample: expected a multiple of the engine's step of 0.001 s"),
        ({"sample": "1 us"}, "--sample: expected a multiple"),
        ({"seed": -1}, "seed: expected a whole number from 0 to 9,223,372,036,854,775,807, got -1"),
        ({"force": "20"}, "--force: .* has no unit"),
        ({"force": "20 mA"}, "--force: .* measures a current, not a force"),
        ({"start": "2 s"}, "--start: expected a time before the end of the run at 2 s"),
        ({"input": InputKind.RELEASE}, "--angle: expected with --input release"),
        ({"input": InputKind.RELEASE, "angle": "181 deg"}, "--angle: expected -180 to 180 deg, got 181 deg"),
        ({"input": InputKind.PULSE, "width": "0"}, "Pulse: expected width_s to be a number above 0"),
        (
            {"input": InputKind.STOP_TO_STOP, "input_duration": "0 s"},
            "StopToStop: expected duration_s to be a number above 0",
        ),
        ({"input": InputKind.MULTISINE, "lines": "0.123 Hz"}, "to be a multiple of 1 / duration_s"),
        ({"input": InputKind.MULTISINE, "lines": "1 Hz", "to": "3 Hz"}, "--to: given with --lines"),
        ({"input": InputKind.MULTISINE, "from_": "5 Hz", "to": "4 Hz"}, "--from, --to: expected 1 to 10000 multiples"),
        ({"trim": "5"}, "--trim: .* has no unit"),
        ({"trim": "1 s: 5 deg"}, "--trim: one point holds for all the run"),
        ({"trim": "1 s: 5 deg, 0 s: 3 deg"}, "--trim: time goes back from 1 s to 0 s"),
        ({"trim": "0 s: 5 deg, 3 deg"}, "--trim: expected times and values such as"),
        ({"shaker": "1"}, r"--shaker: the loader has no feel.shaker_force; add --set 'feel.shaker_force=10 lb'"),
        ({"shaker": "1.1"}, "--shaker: expected shares from 0 to 1, got 1.1"),
        ({"sample": "1e308"}, "--sample: expected a multiple of the engine's step of 0.001 s, got 1e\\+308 s"),
        ({"seed": 2**64}, "seed: expected a whole number from 0 to"),
        ({"input": InputKind.MULTISINE, "to": "2e307 Hz", "input_duration": "100"}, "multiples of 0.01 Hz, .* got inf"),
        ({"change": ["1e300 s: feel.breakout=2 lb"]}, "expected changes that are done by 1e\\+06 s, got 1e\\+300 s"),
        ({"change": ["1 s: feel.breakout=2 lb"], "fade_time": "1e300 s"}, "expected changes that are done by"),
        ({"fade_time": "1 s"}, "--fade-time: requires a --change"),
        ({"change": ["feel.stiffness=3 N m/rad"]}, "--change: expected a time, a colon and new values"),
        ({"change": ["1 s: feel.stiffness"]}, "--change: expected a parameter and its value"),
        ({"change": ["1 s: feel.stiffness=off"]}, "--change: feel.stiffness is required in every loader"),
        ({"change": ["1 s: feel.breakout=2 lb", "1.2 s: feel.breakout=off"]}, "do not overlap"),
        ({"change": ["1 s: feel.breakout=2 lb"], "fade_time": "0"}, "expected changes that take time"),
    ],
)
def test_bad_options_are_named(options, said):
    with pytest.raises(InputError, match=said):
        scenario(**options)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"set_": ["column.coulomb_friction=-3 lb"]}, "column.coulomb_friction: expected 0 to 10000 lb"),
        (
            {"set_": ["controller.period=0 ms"]},
            "expected 0.01 to 100 ms, got 0 ms; give None, or off on the command line",
        ),
        ({"set_": ["controller.delay=1 ms"]}, "controller.delay: has no effect without controller.period"),
        ({"set_": ["linkage.stifness=1 N/m"]}, "unknown parameter 'linkage.stifness'; did you mean linkage.stiffness"),
        ({"set_": ["valve.orifice=maybe"]}, "valve.orifice: expected true or false, got 'maybe'"),
        ({"set_": ["linkage.stiffness"]}, "--set: expected a parameter and its value"),
        ({"set_": ["linkage.stiffness="]}, "--set: expected a parameter and its value"),
        ({"set_": ["linkage.stiffness=7 kN/m", "linkage.stiffness=8 kN/m"]}, "--set: linkage.stiffness is given twice"),
        ({"set_": ["feel.stiffness=off"]}, "--set: feel.stiffness is required in every loader"),
        ({"set_": ["column.stop_low=1 deg"]}, "column.stop_low: expected -180 to 0 deg"),
        ({"set_": ["pilot.arm_mass=1 kg"], "arm": Arm.FIRM}, "--arm: sets pilot.arm_mass, and so does --set"),
    ],
)
def test_bad_changes_of_the_loader_are_named(options, said):
    with pytest.raises(InputError, match=said):
        ScenarioOptions(**options).changed(ff.elevator())


def test_unconverged_recursion_raises_input_error(monkeypatch):
    monkeypatch.setattr(compensation, "MOST_STEPS", 10)
    with pytest.raises(InputError, match="--law: the recursion does not give the converged gains"):
        ScenarioOptions(law="converged").law_of(ff.elevator())


def test_option_text_is_read():
    assert seconds("--x", "0.5") == 0.5
    assert seconds("--x", "5 ms") == pytest.approx(0.005, **EXACT)
    assert over_time("--x", "2 deg", "rad", "5 deg")[0] == (0.0,)
    assert assignments("--set", ("a.b = TRUE", "c.d=Off", "e.f=3 lb")) == {"a.b": True, "c.d": None, "e.f": "3 lb"}
