"""What tunes ``robust``, ``agile`` and ``grip``, from the loader: numbers without unit, and units that the loader itself gives.

**Valve.** Neither supply pressure nor largest current is in the linear plant, so that no tuning is to follow those; what bounds
every loop is the lag between a command and its effect. In these units loaders of any size and speed are alike, but for the
resonance of the column on its link, and one set of numbers serves them:

    time       1 / w = 2 zeta / w_n + tau + T / 2      lag of the valve, delay, hold
    angle      1 rad
    torque     J w^2                                   gives the column the rate w in one unit of time
    command    alpha R_b A w / (K_2 C_i)               turns the column at the rate w, eqs. (2), (5), (9)
    flow       alpha R_b A w

**Motor.** Its command is a torque, and the lag of its current loop is short; what bounds the loop is the largest current, beyond
which a light feel would end in a limit cycle between its two ends. The units are those of ``plant.Scale``, which has that current.

**How well the loader is known.** The load cell tells what torque the motor has given, less what the rotor took; so does the
current, of a loader that is known, and with hardly any noise. What its torque may be off by is what the filter is told that acts on
it. Of a motor those numbers are between two sets, in decades by the largest share that a parameter may be off
(``loader.known.off_by``): from ``ASSUMED`` on the first, up to ``KNOWN`` the second, which leaves the load cell out. Of a valve the
flow and not the force follows the command, and there is one set.

In either the weights are Bryson's: each the square of how much of it is as bad as a radian of error (A. E. Bryson, Y.-C. Ho,
Applied Optimal Control, 1969, section 5.2).

**Noise of sensors.** A sample has the variance ``sigma^2 + q^2 / 12`` of noise and rounding, as the loader declares them
(B. Widrow, 1956). The filter is given more than that, since a model is wrong beyond it, and more where the sensor is noisier:
the density ``10^p sqrt(s u)``, halfway in decades between the declared one ``s`` and the unit ``u``. With 17 to 26 bits of the
column's angle that renders more than a filter that follows the declared noise in full, and than one that does not know it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import log10, sqrt
from types import MappingProxyType

import numpy as np

from forcefeel.laws.sampled.plant import Scale, drive_lag_s, period_and_delay
from forcefeel.laws.sampled.tuning import Power, Tuning
from forcefeel.loader.known import off_by
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.loader.sensors import has_grip_sensor, sample_variance, sensors_of
from forcefeel.loader.tolerances import ASSUMED

_NUMBERS: Mapping[str, Tuning] = MappingProxyType(
    {
        HYDRAULIC: Tuning(
            # As bad as a radian of error are a command for six times w, and a rate of half w; of a heavy feel less, as the link,
            # stretched by the hand that let go, throws its column further. Where the link is hardly stiffer than the feel, what
            # catches the column is command, and what keeps it from swinging on that link the rate.
            command_weight=Power(-1.6, -0.3, throw=-0.7),
            rate_weight=Power(0.6, -0.5, throw=1.2),
            input_noise=Power(-0.3, -0.1),
            # Of a light feel the torque is believed to change slower: its noise moves the feel by 1 / I.
            torque_walk=Power(-2.0, 0.3),
            disturbance_walk=Power(-4.0, 0.9),
            # Input noise is held over a period. With little flow noise and an accurate load cell, the filter has a pole near -1,
            # which a load cell lag of 0.3 ms moves out of the unit circle if the valve is fast.
            flow_walk=Power(-1.7, -0.4),
            pressure_noise=Power(-5.0, -2.2),
            angle_noise=Power(-1.2, -0.5),
        ),
        ELECTRIC: Tuning(
            command_weight=Power(-3.224, -0.313),
            # An arm adds its mass to a light grip; damping is what bears it.
            rate_weight=Power(-1.2, 0.8),
            input_noise=Power(-1.638, 0.262),
            torque_walk=Power(-1.6, 0.183),
            disturbance_walk=Power(-2.811, -0.018),
            flow_walk=Power(-5.302, -1.58),
            pressure_noise=Power(-3.7, -1.501),
            angle_noise=Power(-3.4, -0.212),
        ),
    }
)
"""In the units of the loader. Found by search. Of a valve: over eleven loaders drawn within a factor of two from ``elevator-2khz``,
four of them with other sensors, released from 10 and 2 deg, and over that loader with column, link and arm off its values. The
exponents ``throw``: over ten loaders of seeds 5000 to 5124. Of a motor: over the six built-in loaders.
``benchmarks/drawn_loaders.py`` tries the numbers on other loaders."""

KNOWN = 0.01
"""Share by which the parameters of a machine that is known are off at most. At a hundredth an aileron's wheel passes more with the
second set in every case, at a fifth less."""

_NUMBERS_KNOWN: Mapping[str, Tuning] = MappingProxyType(
    {
        HYDRAULIC: _NUMBERS[HYDRAULIC],
        ELECTRIC: Tuning(
            # A heavy feel has stretched the link, which throws the column as the hand lets go: a regulator that answers that
            # with all that it has ends in a limit cycle between the largest currents.
            command_weight=Power(-4.2, -0.3, throw=1.0),
            rate_weight=Power(-2.0, 0.4),
            input_noise=Power(-4.0, 0.2),
            torque_walk=Power(-1.9, 0.5),
            disturbance_walk=Power(-4.3, 1.2),
            flow_walk=Power(-6.4, -2.1),
            pressure_noise=Power(1.2, -1.3),
            angle_noise=Power(-3.0, -0.2),
        ),
    }
)
"""Of a machine that is known to ``KNOWN``. Found by search over twelve electric loaders drawn within a factor of two (seeds 2000 to
2011 of ``benchmarks/drawn_loaders.py``, which counts others), released from 10 and 2 deg."""

_ARM: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {HYDRAULIC: {}, ELECTRIC: {"input_noise": 0.3, "torque_walk": -0.4, "angle_noise": -4.0}}
)
"""Exponents ``arm``: where a firm arm closes a loop of gain ``K`` over the estimate of its torque, ``SampledPlant.arm_gain``, the
torque is believed to change slower and the column's angle more. Both take lag from the filter where it still has ``1 / K`` of
its gain. Found by search over four of the built-in motors with every arm, with J within 1 %. A machine that is known has none of
them: without its load cell there is no such filter in double precision."""

_FRICTION: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        HYDRAULIC: {"torque_walk": -0.3, "disturbance_walk": -0.5},
        ELECTRIC: {"angle_noise": 1.0},
    }
)
"""Decades by which the numbers differ where the law gives known dry friction back: a calmer filter, since the friction's sign is
that of an estimated rate. Found by search over machines of ``benchmarks/commission.py`` (seed 2026) whose friction is as stated, a
fifth less and a fifth more: four of ``elevator-2khz`` with 0.8 to 2.7 lb, three of ``elevator-electric`` at 20 bits with 1 lb."""

_UNDECLARED = {"load_cell": 3e-5, "column_sensor": 7e-7}
"""Noise of a sample where the loader declares none, as a share of the largest force and in rad: that of the sensors of
``elevator-2khz``. A filter without any does not exist."""


@dataclass(frozen=True)
class Units:
    """What a loader measures itself by, as shares of ``plant.Scale``.

    Attributes:
        time: Lag of drive, delay and hold.
        torque: Gives the column a unit of rate in a unit of time.
        command: Brings the column to a unit of rate.
        drive: Flow of that command.
    """

    time: float = 1.0
    torque: float = 1.0
    command: float = 1.0
    drive: float = 1.0

    @classmethod
    def of(cls, loader: Loader) -> "Units":
        """The units of a loader.

        Raises:
            InputError: If it has no controller's period, or a delay longer than that.
        """
        period_and_delay(loader)
        if loader.drive == ELECTRIC:
            return cls()
        lag = drive_lag_s(loader)
        flow = loader["linkage.ratio"] * loader["column.base_arm"] * loader["actuator.area"] / lag
        command = flow / (loader["amplifier.admittance"] * loader["valve.current_gain"])
        scale = Scale.of(loader)
        return cls(
            time=lag / scale.time_s,
            torque=loader["column.inertia"] / lag**2 / scale.torque_n_m,
            command=command / scale.command_v,
            drive=flow / loader["valve.rated_flow"],
        )


_AGILE = Tuning(
    command_weight=Power(-0.48, -0.68),
    rate_weight=Power(-1.91, -0.46),
    input_noise=Power(0.88, -0.36),
    torque_walk=Power(-1.24, 0.47),
    disturbance_walk=Power(-3.38, 1.2),
    flow_walk=Power(-6.19, -0.99),
    pressure_noise=Power(-1.68, -1.8),
    angle_noise=Power(-2.19),
)
"""Likewise, of a valve. Found by search on ``elevator-2khz`` for the share that passes on every perturbed plant and under every
arm. Its filter follows the torque some four times as fast, ``(W / s)^(1/3)`` of walk and angle noise: a light feel is a lever from
the torque to the motion of the arm that holds it, and goes unstable by what the filter lags. It takes as much more noise to the
command, and with it settings of other loaders."""


def agile_tuning(loader: Loader) -> Tuning:
    """The weights and noises of ``agile`` for a loader; errors as ``robust_tuning``.

    Of a motor they are those of ``robust`` for a machine that may be off by as much as is assumed, however well it is known: they
    keep the load cell, which tells what an arm takes of the drive's torque.

    Example:
        >>> from forcefeel.laws.sampled.rules import agile_tuning, robust_tuning
        >>> loader = ff.digital_elevator()
        >>> agile_tuning(loader).torque_walk.decades > robust_tuning(loader).torque_walk.decades
        True
    """
    if loader.drive == ELECTRIC:
        return _in_units(loader, _bearing_arms(_NUMBERS[ELECTRIC], loader, 1.0))
    return _in_units(loader, _AGILE)


def robust_tuning(loader: Loader) -> Tuning:
    """The weights and noises of ``robust`` for a loader; of a motor they follow how well it is known.

    Raises:
        InputError: If it has no ``controller.period``, or a delay longer than that.

    Example:
        >>> from forcefeel.laws.sampled import robust_tuning
        >>> coarse = ff.digital_elevator().replace({"column_sensor.resolution": "3.4e-4 deg"})  # 20 bits
        >>> fine, noisier = (robust_tuning(one).angle_noise.decades for one in (ff.digital_elevator(), coarse))
        >>> noisier > fine
        True
    """
    knowledge = _knowledge(loader)
    numbers = _NUMBERS[loader.drive].towards(_NUMBERS_KNOWN[loader.drive], knowledge)
    if not has_grip_sensor(loader):
        numbers = _bearing_arms(numbers, loader, 1 - knowledge)
    tuning = _in_units(loader, numbers)
    calmer = {name: getattr(tuning, name).times(decades) for name, decades in _calmer(loader).items()}
    return replace(tuning, **calmer)


def _bearing_arms(numbers: Tuning, loader: Loader, share: float) -> Tuning:
    arms = {name: replace(getattr(numbers, name), arm=share * arm) for name, arm in _ARM[loader.drive].items()}
    return replace(numbers, **arms)


QUIET = 1e-6
"""Noise of the column's angle, in rad by root of the loader's unit of time, to which the filter's estimate of the rate still tells
which way dry friction acts: that of an encoder of 21 bits on ``elevator-2khz``."""


def _calmer(loader: Loader) -> dict[str, float]:
    """Decades by which the numbers differ where the law gives known dry friction back, by name.

    The sign of the friction is that of the estimated rate, whose noise goes as ``s w^(3/2)`` with the angle's noise s and the
    filter's rate ``w = (W / s_f)^(1/3)``. Since the filter is told of ``s_f ~ s^(1/2)``, a walk of the pilot's torque
    ``W ~ s^(-3/2)`` keeps it as it is. A valve's law has that shift too.
    """
    if has_grip_sensor(loader) or not loader["column.coulomb_friction"]:
        return {}
    shifts = dict(_FRICTION[loader.drive])
    if loader.drive == HYDRAULIC:
        _, angle = _declared(loader)
        shifts["torque_walk"] -= 1.5 * max(log10(angle / sqrt(Units.of(loader).time) / QUIET), 0.0)
    return shifts


def _knowledge(loader: Loader) -> float:
    """One of a machine that is known, zero of one that may be off by as much as is assumed, even in proportion between."""
    if has_grip_sensor(loader):
        return 0.0  # its law estimates another torque
    return float(np.clip(log10(ASSUMED / off_by(loader)) / log10(ASSUMED / KNOWN), 0.0, 1.0))


GRIP_BY_FREQUENCY = {HYDRAULIC: -1.2, ELECTRIC: 0.0}
"""Power of the feel's natural frequency by which the command's weight goes in ``grip``."""

_AT_GRIP: Mapping[str, Tuning] = MappingProxyType(
    {
        HYDRAULIC: replace(_NUMBERS[HYDRAULIC], command_weight=Power(-1.93, -0.5), rate_weight=Power(0.6, -0.5)),
        ELECTRIC: _NUMBERS[ELECTRIC],
    }
)
"""Of ``grip``: those of ``robust`` but for the regulator's, which is softer, the more so the lighter the feel."""


