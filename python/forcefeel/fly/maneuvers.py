"""Maneuvers, flown through the loader and on the programmed feel alone."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import acos, degrees, pi, radians, sqrt

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, suggestion
from forcefeel.fly.aircraft import FRAME_S, Aircraft
from forcefeel.fly.case import FlightCase
from forcefeel.fly.modes import free_modes
from forcefeel.fly.pilot import CrossoverPilot
from forcefeel.fly.run import FlightOptions, Flown, Pilot
from forcefeel.fly.trims import held_force, trimmed_force
from forcefeel.units import (
    AIRSPEED,
    ALTITUDE,
    ANGLE,
    ANGULAR_VELOCITY,
    FORCE,
    HERTZ,
    LOAD_FACTOR,
    RATIO,
    SECONDS,
    Json,
    Unit,
    UnitSystem,
    quantity,
)

GRAVITY = 9.80665

_BEGINS_S, _RAMP_S, _TURN_S = 1.0, 2.0, 6.0
"""Time of calm at the start, time in which hand or target moves, time in which a turn winds up."""
_CALM_S, _CHANGE_S, _AFTER_S = 5.0, 1.0, 15.0
"""Of a change of power, flaps, gear or speed brake, as 14 CFR Part 60 records it."""
_FLAPS = 0.5
CHANGED = {"calibrated_airspeed": AIRSPEED, "altitude": ALTITUDE, "pitch_attitude": ANGLE}
"""States in which such a change is measured, and their units: 14 CFR Part 60 App. A 2.c.1 to 2.c.4."""
_PULSE_G, _PULSE_S, _SHORT_S = 0.1, 2.0, 8.0
_QUICK_STEP_S, _QUICK_ORDER, _QUICK_RAD_PER_S, _STUCK_RAD = 0.016, 6, 1.0, 1e-3
_PERIODS, _RETURN_PERIODS = 3.0, 2.5
"""Periods of a phugoid, and of the swing to the speed at which a released aircraft returns."""
_STALL_PERIODS, _PATH_RAD_PER_S, _PATH_LEAD_S, _PATH_INTEGRAL_S = 1.8, 0.4, 0.5, 3.0
_LEAST_GAINED = 0.05
"""Load factor from which a force per g is stated."""
_SINKS_RAD = 0.12
"""Descent at which a stall ends: the pull no longer holds the path."""
_LAST = slice(-round(0.5 / FRAME_S), None)
_MOST_LOAD_FACTOR = 12.0
_MOST_SIDESLIP_RAD = radians(20)
_TRAVELS = {"roll": (1 / 3, "a third"), "yaw": (1 / 4, "a quarter")}
"""Shares of the travel, as 14 CFR Part 60 App. A 2.d.2 and 2.d.6 have them."""
_QUICK_S, _ROLLS_S = 0.5, 2.0
_SLIP_RAMP_S, _SLIPS_S, _MEAN = 4.0, 14.0, slice(-round(4.0 / FRAME_S), None)
_BANK_RAD_PER_S, _BANK_LEAD_S, _BANK_INTEGRAL_S = 0.6, 0.5, 4.0


@dataclass(frozen=True)
class ManeuverRequest:
    """The numbers of a maneuver.

    Attributes:
        load_factor: Of pull-up and wind-up turn.
        off_trim: Share of the trim speed at which a release begins.
        sideslip_rad: Of a steady sideslip; positive with the wind from the right.

    Raises:
        InputError: If a number is out of its range.

    Example:
        >>> ff.fly.ManeuverRequest(load_factor=2.0).off_trim
        0.9
    """

    load_factor: float = 1.4
    off_trim: float = 0.9
    sideslip_rad: float = radians(5)

    def __post_init__(self) -> None:
        if not 1 < self.load_factor < _MOST_LOAD_FACTOR:
            raise InputError(
                f"load factor: expected one above 1 and below {_MOST_LOAD_FACTOR:g}, got {self.load_factor:g}"
            )
        if not 0.5 <= self.off_trim <= 2 or self.off_trim == 1:
            raise InputError(
                f"off trim: expected 50 % to 200 % of the trim speed, not 100 %, got {100 * self.off_trim:g} %"
            )
        if not 0 < abs(self.sideslip_rad) <= _MOST_SIDESLIP_RAD:
            raise InputError(
                f"sideslip: expected an angle of at most {degrees(_MOST_SIDESLIP_RAD):g} deg other than 0, "
                f"got {degrees(self.sideslip_rad):g} deg"
            )


@dataclass(frozen=True)
class Measure:
    """A number of a maneuver, through the loader and on the programmed feel alone."""

    name: str
    unit: Unit
    with_loader: float
    alone: float

    def as_json(self, system: UnitSystem) -> dict[str, Json]:
        """Both numbers with their unit."""
        numbers = {"with_loader": self.with_loader, "feel_alone": self.alone}
        return {"name": self.name, **{key: quantity(number, self.unit, system) for key, number in numbers.items()}}


@dataclass(frozen=True, eq=False)
class Maneuver:
    """A flown maneuver.

    Attributes:
        name: Its name, as in ``MANEUVERS``.
        label: Its name with its number.
        flown: The flight through the loader.
        alone: The same on the programmed feel alone.
        measures: Its numbers.

    Example:
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "c172p", 51.4, 900.0, "robust")
        >>> [measure.name for measure in ff.fly.fly_maneuver(case, "short-period").measures][0]
        'largest pitch rate'
    """

    name: str
    label: str
    flown: Flown = field(repr=False)
    alone: Flown = field(repr=False)
    measures: tuple[Measure, ...]


_Numbers = dict[str, tuple[Unit, float]]


@dataclass(frozen=True)
class _Plan:
    """How a maneuver is flown: a new pilot for each flight, duration, levers, bank, share of the trim speed at the start."""

    hand: Callable[[], Pilot]
    lasts_s: float
    measured: Callable[[Flown], _Numbers]
    levers: Callable[[float, Aircraft], None] = lambda *_: None
    share: float = 1.0
    bank_rad: Callable[[float], float] = lambda _: 0.0
    ends: Callable[[Mapping[str, float]], bool] = lambda _: False
    label: str = ""


def fly_maneuver(case: FlightCase, name: str, request: ManeuverRequest = ManeuverRequest()) -> Maneuver:
    """Flies a maneuver through the loader and on the programmed feel alone.

    Args:
        case: Loader, aircraft and trimmed flight.
        name: In pitch ``pull-up``, ``wind-up-turn``, ``release``, ``phugoid``, ``short-period``, ``power``, ``flaps``,
            ``gear``, ``speed-brake`` or ``stall``;
            in roll ``roll-rate`` or ``sideslip``, in yaw ``yaw-rate`` or ``sideslip``.
        request: Its numbers.

    Raises:
        InputError: If the maneuver is unknown, or as in ``fly``.

    Example:
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "c172p", 51.4, 900.0, "robust")
        >>> pull = ff.fly.fly_maneuver(case, "pull-up").measures[0]
        >>> pull.name, round(pull.alone / pull.with_loader, 1)
        ('force per g', 1.0)
    """
    known = [each for each in MANEUVERS if case.axis in _AXES.get(each, ("pitch",))]
    if name not in known:
        raise InputError(
            f"maneuver: expected one of {', '.join(known)} in {case.axis}, got {name!r}{suggestion(name, known)}"
        )
    plan = MANEUVERS[name](case, request)

    def levers(time_s: float, aircraft: Aircraft) -> None:
        plan.levers(time_s, aircraft)
        if case.axis == "pitch":
            aircraft.set_bank(plan.bank_rad(time_s))

    def flown(*, alone: bool) -> Flown:
        begins = case.at(plan.share * case.speed_m_per_s)
        return case.flown(plan.hand(), plan.lasts_s, FlightOptions(alone=alone, levers=levers, ends=plan.ends), begins)

    with_loader, alone = flown(alone=False), flown(alone=True)
    loader_numbers, alone_numbers = plan.measured(with_loader), plan.measured(alone)
    measures = tuple(
        Measure(key, unit, number, alone_numbers[key][1])
        for key, (unit, number) in loader_numbers.items()
        if key in alone_numbers
    )
    return Maneuver(name, plan.label or name, with_loader, alone, measures)


def return_speed(time_s: NDArray[np.float64], speed: NDArray[np.float64]) -> float:
    """The speed about which a freely swinging aircraft swings.

    Three extremes in a row of a damped swing lie as ``x_k - c ~ (-r)^k``, so that
    ``c = (x_1 x_3 - x_2^2) / (x_1 + x_3 - 2 x_2)``; without three, the last speed.
    """
    whole = round(0.5 / (time_s[1] - time_s[0])) or 1
    calm = speed[: len(speed) // whole * whole].reshape(-1, whole).mean(axis=1)
    rate = np.diff(calm)
    extremes = calm[1:-1][rate[:-1] * rate[1:] < 0][-3:]
    if len(extremes) < 3:
        return float(calm[-1])
    first, second, third = extremes.tolist()
    return float((first * third - second**2) / (first + third - 2 * second))


def _ramp(time_s: float, begins_s: float = _BEGINS_S, lasts_s: float = _RAMP_S) -> float:
    return min(1.0, max(0.0, (time_s - begins_s) / lasts_s))


def _swing_s(case: FlightCase) -> float:
    """Lanchester's period of a phugoid, ``sqrt(2) pi V / g``."""
    return sqrt(2) * pi * case.trim.state()["true_airspeed"] / GRAVITY


