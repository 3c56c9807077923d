"""The nonlinear loader written out by hand in U.S. units (lb, in, s, mA, V, rad) and solved to tight tolerance.

The tests' independent witness of the simulation: the equations from the 1974 report and the specification of the nonlinear
effects alone, nothing from ``forcefeel``. What is discontinuous or set-valued is a mode with a guard; a guard that turns
negative is an event, located within the step, and the solver starts anew behind it:

- dry friction of column and feel: the rate is exactly zero while stuck,
- dry friction of the piston's seals: what pushes the piston, less at most that friction, is the link damper's,
- stops (a damper that comes in with speed), hard stop and velocity limit of the feel, the hysteresis' slider,
- backlash: in the gap A p = 0 and x_p' = q / A, in contact p is a state,
- clamps of current, commanded flow and relief, and the sign of q_i: each branch is smooth inside a step,
- jumps of the inputs and samples of the controller: ends of a piece.

Kinks of the feel's springs (curve's knots, deadband, breakout, detent) and |q_i| sqrt|r| at r = 0 are left to the step control.

`x_p` piston · `p` load pressure · `q_i` no-load flow · `theta` column angle · `delta` programmed displacement ·
`phi` = delta / lambda · `s` stretch of the link or slider of the hysteresis · `M` torque on the column without dry friction ·
`N` torque on the feel's inertia without dry friction · `e` amplifier input · `T` torque that the feel computer sees
"""

import math
from bisect import bisect_right
from collections import deque
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau, cumulative_simpson
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

INF = math.inf
GRAVITY = 9.80665 / 0.0254  # in/s^2, makes lb s^2/in of lbm
METHODS = {"DOP853": DOP853, "LSODA": LSODA, "Radau": Radau}

VIOLATED = -1e-13
"""A guard counts as negative below this; guards are of order one, so it is rounding."""

MOST_STEPS = 400_000
"""Of one run; two seconds of the elevator loader take some 10 000."""

STATES = ("x_p", "p", "q_i", "q_i_rate", "theta", "theta_rate", "load_cell", "potentiometer", "column_sensor")
FEEL_STATES = ("delta", "delta_rate")
SCALES = (1.0, 100.0, 10.0, 1e3, 0.1, 1.0, 100.0, 1.0, 0.1, 10.0, 10.0)
"""Size of each state, the lags in lb, in, rad: absolute tolerances are in proportion."""

COLUMNS = (
    "time_s",
    "theta",
    "theta_rate",
    "delta",
    "delta_rate",
    "x_p",
    "p",
    "q_i",
    "q_i_rate",
    "flow",
    "current",
    "link_force",
    "feel_force",
    "slider",
    "e",
    "force",
    "load_cell",
    "potentiometer",
    "column_sensor",
)
"""What `simulate` returns. ``feel_force``: springs, preload, detent, hysteresis and soft stops of the feel, lb at the grip.
The last three: the sensors' lags, without offset; zero where the bandwidth is infinite."""


@dataclass(frozen=True, kw_only=True)
class Machine:
    """Numbers of one loader; the defaults are the elevator loader's, every effect off. Angles in rad, grip forces in lb."""

    area: float = 2.36
    link_damping: float = 16.2016
    link_stiffness: float = 6107.86
    current_gain: float = 5.45
    pressure_gain: float = 0.0102
    maximum_stiffness: float = 28800.0
    column_inertia: float = 37.4
    load_cell_gain: float = 0.005
    admittance: float = 1.56
    potentiometer_gain: float = 7.632
    base_arm: float = 10.0
    grip_arm: float = 31.375
    oil_volume: float = 11.7
    ratio: float = 0.59
    bulk_modulus: float = 250000.0
    valve_damping_ratio: float = 0.9
    valve_frequency: float = 377.0
    rated_flow: float = 100.0
    rated_current: float = 15.0
    supply_pressure: float = 1200.0
    feel_inertia: float = 60.0
    feel_damping: float = 304.0
    feel_stiffness: float = 9600.0

    gains: tuple[float, ...] | None = None
    """c_1 .. c_7 on [x_p, p, delta, delta', x_b, x_b', F_p], V; None: the original loop, delta in V."""

    current_limit: float = INF
    orifice: bool = False
    orifice_smoothing: float = 0.0
    """Not of the machine: |r| below which the root is smoothed, 1e-8 for a stall (p resting at p_s), with LSODA or Radau."""
    flow_limit: float = INF
    relief_pressure: float = INF
    relief_gain: float = 1.0
    backlash: float = 0.0
    seal_friction: float = 0.0

    arm_mass: float = 0.0  # lbm
    arm_damping: float = 0.0  # lb s/in
    arm_stiffness: float = 0.0  # lb/in
    viscous_friction: float = 0.0
    gravity_torque: float = 0.0
    gravity_angle: float = 0.0
    stop_low: float = -INF
    stop_high: float = INF
    stop_stiffness: float = 500000.0
    stop_damping: float = 1000.0
    coulomb_friction: float = 0.0
    static_friction: float = 0.0
    stribeck_velocity: float = 0.0
    friction_asymmetry: float = 0.0

    feel_curve: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    """(angles, forces at the grip)."""
    feel_deadband: float = 0.0
    feel_q: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    """(dynamic pressures, factors on the spring), linear between, constant beyond."""
    feel_breakout: float = 0.0
    feel_breakout_travel: float = math.radians(0.1)
    feel_preload: float = 0.0
    feel_detent_force: float = 0.0
    feel_detent_angle: float = 0.0
    feel_detent_travel: float = math.radians(1.0)
    feel_hysteresis: float = 0.0
    feel_hysteresis_travel: float = math.radians(0.2)
    feel_coulomb_friction: float = 0.0
    feel_static_friction: float = 0.0
    feel_quadratic_damping: float = 0.0
    feel_soft_stop_low: float = -INF
    feel_soft_stop_high: float = INF
    feel_soft_stop_stiffness: float = 50000.0
    feel_soft_stop_damping: float = 0.0
    feel_hard_stop_low: float = -INF
    feel_hard_stop_high: float = INF
    feel_velocity_limit: float = INF
    feel_trim_rate: float = INF
    feel_shaker_force: float = 0.0
    feel_shaker_frequency: float = 20.0  # Hz

    load_cell_offset: float = 0.0  # lb
    load_cell_resolution: float = 0.0
    load_cell_bandwidth: float = INF  # rad/s, as the next two
    potentiometer_offset: float = 0.0  # in
    potentiometer_resolution: float = 0.0
    potentiometer_bandwidth: float = INF
    column_sensor_offset: float = 0.0  # rad
    column_sensor_resolution: float = 0.0
    column_sensor_bandwidth: float = INF

    period: float = 0.0
    """Period of the digital controller; 0: analog."""
    delay: float = 0.0
    input_range: float = INF
    input_bits: int = 0
    output_range: float = INF
    output_bits: int = 0
    antiwindup: float = 0.0

    @property
    def law(self):
        """c_1 .. c_7."""
        return (-self.potentiometer_gain, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0) if self.gains is None else self.gains

    @property
    def load_cell_arm(self):
        """Torque T that the feel computer sees is minus this times A p."""
        return self.maximum_stiffness * self.load_cell_gain if self.gains is None else self.ratio * self.base_arm

    @property
    def volts_per_angle(self):
        """lambda: the column angle of the feel is delta / lambda."""
        return self.potentiometer_gain * self.ratio * self.base_arm if self.gains is None else 1.0

    @property
    def torque_scale(self):
        """What a torque at the column is multiplied by in the feel's equation."""
        return self.load_cell_arm / (self.ratio * self.base_arm)


