"""An electric loader under a sampled law, written out by hand and solved to tight tolerance: the tests' independent witness.

The equations are those at the head of ``crates/model/src/drive/electric.rs`` and of its parts; nothing of the engine is used, of a
loader its numbers alone. Dry friction is a steep slope through zero, ``CREEP`` wide, so static friction is the dry friction.

`x_m` end of the drive · `v_m` its velocity · `i` current · `x_b`, `v_b` base of the column · `T_w`, `T_h` winding and housing over
the temperature around · `f`, `x`, `theta` what the sensors show · `delta` programmed displacement · `e` command ·
`xi` state of the law
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import LSODA
from scipy.linalg import expm

CREEP = 1e-6
"""m/s at which dry friction is three quarters of what it is."""

OUTPUTS = (
    "drive_position_m",
    "motor_speed",
    "motor_current_a",
    "column_angle_rad",
    "column_rate",
    "winding",
    "housing",
)
SCALES = np.array([1e-3, 1e-2, 1.0, 1e-3, 1e-2, 10.0, 10.0, 100.0, 1e-3, 1e-3])
"""Size of each state, the lags in N, m, rad."""


class Plant:
    """Motor, transmission, column and sensors of a loader; states as above."""

    def __init__(self, loader):
        g = loader.__getitem__
        self.loader = loader
        self.three = 1.5 if g("motor.three_phase") else 1.0
        self.kt, self.r = g("motor.torque_constant"), g("transmission.travel")
        self.ke = self.kt / self.three
        softness = 1 / g("linkage.stiffness") + 1 / g("transmission.stiffness")
        self.k = 1 / softness
        self.c = g("linkage.damping") * self.k / g("linkage.stiffness")
        self.alpha, self.arm, self.grip = g("linkage.ratio"), g("column.base_arm"), g("column.grip_arm")
        self.play = 0.5 * (g("linkage.backlash") + g("transmission.backlash"))
        self.heats = math.isfinite(g("thermal.winding_capacity"))
        self.bandwidths = [g(f"{part}.bandwidth") for part in ("load_cell", "potentiometer", "column_sensor")]

    def force(self, x_m, v_m, x_b, v_b):
        """On the link."""
        stretch = x_m - self.alpha * x_b
        spring = stretch - min(max(stretch, -self.play), self.play)
        force = self.k * spring + self.c * (v_m - self.alpha * v_b)
        return force if self.play == 0 or (spring != 0 and force * stretch > 0) else 0.0

    def heat(self, i, warm):
        """Of all phases in W."""
        return self.three * self.resistance(warm) * i * i

    def resistance(self, warm):
        return self.loader["winding.resistance"] * (1 + self.loader["winding.temperature_coefficient"] * warm)

    def current_rate(self, i, omega, warm, e):
        g = self.loader.__getitem__
        limit = g("current_loop.current_limit")
        if self.heats:
            start, end = (g(f"thermal.{name}") - g("thermal.ambient") for name in ("derating_from", "winding_limit"))
            limit *= 1 - min(max((warm - start) / (end - start), 0.0), 1.0)
        e = min(max(e, -limit), limit)
        held = self.resistance(warm) * i + self.ke * omega
        inductance, most = g("winding.inductance"), g("current_loop.voltage_limit")
        u = held + g("current_loop.bandwidth") * inductance * (e - i)
        return (min(max(u, -most), most) - held) / inductance

    def rates(self, y, e, pilot):
        g = self.loader.__getitem__
        x_m, v_m, i, x_b, v_b, winding, housing, *shown = y
        force, phi, omega = self.force(x_m, v_m, x_b, v_b), x_m / self.r, v_m / self.r
        torque = self.kt * i - g("motor.viscous_friction") * omega - self.r * force
        for n in ("", "_2"):
            angle = g(f"motor.cogging_periods{n}") * phi + g(f"motor.cogging_phase{n}")
            torque += g(f"motor.cogging_torque{n}") * math.sin(angle)
        driven = force * v_m <= 0
        eta = g("transmission.backdriving_efficiency" if driven else "transmission.efficiency")
        lost = abs(force) * self.r * (1 - eta if driven else 1 / eta - 1)
        torque -= (g("motor.coulomb_friction") + lost) * math.tanh(v_m / CREEP)
        theta, rate = x_b / self.arm, v_b / self.arm
        on_column = self.grip * pilot + self.alpha * self.arm * force - g("column.viscous_friction") * rate
        on_column -= self.grip * g("column.coulomb_friction") * math.tanh(v_b / CREEP)
        # What holds the grip.
        on_column -= self.grip**2 * (g("pilot.arm_stiffness") * theta + g("pilot.arm_damping") * rate)
        inertia = g("column.inertia") + self.grip**2 * g("pilot.arm_mass")
        for side, stop in ((1, g("column.stop_high")), (-1, g("column.stop_low"))):
            depth = side * (theta - stop)
            if depth > 0:
                on_column -= side * max(
                    g("column.stop_stiffness") * depth + side * g("column.stop_damping") * rate, 0.0
                )
        warmer = [0.0, 0.0]
        if self.heats:
            inner = (winding - housing) / g("thermal.winding_resistance")
            outer = housing / g("thermal.housing_resistance")
            power = self.heat(i, winding)
            warmer = [(power - inner) / g("thermal.winding_capacity"), (inner - outer) / g("thermal.housing_capacity")]
        measured = (force, x_m, theta)
        lags = [
            w * (value - seen) if math.isfinite(w) else 0.0
            for w, value, seen in zip(self.bandwidths, measured, shown, strict=True)
        ]
        warm = winding if self.heats else 0.0
        return [
            v_m,
            torque * self.r / g("motor.inertia"),
            self.current_rate(i, omega, warm, e),
            v_b,
            on_column * self.arm / inertia,
            *warmer,
            *lags,
        ]

    def sampled(self, y, pilot):
        """What the controller reads; of a loader with a sensor at the grip, one without a lag, its force too."""
        x_m, v_m, _, x_b, v_b, *_ = y
        measured = (self.force(x_m, v_m, x_b, v_b), x_m, x_b / self.arm)
        shown = [
            seen if math.isfinite(w) else value for w, value, seen in zip(self.bandwidths, measured, y[7:], strict=True)
        ]
        gain, mass = self.loader["grip_sensor.gain"], self.loader["grip_sensor.mass"]
        if gain:
            angular = self.rates(y, 0.0, pilot)[4] / self.arm  # the current does not pull at the column
            shown.append(gain * (pilot - mass * self.grip * angular))
        return np.array(shown)


@dataclass(frozen=True)
class Start:
    """Where a run begins: states of the plant, the feel's displacement and rate, the law's state and the command on its way."""

    plant: np.ndarray
    feel: np.ndarray
    law: np.ndarray
    command: float


def simulate(loader, law, pilot, duration, *, start=None, command=None, added=None, test=None, rtol=1e-9):  # noqa: PLR0913
    """Columns `OUTPUTS` at the controller's samples, from ``start`` or rest at zero; ``pilot`` is a force over time in N.

    ``law`` are a sampled law's numbers; ``command`` over time, in A, comes to its command, or stands in place of one; ``added`` to
    it, of the drive's position as sampled and its last period's difference over the period, is known to the law; ``test`` over
    time, in A, is asked of the current loop beside it.
    """
    plant, g = Plant(loader), loader.__getitem__
    period, delay = g("controller.period"), g("controller.delay")
    feel = np.array(
        [
            [0, 1, 0],
            [-g("feel.stiffness") / g("feel.inertia"), -g("feel.damping") / g("feel.inertia"), 1 / g("feel.inertia")],
            [0, 0, 0],
        ]
    )
    step = expm(feel * period)
    y, feels, rows, last, memory = np.zeros(10), np.zeros(2), [], 0.0, np.zeros(7)
    xi, e = None if law is None else np.zeros(law.transition.shape[-1]), 0.0 if added is None else added(0.0, 0.0)
    y[2] = e
    if start is not None:
        y, feels, xi, e = start.plant, start.feel, start.law, start.command
    touch = Touch(law.contact[0]) if law is not None and law.knows_contact else None
    if touch is not None and law.knows_friction:
        touch.rubs(law.friction[0], g("feel.stiffness"), g("feel.inertia"))
    if touch is not None and g("grip_sensor.gain"):
        touch.ends = g("column.stop_low"), g("column.stop_high"), g("feel.stiffness")
    for k in range(round(duration / period)):
        t = k * period
        rows.append(y[:7])
        new = 0.0 if command is None else command(t)
        if law is not None:
            sample = plant.sampled(y, pilot(t))
            known = np.concatenate([xi, sample, feels])
            own, torque = float(law.command[0] @ known), float(law.torque[0] @ known)
            limit = g("current_loop.current_limit")
            drive_rate = (sample[1] - last) / period
            more, last = 0.0 if added is None else added(sample[1], drive_rate), sample[1]
            memory, moved = hear(law.friction[0], known, torque, memory)
            heard = memory[0]
            if touch is not None:
                feels, own, heard = touch.step(period, (*sample, drive_rate), feels, (own, heard), (memory[5], limit))
            answered = min(max(own + more, -limit), limit) - more
            xi = law.transition[0] @ xi + law.input[0] @ np.append(sample, answered) + moved
            feels = (step @ np.append(feels, heard))[:2]
            if touch is not None:
                feels = touch.damp(period, feels, g("feel.inertia"))
            excess, way = (own - answered) / law.command[0, -2], g("controller.antiwindup")
            feels = feels - period * way * excess * np.array([2.0, way])
            if touch is not None:
                feels = touch.follow(feels, sample[2])
            new += own + more
        for begin, end, held in ((t, t + delay, e), (t + delay, t + period, new)):
            if end - begin > 1e-12:  # s, far below any delay
                y = _piece(plant, y, (begin, end), (held, test), pilot, rtol)
        e = new
    rows.append(y[:7])
    found = dict(zip(OUTPUTS, np.array(rows).T, strict=True))
    found["column_angle_rad"] = found["column_angle_rad"] / plant.arm
    return found


class Touch:
    """What a law does in contact, by the table at the head of ``crates/model/src/contact_law.rs``."""

    def __init__(self, numbers):
        self.per_angle, self.k_x, self.k_v, self.damping, self.fastest, self.ripple, *more = numbers
        self.least, self.environment, self.quick, self.near, self.travel = more
        self.share = self.torque = self.torque_before = self.angle = self.rate = self.peak = 0.0
        self.before = self.last = self.column = 0.0
        self.place, self.extreme = (0.0, 0.0), (0.0, 0.0, 0.0)  # angle, torque, lead of the feel
        self.lead = 0.0
        self.offset = self.loose = 0.0
        self.side, self.push, self.since, self.swings = 1.0, -1, 1.0, 0
        self.way, self.turn, self.since_turn, self.turns = 1.0, (0.0, 0.0, 0.0), 1.0, 0
        self.bounces = 0
        self.began = 0.0
        self.acts = 0.0  # the share, or all of it at rest
        self.column_rate = 0.0
        self.ends = None  # of the column, and the feel's stiffness, under a sensor at the grip
        self.rubbing = 0.0  # the most that known friction may be
        self.rest, self.rested = None, 0.0  # of known friction

    def rubs(self, friction, stiffness, inertia):
        """Friction is known, by the head of ``crates/model/src/known_friction.rs``."""
        uncertain, most, rate = friction[-10], friction[-4], friction[-1]
        self.rest = uncertain, most, rate, stiffness, min(10 * 2 * rate * inertia / uncertain, 0.06)
        self.rubbing = most

    def is_held(self, h, delta):
        """Whether friction holds the column."""
        if self.rest is None:
            return False
        uncertain, _, slowest, stiffness, lasts = self.rest
        weak = abs(stiffness * delta) < uncertain
        rests = weak and abs(self.rate) < slowest
        self.rested += (float(weak) - self.rested) * min(h / (lasts if rests else 2.0), 1.0)
        return rests and self.rested > 0.5

    def count_swing(self, other, times, stiff, by_hand):
        """Swings in a row, ``other`` where the torque now pushes to the other side."""
        (quick, slow), peak = times, abs(self.extreme[1])
        if other and quick:
            self.swings = self.swings + 1 if not by_hand and (stiff or peak >= 1.2 * self.last) else 0
        elif other:
            self.swings = self.swings + 0.125 if slow and stiff and not by_hand and peak > 0.97 * self.last else 0
        elif not slow:
            self.swings = 0

    def count_turn(self, stiff, apart):
        """Turns in a row; of a slow one the feel's own way tells."""
        if self.since_turn < self.quick or (self.since_turn < 3 * self.quick and stiff and apart):
            return self.turns + (1 if stiff else 0.5)
        return max(self.turns - 0.5, 0) if self.since_turn < 3 * self.quick else 0

    def bounces_on(self, over, rate, begins):
        """Whether the column bounces the fourth time in a row."""
        if begins and self.since >= 0.4:
            self.bounces = 0
        if (
            over
            and self.push > 0
            and self.since < self.quick
            and self.before * self.side < -1
            and rate * self.side > 0.02
        ):
            self.bounces = self.side + (self.bounces if self.bounces * self.side > 0 else 0)
            return abs(self.bounces) >= 4
        return False

    def strikes(self, blow, stiff, rate):
        """Whether a push that is over was a blow that the column struck, or one that turned it."""
        came, thrown = -self.before * self.side, rate * self.side
        struck = blow and self.since < 0.9 * self.quick and stiff and self.push > 0 and thrown <= 1.6 * came
        turned = blow and came > 0.02 and thrown > 0.02 and self.since < self.quick / 3
        return struck, turned

    def is_thrown(self, h, lead_before, turns):
        """Whether the feel turns round before a column that struck something."""
        way = math.copysign(1.0, self.rate)
        against, risen = -self.torque * way, (self.torque_before - self.torque) * way
        rises, turns_faster = (
            risen > 0.2 * self.environment * 0.008 * abs(self.rate),
            (lead_before - self.lead) / h * way,
        )
        slows = abs(self.rate) > 0.02 and (self.rate - turns) * way > min(0.05, 0.5 * abs(self.rate))
        moves_freely = self.share < 0.5
        return moves_freely and rises and slows and turns_faster > 0.1 and against * turns_faster > 0.12 * self.least

    def notice(self, h, torque, column, feel):
        """Whether there is contact at a sample."""
        before, lead_before = self.angle, self.lead
        self.torque += (torque - self.torque) * h / 0.004
        self.angle += (column - self.angle) * h / 0.004
        self.lead += (feel - column - self.lead) * h / 0.004
        turns = (self.angle - before) / h
        self.rate += (turns - self.rate) * h / 0.008
        self.torque_before += (self.torque - self.torque_before) * h / 0.008
        self.peak = max(abs(self.torque), self.peak * (1 - h / self.quick / 5))
        rubbing = self.rubbing if abs(self.rate) < 0.05 else 0.0
        pushes = abs(self.torque) > max(self.least, 0.3 * self.peak, rubbing)
        other = pushes and self.torque * self.side < 0
        over, begins = self.push != 0 and not pushes, other or (pushes and self.push == 0)
        went, fell = self.angle - self.extreme[0], self.torque - self.extreme[1]
        hard = abs(fell) > self.environment * abs(went)
        stiff, quick = hard and fell * went <= 0, self.since < self.quick
        swing = other and quick
        slow, peak_before = self.since < 2 * self.quick, abs(self.extreme[1])
        by_hand = abs(self.lead - self.extreme[2]) < 0.03 * abs(went)
        self.count_swing(other, (quick, slow), stiff, by_hand)
        back = (self.turn[1] - self.torque) * self.way
        ripples = self.share < 0.5 and (self.since_turn < 0.04 or self.since_turn >= 1)
        turned_back = back > max(self.ripple if ripples else 0.8 * self.least, 2.5 * rubbing)
        turns_before = self.turns
        if turned_back:
            turned_by = self.angle - self.turn[0]
            hard_turn = back > self.environment * abs(turned_by) and turned_by * self.way >= 0
            apart = not by_hand and abs(self.lead - self.turn[2]) > 0.3 * abs(turned_by)
            self.way, self.turns = -self.way, self.count_turn(hard_turn, apart)
        self.since_turn = 0.0 if turned_back else min(self.since_turn + h, 1.0)
        turn_before = self.turn
        if turned_back or back < 0:
            self.turn = (self.angle, self.torque, self.lead)
        pushed_on = turned_back and self.turns >= 16
        rose = peak_before > self.environment * abs(self.extreme[0] - self.began)
        blow = over and hard and rose and abs(fell) > 0.5 * peak_before
        struck, turned = self.strikes(blow, stiff and not by_hand, turns)
        thrown, at = self.is_thrown(h, lead_before, turns), turn_before if pushed_on else self.extreme
        self.struck_at = (self.angle, self.torque) if thrown and self.push == 0 else at[:2]
        noticed = self.bounces_on(over, turns, begins) or thrown or struck or turned
        if other:
            self.last = peak_before
        if begins:
            self.side, alone = math.copysign(1.0, self.torque), self.since >= 0.3 or turns_before == 0
            self.push = 1 if self.rate * self.side < -0.05 else -1 if alone else -0.5
            self.since, self.before, self.began = 0.0, self.rate, self.angle
        else:
            self.since, self.push = min(self.since + h, 1.0), self.push if pushes else 0
        if begins or self.torque * self.side > self.extreme[1] * self.side:
            self.extreme = (self.angle, self.torque, self.lead)
        return self.swings >= 2 or pushed_on or noticed or (swing and self.share > 0)

    def step(self, h, sample, feels, own, bounds):
        """The feel, the command and its torque at a sample, from those of free motion."""
        (force, position, column), drive_rate, (push, limit) = sample[:3], sample[-1], bounds
        column_rate, self.column = (column - self.column) / h, column
        self.column_rate = column_rate
        at_end = self.at_end(feels, column, own[1])
        noticed, was = self.notice(h, own[1], column, feels[0]) or at_end, self.share
        if noticed:
            self.place = (column if at_end else self.struck_at[0], self.struck_at[1])
        elif was > 0:
            here, torque = self.place
            follows = (column - here) * h / 5.0 if abs(column - here) < self.near else 0.0
            self.place = here + follows, torque + (self.torque - torque) * h / 0.5
        away = column - self.place[0]
        held = (self.torque - self.place[1]) * away < -0.05 * self.environment * away**2
        slowed = self.damping * abs(feels[1]) > 2 * (abs(self.torque) + self.rubbing)
        self.loose = self.loose + h if was > 0 and slowed and self.rate * away > 0 else 0.0
        if noticed or (was > 0 and abs(away) < self.near / 5):
            self.share = 1.0
        else:
            leaves = self.rate * away > 0 and not held and (self.since >= 0.3 or self.push == -1)
            by_way = abs(self.rate) * h / self.travel if leaves else 0.0
            self.share = max(was - max(by_way, h / 0.2 if self.loose > 0.06 else 0.0), 0.0)
        if noticed and was < 0.5:
            feels = np.array([position / self.per_angle, 0.0])
        rate = feels[1]
        if at_end:
            feels, rate = np.array([column, column_rate]), self.rate
        command = self.k_x * (self.per_angle * (feels[0] - self.offset) - position) + self.k_v * (
            self.per_angle * rate - drive_rate
        )
        rubs = self.is_held(h, feels[0])
        self.acts, most = (1.0, self.rest[1] + abs(push)) if rubs else (self.share, math.inf)
        contact = (command, min(max(-self.per_angle * force, -most), most))
        command, torque = (a + self.acts * (b - a) for a, b in zip(own, contact, strict=True))
        leaves = self.share < 0.9 or abs(command) > limit
        self.offset += (-self.offset if leaves else column - feels[0]) * h / 0.5
        self.acts = 0.0 if at_end else self.acts
        return feels, command, torque

    def at_end(self, feels, column, hand):
        """Whether feel and column go into an end stop by their motion or a hand, as a sensor at the grip shows it."""
        if self.ends is None:
            return False
        (low, high, stiffness), (delta, rate) = self.ends, feels
        if delta > high and column > high - self.near:
            return hand > stiffness * delta or rate > 0
        return delta < low and column < low + self.near and (hand < stiffness * delta or rate < 0)

    def follow(self, feels, column):
        """The feel no farther out than the column by 0.05 rad; its neutral is at zero."""
        (delta, rate), ahead = feels, feels[0] - column
        if abs(ahead) <= 0.05 or ahead * delta <= 0:
            return feels
        side = math.copysign(1.0, ahead)
        runs_on = (rate - self.column_rate) * side > 0
        return np.array([column + 0.05 * side, self.column_rate if runs_on else rate])

    def damp(self, h, feels, inertia):
        """The feel after a period."""
        if self.acts == 0:
            return feels
        most = self.fastest / self.acts
        rate = min(max(feels[1] / (1 + self.acts * self.damping * h / inertia), -most), most)
        return np.array([feels[0] - (feels[1] - rate) * h / 2, rate])


