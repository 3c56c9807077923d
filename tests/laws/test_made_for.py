"""Whom a law was made for: known by what its design depends on, said on another loader, refused on another drive."""

import json

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.laws.made_for import design_rows, differing
from forcefeel.laws.sampled.sampled_law import NUMBERS
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import TABLE, has
from tests.command_line import runs
from tests.parametrization import mostly_slow

DIGITAL = ff.digital_elevator().replace({"column.coulomb_friction": "2 lb"})
INPUT_IS_BAD = 2
STICK = ff.loader.electric("sidestick-pitch")
OTHER = "linkage.stiffness"


def another(loader, key):
    """The loader with another value of a row; nothing where the row cannot stand by itself."""
    value, row = loader[key], TABLE[key]
    for change in (1.03 * value, 0.97 * value) if np.isfinite(value) and value else (row.default_si, 1.0):
        try:
            return loader.replace({key: change}, si=True)
        except InputError:
            continue
    return None


def numbers(name, loader):
    law = Law.of(name, loader)
    return [getattr(law.numbers, one) for one in NUMBERS], law.cancellation


@pytest.mark.parametrize(
    ("loader", "name"), mostly_slow([(DIGITAL, "robust"), (STICK, "robust"), (STICK, "torque-mode")])
)
def test_rows_not_stored_in_a_law_do_not_affect_the_design(loader, name):
    """Row by row: where the rows stay, so do the law's numbers. The exception is an arm's mass, which no loader of its own has."""
    designed, cancelled = numbers(name, loader)
    known, left_out = design_rows(loader), 0
    for key in TABLE:
        if not has(loader.drive, TABLE[key]) or key in {*FEEL_SETTING, "pilot.arm_mass"}:
            continue
        changed = another(loader, key)
        if changed is None or differing(known, changed):
            continue
        left_out += 1
        found, also = numbers(name, changed)
        assert all(map(np.array_equal, found, designed)), key
        assert also == cancelled, key
    assert left_out > 40


def test_loader_comparison_ignores_units_and_name(tmp_path):
    known = design_rows(DIGITAL)
    for units in ff.UnitSystem:
        path = tmp_path / f"called-{units.value}.toml"
        path.write_text(DIGITAL.to_toml(units), encoding="utf-8")
        assert not differing(known, ff.load(path))
    for key in (OTHER, "column.inertia", "valve.rated_flow", "column.coulomb_friction"):
        assert differing(known, another(DIGITAL, key)) == (key,)


command_line = runs(report=True)


@pytest.fixture
def run(command_line, tmp_path):
    Law.of("robust", ff.digital_elevator()).save(tmp_path / "law.json")
    other = ff.digital_elevator().replace({OTHER: "7000 lb/in"})
    (tmp_path / "other.toml").write_text(other.to_toml(ff.UnitSystem.US), encoding="utf-8")
    return command_line


COMMANDS = {
    "simulate": ("simulate", "--duration", "0.2"),
    "sweep": ("sweep", "--runs", "4", "--vary", "column.inertia=5 %", "--duration", "0.2"),
    "qualify": ("qualify", "--test", "static"),
    "excite": ("excite", "--fit", "k", "--experiment", "loader", "--time", "2", "--rate", "200"),
    "run": ("run", "--headless", "--duration", "0.1"),
}


@pytest.mark.parametrize("what", mostly_slow(COMMANDS))
def test_law_on_another_loader_is_reported_in_one_line_and_json(run, what):
    command, *words = COMMANDS[what]
    said = "was made for elevator-2khz, and runs here on elevator-2khz with other values of linkage.stiffness:"
    replace = () if what == "run" else ("--replace",)
    for loader, times in (("other.toml", 1), ("elevator-2khz", 0))[: 2 if what == "simulate" else 1]:
        status, out, err = run(command, loader, *words, *replace, "--law", "law.json", "--json")
        assert (status == INPUT_IS_BAD, out.count(said)) == (False, times), err
    out = " ".join(run(command, "other.toml", *words, *replace, "--law", "law.json")[1].split())
    assert out.count(said) == 1