@dataclass(frozen=True)
class Signals:
    """Inputs besides the pilot's force, each as `Signal` takes it; the trim command as steps only, angles in rad."""

    trim: object = ()
    dynamic_pressure: object = ()
    shaker: object = ()
    test_signal: object = ()
    """V at the amplifier, on what the controller gives, as it runs."""


@dataclass(frozen=True)
class Solver:
    """How the pieces are solved; absolute tolerances are ``rtol / 10`` of each state's size."""

    method: str = "DOP853"
    rtol: float = 1e-10
    events: list | None = None
    """A list to be filled with (time, name) of what happened."""


class Signal:
    """A time function: steps ``[(time, value), ...]``, zero before the first, or ``(function, [times of its jumps])``."""

    def __init__(self, given):
        self.function, self.breaks, self.values = None, [], []
        if len(given) == 2 and callable(given[0]):
            self.function, self.breaks = given[0], sorted(given[1])
        elif len(given):
            self.breaks, self.values = (list(column) for column in zip(*sorted(given), strict=True))

    def over(self, start, end):
        """Function of time on a piece without jumps inside; one-sided at both of its ends."""
        if self.function is not None:
            low, high = math.nextafter(start, end), math.nextafter(end, start)
            return lambda t: self.function(min(max(t, low), high))
        index = bisect_right(self.breaks, 0.5 * (start + end))
        value = float(self.values[index - 1]) if index else 0.0
        return lambda _: value


class Trim(Signal):
    """The neutral that follows the steps of the trim command at no more than the rate; it starts at the command."""

    def __init__(self, steps, rate):
        super().__init__(steps)
        self.rate, self.knots, self.neutrals = rate, [], []
        if rate == INF or not self.breaks:
            return
        time, neutral = 0.0, self.values[0] if self.breaks[0] <= 0 else 0.0
        for step, (start, target) in enumerate(zip(self.breaks, self.values, strict=True)):
            end = self.breaks[step + 1] if step + 1 < len(self.breaks) else INF
            time = max(start, 0.0)
            arrival = time + abs(target - neutral) / rate
            self.knots.append(time)
            self.neutrals.append(neutral)
            neutral += math.copysign(min(arrival, end) - time, target - neutral) * rate
            self.knots.append(min(arrival, end))
            self.neutrals.append(neutral)
        self.breaks = self.knots

    def over(self, start, end):
        if self.knots:
            return lambda t: float(np.interp(t, self.knots, self.neutrals))
        return super().over(start, end)


def _clamp(x, limit):
    return min(max(x, -limit), limit)


def _sign(x):
    return int(x > 0) - int(x < 0)


class Band:
    """Three smooth regions of a variable: within +-limit and beyond on either side."""

    def __init__(self, limit):
        self.limit, self.region = limit, 0
        self.scale = limit if 0 < limit < INF else 1.0

    def settle(self, x):
        self.region = 0 if abs(x) <= self.limit else _sign(x)

    def cross(self, x):
        self.region = 0 if self.region else _sign(x)

    def guard(self, x):
        return ((self.limit - abs(x)) if self.region == 0 else (self.region * x - self.limit)) / self.scale

    def clamp(self, x):
        return self.region * self.limit if self.region else x

    def excess(self, x):
        return x - self.region * self.limit if self.region else 0.0


class Stops:
    """Two one-sided spring-dampers that never pull; the damper comes in at contact."""

    def __init__(self, low, high, stiffness, damping):
        self.low, self.high, self.stiffness, self.damping = low, high, stiffness, damping
        self.region = 0

    def depth(self, angle, rate, side):
        """Positive where the stop of that side pushes; its torque over its stiffness or the depth, whichever is less."""
        into = angle - self.high if side > 0 else self.low - angle
        return min(into, into + self.damping / self.stiffness * side * rate) if self.stiffness else -INF

    def settle(self, angle, rate):
        self.region = next((side for side in (1, -1) if self.depth(angle, rate, side) > 0), 0)

    def guard(self, angle, rate):
        if self.region:
            return self.depth(angle, rate, self.region)
        return -max(self.depth(angle, rate, 1), self.depth(angle, rate, -1))

    def torque(self, angle, rate):
        """What the stop takes from the torque on the shaft."""
        if not self.region:
            return 0.0
        return self.stiffness * (angle - (self.high if self.region > 0 else self.low)) + self.damping * rate


