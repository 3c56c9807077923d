"""The one law: its time, its settings, its file, and that every consumer takes it in the same place."""

import dataclasses
import json
import pickle

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.identification.linear import LinearModel
from forcefeel.cli.law_option import LAWS
from forcefeel.errors import InputError
from forcefeel.laws.law import NAMED_LAWS, Law, names_for
from forcefeel.laws.made_for import design_rows
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops.sampled_loop import sampled_loops
from forcefeel.qualification.plan.run import QualificationSetup, qualify_loader
from tests.command_line import runs

ANALOG, DIGITAL = ff.elevator(), ff.digital_elevator()
SLOWER = DIGITAL.replace({"controller.period": "1 ms"})
LATER = DIGITAL.replace({"controller.delay": "0.25 ms"})
GRID = {"stiffness": "10, 20 %", "frequency": "1, 2 Hz", "damping": "0.3, 0.7"}
PUSH = ff.Scenario(ff.Step(50.0, 0.0), 0.2)


def settings(loader, *stiffness):
    inertia, damping, _ = (loader[key] for key in FEEL_SETTING)
    return np.array([[inertia, damping, g] for g in stiffness])


def laws():
    """A law of every kind of numbers, with the loader that it is for."""
    feel = settings(DIGITAL, 500.0, 900.0, 1500.0)
    return {
        "original": (Law.of("original", ANALOG), ANALOG),
        "law": (Law.of("published", ANALOG), ANALOG),
        "state feedback": (Law.of("published", DIGITAL, feel), DIGITAL),
        "sampled": (Law.of("robust", DIGITAL), DIGITAL),
        "sampled, many": (Law.of("observer", DIGITAL, feel), DIGITAL),
    }


def test_command_line_lists_the_law_names():
    assert LAWS == NAMED_LAWS


@pytest.mark.parametrize("kind", laws())
def test_law_round_trips_exactly_through_its_file(kind, tmp_path):
    law, loader = laws()[kind]
    law.save(tmp_path / "law.json")
    feel = law.feel if law.feel is not None and len(law.feel) > 1 else None
    back = Law.of(tmp_path / "law.json", loader, feel)
    assert (back.period_s, back.delay_s, back.loader_rows) == (law.period_s, law.delay_s, design_rows(loader))
    assert back.name == f"{law.name} (law.json)"
    for key, given in law.engine(loader).items():
        found = back.engine(loader)[key]
        assert np.array_equal(found, given) if isinstance(given, np.ndarray) else found == given


@pytest.mark.parametrize(("name", "loader"), [("published", ANALOG), ("robust", DIGITAL), ("original", DIGITAL)])
def test_run_under_a_law_file_matches_the_named_law(name, loader, tmp_path):
    Law.of(name, loader).save(tmp_path / "law.json")
    named, read = (ff.simulate(loader, PUSH, law).history for law in (name, tmp_path / "law.json"))
    assert named.equals(read)


def consumers(loader, law):
    """Everything that runs or judges a law, as calls."""
    values = np.tile(loader.si_values, (2, 1))
    experiment = Experiment(Loop.LOADER, Drive.TEST_SIGNAL)
    hz = np.array([1.0, 2.0])
    found = {
        "simulate": lambda: ff.simulate(loader, PUSH, law),
        "simulate_batch": lambda: ff.simulation.simulate_batch(loader, PUSH, values, law),
        "sweep": lambda: ff.Sweep(loader, PUSH, law, runs=2, vary={"linkage.stiffness": "5 %"}).nominal_law,
        "envelope": lambda: ff.find_envelope(loader, {"law": law}, GRID, changes={}, arms=()),
        "qualify": lambda: qualify_loader(loader, QualificationSetup(laws={"law": law})),
        "identify": lambda: ff.bench.model_response(loader, experiment, "test_signal", "column_angle", hz, law=law),
    }
    return found | ({"loops": lambda: sampled_loops(loader, law)} if loader["controller.period"] else {})


TIMES = {
    "2 kHz law at 1 kHz": ("robust", DIGITAL, SLOWER, r"made for a controller\.period of 0\.5 ms, the loader has 1 ms"),
    "another delay": ("robust", DIGITAL, LATER, r"made for a controller\.delay of 0\.5 ms, the loader has 0\.25 ms"),
    "sampled law, analog loader": ("robust", DIGITAL, ANALOG, r"made for a controller\.period of 0\.5 ms"),
    "analog law, digital loader": ("published", ANALOG, DIGITAL, "published is an analog law"),
}