@pytest.mark.parametrize("laws", ["file", "name"])
def test_envelope_reports_mismatch_of_a_law_file_only(laws, tmp_path):
    grid = {"stiffness": "50, 100 %", "frequency": "1, 2 Hz", "damping": "0.3, 0.7"}
    made_for = ff.digital_elevator()
    feel = np.vstack([own_feel(made_for), Settings.of(grid).feel(made_for)])
    Law.of("robust", made_for, feel).save(tmp_path / "law.json")
    # A feel of friction is left out of an envelope; it makes no other loader of it.
    loader = made_for.replace({OTHER: "7000 lb/in", "feel.coulomb_friction": "1 lb"})
    given = {"law": tmp_path / "law.json"} if laws == "file" else ["robust"]
    found = ff.find_envelope(loader, given, grid, changes={}, arms=())
    said = [one for one in envelope_conclusions(found, ff.UnitSystem.SI).findings if "was made for" in one]
    assert len(said) == (laws == "file")


def saved(path, loader=DIGITAL, name="robust"):
    Law.of(name, loader).save(path)
    return json.loads(path.read_text(encoding="utf-8"))


UNITS = {
    "time": ({"time": {"unit": "ms"}}, r"time\.unit: expected 's', in which the numbers are taken, got 'ms'"),
    "settings": (
        {"settings": {"units": ["kg ft", "N m s/rad", "N m/rad"]}},
        r"settings\.units: expected 'N m s\^2/rad, .*', in which the numbers are taken, got 'kg ft, ",
    ),
    "numbers": ({"units": {"transition": "in"}}, r"units\.transition: expected 'xi on xi', .* got 'in'"),
    "one more": ({"units": {"gain": "dB"}}, r"units\.gain: expected 'nothing', .* got 'dB'"),
    "drive": ({"made_for": {"drive": "steam"}}, r"made_for\.drive: expected hydraulic, electric.*, got 'steam'"),
    "key": ({"scale": 2.0}, r"scale: expected .*got this key with 2\.0; remove it"),
    "key of time": ({"time": {"jitter": 1}}, r"time\.jitter: expected delay, period, unit, got this key with 1"),
}


@pytest.mark.parametrize("what", UNITS)
def test_unknown_units_and_keys_in_a_file_are_refused(what, tmp_path):
    change, message = UNITS[what]
    document = saved(tmp_path / "law.json")
    for key, value in change.items():
        document[key] = {**document[key], **value} if isinstance(value, dict) else value
    (tmp_path / "law.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError, match=message) as refused:
        Law.of(tmp_path / "law.json", DIGITAL)
    assert "--save-law" in str(refused.value) or what == "drive"


@pytest.mark.parametrize("part", ["time", "settings", None])
def test_numbers_without_units_are_refused(part, tmp_path):
    document = saved(tmp_path / "law.json")
    of = document if part is None else document[part]
    del of[{"time": "unit", "settings": "units", None: "units"}[part]]
    (tmp_path / "law.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError, match=r"units?: missing; save the law anew"):
        Law.of(tmp_path / "law.json", DIGITAL)


def test_motor_law_has_the_quantities_of_the_motor(tmp_path):
    units = saved(tmp_path / "motor.json", STICK)["units"]
    assert units["input"][-1] == "current of the motor in A"
    assert units["command"][0] == "A on"
    assert "rotor angle times transmission.travel, in m" in units["command"]
    assert units["neutral"][0] == "A per rad of the feel's neutral"
    assert not {"V", "piston"} & set(" ".join(map(str, units.values())).replace("'", " ").split())
    of_valve = saved(tmp_path / "valve.json")["units"]
    assert (of_valve["command"][0], of_valve["input"][-1]) == ("V on", "command in V at the valve's amplifier")


def test_law_of_another_drive_is_refused_despite_equal_period(tmp_path):
    saved(tmp_path / "motor.json", STICK)
    valve = DIGITAL.replace(
        {"controller.period": STICK["controller.period"], "controller.delay": STICK["controller.delay"]}, si=True
    )
    with pytest.raises(InputError, match="is a law for a motor, and elevator-2khz has a valve"):
        Law.of(tmp_path / "motor.json", valve)
