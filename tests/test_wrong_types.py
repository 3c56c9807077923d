"""A wrong type is bad input: the message names the argument, in every function and class that most people need."""

import control
import numpy as np
import pytest

import forcefeel as ff

LOADER, SCENARIO, ARRAY = ff.elevator(), ff.Scenario(), np.zeros(3)
SWEEP = "examples/bench/sweep.csv"

CALLS = {
    "path": [lambda: ff.load(5), lambda: ff.load(None), lambda: ff.read_bench_data(5)],
    "name": [lambda: ff.Loader(5, "", LOADER.si_values)],
    "source": [lambda: ff.Loader("a", None, LOADER.si_values)],
    "si_values": [lambda: ff.Loader("a", "", "x"), lambda: ff.Loader("a", "", None)],
    "tolerances": [lambda: ff.Loader("a", "", LOADER.si_values, tolerances=5)],
    "changes": [
        lambda: LOADER.replace([1], si=True),
        lambda: LOADER.replace(None, si=True),
        lambda: LOADER.with_tolerances("a"),
    ],
    "unknown parameter 5": [lambda: LOADER[5], lambda: LOADER.replace({5: 1.0}, si=True)],
    "scale": [lambda: LOADER.scale_feel("a")],
    "units": [lambda: LOADER.to_toml("us"), lambda: LOADER.plot_bode(units="si")],
    "loader": [
        lambda: ff.compliant_model("elevator-1974"),
        lambda: ff.linear.ideal_feel(ff.elevator),
        lambda: ff.linear.design_plant(None),
        lambda: ff.analyze("elevator-1974"),
        lambda: ff.design_loader("elevator-1974"),
        lambda: ff.design_gains("elevator-1974"),
        lambda: ff.Law.of("robust", "elevator-1974"),
        lambda: ff.simulate("elevator-1974", SCENARIO),
        lambda: ff.simulation.simulate_batch("elevator-1974", SCENARIO, LOADER.si_values[np.newaxis]),
        lambda: ff.Sweep("elevator-1974", SCENARIO),
        lambda: ff.qualify_loader("elevator-1974"),
        lambda: ff.find_envelope("elevator-1974"),
        lambda: ff.find_frontier("elevator-1974"),
        lambda: ff.identify("elevator-1974", [], "k"),
    ],
    "model": [lambda: ff.modes(ARRAY), lambda: ff.modes(LOADER), lambda: ff.step_response(LOADER, 1.0)],
    "model: expected a model in continuous": [lambda: ff.modes(control.ss(-1.0, 1.0, 1.0, 0.0, 0.01))],
    "loop: expected one input and one": [lambda: ff.linear.margins(ff.compliant_model(LOADER))],
    "duration_s, samples": [lambda: ff.step_response(ff.compliant_model(LOADER), 1.0, samples=1)],
    "force_n": [lambda: ff.step_response(ff.compliant_model(LOADER), "100 lb")],
    "settings": [lambda: ff.design_gains(LOADER, 0.05), lambda: ff.design_loader(LOADER, "x")],
    "law": [
        lambda: ff.compliant_model(LOADER, "robust"),
        lambda: ff.compliant_model(LOADER, ff.Law.of("published", LOADER)),
        lambda: ff.Law.of(5, LOADER),
        lambda: ff.simulate(LOADER, SCENARIO, 5),
        lambda: ff.simulate(LOADER, SCENARIO, ARRAY),
        lambda: ff.Sweep(LOADER, SCENARIO, law=5),
        lambda: ff.find_frontier(LOADER, 5),
    ],
    "force": [
        lambda: ff.Scenario(ARRAY),
        lambda: ff.Scenario(100.0),
        lambda: ff.Scenario(ff.Step),
        lambda: ff.Scenario(None),
    ],
    "duration_s": [lambda: ff.Scenario(duration_s="2"), lambda: ff.Scenario(duration_s=True)],
    "step_s": [lambda: ff.Scenario(step_s=None)],
    "trim_rad": [lambda: ff.Scenario(trim_rad=ARRAY), lambda: ff.Scenario(trim_rad=0.1)],
    "shaker": [lambda: ff.Scenario(shaker=1.0)],
    "feel_changes": [lambda: ff.Scenario(feel_changes="x"), lambda: ff.Scenario(feel_changes=(1,))],
    "seed": [lambda: ff.Scenario(seed="a"), lambda: ff.Scenario(seed=1.5)],
    "Step: expected force_n": [lambda: ff.Step(["100 lb"]), lambda: ff.Step(None), lambda: ff.Step(ARRAY)],
    "Release: expected angle_rad": [lambda: ff.Release(["5 deg"])],
    "Recorded: expected force_n": [lambda: ff.Recorded(ARRAY, "b")],
    "scenario": [
        lambda: ff.simulate(LOADER, "x"),
        lambda: ff.simulate(LOADER, ff.Step(100.0)),
        lambda: ff.Sweep(LOADER, ff.Step(100.0)),
    ],
    "vary": [lambda: ff.Sweep(LOADER, SCENARIO, vary="linkage.stiffness")],
    "grids": [lambda: ff.Sweep(LOADER, SCENARIO, grids="feel.stiffness")],
    "sweep": [lambda: ff.run_sweep("x")],
    "setup": [lambda: ff.qualify_loader(LOADER, "part60")],
    "laws": [lambda: ff.find_envelope(LOADER, 5), lambda: ff.find_envelope(LOADER, "original")],
    "grid": [lambda: ff.find_envelope(LOADER, ["original"], "x"), lambda: ff.find_frontier(LOADER, None, 5)],
    "data": [lambda: ff.identify(LOADER, "x", "k"), lambda: ff.identify(LOADER, [ARRAY], "k")],
    "fit": [lambda: ff.identify(LOADER, [], 5)],
    "columns": [lambda: ff.read_bench_data(SWEEP, columns=5)],
}


@pytest.mark.parametrize(
    ("argument", "call"),
    [
        pytest.param(argument, call, id=f"{argument}-{k}")
        for argument, calls in CALLS.items()
        for k, call in enumerate(calls)
    ],
)
def test_a_wrong_type_is_named(argument, call):
    with pytest.raises(ff.InputError, match=f"^{argument}[:; ]") as caught:
        call()
    assert len(str(caught.value)) < 4000 if argument.startswith("unknown") else len(str(caught.value)) < 300


def test_refused_value_is_named_by_its_type():
    with pytest.raises(ff.InputError, match=r"got a value of type ndarray$"):
        ff.Scenario(ARRAY)
    with pytest.raises(ff.InputError, match=r"got the class Step itself$"):
        ff.Scenario(ff.Step)
    with pytest.raises(ff.InputError, match=r"got the text 'elevator-1974'$"):
        ff.analyze("elevator-1974")