def _pull_up(case: FlightCase, request: ManeuverRequest) -> _Plan:
    still = case.trim.state()["load_factor"]

    def hand() -> Pilot:
        return case.load_factor_pilot(lambda time: still + (request.load_factor - 1) * _ramp(time))

    label = f"pull-up to {request.load_factor:.3g} g"
    return _Plan(hand, _BEGINS_S + 2 * _RAMP_S, partial(_held_load_factor, case), label=label)


def _wind_up_turn(case: FlightCase, request: ManeuverRequest) -> _Plan:
    """The bank that carries the weight at the load factor, by the ailerons."""
    still = case.trim.state()["load_factor"]

    def wound(time_s: float) -> float:
        return (request.load_factor - 1) * _ramp(time_s, lasts_s=_TURN_S)

    def measured(flown: Flown) -> _Numbers:
        return _held_load_factor(case, flown) | {"bank": (ANGLE, float(flown.states["bank"][_LAST].mean()))}

    return _Plan(
        lambda: case.load_factor_pilot(lambda time: still + wound(time)),
        _BEGINS_S + _TURN_S + _RAMP_S,
        measured,
        bank_rad=lambda time: acos(1 / (1 + wound(time))),
        label=f"wind-up turn to {request.load_factor:.3g} g",
    )


