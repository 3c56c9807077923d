"""The loader file's tolerances size the cases of every command that has cases, and what is assumed is called so."""

import json
from dataclasses import replace
from math import isclose

import numpy as np
import pytest
from scipy.stats import truncnorm

import forcefeel as ff
from forcefeel.envelope.deviations import Deviation, Origin, chosen_deviations, deviations_of, uncounted
from forcefeel.envelope.machines import feel_json, full_rows
from forcefeel.envelope.plan import make_plan
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.parameters import INDEX
from forcefeel.loader.tolerances import Distribution, Tolerance
from tests.command_line import runner
from tests.parametrization import mostly_slow

ROUNDING = 1e-12  # relative, of a share that is added to a value
THREE_DIGITS = 5e-4  # 95.4 % in the documentation; it is 95.44997 %
A_CHANGE = 1e-3  # relative, more than any rounding of a gain: a third of the stiffness more moves one by 0.4
INERTIA = "column.inertia"
GRID = {"stiffness": "1..100 %:6:log", "frequency": "0.5..4 Hz:4:log", "damping": "0.1, 0.4, 1.5"}
SMALL = ("--grid", "stiffness=3, 100 %", "--grid", "frequency=2, 4 Hz", "--grid", "damping=0.2, 1.5")
KNOTS = "pressure (psi),stiffness (lb in/rad),frequency (Hz),damping ratio\n50,2880,1,0.6\n200,11520,1.5,0.6\n"


def stating(loader, **tolerances):
    """The loader with a tolerance for the inertia, as a file states it."""
    return loader.with_tolerances({INERTIA: tolerances.pop("inertia"), **tolerances})


@pytest.mark.slow
def test_tighter_file_tolerance_loses_fewer_settings(tmp_path):
    file, lost = tmp_path / "mine.toml", []
    for share in ("1 %", "20 %"):
        file.write_text(stating(ff.elevator(), inertia=share).to_toml(), encoding="utf-8")
        rows = ff.find_envelope(ff.load(file), ("converged",), GRID, arms=()).case_shares("converged")
        lost.append(sum(row.lost for row in rows if row.case.startswith(INERTIA)))
    assert lost[0] < lost[1]


@pytest.mark.parametrize(
    ("stated", "low", "high"),
    [
        ("1 %", 0.99, 1.01),
        ({"uniform": ["-10 %", "20 %"]}, 0.9, 1.2),
        ({"uniform": ["38 lb in s^2/rad", "40 lb in s^2/rad"]}, 38 / 37.4, 40 / 37.4),
        ({"triangular": ["-5 %", "1 %", "10 %"]}, 0.95, 1.1),
        ({"normal": "2 %", "low": "-9 %", "high": "9 %"}, 0.96, 1.04),  # two standard deviations
        ({"normal": "2 %", "mean": "1 %", "low": "-9 %", "high": "3.5 %"}, 0.97, 1.035),  # cut off above
    ],
)
def test_cases_are_at_the_ends_of_the_stated_tolerance(stated, low, high):
    plan = make_plan(stating(ff.elevator(), inertia=stated), ("original",), GRID)
    cases = [case for case in plan.cases if case.parameter == INERTIA]
    feel = plan.settings.feel(plan.loader)[:1]
    built = [full_rows(plan.loader, case, feel, Law("original"))[0, INDEX[INERTIA]] for case in cases]
    nominal = ff.elevator()[INERTIA]
    assert built == pytest.approx([low * nominal, high * nominal], rel=ROUNDING)


def test_normal_tolerance_ends_at_two_standard_deviations():
    ends = Tolerance(Distribution.NORMAL, -10.0, 10.0, peak=0.0, deviation=1.0).ends
    assert ends == (-2.0, 2.0)
    assert truncnorm.cdf(ends[1], -10, 10) - truncnorm.cdf(ends[0], -10, 10) == pytest.approx(0.954, abs=THREE_DIGITS)


