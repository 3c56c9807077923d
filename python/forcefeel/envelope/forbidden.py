"""Settings that no law renders: what the drive cannot give, and what the sensors' noise covers.

``theta_0`` angle of the release · ``I``, ``B``, ``G`` programmed, ``w``, ``zeta`` their frequency and damping ratio · ``J`` column
· ``T`` sample period

**Drive.** The rule times the way back, from 0.9 of ``theta_0`` to zero, or to 0.1 where it does not swing, and allows a tolerance
more than the ideal's. Forbidden is a setting for which the drive takes longer with all that it has (``sizing.fastest``). Of a
motor also one whose ``G theta_0`` it does not hold standing still (``sizing.too_small``).

**Noise.** The column obeys ``J s^2 theta = T_p + T_l``. The torque ``T_l`` of the link is what a law makes of its samples of
``theta``, which have the noise ``n``. Whatever the linear law ``T_l = C (theta + n)``, with ``H`` what it renders of a hand's
torque,

    theta = H T_p + C n / (J s^2 - C),     H = 1 / (J s^2 - C)
    theta = H T_p + (J s^2 H - 1) n

so that a law that renders ``H = 1 / (I s^2 + B s + G)`` moves the column so much by its noise, and nothing but another ``H`` makes
it less. Counted are the frequencies up to twice the feel's alone, above which a law may do what it likes:

    sigma^2 = (V T / pi) int_0^{2 w} |J s^2 H - 1|^2 d omega

``V`` variance of what the column's sensor and, through the link, that of the drive's end tell of theta together; the load cell's
noise comes on top. A sensor at the grip tells of ``T_p`` too, but for ``m s^2 theta`` of what lies outboard, with the variance
``V_g``. Of all ``T_l = C (theta + n) + D (T_p - m s^2 theta + n_g)`` that render ``H``, the best one has in place of V

    V V_g / (V_g + ((J - m) omega^2)^2 V)

Forbidden is a setting whose ``sigma`` is above ``COVERED`` times the band in which the rule wants it at rest.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import measured, pieces
from forcefeel.loader.loader import Loader
from forcefeel.loader.sensors import SENSORS, has_grip_sensor, sample_variance, unseen_inertia
from forcefeel.qualification.release_batch import ReleaseBatch
from forcefeel.sizing.fastest import Fastest, Limit
from forcefeel.sizing.too_small import Beyond
from forcefeel.threads import threads_or_cores
from forcefeel.units import ANGLE, SECONDS

NOISE = "the sensors' noise"
REASONS = (*Limit, NOISE)
"""Why a setting is forbidden."""

COVERED = 1.0
"""Times the residual band: noise that is as large r.m.s. leaves the band, and counts as overshoots, at most turns."""

_HIGHEST, _FREQUENCIES = 2.0, 401
"""Times the feel's frequency, and into how many the range is cut: some ten within the width of the least damped resonance."""


@dataclass(frozen=True, eq=False)
class Forbidden:
    """What no law renders of a plan's settings.

    Attributes:
        reason: Place of each setting's reason in ``REASONS``, -1 where it is allowed, (settings,).
        fastest_s: The least time for the way back, (settings,).
        most_s: The longest that the rule allows, (settings,).
        noise_rad: sigma, (settings,); zero of an analog loader.
        beyond: What the motor cannot hold.
    """

    reason: NDArray[np.int8] = field(repr=False)
    fastest_s: Annotated[NDArray[np.float64], SECONDS] = field(repr=False)
    most_s: Annotated[NDArray[np.float64], SECONDS] = field(repr=False)
    noise_rad: Annotated[NDArray[np.float64], ANGLE] = field(repr=False)
    beyond: Beyond = field(repr=False)

    @property
    def settings(self) -> NDArray[np.bool_]:
        """Which settings are forbidden."""
        return np.asarray(self.reason >= 0)

    @property
    def counts(self) -> dict[str, int]:
        """How many settings each reason forbids, of those that forbid any; each is counted once."""
        found = np.bincount(self.reason[self.settings], minlength=len(REASONS)).tolist()
        return {str(reason): count for reason, count in zip(REASONS, found, strict=True) if count}

    def of(self, reason: str) -> NDArray[np.bool_]:
        """Which settings one reason forbids."""
        return np.asarray(self.reason == REASONS.index(reason))