class Plant:
    """Valve, actuator, link and column under a given amplifier input; states `STATES`."""

    size = len(STATES)

    def __init__(self, machine):
        m = self.m = machine
        self.force = self.test_signal = lambda _: 0.0
        self.current, self.command, self.relief = Band(m.current_limit), Band(m.flow_limit), Band(m.relief_pressure)
        self.flow_sign = 1
        self.stops = Stops(m.stop_low, m.stop_high, m.stop_stiffness, m.stop_damping)
        self.inertia = m.column_inertia + m.arm_mass / GRAVITY * m.grip_arm**2
        self.coulomb = m.grip_arm * m.coulomb_friction
        self.breakaway = m.grip_arm * max(m.static_friction, m.coulomb_friction)
        self.seals = Band(m.seal_friction)
        self.motion = None if self.breakaway == 0 else 0
        self.contact = None if m.backlash == 0 else 0
        self.gap = 0.5 * m.backlash
        self.spring, self.damper = m.link_stiffness, m.link_damping
        self.lever = m.ratio * m.base_arm
        self.viscous = m.viscous_friction + m.grip_arm**2 * m.arm_damping
        self.arm_spring = m.grip_arm**2 * m.arm_stiffness
        self.gain = m.rated_flow / m.rated_current if m.orifice else m.current_gain
        self.bandwidths = [
            0.0 if w == INF else w
            for w in (m.load_cell_bandwidth, m.potentiometer_bandwidth, m.column_sensor_bandwidth)
        ]

    def flow(self, q_i, p):
        """Flow q into the actuator."""
        m = self.m
        if not m.orifice:
            return q_i - m.pressure_gain * p  # eq. (4)
        r = 1.0 - self.flow_sign * p / m.supply_pressure
        if m.orifice_smoothing:
            return q_i * r / (r * r + m.orifice_smoothing**2) ** 0.25
        return q_i * math.copysign(math.sqrt(abs(r)), r)  # eq. (1) in four quadrants

    def current_at(self, e):
        """Current i that the amplifier gives."""
        return _clamp(self.m.admittance * e, self.m.current_limit)

    def stretch(self, x_p, theta):
        """Stretch of the link's spring on the side that touches."""
        s = x_p - self.lever * theta
        return s if self.contact is None else s - self.contact * self.gap

    def piston_rate(self, y):
        if self.contact == 0:
            return y[2] / self.m.area  # the gap: p = 0, q = q_i
        # A p = k s + c s' + what the seals take                                                           eq. (9)
        push = self.push(y)
        return (self.seals.excess(push) if self.m.seal_friction else push) / self.damper

    def push(self, y):
        """What pushes the massless piston against its seals: the link's force at rest of the piston taken off."""
        return self.m.area * y[1] - self.spring * self.stretch(y[0], y[4]) + self.damper * self.lever * y[5]

    def link_force(self, y):
        """F_c, which the load cell shows."""
        rubbed = self.seals.clamp(self.push(y)) if self.m.seal_friction and self.contact != 0 else 0.0
        return self.m.area * y[1] - rubbed

    def level(self, way, rate):
        """Torque of the dry friction of a column that moves that way."""
        m, over = self.m, self.breakaway - self.coulomb
        fall = math.exp(-((rate / m.stribeck_velocity) ** 2)) if m.stribeck_velocity else 0.0
        return (self.coulomb + over * fall) * (1.0 + way * m.friction_asymmetry)

    def held(self, torque):
        """Largest torque that friction holds that way."""
        return self.breakaway * (1.0 + _sign(torque) * self.m.friction_asymmetry)

    def torque(self, t, y):
        """M: torque on the column without dry friction."""
        m, theta, rate = self.m, y[4], y[5]
        torque = m.grip_arm * self.force(t) + self.lever * self.link_force(y) - self.viscous * rate
        torque -= self.arm_spring * theta
        if m.gravity_torque:
            torque += m.gravity_torque * math.sin(m.gravity_angle + theta)
        return torque - self.stops.torque(theta, rate)

    def derivative(self, t, y, e):
        m = self.m
        p, q_i, q_i_rate, theta, rate = y[1:6]
        x_p_rate = self.piston_rate(y)
        command = self.command.clamp(self.gain * self.current.clamp(m.admittance * e))
        if self.contact == 0:
            p_rate = 0.0
        else:
            flow = self.flow(q_i, p) - m.relief_gain * self.relief.excess(p)
            p_rate = 4.0 * m.bulk_modulus / m.oil_volume * (flow - m.area * x_p_rate)
        acceleration = 0.0
        if self.motion is None:
            acceleration = self.torque(t, y) / self.inertia
        elif self.motion:
            acceleration = (self.torque(t, y) - self.motion * self.level(self.motion, rate)) / self.inertia
        w_n = m.valve_frequency
        return [
            x_p_rate,
            p_rate,
            q_i_rate,
            w_n * w_n * (command - q_i) - 2.0 * m.valve_damping_ratio * w_n * q_i_rate,
            rate,
            acceleration,
            self.bandwidths[0] * (self.link_force(y) - y[6]),
            self.bandwidths[1] * (y[0] - y[7]),
            self.bandwidths[2] * (theta - y[8]),
        ]

    def measured(self, y):
        """F_c, x_p, theta and theta' as the sensors give them, offsets and lags in."""
        m = self.m
        force, piston, column = self.bandwidths
        return (
            (y[6] if force else self.link_force(y)) + m.load_cell_offset,
            (y[7] if piston else y[0]) + m.potentiometer_offset,
            (y[8] if column else y[4]) + m.column_sensor_offset,
            column * (y[4] - y[8]) if column else y[5],
        )

    # Modes

    def settle(self, t, y, e):
        """Modes that fit the state, at the start of a piece."""
        m = self.m
        self.current.settle(m.admittance * e)
        self.command.settle(self.gain * self.current.clamp(m.admittance * e))
        self.relief.settle(y[1])
        self.flow_sign = -1 if y[2] < 0 else 1
        self.seals.settle(self.push(y))
        self.stops.settle(y[4], y[5])
        if self.contact is not None and y[1] != 0:
            self.contact = _sign(y[1])
        if self.motion is not None:
            self._settle_motion(t, y)

    def _settle_motion(self, t, y):
        if y[5] == 0:
            torque = self.torque(t, y)
            self.motion = 0 if abs(torque) <= self.held(torque) else _sign(torque)
        else:
            self.motion = _sign(y[5])

    def guards(self, t, y, e):
        """(name, value, what happens when it turns negative) of every mode."""
        m, found = self.m, []
        if self.current.limit < INF:
            i = m.admittance * e
            found.append(("current", self.current.guard(i), lambda _, __: self.current.cross(i)))
        if self.command.limit < INF:
            q = self.gain * self.current.clamp(m.admittance * e)
            found.append(("flow", self.command.guard(q), lambda _, __: self.command.cross(q)))
        if self.relief.limit < INF:
            found.append(("relief", self.relief.guard(y[1]), lambda _, y: self.relief.cross(y[1])))
        if m.seal_friction and self.contact != 0:
            found.append(("seals", self.seals.guard(self.push(y)), lambda _, y: self.seals.cross(self.push(y))))
        if m.orifice:
            found.append(("sign of q_i", self.flow_sign * y[2], self._turn_flow))
        if self.stops.high < INF or self.stops.low > -INF:
            found.append(("stop", self.stops.guard(y[4], y[5]), self._toggle_stop))
        if self.contact is not None:
            found.append(("contact", self._contact_guard(y), self._toggle_contact))
        if self.motion is not None:
            if self.motion == 0:
                torque = self.torque(t, y)
                found.append(("break-away", 1.0 - abs(torque) / self.held(torque), self._break_away))
            else:
                found.append(("rest", self.motion * y[5], self._stop))
        return found

    def _turn_flow(self, _, __):
        self.flow_sign = -self.flow_sign

    def _toggle_stop(self, _, y):
        touching = 1 if self.stops.depth(y[4], y[5], 1) > self.stops.depth(y[4], y[5], -1) else -1
        self.stops.region = 0 if self.stops.region else touching

    def _touch(self, y, side):
        """Positive where the link pushes on that side: stretched beyond the gap, k (s - g) + c s' > 0."""
        s = side * (y[0] - self.lever * y[4]) - self.gap
        s_rate = side * (y[2] / self.m.area - self.lever * y[5])
        return min(s, s + self.damper / self.spring * s_rate)

    def _contact_guard(self, y):
        if self.contact:
            return self.contact * y[1]
        return -max(self._touch(y, 1), self._touch(y, -1))

    def _toggle_contact(self, _, y):
        y[1] = 0.0
        touching = 1 if self._touch(y, 1) > self._touch(y, -1) else -1
        self.contact = 0 if self.contact else touching

    def _break_away(self, t, y):
        self.motion = _sign(self.torque(t, y))

    def _stop(self, t, y):
        y[5] = 0.0
        self._settle_motion(t, y)


