"""Contact in an envelope: which settings swing on, in numbers, sentences and on the page."""

import json
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.contact import touch
from forcefeel.envelope.findings import renders
from forcefeel.loader.loader import FEEL_SETTING

GRID = {"stiffness": "4, 100 %", "frequency": "0.8, 3 Hz", "damping": "0.3, 0.7"}
CLAMP, STOP = ff.envelope.Contact(False, 1e5, 0.5), ff.envelope.Contact(True, 1e6, 0.02)


SETTINGS = ff.envelope.make_plan(ff.digital_elevator(), ["robust"], GRID).settings


@pytest.fixture(scope="module")
def envelope():
    loader = ff.digital_elevator()
    own = [loader[key] for key in FEEL_SETTING]
    alone = ff.Law.of("robust", loader, np.vstack([SETTINGS.feel(loader), own]))
    laws = {"robust": "robust", "alone": alone.without_contact()}
    return ff.find_envelope(loader, laws, GRID, contacts=(CLAMP, STOP), changes={}, arms=())


def test_the_part_for_contact_quiets_every_setting(envelope):
    with_it, without = map(envelope.contact_shares, ("robust", "alone"))
    assert with_it.quiet == 1
    assert without.quiet <= 0.75
    assert without.largest_force_n > 2 * with_it.largest_force_n
    assert renders(envelope)


def test_a_law_that_swings_in_contact_does_not_render_the_envelope(envelope):
    swings = {name: (over, values[1:]) for name, (over, values) in envelope.arrays.arrays.items()}
    plan = ff.envelope.make_plan(
        ff.digital_elevator(), {"alone": envelope.plan.laws["alone"]}, GRID, contacts=(CLAMP, STOP), changes={}, arms=()
    )
    alone = ff.envelope.Envelope(plan, replace(envelope.arrays, arrays=swings), envelope.outcomes, envelope.passivity)
    assert alone.shares("alone").worst_case_share == 1
    assert not renders(alone)


def test_shares_without_contacts_are_refused():
    bare = ff.find_envelope(ff.digital_elevator(), ["robust"], GRID, changes={}, arms=())
    with pytest.raises(ff.InputError, match="contacts: the envelope was made without"):
        bare.contact_shares("robust")


def test_swings_are_those_of_single_runs(envelope):
    """The setting and contact of the largest force, run by itself: the force is still there at the end."""
    data = envelope.data.sel(law="alone")
    forces = data["largest_force_n"].sel(contact=CLAMP.name)
    where = np.unravel_index(int(forces.values.argmax()), forces.shape)
    setting = int(np.ravel_multi_index(where, forces.shape))
    loader, feel = ff.digital_elevator(), SETTINGS.feel(ff.digital_elevator())[setting]
    assert bool(data["swings_on"].sel(contact=CLAMP.name).values[where])
    there = CLAMP.on(loader).replace(dict(zip(FEEL_SETTING, feel.tolist(), strict=True)), si=True)
    force = ff.simulation.inputs.Pulse("13.3 N", start_s=0.05, width_s=0.05)
    run = ff.simulate(there, ff.Scenario(force, duration_s=2.0), ff.Law.of("robust", there).without_contact()).history
    held = 1e5 * loader["column.grip_arm"] * run["column_angle_rad"].to_numpy()
    assert np.ptp(held[-500:]) > 100
    assert np.abs(held).max() == pytest.approx(float(forces.max()), rel=0.2)  # its noise is another


def test_a_column_that_rubs_and_never_comes_to_the_stop_is_in_no_contact():
    """Pushed with less than its friction, it hunts short of the stop, and its load cell shows it: no fault in contact."""
    lag = {f"{sensor}.bandwidth": "500 Hz" for sensor in ("load_cell", "potentiometer", "column_sensor")}
    rubs = dict.fromkeys(("column.coulomb_friction", "column.static_friction"), "2.7 lb")
    loader = ff.digital_elevator().replace(lag | rubs)
    inertia, rate = 0.068 * loader["column.inertia"], 2 * np.pi * 4
    feel = np.array([[inertia, 0.2 * rate * inertia, rate**2 * inertia]])
    touched = touch(loader, ff.Law.of("robust", loader, feel), feel, STOP, None)
    assert touched.largest_force_n == 0
    assert not touched.swings_on.any()


def test_contacts_are_named_on_the_page_and_in_the_results(envelope, tmp_path):
    page = ff.envelope.write_envelope(envelope, tmp_path / "out", ff.UnitSystem.SI)
    text = page.read_text(encoding="utf-8")
    assert "Clamp, damping 0.5" in text
    assert "Stop, damping 0.02" in text
    laws = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["laws"]
    assert laws["robust"]["contact"]["by_contact"] == {
        "clamp 100,000 N/m, damping 0.5": 1.0,
        "stop 1,000,000 N/m, damping 0.02": 1.0,
    }