def test_missing_tolerance_uses_the_marked_default():
    bare = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    for loader in (bare, ff.elevator(), ff.elevator().replace({INERTIA: "40 lb in s^2/rad"})):
        found = deviations_of(loader)
        lengths = {"linkage.ratio", "column.base_arm", "column.grip_arm"}
        shares = dict.fromkeys(lengths, 0.01) | {"valve.current_gain": 0.3}
        for key, one in found.items():
            assert one.origin is (Origin.RULER if key in lengths else Origin.ASSUMED)
            assert one.size == pytest.approx(shares.get(key, 0.2))
    known = deviations_of(stating(ff.elevator(), inertia="1 %"))
    assert {key for key, one in known.items() if one.origin is Origin.FILE} == {INERTIA}


def test_friction_and_cogging_are_among_the_cases_of_a_motor_that_has_them():
    motor = ff.loader.electric("desktop-yoke")
    rubs = {"column.coulomb_friction": 1.0, "motor.coulomb_friction": 0.1, "motor.cogging_torque": 0.2}
    assert not {case.parameter for case in make_plan(motor, ("robust",), GRID).cases} & {*rubs}
    changes = {case.parameter: case.change for case in make_plan(motor.replace(rubs, si=True), ("robust",), GRID).cases}
    assert {key: changes[key] for key in rubs} == pytest.approx(dict.fromkeys(rubs, 0.2))
    assert changes["transmission.travel"] == pytest.approx(0.01)


def test_identified_tolerance_is_used_and_others_are_assumed():
    loader = ff.elevator()
    value, deviation = 1.07 * loader["linkage.stiffness"], 1.4e-5 * loader["linkage.stiffness"]
    fitted = Tolerance(
        Distribution.NORMAL, value - 3 * deviation, value + 3 * deviation, value, deviation, nominal=value
    )
    found = loader.with_tolerances({"linkage.stiffness": None}).replace({"linkage.stiffness": value}, si=True)
    found = replace(
        found.with_tolerances({"linkage.stiffness": fitted}), source=f"{loader.source}; k identified from a"
    )
    deviations = deviations_of(found)
    assert {key for key, one in deviations.items() if one.origin is Origin.FILE} == {"linkage.stiffness"}
    assert deviations["linkage.stiffness"].size == pytest.approx(2 * deviation / value)
    cases = [case.name for case in make_plan(found, ("original",), GRID).cases]
    assert "linkage.stiffness +0.002617 %" in cases  # 2 * 1.4e-5 / 1.07


def test_tolerances_outside_the_plant_are_named():
    digital = ff.digital_elevator().replace({"column.coulomb_friction": "2 lb"})
    loader = digital.with_tolerances({"column.coulomb_friction": {"uniform": ["1 lb", "4 lb"]}})
    assert deviations_of(loader)["column.coulomb_friction"].ends == pytest.approx((-0.5, 1.0))
    assert uncounted(loader) == uncounted(ff.elevator()) == ("load_cell.gain", "potentiometer.gain")
    assert "valve.rated_flow" in deviations_of(loader)
    assert "valve.rated_flow" not in deviations_of(ff.elevator())  # the flow follows the gains


def test_feel_row_with_tolerance_is_still_omitted():
    loader = ff.elevator().replace({"feel.breakout": "4 lb"}).with_tolerances({"feel.breakout": "20 %"})
    assert feel_json(loader)[0]["feel.breakout"] == 0