def grip_tuning(loader: Loader) -> Tuning:
    """The weights and noises of ``grip`` for a loader; errors as ``robust_tuning``.

    Example:
        >>> from forcefeel.laws.sampled.rules import grip_tuning, robust_tuning
        >>> loader = ff.digital_elevator()
        >>> grip_tuning(loader).angle_noise == robust_tuning(loader).angle_noise
        True
    """
    tuning = _in_units(loader, _AT_GRIP[loader.drive])
    # The feel's natural frequency is counted in the plant's unit of time there, in the loader's here.
    by_time = GRIP_BY_FREQUENCY[loader.drive] * log10(Units.of(loader).time)
    weight = tuning.command_weight
    return replace(tuning, command_weight=weight.times(by_time))


def _in_units(loader: Loader, numbers: Tuning) -> Tuning:
    """Numbers without unit, in those of the loader as shares of ``plant.Scale``."""
    units = Units.of(loader)
    root = sqrt(units.time)
    pressure, angle = _declared(loader)
    factors = {
        "command_weight": units.command**-2,
        "rate_weight": units.time**2,
        "input_noise": units.command * root,
        "torque_walk": units.torque / root,
        "disturbance_walk": units.command / root,
        "flow_walk": units.drive / root,
        "pressure_noise": sqrt(pressure * units.torque * root),
        "angle_noise": sqrt(angle * root),
    }
    given = {name: getattr(numbers, name) for name in factors}
    return Tuning(**{name: power.times(log10(factors[name])) for name, power in given.items()})