class Feel:
    """The programmed control under a given torque T; states `FEEL_STATES`."""

    size = len(FEEL_STATES)

    def __init__(self, machine):
        m = self.m = machine
        self.neutral = self.shaker = self.dynamic_pressure = lambda _: 0.0
        self.drift = self.slowing = 0.0
        self.per_angle, self.scale = m.volts_per_angle, m.torque_scale
        self.per_force = self.scale * m.grip_arm
        self.coulomb = self.per_force * m.feel_coulomb_friction
        self.breakaway = self.per_force * max(m.feel_static_friction, m.feel_coulomb_friction)
        self.rubs = self.breakaway > 0
        self.motion = None  # direction, 0 while held; None: free to move either way
        self.wall = 0  # hard stop that is touched
        self.capped = 0  # direction in which the velocity limit holds
        self.hysteresis = Band(1.0)
        self.slider = 0.0
        self.stops = Stops(
            m.feel_soft_stop_low, m.feel_soft_stop_high, m.feel_soft_stop_stiffness, m.feel_soft_stop_damping
        )
        self.curve = None if m.feel_curve is None else _pchip(*m.feel_curve)

    def spring(self, t, x):
        """Torque of the spring at x from neutral."""
        m = self.m
        u = x - _clamp(x, m.feel_deadband) if m.feel_deadband else x
        torque = m.feel_stiffness * self.per_angle * u if self.curve is None else self.per_force * self.curve(u)
        return torque if m.feel_q is None else torque * float(np.interp(self.dynamic_pressure(t), *m.feel_q))

    def load(self, t, delta, rate):
        """Torque of springs, preload, detent, hysteresis and soft stops, against positive angles."""
        m, phi = self.m, delta / self.per_angle
        x = phi - self.neutral(t)
        torque = self.spring(t, x) + self.per_force * m.feel_preload
        if m.feel_breakout:
            torque += self.per_force * m.feel_breakout * _clamp(x / m.feel_breakout_travel, 1.0)
        if m.feel_detent_force:
            u = (phi - m.feel_detent_angle) / m.feel_detent_travel
            torque += self.per_force * m.feel_detent_force * _sign(u) * max(0.0, min(abs(u), 2.0 - abs(u)))
        if m.feel_hysteresis:
            u = (phi - self.slider) / m.feel_hysteresis_travel
            torque += self.per_force * m.feel_hysteresis * (self.hysteresis.region or u)
        return torque + self.scale * self.stops.torque(phi, rate / self.per_angle)

    def torque(self, t, y, given):
        """N: torque on the inertia without dry friction, ``given`` being T."""
        m = self.m
        delta, rate = y
        torque = given - m.feel_damping * rate - self.load(t, delta, rate)
        if m.feel_quadratic_damping:
            phi_rate = rate / self.per_angle
            torque -= self.scale * m.feel_quadratic_damping * phi_rate * abs(phi_rate)
        return torque

    def shake(self, t):
        """Torque of the stick shaker."""
        m = self.m
        if not m.feel_shaker_force:
            return 0.0
        return (
            self.per_force * m.feel_shaker_force * math.sin(2 * math.pi * m.feel_shaker_frequency * t) * self.shaker(t)
        )

    def friction(self):
        return (self.motion or 0) * self.coulomb

    def derivative(self, t, y, given):
        rate = y[1]
        if self.motion == 0:
            return [0.0 if self.wall else self.drift, 0.0]
        if self.capped:
            return [rate + self.drift, 0.0]
        return [rate + self.drift, (self.torque(t, y, given) - self.friction()) / self.m.feel_inertia + self.slowing]

    # Modes

    def settle(self, t, y, given):
        """Modes that fit the state, at the start of a piece; brings the state within hard stops and velocity limit."""
        m, phi = self.m, y[0] / self.per_angle
        self.wall = 1 if phi >= m.feel_hard_stop_high - 1e-12 else -1 if phi <= m.feel_hard_stop_low + 1e-12 else 0
        if self.wall:
            y[0] = self.per_angle * (m.feel_hard_stop_high if self.wall > 0 else m.feel_hard_stop_low)
            if self.wall * y[1] >= 0:
                y[1] = 0.0
            else:
                self.wall = 0
        limit = m.feel_velocity_limit * self.per_angle
        self.capped = _sign(y[1]) if abs(y[1]) >= limit else 0
        if self.capped:
            y[1] = self.capped * limit
        self.stops.settle(y[0] / self.per_angle, y[1] / self.per_angle)
        self._settle_motion(t, y, given)
        if self.capped and self.capped * (self.torque(t, y, given) - self.friction()) < 0:
            self.capped = 0

    def _settle_motion(self, t, y, given):
        self.motion = _sign(y[1]) if self.rubs else None
        if y[1] == 0 and (self.rubs or self.wall):
            torque = self.torque(t, y, given)
            held = abs(torque) <= self.breakaway or self.wall * torque > 0
            self.motion = 0 if held else self._leave(torque)
            if not held:
                self.wall = 0

    def _leave(self, torque):
        return _sign(torque) if self.rubs else None

    def guards(self, t, y, given):
        """(name, value, what happens when it turns negative) of every mode."""
        m, found = self.m, []
        phi = y[0] / self.per_angle
        if self.motion == 0:
            torque = self.torque(t, y, given)
            up = INF if self.wall > 0 else self.breakaway - torque
            down = INF if self.wall < 0 else self.breakaway + torque
            value = min(up, down) / (self.breakaway or self.per_force)
            found.append(("feel break-away", value, lambda _, __: self._release(torque)))
        else:
            found += self._motion_guards(t, y, given)
        if m.feel_hysteresis:
            found.append(self._hysteresis_guard(phi, y[1] + self.drift))
        if self.stops.high < INF or self.stops.low > -INF:
            found.append(("soft stop", self.stops.guard(phi, y[1] / self.per_angle), self._toggle_stop))
        return found

    def _release(self, torque):
        self.motion, self.wall = self._leave(torque), 0

    def _motion_guards(self, t, y, given):
        m, found = self.m, []
        phi = y[0] / self.per_angle
        if self.rubs:
            found.append(("feel rest", self.motion * y[1], lambda t, y: self._halt(t, y, given)))
        if m.feel_hard_stop_high < INF:
            found.append(("hard stop", m.feel_hard_stop_high - phi, lambda t, y: self._hit(t, y, given, 1)))
        if m.feel_hard_stop_low > -INF:
            found.append(("hard stop", phi - m.feel_hard_stop_low, lambda t, y: self._hit(t, y, given, -1)))
        limit = m.feel_velocity_limit * self.per_angle
        if self.capped:
            net = self.capped * (self.torque(t, y, given) - self.friction())
            found.append(("slower", net / self.per_force, self._uncap))
        elif limit < INF:
            found.append(("velocity limit", 1.0 - abs(y[1]) / limit, self._cap))
        return found

    def _halt(self, t, y, given):
        y[1] = 0.0
        self._settle_motion(t, y, given)

    def _hit(self, t, y, given, side):
        y[0] = self.per_angle * (self.m.feel_hard_stop_high if side > 0 else self.m.feel_hard_stop_low)
        y[1], self.wall, self.capped = 0.0, side, 0
        self._settle_motion(t, y, given)

    def _cap(self, _, y):
        self.capped = _sign(y[1])
        y[1] = self.capped * self.m.feel_velocity_limit * self.per_angle

    def _uncap(self, _, __):
        self.capped = 0

    def _hysteresis_guard(self, phi, rate):
        if self.hysteresis.region:
            return "slider left", self.hysteresis.region * rate / self.per_angle, self._leave_slider
        return "slider dragged", 1.0 - abs(phi - self.slider) / self.m.feel_hysteresis_travel, self._drag_slider

    def _leave_slider(self, _, y):
        self.slider = self.slider_at(y[0])
        self.hysteresis.region = 0

    def _drag_slider(self, _, y):
        self.hysteresis.region = _sign(y[0] / self.per_angle - self.slider)

    def slider_at(self, delta):
        """Place of the hysteresis' slider."""
        region = self.hysteresis.region
        return delta / self.per_angle - region * self.m.feel_hysteresis_travel if region else self.slider

    def _toggle_stop(self, _, y):
        phi, rate = y[0] / self.per_angle, y[1] / self.per_angle
        touching = 1 if self.stops.depth(phi, rate, 1) > self.stops.depth(phi, rate, -1) else -1
        self.stops.region = 0 if self.stops.region else touching