def test_deviations_shrink_about_the_nominal_value():
    skewed = Deviation(Tolerance(Distribution.NORMAL, -0.1, 0.3, peak=0.1, deviation=0.05), Origin.FILE)
    assert skewed.ends == pytest.approx((0.0, 0.2))
    assert skewed.scaled(0.5).ends == pytest.approx((0.0, 0.1))
    assert (skewed.size, skewed.lean) == pytest.approx((0.1, 1.0))
    assert Deviation.within(0.2).lean == 0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({INERTIA: 0.0}, "above 0 and below 1"),
        ({INERTIA: True}, "above 0 and below 1"),
        ({"column.inertja": 0.1}, "did you mean"),
        ({"valve.orifice": 0.1}, "parameters of the plant"),
        ({"controller.delay": 0.1}, "feel and pilot are not part of the plant"),
        ({"column.coulomb_friction": 0.1}, "off or zero"),
    ],
)
def test_parameter_without_deviation_is_named(changes, message):
    with pytest.raises(InputError, match=message):
        chosen_deviations(ff.elevator(), changes)


def test_tolerance_out_of_range_raises_input_error():
    loader = ff.elevator().with_tolerances({"linkage.ratio": "20 %"}).replace({"linkage.ratio": 0.95}, si=True)
    with pytest.raises(InputError, match=r"tolerances\.linkage\.ratio: out of range"):
        make_plan(loader, ("original",), GRID)


COMMANDS = {
    "envelope": (("mine.toml", "--law", "original", *SMALL, "--draws", "2"), 0),
    "frontier": (("mine.toml", "--law", "original", *SMALL), 0),
    "schedule": (("mine-2khz.toml", "--knots", "knots.csv", "--refine", "2"), 0),
    "law": (("mine.toml", "--law", "original", "--envelope", *SMALL), 0),
}


@pytest.mark.parametrize("command", mostly_slow(COMMANDS))
def test_every_command_with_cases_uses_tolerances_and_deviation_options(command, forcefeel, monkeypatch, tmp_path):
    monkeypatch.setattr("forcefeel.frontier.run.ERRORS", (0.02,))
    for name, loader in (("mine", ff.elevator()), ("mine-2khz", ff.digital_elevator())):
        (tmp_path / f"{name}.toml").write_text(stating(loader, inertia="1 %").to_toml(), encoding="utf-8")
    (tmp_path / "knots.csv").write_text(KNOTS)
    words, wanted = COMMANDS[command]
    options = (
        "--deviation",
        "linkage.ratio=3 %",
        "--deviation",
        "column.grip_arm=none",
        "--set",
        "linkage.stiffness=7000 lb/in",
    )
    status, out, err = forcefeel(command, *words, *options)
    assert (status, err) == (wanted, "")
    said = " ".join(out.split())
    assert f"Tolerances by the loader file: ±1 % of {INERTIA}." in said
    assert "Tolerances by option: ±3 % of linkage.ratio." in said
    assert "Tolerances assumed, not measured: ±20 % of amplifier.admittance" in said
    folder = tmp_path / f"forcefeel-{command}"
    (page,) = folder.glob("*.html")
    assert "Tolerances assumed, not measured" in page.read_text(encoding="utf-8")
    stored = json.loads((folder / "results.json").read_text(encoding="utf-8"))["tolerances"]
    by_key = {one["parameter"]: one for one in stored}
    assert by_key[INERTIA]["origin"] == "loader file"
    assert isclose(by_key["linkage.ratio"]["ends"][1]["value"], 3)
    assert "column.grip_arm" not in by_key
    assert forcefeel(command, *words, "--deviation", "column.mass=none")[0] == 2
    assert forcefeel(command, *words, "--set", "column.mass=3")[0] == 2


def test_law_from_equations_accepts_set(monkeypatch, capsys, tmp_path):
    run = runner(monkeypatch, capsys, tmp_path, "law", report=True)
    found = [json.loads(run("--json", *words)[1]) for words in ((), ("--set", "linkage.stiffness=9000 lb/in"))]
    gains = [[one["value"] for one in each["compensation"]["gains"]] for each in found]
    assert not np.allclose(*gains, rtol=A_CHANGE)
    status, _, err = run("--deviation", f"{INERTIA}=2 %")
    assert (status, "--deviation: does not go with --law report" in err) == (2, True)