def _declared(loader: Loader) -> tuple[float, float]:
    """Densities of the noise that the loader declares for its load cell and its column's sensor, in units of ``Scale``."""
    scale, assumed = Scale.of(loader), undeclared_noise(loader)
    seen = dict(zip(sensors_of(loader), np.sqrt(sample_variance(loader)).tolist(), strict=True)) | assumed
    root = sqrt(loader["controller.period"] / scale.time_s)
    force, _, angle = scale.sampled.tolist()
    return seen["load_cell"] / force * root, seen["column_sensor"] / angle * root


def undeclared_noise(loader: Loader) -> dict[str, float]:
    """What the rules take, r.m.s. in N and rad, for each sensor of theirs of which the loader file declares neither noise nor step.

    Example:
        >>> from forcefeel.laws.sampled.rules import undeclared_noise
        >>> undeclared_noise(ff.digital_elevator())
        {}
    """
    units = dict(zip(_UNDECLARED, Scale.of(loader).sampled[[0, 2]].tolist(), strict=True))
    silent = [
        sensor
        for sensor, variance in zip(sensors_of(loader), sample_variance(loader).tolist(), strict=True)
        if not variance
    ]
    return {sensor: share * units[sensor] for sensor, share in _UNDECLARED.items() if sensor in silent}