def _pchip(angles, forces):
    """Force over angle: PCHIP, straight beyond the ends with the end slope."""
    knots, curve = list(angles), PchipInterpolator(angles, forces)
    coefficients = curve.c.T.tolist()
    ends = [(knots[i], float(curve(knots[i])), float(curve(knots[i], 1))) for i in (0, -1)]

    def force(x):
        if x <= knots[0] or x >= knots[-1]:
            knot, value, slope = ends[0] if x <= knots[0] else ends[1]
            return value + slope * (x - knot)
        index = bisect_right(knots, x) - 1
        u = x - knots[index]
        a, b, c, d = coefficients[index]
        return ((a * u + b) * u + c) * u + d

    return force


class Analog:
    """Plant and feel in one: the law acts at every instant."""

    def __init__(self, plant, feel):
        self.plant, self.feel = plant, feel
        self.law, self.arm = plant.m.law, plant.m.load_cell_arm

    def signals(self, t, y):
        """e and T."""
        force, x_p, theta, rate = self.plant.measured(y)
        c, m = self.law, self.plant.m
        e = c[0] * x_p + c[1] * force / m.area + c[2] * y[9] + c[3] * y[10] + m.base_arm * (c[4] * theta + c[5] * rate)
        if c[6]:
            e += c[6] * self.plant.force(t)
        return e + self.plant.test_signal(t), -self.arm * force + self.feel.shake(t)

    def derivative(self, t, y):
        e, given = self.signals(t, y)
        return self.plant.derivative(t, y, e) + self.feel.derivative(t, y[9:], given)

    def settle(self, t, y):
        e, given = self.signals(t, y)
        self.plant.settle(t, y, e)
        self.feel.settle(t, y[9:], given)

    def guards(self, t, y):
        e, given = self.signals(t, y)
        feel = self.feel.guards(t, y[9:], given)
        return self.plant.guards(t, y, e) + [(name, value, _behind(action)) for name, value, action in feel]

    def row(self, t, y):
        held = HeldFeel(self.feel).row(t, y[9:])
        return _row(self.plant, (t, y, self.signals(t, y)[0], self.plant.force(t)), held)