def forbidden(plan: Plan, *, threads: int | None = None) -> Forbidden:
    """What no law renders of a plan's settings, released from the plan's angle.

    Args:
        plan: The envelope; its compensators and cases are not used.
        threads: How many; all cores if not given.
    """
    loader, fastest, angle = plan.loader, Fastest.of(plan.loader), plan.release_rad
    feel, rules = plan.settings.feel(loader), plan.rules.release
    swings, most = _most_s(plan, feel, threads_or_cores(threads))
    stiffness, places = np.unique(feel[:, 2], return_inverse=True)
    of_speed, of_force = (
        np.where(swings, *(times[places] for times in pair))
        for pair in zip(*(fastest.fall_s(angle, stiffness, rules.high, low) for low in (0.0, rules.low)), strict=True)
    )
    noise, beyond = noise_floor(plan), Beyond.of(loader, feel[:, 2], angle)
    reason = np.full(len(feel), -1, dtype=np.int8)
    for which, why in (
        (noise > COVERED * rules.residual_band * angle, NOISE),
        (of_speed > most, fastest.of_speed),
        (of_force > most, fastest.of_force),
        (beyond.settings, Limit.TORQUE),
    ):
        reason[which] = REASONS.index(why)
    return Forbidden(reason, np.maximum(of_speed, of_force), most, noise, beyond)


def _most_s(plan: Plan, feel: NDArray[np.float64], threads: int) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which settings swing, and how long their way back may take by the rule."""
    swings, most = np.zeros(len(feel), dtype=np.bool_), np.full(len(feel), np.inf)
    for which, record in pieces(plan):
        ideal = ideal_releases(feel[which], plan.release_rad, record.step_s, record.samples)
        found = measured(plan, record, ideal, threads)
        swings[which] = found.count > 0
        most[which] = np.where(found.count > 0, _allowed(plan, "P0", found), _allowed(plan, "fall time", found))
    return swings, most


def _allowed(plan: Plan, quantity: str, found: ReleaseBatch) -> NDArray[np.float64]:
    """A time and its tolerance; endless where the rule does not ask for it."""
    time = found.cycles_s[:, 0] if quantity == "P0" else found.fall_time_s
    tolerance = plan.test.tolerance(quantity)
    return np.full(len(time), np.inf) if tolerance is None else np.asarray(time + tolerance.limit(time))


def noise_floor(plan: Plan) -> NDArray[np.float64]:
    """Sigma of each setting in rad."""
    loader = plan.loader
    inertia, damping, stiffness = plan.settings.feel(loader).T[:, :, np.newaxis]
    omega = np.linspace(0.0, _HIGHEST, _FREQUENCIES) * plan.settings.rows[:, 1:2]
    torque = loader["column.inertia"] * omega**2
    ideal = 1 / (stiffness - inertia * omega**2 + 1j * damping * omega)
    counted = np.abs(torque * ideal + 1) ** 2 * _sampled(loader, omega)
    return np.asarray(np.sqrt(loader["controller.period"] / np.pi * np.trapezoid(counted, omega)))


def _sampled(loader: Loader, omega: NDArray[np.float64]) -> NDArray[np.float64]:
    """V, or with a sensor at the grip ``V V_g / (V_g + ((J - m) omega^2)^2 V)``, in rad^2."""
    angle = angle_variance(loader)
    if not has_grip_sensor(loader) or not angle:
        return np.full(omega.shape, angle)
    grip = sample_variance(loader)[-1] * (loader["column.grip_arm"] / loader["grip_sensor.gain"]) ** 2
    between = (loader["column.inertia"] - unseen_inertia(loader)) * omega**2
    return np.asarray(angle * grip / (grip + between**2 * angle)) if grip else np.zeros(omega.shape)


def angle_variance(loader: Loader) -> float:
    """Variance in rad^2 of what a sample of all sensors tells of the column's angle, ``x_p = alpha R_b theta + F_c / k``."""
    force, end, angle = sample_variance(loader)[: len(SENSORS)].tolist()
    lever = loader["linkage.ratio"] * loader["column.base_arm"]
    through_link = (end + force / loader["linkage.stiffness"] ** 2) / lever**2
    total = angle + through_link
    return angle * through_link / total if total else 0.0
