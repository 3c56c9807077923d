"""Settings that no law renders, because of the drive or the sensor noise.

``theta_0`` angle of the release · ``I``, ``B``, ``G`` programmed, ``w``, ``zeta`` their frequency and damping ratio · ``J`` column
· ``T`` sample period

**Drive.** The rule times the return from 0.9 of ``theta_0`` to zero, or to 0.1 for a feel that does not swing. It allows the time
of the ideal plus a tolerance. A setting is forbidden if the drive at its limits takes longer (``sizing.fastest``). With a motor it
is also forbidden if the motor cannot hold ``G theta_0`` at rest (``sizing.too_small``).

**Throw.** The torque ``G theta_0`` stretches the link, which throws the column at the release, before the drive can follow. The
rule's first time begins when the column falls through 0.9 of ``theta_0``. The latest possible begin is that with the drive at its
limits from the first command after the release (``sizing.letting_go``). A setting is forbidden if even this is earlier than the
begin of the feel by more than ``THROWN`` times the tolerance of that time. A law that renders the feel after the throw crosses zero
with the feel, within the tolerance, and so fails.

**Noise.** The column obeys ``J s^2 theta = T_p + T_l``. The link's torque ``T_l`` is the law's response to samples of ``theta``
with the noise ``n``. For every linear law ``T_l = C (theta + n)``, with ``H`` its rendered response to a hand's torque,

    theta = H T_p + C n / (J s^2 - C),     H = 1 / (J s^2 - C)
    theta = H T_p + (J s^2 H - 1) n

so the noise motion depends only on the rendered ``H = 1 / (I s^2 + B s + G)``. Only frequencies up to twice the feel's count,
because a law is free above them:

    sigma^2 = (V T / pi) int_0^{2 w} |J s^2 H - 1|^2 d omega

``V`` is the variance of theta from the column's sensor and, through the link, the sensor at the drive's end. The load cell's noise
is not part of the bound: for a known machine ``T_l`` follows from the commands, and a law without the load cell renders lighter
feels (``laws.sampled.rules``). A sensor at the grip measures ``T_p - m s^2 theta``, ``m`` the outboard inertia, with the variance
``V_g``. Of all ``T_l = C (theta + n) + D (T_p - m s^2 theta + n_g)`` that render ``H``, the best one has instead of V

    V V_g / (V_g + ((J - m) omega^2)^2 V)

A setting is forbidden if ``sigma`` is above ``COVERED`` times the rule's rest band.
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
from forcefeel.sizing.fastest import Fastest, Limit
from forcefeel.sizing.letting_go import falls_through_s
from forcefeel.sizing.too_small import Beyond
from forcefeel.threads import threads_or_cores
from forcefeel.units import ANGLE, SECONDS

NOISE = "the sensors' noise"
THROW = "the link's throw"
REASONS = (*Limit, NOISE, THROW)
"""Why a setting is forbidden."""

COVERED = 1.0
"""Factor on the rest band: noise with this r.m.s. leaves the band at most turns and counts as overshoots."""

THROWN = 2.0
"""Factor on the tolerance of the first time: once for the rule, once for the law's zero crossing."""

_HIGHEST, _FREQUENCIES = 2.0, 401
"""Highest frequency as a factor on the feel's, and number of points: some ten within the width of the least damped resonance."""


@dataclass(frozen=True, eq=False)
class Forbidden:
    """Settings of a plan that no law renders.

    Attributes:
        reason: Index of each setting's reason in ``REASONS``, -1 if allowed, (settings,).
        fastest_s: Shortest time of the return, (settings,).
        most_s: Longest time that the rule allows, (settings,).
        noise_rad: sigma, (settings,); zero for an analog loader.
        thrown_s: Latest time at which the thrown column passes the angle where the first time begins; infinite if the drive can
            prevent it, (settings,).
        begins_s: Time at which the feel passes that angle, (settings,).
        beyond: Settings that the motor cannot hold.
    """

    reason: NDArray[np.int8] = field(repr=False)
    fastest_s: Annotated[NDArray[np.float64], SECONDS] = field(repr=False)
    most_s: Annotated[NDArray[np.float64], SECONDS] = field(repr=False)
    noise_rad: Annotated[NDArray[np.float64], ANGLE] = field(repr=False)
    thrown_s: Annotated[NDArray[np.float64], SECONDS] = field(repr=False)
    begins_s: Annotated[NDArray[np.float64], SECONDS] = field(repr=False)
    beyond: Beyond = field(repr=False)

    @property
    def settings(self) -> NDArray[np.bool_]:
        """Which settings are forbidden."""
        return np.asarray(self.reason >= 0)

    @property
    def counts(self) -> dict[str, int]:
        """Number of settings that each reason forbids, without zeros; a setting counts once."""
        counts = np.bincount(self.reason[self.settings], minlength=len(REASONS)).tolist()
        return {str(reason): count for reason, count in zip(REASONS, counts, strict=True) if count}

    def of(self, reason: str) -> NDArray[np.bool_]:
        """Settings that one reason forbids."""
        return np.asarray(self.reason == REASONS.index(reason))