def _behind(action):
    """A feel's action on the joint state."""
    return lambda t, y: action(t, y[Plant.size :])


class HeldPlant:
    """The plant between two changes of the amplifier's input."""

    def __init__(self, plant):
        self.plant, self.e = plant, 0.0

    def given(self, t):
        """What the amplifier is given: the controller's last command and the test signal."""
        return self.e + self.plant.test_signal(t)

    def derivative(self, t, y):
        return self.plant.derivative(t, y, self.given(t))

    def settle(self, t, y):
        self.plant.settle(t, y, self.given(t))

    def guards(self, t, y):
        return self.plant.guards(t, y, self.given(t))

    def row(self, t, y):
        return t, y, self.given(t), self.plant.force(t)


class HeldFeel:
    """The feel between two samples."""

    def __init__(self, feel):
        self.feel, self.given = feel, 0.0

    def derivative(self, t, y):
        return self.feel.derivative(t, y, self.given)

    def settle(self, t, y):
        self.feel.settle(t, y, self.given)

    def guards(self, t, y):
        return self.feel.guards(t, y, self.given)

    def row(self, t, y):
        return (*y, self.feel.slider_at(y[0])), self.feel.load(t, *y) / self.feel.per_force


def _row(plant, at, feel):
    """Values of `COLUMNS`; ``at``: time, plant's state, e, force; ``feel``: (delta, delta', slider), feel force."""
    t, y, e, force = at
    servo = (y[0], y[1], y[2], y[3], plant.flow(y[2], y[1]), plant.current_at(e), plant.link_force(y))
    (delta, delta_rate, slider), feel_force = feel
    return (t, y[4], y[5], delta, delta_rate, *servo, feel_force, slider, e, force, *y[6:9])


class Recorder:
    """Rows of a system at the asked times: each piece gives those from its start to before its end."""

    def __init__(self, times):
        self.times, self.next, self.rows = times, 0, []

    def take(self, system, until, state):
        while self.next < len(self.times) and self.times[self.next] < until:
            t = self.times[self.next]
            self.rows.append(system.row(t, [float(v) for v in state(t)]))
            self.next += 1


class March:
    """Solves a system of modes piece by piece."""

    def __init__(self, system, scales, solver, recorder):
        self.system, self.recorder = system, recorder
        self.method = METHODS[solver.method]
        self.options = {"rtol": solver.rtol, "atol": 0.1 * solver.rtol * np.array(scales)}
        self.step, self.steps, self.events = 1e-6, 0, [] if solver.events is None else solver.events

    def piece(self, t, end, y):
        """State at ``end``; inputs are smooth between."""
        self.system.settle(t, y)
        stuck = 0
        while t < end:
            t_new, y = self._until_event(t, end, y)
            stuck = 0 if t_new > t else stuck + 1
            if stuck > 20:
                raise RuntimeError(f"events without end at {t} s: {self.events[-3:]}")
            t = t_new
        return y

    def _until_event(self, t, end, y):
        system = self.system
        solver = self.method(
            lambda t, y: system.derivative(t, y.tolist()), t, y, end, first_step=min(self.step, end - t), **self.options
        )
        while solver.status == "running":
            before = solver.y.copy()
            message = solver.step()
            self.steps += 1
            if solver.status == "failed" or self.steps > MOST_STEPS:
                raise RuntimeError(f"no way on from {solver.t} s: {message or 'too many steps; a stall?'}")
            self.step = getattr(solver, "h_abs", None) or self.step
            happened = [
                i for i, (_, value, __) in enumerate(system.guards(solver.t, solver.y.tolist())) if value < VIOLATED
            ]
            if happened:
                return self._event(solver, before, happened)
            self._record(solver, before, solver.t)
        return end, solver.y

    def _record(self, solver, before, until):
        recorder = self.recorder
        if recorder.next < len(recorder.times) and recorder.times[recorder.next] < until:
            recorder.take(self.system, until, self._inside(solver, before))

    def _inside(self, solver, before):
        """State inside the last step: solved anew from its start, since a one-step method's interpolant is off in p."""
        if self.method is LSODA:
            return solver.dense_output()

        def state(t):
            start = solver.t_old
            if t <= start:
                return before
            short = self.method(solver.fun, start, before, t, first_step=t - start, **self.options)
            while short.status == "running":
                short.step()
            return short.y

        return state

    def _event(self, solver, before, happened):
        state = self._inside(solver, before)
        time, index = min((self._root(state, solver.t_old, solver.t, i), i) for i in happened)
        if time > solver.t_old:
            self._record(solver, before, time)
        y = np.array(state(time)) if time > solver.t_old else before
        name, _, action = self.system.guards(time, y.tolist())[index]
        self.events.append((time, name))
        action(time, y)
        self.step = max(solver.t - time, 1e-9)
        return time, y

    def _root(self, state, start, end, index):
        def guard(t):
            return self.system.guards(t, state(t).tolist())[index][1]

        for t in (start, *(start + (end - start) * np.array([1e-6, 1e-3, 0.03, 0.1, 0.25, 0.5, 0.75]))):
            if guard(t) > 0:
                return brentq(guard, t, end, xtol=1e-16, rtol=1e-15)  # a few bits of the time
        return start