@pytest.mark.parametrize("times", TIMES)
def test_law_of_another_period_is_refused_with_the_same_message(times):
    name, made_for, used_on, message = TIMES[times]
    law = Law.of(name, made_for)
    for what, call in consumers(used_on, law).items():
        with pytest.raises(InputError, match=message) as refused:
            call()
        assert str(refused.value).endswith("design it for this loader"), what


def test_law_for_a_digital_loader_has_its_period():
    for name in names_for(DIGITAL):
        law = Law.of(name, DIGITAL)
        assert (law.period_s, law.delay_s) == (0.5e-3, 0.5e-3)
    assert Law.of("published", ANALOG).period_s is None


def test_laws_are_selected_by_setting():
    feel = settings(DIGITAL, 500.0, 900.0, 1500.0)
    law = Law.of("robust", DIGITAL, feel)
    turned = law.at(feel[[2, 0]])
    assert np.array_equal(turned.sampled.command, law.sampled.command[[2, 0]])
    assert np.array_equal(turned.feel, feel[[2, 0]])
    with pytest.raises(InputError, match=r"laws for 3 settings of the feel, none for I, B, G = .*, 700 \(SI units\)"):
        law.at(settings(DIGITAL, 900.0, 700.0))


def test_setting_independent_law_is_returned_unchanged():
    law = Law.of(ff.laws.GainLaw.original(ANALOG.si_values), ANALOG)
    assert law.at(settings(ANALOG, 500.0, 900.0)) is law


def test_loader_fingerprint_depends_on_its_numbers_only():
    assert ff.elevator().fingerprint == ANALOG.fingerprint
    assert ANALOG.replace({"linkage.stiffness": "7000 lb/in"}).fingerprint != ANALOG.fingerprint
    assert DIGITAL.fingerprint != ANALOG.fingerprint


def damaged():
    """What may be wrong with a file, and what is said of it."""
    return {
        "not JSON": (lambda _: "gains", "expected the file of a law: JSON"),
        "a list": (lambda _: "[]", "expected a JSON object"),
        "empty": (lambda _: "{}", "format: missing"),
        "another format": (lambda law: law | {"format": 1}, "format: expected 4, got 1"),
        "no kind": (
            lambda law: law | {"kind": "magic"},
            "kind: expected original, state feedback, compensator, sampled",
        ),
        "no time": (lambda law: law | {"time": None}, "time: expected period and delay"),
        "negative period": (
            lambda law: law | {"time": {"period": -1, "delay": 0}},
            "period: expected a number above 0",
        ),
        "endless period": (
            lambda law: law | {"time": {"period": float("inf"), "delay": 0}},
            "period: expected a finite number",
        ),
        "ragged": (
            lambda law: law | {"command": [[1.0], [1.0, 2.0]]},
            "command: expected numbers in rows of one length",
        ),
        "flat": (lambda law: law | {"command": [1.0]}, "command: expected finite numbers in 2 dimensions"),
        "text": (lambda law: law | {"transition": "A"}, "transition: expected list, got"),
        "too few": (lambda law: law | {"command": [[1.0]]}, "command: expected the shape"),
        "settings": (
            lambda law: law | {"settings": {"inertia, damping, stiffness": [[1.0, 2.0]]}},
            "settings: expected I, B, G",
        ),
        "name": (lambda law: law | {"law": 7}, "law: expected str, got 7"),
    }


@pytest.mark.parametrize("what", damaged())
def test_damaged_law_file_raises_input_error(what, tmp_path):
    path = tmp_path / "law.json"
    Law.of("robust", DIGITAL).save(path)
    change, message = damaged()[what]
    changed = change(json.loads(path.read_text()))
    path.write_text(changed if isinstance(changed, str) else json.dumps(changed))
    with pytest.raises(InputError, match=message) as refused:
        Law.of(path, DIGITAL)
    assert "law.json: " in str(refused.value)


def test_invalid_law_raises_input_error():
    with pytest.raises(InputError, match="expected original, published, converged"):
        Law.of("best", DIGITAL)
    with pytest.raises(InputError, match="expected a law, its name, its file, its design or its numbers, got 7"):
        Law.of(7, DIGITAL)
    with pytest.raises(InputError, match="cannot be read"):
        Law.of("nowhere.json", DIGITAL)


# On the command line.

AXES = [part for axis, values in GRID.items() for part in ("--grid", f"{axis}={values}")]


run = runs()