def forbidden(plan: Plan, *, threads: int | None = None) -> Forbidden:
    """Find the settings of a plan that no law renders, released from the plan's angle; its laws and cases are not used."""
    loader, fastest, angle = plan.loader, Fastest.of(plan.loader), plan.release_rad
    feel, rules = plan.settings.feel(loader), plan.rules.release
    first = _first_times(plan, feel, threads_or_cores(threads))
    stiffness, places = np.unique(feel[:, 2], return_inverse=True)
    of_speed, of_force = (
        np.where(first.swings, *(times[places] for times in pair))
        for pair in zip(*(fastest.fall_s(angle, stiffness, rules.high, low) for low in (0.0, rules.low)), strict=True)
    )
    thrown = falls_through_s(loader, angle, stiffness, rules.high)[places]
    noise, beyond = noise_floor(plan), Beyond.of(loader, feel[:, 2], angle)
    reason = np.full(len(feel), -1, dtype=np.int8)
    for which, why in (
        (first.begins_s - thrown > THROWN * first.tolerance_s, THROW),
        (noise > COVERED * rules.residual_band * angle, NOISE),
        (of_speed > first.most_s, fastest.of_speed),
        (of_force > first.most_s, fastest.of_force),
        (beyond.settings, Limit.TORQUE),
    ):
        reason[which] = REASONS.index(why)
    return Forbidden(reason, np.maximum(of_speed, of_force), first.most_s, noise, thrown, first.begins_s, beyond)


@dataclass(frozen=True, eq=False)
class _FirstTimes:
    """First time that the rule compares, for each feel: whether the feel swings, begin, duration and tolerance; (settings,) each.

    The tolerance is infinite for a time that the rule does not require.
    """

    swings: NDArray[np.bool_]
    begins_s: NDArray[np.float64]
    time_s: NDArray[np.float64]
    tolerance_s: NDArray[np.float64]

    @property
    def most_s(self) -> NDArray[np.float64]:
        """Longest allowed time of the return."""
        return self.time_s + self.tolerance_s


def _first_times(plan: Plan, feel: NDArray[np.float64], threads: int) -> _FirstTimes:
    count = len(feel)
    swings, begins, time, tolerance = (
        np.zeros(count, dtype=np.bool_),
        np.zeros(count),
        np.zeros(count),
        np.full(count, np.inf),
    )
    level = plan.rules.release.high * plan.release_rad
    for which, record in pieces(plan):
        ideal = ideal_releases(feel[which], plan.release_rad, record.step_s, record.samples)
        measures = measured(plan, record, ideal, threads)
        swings[which] = measures.count > 0
        begins[which] = _falls_through(ideal, level, record.step_s)
        for turns, quantity, times in (
            (True, "P0", measures.cycles_s[:, 0]),
            (False, "fall time", measures.fall_time_s),
        ):
            these = (measures.count > 0) == turns
            limit = plan.test.tolerance(quantity)
            time[which[these]] = times[these]
            if limit is not None:
                tolerance[which[these]] = limit.limit(times[these])
    return _FirstTimes(swings, begins, time, tolerance)


def _falls_through(angles: NDArray[np.float64], level: float, step_s: float) -> NDArray[np.float64]:
    """Time at which each history (settings, samples) first falls below a level, interpolated between two samples."""
    after = (angles < level).argmax(axis=1)
    above, below = (angles[np.arange(len(angles)), column] for column in (after - 1, after))
    return np.asarray((after - 1 + (above - level) / (above - below)) * step_s)


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
    """Variance in rad^2 of the column angle from a sample of all sensors, ``x_p = alpha R_b theta + F_c / k``."""
    force, end, angle = sample_variance(loader)[: len(SENSORS)].tolist()
    lever = loader["linkage.ratio"] * loader["column.base_arm"]
    through_link = (end + force / loader["linkage.stiffness"] ** 2) / lever**2
    total = angle + through_link
    return angle * through_link / total if total else 0.0