def hear(numbers, known, torque, memory):
    """What the feel hears of an estimated torque, first in the memory, and how the friction that is known moves the law's state."""
    *levels, beta, per_stribeck, uncertain, slow, leak, low, high, gain, hand, blur, trust, _ = numbers[-14:]
    by_rate, enters = np.split(numbers[:-14], [len(known)])
    heard, *learnt, trusted_negative, trusted_positive, push, way_before = memory
    trusted = [trusted_negative, trusted_positive]
    if not levels[0]:
        return np.array([torque, *memory[1:]]), 0.0
    rate = by_rate @ known
    way_now = rate / math.hypot(rate, slow)
    own = 0 if way_now < 0 else 1
    square = (rate * per_stribeck) ** 2
    falls = 1 + beta / (1 + square + square**2 / 2 + square**3 / 6)
    levels = [level * falls * (1 + share) for level, share in zip(levels, learnt, strict=True)]
    friction = levels[own] * way_now
    # The torques of dry friction at this rate: all of them at rest, one in motion, in between within half a slow rate.
    least, most = (min(max(2 * (rate + way * slow) / slow, -1.0), 1.0) for way in (-1, 1))
    least, most = min(least, way_now), max(most, way_now)
    rest = torque - friction
    heard += leak * ((rest if abs(push) >= hand else 0.0) - heard)
    reach = [share * levels[0 if share < 0 else 1] for share in (least, most)]
    heard = min(max(heard, rest + reach[0] - uncertain), rest + reach[1] + uncertain)
    one_way = way_now * way_before > 0.8
    of_friction = max(abs(friction), hand - abs(friction)) if one_way else hand
    for k in (0, 1):
        if abs(push) >= of_friction:  # what was learnt of late was the hand's
            learnt[k] += blur * (trusted[k] - learnt[k])
        elif one_way:
            by = (1.0 if k == own else 0.5) * gain * way_now * torque
            before, learnt[k] = learnt[k], min(max(learnt[k] - by, low), high)
            trusted[k] += trust * (before - trusted[k]) if abs(rate) > 0.05 else 0.0
    push, way_before = push + blur * (torque - push), way_before + blur * (way_now - way_before)
    return np.array([heard, *learnt, *trusted, push, way_before]), enters * friction


def _piece(plant, y, span, asked, pilot, rtol):
    """The states at the end of a span in which the command stays."""
    e, test = asked
    solver = LSODA(
        lambda t, states: plant.rates(states, e if test is None else e + test(t), pilot(t)),
        span[0],
        y,
        span[1],
        rtol=rtol,
        atol=rtol * SCALES,
    )
    while solver.status == "running":
        solver.step()
    if solver.status != "finished":
        raise ArithmeticError(f"no solution beyond {solver.t} s")
    return solver.y