def _held_load_factor(case: FlightCase, flown: Flown) -> _Numbers:
    """Means of the last half second."""
    load_factor = flown.states["load_factor"]
    force, held = float(flown.force_n[_LAST].mean()), float(load_factor[_LAST].mean())
    gained = held - float(load_factor[0])
    per_g = {"force per g": (FORCE, -force / gained)} if gained > _LEAST_GAINED else {}
    return per_g | {
        "force": (FORCE, force),
        "force of the programmed feel in the same states": (FORCE, case.feel_n(flown, _LAST)),
        "load factor": (LOAD_FACTOR, held),
        "calibrated airspeed at the end": (AIRSPEED, float(flown.states["calibrated_airspeed"][-1])),
    }


def _release(case: FlightCase, request: ManeuverRequest) -> _Plan:
    """A hand holds another speed, at the throttle of the trimmed flight, and lets go slowly."""
    held = case.trimmed_force_n(request.off_trim * case.speed_m_per_s)

    def measured(flown: Flown) -> _Numbers:
        speed = flown.states["calibrated_airspeed"]
        after = slice(round((_BEGINS_S + _RAMP_S) / FRAME_S), None)
        returned = return_speed(flown.time_s[after], speed[after])
        return {
            "speed when released": (AIRSPEED, float(speed[round(_BEGINS_S / FRAME_S)])),
            "speed of return": (AIRSPEED, returned),
            "off the trim speed": (RATIO, returned / case.speed_m_per_s - 1),
        }

    return _Plan(
        lambda: lambda time, _: held * (1 - _ramp(time)),
        _BEGINS_S + _RAMP_S + _RETURN_PERIODS * _swing_s(case),
        measured,
        lambda _, aircraft: aircraft.set_throttle(case.trim.throttle),
        request.off_trim,
        label=f"release from {100 * request.off_trim:.3g} % of the trim speed",
    )


def _pulsed(case: FlightCase, lasts_s: float, measured: Callable[[Flown], _Numbers]) -> _Plan:
    """A pull of a tenth of a load factor, then hands off."""
    force = _PULSE_G * case.force_per_g_n
    return _Plan(lambda: lambda time, _: force if time < _PULSE_S else 0.0, lasts_s, measured)