def _merge(times, start, end):
    """The times within, rounding apart taken as one."""
    merged = [start]
    for t in sorted(times):
        if t - merged[-1] > 1e-12 and end - t > 1e-12:
            merged.append(t)
    return [*merged, end]


def simulate(machine, force, duration, samples_s, initial=None, *, signals=None, solver=None):
    """Arrays `COLUMNS` at the times ``samples_s``, from rest or from ``initial`` (see `release`).

    Values of what jumps (current, e, force) are those behind the jump.
    """
    signals, solver = signals or Signals(), solver or Solver()
    times = [float(t) for t in samples_s]
    inputs = [
        Signal(force),
        Trim(signals.trim, machine.feel_trim_rate),
        Signal(signals.dynamic_pressure),
        Signal(signals.shaker),
        Signal(signals.test_signal),
    ]
    plant, feel = Plant(machine), Feel(machine)
    initial = dict(initial or {})
    lags = {"load_cell": machine.area * initial.get("p", 0.0), "potentiometer": initial.get("x_p", 0.0)}
    initial = lags | {"column_sensor": initial.get("theta", 0.0)} | initial
    y = np.array([initial.get(name, 0.0) for name in STATES])
    z = np.array([initial.get(name, 0.0) for name in FEEL_STATES])
    feel.slider = initial.get("slider", z[0] / feel.per_angle)
    run = _analog if machine.period == 0 else _digital
    rows = run((plant, feel), inputs, duration, (times, solver), (y, z))
    return dict(zip(COLUMNS, np.array(rows).T, strict=True))


def _connect(plant, feel, inputs, start, end):
    plant.force, feel.neutral, feel.dynamic_pressure, feel.shaker, plant.test_signal = (
        signal.over(start, end) for signal in inputs
    )


def _final(march, end, y):
    march.recorder.take(march.system, INF, lambda _: y)


def _analog(parts, inputs, duration, options, initial):
    times, solver = options
    march = March(Analog(*parts), SCALES, solver, Recorder(times))
    y = np.concatenate(initial)
    pieces = _merge([t for signal in inputs for t in signal.breaks], 0.0, duration)
    for start, end in pairwise(pieces):
        _connect(*parts, inputs, start, end)
        y = march.piece(start, end, y)
    _final(march, duration, y)
    return march.recorder.rows


class Controller:
    """The digital controller: what it makes of a sample."""

    def __init__(self, plant, feel):
        self.plant, self.feel, self.m = plant, feel, plant.m
        self.last_angle = None

    def sample(self, t, y, z):
        """(e, T) from the state at a sample; sets how the feel gives way."""
        m, c = self.m, self.m.law
        force, x_p, theta, _ = self.plant.measured(y)
        force = self._read(force, m.load_cell_resolution, m.load_cell_gain)
        x_p = self._read(x_p, m.potentiometer_resolution, m.potentiometer_gain)
        theta = self._read(theta, m.column_sensor_resolution, m.potentiometer_gain * m.ratio * m.base_arm)
        rate = 0.0 if self.last_angle is None else (theta - self.last_angle) / m.period
        self.last_angle = theta
        measured = (x_p, force / m.area, z[0], z[1], m.base_arm * theta, m.base_arm * rate, self.plant.force(t))
        asked = sum(gain * value for gain, value in zip(c, measured, strict=True))
        given = _convert(asked, m.output_range, m.output_bits)
        possible = _clamp(_clamp(asked, m.output_range), m.current_limit / m.admittance)
        short = m.antiwindup * (possible - asked) / c[2] if m.antiwindup else 0.0
        self.feel.drift, self.feel.slowing = 2 * short, m.antiwindup * short
        return given, -m.load_cell_arm * force + self.feel.shake(t)

    def _read(self, value, resolution, gain):
        """A sensor's value through its resolution and the converter behind its gain."""
        if resolution:
            value = round(value / resolution) * resolution
        return _convert(value * gain, self.m.input_range, self.m.input_bits) / gain


def _convert(volts, limit, bits):
    """Clipped to +-limit and, with bits, rounded to the nearest of the 2^bits steps of that range."""
    volts = _clamp(volts, limit)
    if not bits or limit == INF:
        return volts
    step = 2.0 * limit / 2**bits
    return round(volts / step) * step