@pytest.mark.slow
def test_saved_law_replaces_a_law_name(run, tmp_path):
    status, out, _ = run("law", "elevator-2khz", "--law", "robust", "--save-law", "law.json")
    assert (status, "law file: law.json" in out) == (0, True)
    by_name, by_file = (run("simulate", "elevator-2khz", "--law", law)[1] for law in ("robust", "law.json"))
    assert by_name == by_file
    said = run("qualify", "elevator-2khz", "--law", "law.json", "--test", "release-25-positive")[1]
    assert "law of law.json" in " ".join(said.split())
    saved = (tmp_path / "law.json").read_text(encoding="utf-8")
    for method in ([], ["--law", "observer", "--out", "other"]):
        status, _, err = run("law", "elevator-2khz", *method, "--save-law", "law.json")
        assert (status, "law.json: is there already; give another name, or --replace" in err) == (2, True)
    assert (tmp_path / "law.json").read_text(encoding="utf-8") == saved
    assert not (tmp_path / "other").exists()
    assert run("law", "elevator-1974", "--save-law", "law.json", "--replace")[0] == 0
    assert (tmp_path / "law.json").read_text(encoding="utf-8") != saved
    assert run("law", "elevator-1974", "--save-law", "gains.json")[0] == 0
    status, _, err = run("simulate", "elevator-2khz", "--law", "gains.json")
    assert status == 2
    assert "is an analog law" in err


def test_envelope_laws_are_saved_with_their_settings(run):
    assert run("law", "elevator-1974", "--law", "published", "--envelope", *AXES, "--save-law", "law.json")[0] == 0
    common = ("--draws", "0", *AXES, "--json", "--replace")
    by_name, by_file = (
        json.loads(run("envelope", "elevator-1974", "--law", law, *common)[1]) for law in ("published", "law.json")
    )
    named, read = (
        {**found["laws"][law]["shares"], "law": ""} for law, found in (("published", by_name), ("law.json", by_file))
    )
    assert named == read
    status, _, err = run(
        "envelope", "elevator-1974", "--law", "law.json", "--grid", "stiffness=10, 30 %", *AXES[2:], "--replace"
    )
    assert status == 2
    assert "has laws for 9 settings of the feel, none for I, B, G" in err


def test_invalid_law_file_names_are_refused(run, tmp_path):
    for command in (["simulate"], ["qualify"], ["identify", "--data", "x.csv", "--fit", "k"]):
        status, _, err = run(*command, "--law", "best")
        assert status == 2
        assert "or a law file" in err
    status, _, err = run("law", "elevator-1974", "--save-law", "law.txt")
    assert (status, "whose name ends with .json" in err) == (2, True)
    status, _, err = run("law", "elevator-1974", "--save-law", "none/law.json")
    assert (status, "expected a file in a folder that is there" in err) == (2, True)
    status, _, err = run("frontier", "elevator-1974", "--law", "law.json")
    assert (status, "expected the name of a design" in err) == (2, True)


def test_law_is_designed_once_per_sweep_and_model():
    """Not for each piece or evaluation: a design takes a second, and its file may lie on another machine."""
    calls = []
    experiment = Experiment(Loop.LOADER, Drive.TEST_SIGNAL)
    robust = LAW_DESIGNS["robust"]
    counted = dataclasses.replace(robust, design=lambda *given: calls.append(1) or robust.design(*given))
    sweep = ff.Sweep(DIGITAL, PUSH, counted, runs=4, vary={"linkage.stiffness": "5 %"})
    pieces = [sweep.law_of(sweep.values(range(first, first + 2))) for first in (0, 2)]
    assert (len(calls), pieces[0] is pieces[1]) == (1, True)
    model = LinearModel(DIGITAL, experiment.loop, counted)
    for stiffness in ("6000 lb/in", "7000 lb/in"):
        model.responses(DIGITAL.replace({"linkage.stiffness": stiffness}, si=True).si_values, (), np.array([1.0]))
    assert len(calls) == 2


def test_pickled_sweep_contains_its_law(tmp_path):
    path = tmp_path / "law.json"
    Law.of("robust", DIGITAL).save(path)
    sweep = ff.Sweep(DIGITAL, PUSH, path, runs=4, vary={"linkage.stiffness": "5 %"})
    sent = pickle.dumps(sweep)
    path.unlink()
    values = sweep.values(range(2))
    there, here = (one.law_of(values).engine(DIGITAL)["observers"] for one in (pickle.loads(sent), sweep))
    assert np.array_equal(there, here)