def _phugoid(case: FlightCase, request: ManeuverRequest) -> _Plan:
    swing = _swing_s(case)

    def measured(flown: Flown) -> _Numbers:
        every = round(swing / 60 / FRAME_S)
        speed = flown.states["true_airspeed"][round(3 * _PULSE_S / FRAME_S) :]
        blocks = speed[: len(speed) // every * every].reshape(-1, every).mean(axis=1)
        modes = free_modes((blocks - blocks[-1])[None], every * FRAME_S, 4)
        near = [mode for mode in modes if 0.3 < mode.frequency_rad_per_s * swing / (2 * pi) < 3]
        if not near:
            return {}
        mode = max(near, key=lambda mode: mode.frequency_rad_per_s)
        return {
            "period": (SECONDS, 2 * pi / mode.imaginary_per_s),
            "damping ratio": (RATIO, mode.damping_ratio),
        }

    return _pulsed(case, 3 * _PULSE_S + _PERIODS * swing, measured)


def _short_period(case: FlightCase, request: ManeuverRequest) -> _Plan:
    def measured(flown: Flown) -> _Numbers:
        rows = flown.states
        return {
            "largest pitch rate": (ANGULAR_VELOCITY, float(np.abs(rows["pitch_rate"]).max())),
            "largest load factor": (LOAD_FACTOR, float(rows["load_factor"].max())),
            "smallest load factor": (LOAD_FACTOR, float(rows["load_factor"].min())),
            **_quick_modes(flown),
        }

    return _pulsed(case, _SHORT_S, measured)


def _quick_modes(flown: Flown) -> _Numbers:
    """Short period and column after the pulse, slower first; none where friction kept the column from moving."""
    rows = [flown.angle_rad, *(flown.states[name] for name in ("pitch_rate", "load_factor", "angle_of_attack"))]
    if np.ptp(flown.angle_rad) < _STUCK_RAD:
        return {}
    every, begin = round(_QUICK_STEP_S / FRAME_S), round((_PULSE_S + 10 * FRAME_S) / FRAME_S)
    modes = free_modes(np.array([row - row[0] for row in rows])[:, begin::every], every * FRAME_S, _QUICK_ORDER)
    numbers: _Numbers = {}
    for k, mode in enumerate((mode for mode in modes if mode.frequency_rad_per_s > _QUICK_RAD_PER_S), 1):
        numbers[f"frequency of mode {k}"] = (HERTZ, mode.frequency_rad_per_s)
        numbers[f"damping ratio of mode {k}"] = (RATIO, mode.damping_ratio)
    return numbers


def _lever(case: FlightCase, request: ManeuverRequest, *, lever: str) -> _Plan:
    """Hands off while throttle, flaps or speed brake move, or the gear goes up.

    Raises:
        InputError: If JSBSim's aircraft has none that moves.
    """
    if lever in case.without:
        raise InputError(
            f"aircraft: JSBSim's {case.aircraft} has no {lever.replace('-', ' ')} that a lever moves; take another maneuver"
        )
    throttle, lasts_s = case.trim.throttle, _CALM_S + _CHANGE_S + _AFTER_S

    def levers(time_s: float, aircraft: Aircraft) -> None:
        moved = _ramp(time_s, _CALM_S, _CHANGE_S)
        if lever == "flaps":
            aircraft.set_flaps(_FLAPS * moved)
        elif lever == "gear":
            aircraft.set_gear(1 - moved)
        elif lever == "speed-brake":
            aircraft.set_speed_brake(moved - _ramp(time_s, lasts_s, _CHANGE_S))
        else:
            aircraft.set_throttle(throttle + (1 - throttle) * moved)

    def measured(flown: Flown) -> _Numbers:
        changes = {name: flown.states[name] - flown.states[name][0] for name in CHANGED}
        return {
            f"largest change of {name.replace('_', ' ')}": (unit, float(max(changes[name], key=abs)))
            for name, unit in CHANGED.items()
        }

    label = {
        "power": "full power",
        "flaps": f"flaps to {100 * _FLAPS:g} %",
        "gear": "gear up",
        "speed-brake": "speed brake out and in",
    }[lever]
    if lever == "speed-brake":  # its retraction is recorded, too
        return _Plan(lambda: lambda *_: 0.0, lasts_s + _CHANGE_S + _AFTER_S, measured, levers, label=label)
    return _Plan(lambda: lambda *_: 0.0, lasts_s, measured, levers, label=label)


def _stall(case: FlightCase, request: ManeuverRequest) -> _Plan:
    """Level flight with idle power: the speed falls, the pull grows, until the wing no longer carries."""
    gain = _PATH_RAD_PER_S * case.force_per_g_n * case.trim.state()["true_airspeed"] / GRAVITY

    def measured(flown: Flown) -> _Numbers:
        slowest = int(np.argmin(flown.states["calibrated_airspeed"]))
        return {
            "smallest calibrated airspeed": (AIRSPEED, float(flown.states["calibrated_airspeed"][slowest])),
            "largest pull": (FORCE, -float(flown.force_n.min())),
            "largest column angle": (ANGLE, float(np.abs(flown.angle_rad).max())),
            "largest angle of attack": (ANGLE, float(flown.states["angle_of_attack"].max())),
        }

    return _Plan(
        lambda: CrossoverPilot(lambda _, seen: -seen["climb_angle"], gain, _PATH_LEAD_S, _PATH_INTEGRAL_S),
        _STALL_PERIODS * _swing_s(case),
        measured,
        lambda time, aircraft: aircraft.set_throttle(case.trim.throttle * (1 - _ramp(time))),
        ends=lambda seen: seen["climb_angle"] < -_SINKS_RAD,
        label="stall in level flight, power idle",
    )


def _rate(case: FlightCase, request: ManeuverRequest) -> _Plan:
    """The force that would hold a share of the travel in the trimmed flight; the other controls stay."""
    rate, (share, words) = f"{case.axis}_rate", _TRAVELS[case.axis]
    force = held_force(case.feel, case.trim.state(), share * case.trim.travel_rad)

    def measured(flown: Flown) -> _Numbers:
        rates = flown.states[rate]
        return {
            f"largest {case.axis} rate": (ANGULAR_VELOCITY, float(max(rates, key=abs))),
            f"{case.axis} rate": (ANGULAR_VELOCITY, float(rates[_LAST].mean())),
            **_held_control(case, flown, _LAST),
        }

    return _Plan(
        lambda: lambda time, _: force * _ramp(time, lasts_s=_QUICK_S),
        _BEGINS_S + _QUICK_S + _ROLLS_S,
        measured,
        label=f"{case.axis} rate with the force of {words} of the travel",
    )


def _held_control(case: FlightCase, flown: Flown, window: slice) -> _Numbers:
    return {
        "control angle": (ANGLE, float(flown.angle_rad[window].mean())),
        "force": (FORCE, float(flown.force_n[window].mean())),
        "force of the programmed feel in the same states": (FORCE, case.feel_n(flown, window)),
    }


def _sideslip(case: FlightCase, request: ManeuverRequest) -> _Plan:
    """From level flight into a sideslip that JSBSim trims: its force at this control, the others as it has them.

    The wheel holds the bank: that of the loader, by a pilot, or the ailerons' own.
    """
    end = case.at(sideslip_rad=request.sideslip_rad)
    force = trimmed_force(case.feel, case.trim, end)
    banks = [trim.attitude()["bank"] for trim in (case.trim, end)]

    def moved(time_s: float) -> float:
        return _ramp(time_s, lasts_s=_SLIP_RAMP_S)

    def hand() -> Pilot:
        if case.axis == "yaw":
            return lambda time, _: force * moved(time)
        return CrossoverPilot(
            lambda time, seen: banks[0] + (banks[1] - banks[0]) * moved(time) - seen["bank"],
            _BANK_RAD_PER_S * case.force_per_roll_rate_n,
            _BANK_LEAD_S,
            _BANK_INTEGRAL_S,
            lambda time: force * moved(time),
        )

    def measured(flown: Flown) -> _Numbers:
        angles = {name: (ANGLE, float(flown.states[name][_MEAN].mean())) for name in ("sideslip", "bank")}
        return angles | _held_control(case, flown, _MEAN)

    return _Plan(
        hand,
        _BEGINS_S + _SLIPS_S,
        measured,
        lambda time, aircraft: aircraft.lead(case.trim, end, moved(time)),
        label=f"steady sideslip of {degrees(request.sideslip_rad):.3g} deg",
    )


_AXES: dict[str, tuple[str, ...]] = {"roll-rate": ("roll",), "yaw-rate": ("yaw",), "sideslip": ("roll", "yaw")}
"""Axes of a maneuver that is not of pitch."""

MANEUVERS: dict[str, Callable[[FlightCase, ManeuverRequest], _Plan]] = {
    "pull-up": _pull_up,
    "wind-up-turn": _wind_up_turn,
    "release": _release,
    "phugoid": _phugoid,
    "short-period": _short_period,
    "power": partial(_lever, lever="power"),
    "flaps": partial(_lever, lever="flaps"),
    "gear": partial(_lever, lever="gear"),
    "speed-brake": partial(_lever, lever="speed-brake"),
    "stall": _stall,
    "roll-rate": _rate,
    "yaw-rate": _rate,
    "sideslip": _sideslip,
}
