"""A live feel beyond the drive: softened at the start, when it is changed, and where a simulator asks for more."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.softening import largest_share
from forcefeel.laws.law import Law
from forcefeel.live import live_session
from forcefeel.live.rendered import rendered_feels, within_drive

STICK = ff.loader.electric("sidestick-pitch")
OWN = STICK["feel.stiffness"]


def test_feel_is_softened_at_the_start_and_at_each_change():
    stiff = STICK.replace({"feel.stiffness": 2 * OWN}, si=True)
    with ff.live.start(stiff, real_time=False, soften=True) as running:
        most = running.feel["feel.stiffness"]
        assert running.softened.reason == "the motor's torque"
        assert running.softened.requested_n_m_per_rad == 2 * OWN
        assert OWN < most < 2 * OWN
        running.feel = {"feel.stiffness": OWN}
        assert running.softened.sentence(ff.UnitSystem.US) == ""
        assert running.feel["feel.stiffness"] == OWN
        running.feel = {"feel.stiffness": 1.9 * OWN}
        assert running.softened.requested_n_m_per_rad == pytest.approx(1.9 * OWN)
        assert running.feel["feel.stiffness"] == pytest.approx(most, rel=0.01)  # two bisections of 0.3 %


@pytest.mark.slow
def test_refused_change_leaves_what_is_stated_of_the_feel(monkeypatch):
    def refuse(*_):
        raise ff.InputError("law: none for this feel")

    with ff.live.start(STICK.replace({"feel.stiffness": 2 * OWN}, si=True), real_time=False, soften=True) as running:
        monkeypatch.setattr(live_session.Law, "of", refuse)
        with pytest.raises(ff.InputError, match="none for this feel"):
            running.feel = {"feel.stiffness": 1.9 * OWN}
        assert running.softened.requested_n_m_per_rad == 2 * OWN


def test_feel_stays_as_programmed_without_the_option():
    with ff.live.start(STICK.replace({"feel.stiffness": 2 * OWN}, si=True), real_time=False) as running:
        assert running.softened is None
        assert running.feel["feel.stiffness"] == 2 * OWN


def test_springs_of_a_host_end_where_the_drive_does():
    rendered = rendered_feels(STICK, Law.of("robust", STICK))
    within = within_drive(rendered, STICK)
    most = OWN * largest_share(STICK, rendered[-1, 0] / OWN)
    assert OWN < within[-1, 0] == most < rendered[-1, 0]
    assert (np.diff(within[:, 0]) > 0).all()
    np.testing.assert_array_equal(within[:-1], rendered[: len(within) - 1])