def _digital(parts, inputs, duration, options, initial):
    m, (plant, feel), (y, z) = parts[0].m, parts, initial
    times, solver = options
    body = March(HeldPlant(plant), SCALES[: Plant.size], solver, Recorder(times))
    computer = March(HeldFeel(feel), SCALES[Plant.size :], solver, Recorder(times))
    controller, waiting = Controller(plant, feel), deque()
    jumps = [t for signal in inputs for t in signal.breaks]
    for k in range(math.ceil(duration / m.period - 1e-9)):
        start, end = k * m.period, min((k + 1) * m.period, duration)
        _connect(plant, feel, inputs, start, _merge([t for t in jumps if start < t < end], start, end)[1])
        e, computer.system.given = controller.sample(start, y, z)
        if k == 0:
            body.system.e = e
        waiting.append((start + m.delay, e))
        pieces = _merge([t for t in [*jumps, *(at for at, _ in waiting)] if start < t < end], start, end)
        for left, right in pairwise(pieces):
            _connect(plant, feel, inputs, left, right)
            while waiting and waiting[0][0] <= left + 1e-12:
                body.system.e = waiting.popleft()[1]
            y, z = body.piece(left, right, y), computer.piece(left, right, z)
    _final(body, duration, y)
    _final(computer, duration, z)
    return [_row(plant, at, held) for at, held in zip(body.recorder.rows, computer.recorder.rows, strict=True)]


def release(machine, held_angle, neutral=0.0, dynamic_pressure=0.0):
    """State at rest with the grip held at an angle: start of a free release (`simulate` without force).

    The feel is in equilibrium without dry friction, having come from zero (its hysteresis is dragged). ``force``: what holds it.
    """
    m, plant, feel = machine, Plant(machine), Feel(machine)
    feel.neutral, feel.dynamic_pressure = (lambda _: neutral), (lambda _: dynamic_pressure)
    plant.stops.settle(held_angle, 0.0)

    def pressure(delta):
        phi = delta / feel.per_angle
        u = phi - _clamp(phi, m.feel_hysteresis_travel)
        feel.slider = u
        feel.hysteresis.region = 0
        feel.stops.settle(phi, 0.0)
        return (-feel.load(0.0, delta, 0.0) / m.load_cell_arm - m.load_cell_offset) / m.area

    def piston(p):
        return plant.lever * held_angle + m.area * p / m.link_stiffness + plant.gap * _sign(p)

    def valve_flow(p):
        """q_i at which the piston stands still."""
        leak = m.relief_gain * (p - _clamp(p, m.relief_pressure))
        if not m.orifice:
            return leak + m.pressure_gain * p
        return leak / math.sqrt(1.0 - abs(p) / m.supply_pressure) if leak else 0.0

    def grip_force(p, x_p):
        return -plant.torque(0.0, [x_p, p, 0.0, 0.0, held_angle, 0.0]) / m.grip_arm

    def command(delta, p, x_p):
        c = m.law
        force, angle = m.area * p + m.load_cell_offset, held_angle + m.column_sensor_offset
        e = c[0] * (x_p + m.potentiometer_offset) + c[1] * force / m.area + c[2] * delta + c[4] * m.base_arm * angle
        return e + c[6] * grip_force(p, x_p)

    def excess(delta):
        p = pressure(delta)
        return command(delta, p, piston(p)) - valve_flow(p) / plant.gain / m.admittance

    middle, width = feel.per_angle * held_angle, 0.1 * feel.per_angle * (abs(held_angle) + 1e-3)
    while excess(middle - width) * excess(middle + width) > 0:
        width *= 1.5
    delta = brentq(excess, middle - width, middle + width, xtol=1e-15, rtol=1e-15)  # a few bits
    p = pressure(delta)
    x_p = piston(p)
    if abs(excess(delta)) > 1e-6:  # the jump over the gap of the backlash: the piston stands inside it
        p, x_p = 0.0, x_p - command(delta, 0.0, x_p) / m.law[0]
    q_i = valve_flow(p)
    y = [x_p, p, q_i, 0.0, held_angle, 0.0]
    if abs(q_i / plant.gain) > m.current_limit or abs(q_i) > m.flow_limit:
        raise ValueError("the valve cannot hold this angle")
    held = {"delta": delta, "slider": feel.slider, "force": grip_force(p, x_p)}
    return dict(zip(STATES, y, strict=False)) | held


def energy(machine, trajectory):
    """Audit of valve, oil, link and column along a finely sampled run, lb in.

    ``stored`` - its start = ``work`` of the pilot + ``hydraulic`` work of the flow q - ``dissipated``, which never falls.
    """
    m, t = machine, trajectory
    plant = Plant(m)
    theta, rate, x_p, p = (np.asarray(t[name]) for name in ("theta", "theta_rate", "x_p", "p"))
    s = x_p - plant.lever * theta
    z = np.sign(s) * np.maximum(np.abs(s) - plant.gap, 0.0)
    s_rate = (m.area * p - m.link_stiffness * z) / m.link_damping
    if m.backlash:
        s_rate = np.where(p == 0, np.asarray(t["q_i"]) / m.area - plant.lever * rate, s_rate)
    depth = theta - np.clip(theta, m.stop_low, m.stop_high)
    push = np.sign(depth) * np.maximum(np.sign(depth) * (m.stop_stiffness * depth + m.stop_damping * rate), 0.0)
    excess = p - np.clip(p, -m.relief_pressure, m.relief_pressure)
    losses = (
        (m.area * p - m.link_stiffness * z) * s_rate
        + (push - m.stop_stiffness * depth) * rate
        + plant.viscous * rate**2
        + plant.coulomb * np.abs(rate)
        + m.relief_gain * excess * p
    )
    stored = 0.5 * (
        plant.inertia * rate**2
        + m.link_stiffness * z**2
        + m.oil_volume / (4 * m.bulk_modulus) * p**2
        + m.stop_stiffness * depth**2
        + plant.arm_spring * theta**2
    ) + m.gravity_torque * np.cos(m.gravity_angle + theta)
    powers = {
        "work": m.grip_arm * np.asarray(t["force"]) * rate,
        "hydraulic": p * np.asarray(t["flow"]),
        "dissipated": losses,
    }
    return {"stored": stored} | {
        name: cumulative_simpson(power, x=t["time_s"], initial=0.0) for name, power in powers.items()
    }
