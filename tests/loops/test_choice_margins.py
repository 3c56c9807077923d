"""Margins of a loop at its command: by its frequency response, and by the poles of the loop that has them."""

import numpy as np
import pytest
from scipy.linalg import expm

import forcefeel as ff
from forcefeel.laws.law import Law, named
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops.command_loop import CommandLoop, command_loops
from forcefeel.loops.margins import loop_margins, minimum_margins

DIGITAL = ff.digital_elevator()
G_MAX = DIGITAL["feel.maximum_stiffness"]


def _feel(share, hertz, damping):
    stiffness = share * G_MAX
    inertia = stiffness / (2 * np.pi * hertz) ** 2
    return [inertia, 2 * damping * 2 * np.pi * hertz * inertia, stiffness]


SETTINGS = np.array(
    [[DIGITAL[key] for key in FEEL_SETTING], _feel(0.01, 0.5, 0.1), _feel(0.01, 4, 0.1), _feel(1, 4, 1.5)]
)
METHODS = ("load-cell", "observer", "recovered", "h-infinity", "robust")


@pytest.fixture(scope="module", params=METHODS)
def loops(request):
    law = named((request.param,), DIGITAL)[request.param]
    return command_loops(DIGITAL, Law.of(law, DIGITAL, SETTINGS), SETTINGS)


def _radius(loop, gain):
    """Largest pole with so many times the gain: M + (g - 1) b c."""
    return np.abs(np.linalg.eigvals(loop.matrix + (gain - 1) * np.outer(loop.by_command, loop.command))).max()


ROUNDING = 1e-12
"""Relative, and of the largest number: a product or two; the logarithm of a pole that is 0.01 from one. Measured: 1e-14."""
ON_THE_EDGE = 1e-6
"""Share of the gain to either side of the edge; poles move by some 1e-7 for it."""


def test_poles_at_gain_margin_lie_on_unit_circle(loops):
    for loop in loops:
        found = loop_margins(loop)
        assert loop.stable
        within = np.geomspace(max(found.gain_down, 1e-2), min(found.gain_up, 1e2), 200)[1:-1]
        assert all(_radius(loop, gain) < 1 for gain in within)
        assert np.isfinite(found.gain_up)
        assert _radius(loop, found.gain_up * (1 - ON_THE_EDGE)) < 1 < _radius(loop, found.gain_up * (1 + ON_THE_EDGE))
        if found.gain_down > 0:
            assert (
                _radius(loop, found.gain_down * (1 + ON_THE_EDGE))
                < 1
                < _radius(loop, found.gain_down * (1 - ON_THE_EDGE))
            )


def _turned(loop, lag_rad):
    """Largest pole with a phase on the command, ``e^(-j phi)``: the loop's own complex characteristic equation."""
    factor = np.exp(-1j * lag_rad)
    return np.abs(np.linalg.eigvals(loop.matrix + (factor - 1) * np.outer(loop.by_command, loop.command))).max()


def test_command_loop_is_stable_within_phase_margin(loops):
    for loop in loops:
        margin = loop_margins(loop).phase_rad
        within = np.linspace(-margin, margin, 101)[1:-1]
        assert all(_turned(loop, lag) < 1 for lag in within)
        beyond = [_turned(loop, sign * margin * (1 + 1e-5)) for sign in (-1, 1)]  # farther than the edge is known to
        assert max(beyond) > 1


def test_delay_margin_matches_added_whole_periods():
    """A loader whose controller is slower by whole periods, under the same gains."""
    loader = DIGITAL.replace({"controller.delay": None})
    gains = Law.of(named(("published",), loader)["published"], loader, SETTINGS[:1]).numbers.gain_law(loader)
    periods = loop_margins(_gains_loop(loader, gains, 0)).delay_s / loader["controller.period"]
    assert 1 < periods < 7
    stable = [_gains_loop(loader, gains, more).stable for more in (int(periods), int(periods) + 1)]
    assert stable == [True, False]


def _gains_loop(loader, gains, periods):
    late = loader.replace({"controller.delay": f"{0.5 * periods} ms"} if periods else {})
    return command_loops(late, Law.of(gains, late), SETTINGS[:1])[0]


def test_disk_margin_covers_gain_and_phase_together(loops):
    """Of Seiler, Packard and Gahinet: gains from (2 - a) / (2 + a) up, and the angle 2 atan(a / 2), are within it."""
    for loop in loops:
        found = loop_margins(loop)
        low, high = (2 - found.disk) / (2 + found.disk), (2 + found.disk) / (2 - found.disk)
        assert found.gain_down <= low < high <= found.gain_up
        assert found.phase_rad >= 2 * np.arctan(found.disk / 2) * (1 - 1e-3)  # frequencies are some 1 % apart
        for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False):
            delta = 0.999 * found.disk / 2 * np.exp(1j * angle)
            factor = (1 + delta) / (1 - delta)
            matrix = loop.matrix + (factor - 1) * np.outer(loop.by_command, loop.command)
            assert np.abs(np.linalg.eigvals(matrix)).max() < 1


def test_analog_command_loop_matches_model():
    loader = ff.elevator()
    law = Law.of(named(("published",), loader)["published"], loader, SETTINGS[:1])
    loop = command_loops(loader, law, SETTINGS[:1])[0]
    single = law.numbers.gain_law(loader)
    gains = np.array(single.gains)
    labels = ff.compliant_model(loader, single).state_labels
    expected = np.zeros(len(labels))
    names = ["piston_position_m", "load_pressure_pa", "feel_position_rad", "feel_velocity_rad_per_s", "base_position_m"]
    for name, gain in zip([*names, "base_velocity_m_per_s"], gains, strict=False):
        expected[labels.index(name)] = gain
    assert loop.command == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING * np.abs(expected).max())
    found = loop_margins(loop)
    opened = loop.matrix - np.outer(loop.by_command, loop.command)

    def abscissa(gain):
        return np.linalg.eigvals(opened + gain * np.outer(loop.by_command, loop.command)).real.max()

    assert abscissa(found.gain_up * (1 - ON_THE_EDGE)) < 0 < abscissa(found.gain_up * (1 + ON_THE_EDGE))


def test_sampled_loop_modes_match_continuous_system():
    """A swing, sampled: ``s = ln(z) / T``; a delay, whose pole is at zero, is no mode."""
    period, w, zeta = 1e-3, 12.0, 0.3
    swing = expm(np.array([[0, 1], [-(w**2), -2 * zeta * w]]) * period)
    matrix = np.zeros((3, 3))
    matrix[:2, :2] = swing
    (mode,) = CommandLoop(matrix, np.ones(3), np.zeros(3), period).modes
    assert (mode.frequency_rad_per_s, mode.damping_ratio) == pytest.approx((w, zeta), rel=ROUNDING)


def test_unstable_loop_has_zero_margins():
    found = loop_margins(CommandLoop(np.array([[1.1]]), np.ones(1), np.zeros(1), 1e-3))
    assert (found.gain_up, found.gain_down, found.delay_s, found.disk) == (1.0, 1.0, 0.0, 0.0)


def test_minimum_margins_are_least_of_several_loops(loops):
    found = [loop_margins(loop) for loop in loops]
    least = minimum_margins(found)
    assert least.gain_up == min(one.gain_up for one in found)
    assert least.gain_down == max(one.gain_down for one in found)
    assert least.delay_s == min(one.delay_s for one in found)
