"""A bench signal on a drive's bus: the record that an identification reads."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from forcefeel import _core
from forcefeel.bench.excitation import Excitation, ExcitationPlan, excite
from forcefeel.bench.excitation.excite import USUAL_FIT, USUAL_TO_HZ
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.records import BenchRecord
from forcefeel.errors import InputError
from forcefeel.laws.law import LawLike
from forcefeel.live.bus import bus_of
from forcefeel.live.setup import live_law, made_of
from forcefeel.live.starting import Axis, launch
from forcefeel.live.state import COLUMNS, STATES
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.units import to_text

_EVEN = 0.1
"""Share of a period by which commands may come off their times and count as even."""

_GAP = 5.0
"""Periods that a record may lack, as in any bench record."""

_TRIES = 3
"""Records by the clock, of which one may do: a computer that pauses for some milliseconds a minute is no rarity."""

_MOST_RAD = radians(15.0)
"""Angle of the column at which a signal without a law is stopped."""

_PLAYS = {
    ELECTRIC: (Experiment(Loop.MOTOR_OPEN, Drive.TEST_CURRENT), Experiment(Loop.LOADER, Drive.COMMAND_CURRENT)),
    HYDRAULIC: (Experiment(Loop.LOADER, Drive.COMMAND_SIGNAL),),
}
_END = {ELECTRIC: "drive_position", HYDRAULIC: "piston_position"}
"""Channel of the drive's end."""

_SHARE = {ELECTRIC: 1.0, HYDRAULIC: 1 / 3}
"""Of the signal that the limits allow, for an unknown machine: with an inertia 10 % off a valve under ``robust`` swings three times
as far near the link's resonance."""

_SETTLES_S, _FADES_S = 1.0, 5.0
"""Rest with the feel there before a signal, and the longest time in which the feel comes."""

_LOOKS = 200
"""Cycles between two looks at a running loop."""

_LOST = 0.01
"""Share of a record's samples that may be lost; a straight line stands for them."""


def play(excitation: Excitation, *, real_time: bool = True) -> BenchRecord:
    """Give the drive of a loader a bench signal over its bus, and record its sensors.

    ``loader command_current``, of a valve ``loader command_signal``: the loop runs under the excitation's law and the supervisor. A
    second after the feel has come, the signal is added to the law's command. The feel holds the column at its neutral.

    ``motor-open``: the motor alone moves the column, without a law, so free its travel. With dry friction the column wanders, and
    the drive stops at 15 deg from where it began.

    Keep hands off in both.

    Args:
        excitation: A signal of one of these experiments, at the rate of the loader's controller.
        real_time: Play by the clock; otherwise as fast as the drive answers: for an emulator without a clock.

    Returns:
        The record: signal, column angle, drive position and load cell force; of ``motor-open`` the motor's current, too.

    Raises:
        InputError: If the signal is for another experiment or of another rate, or the loader has no bus with a load cell and a
            column encoder; if the drive or the supervisor stopped, or this computer missed more than 5 periods in a row in three
            records.

    Example:
        >>> from dataclasses import replace
        >>> yoke = ff.loader.electric("desktop-yoke")
        >>> yoke = replace(yoke, bus=ff.loader.Bus("moteus", "pty", load_cell_n=400.0, column_gear=1.0))
        >>> with ff.live.BusEmulator([yoke], real_time=False) as emulator:
        ...     wired = replace(yoke, bus=replace(yoke.bus, port=emulator.port))
        ...     plan = ff.bench.ExcitationPlan(
        ...         time_s=3.0, rate_hz=2000.0, from_hz=4.0, to_hz=60.0, measured=ff.bus.PLAYED
        ...     )
        ...     signal = ff.bench.excite(wired, "J_m,k,J", "motor-open", plan)
        ...     record = ff.bus.play(signal, real_time=False)
        >>> sorted(record.channels)
        ['column_angle', 'drive_position', 'load_cell_force', 'motor_current', 'test_current']
    """
    loader, experiment, law = excitation.loader, excitation.experiment, excitation.law
    bus = bus_of(loader)
    if experiment not in (plays := _PLAYS[loader.drive]):
        known = " or ".join(map(str, plays))
        raise InputError(f"experiment: a bus plays {known}, got {experiment}; choose one with --experiment")
    if not bus.senses:
        raise InputError(
            "bus: a bench record requires a load cell and an encoder at the column; add load_cell and column_gear"
        )
    step, period = float(excitation.time_s[1] - excitation.time_s[0]), loader["controller.period"]
    if abs(step - period) > 1e-6 * period:  # of times with nine digits
        rate, got = to_text(1 / period, 6), to_text(1 / step, 6)
        raise InputError(f"rate: expected the controller's, {rate} Hz, got {got} Hz; use --rate {rate}")
    for left in reversed(range(_TRIES)):
        if experiment.loop is Loop.LOADER:
            sent_s, channels = _under_law(excitation, law, real_time=real_time)
        else:
            sent_s, channels = _motor_alone(excitation, real_time=real_time)
        longest = float(np.diff(sent_s).max())
        if not real_time or longest <= _GAP * period:
            break
        if not left:
            raise InputError(
                f"bus: in {_TRIES} records a command came late, in the last {1e3 * longest:.1f} ms after the one before, expected "
                f"at most {_GAP:g} periods of {1e3 * period:g} ms; run it on an idle computer with real-time priority"
            )
    time_s, drive = excitation.time_s, str(experiment.drive)
    if real_time and float(np.abs(sent_s - time_s).max()) > _EVEN * period:
        time_s, channels = _evenly(sent_s, channels, drive, period)
    if not (has_grip_sensor(loader) and bus.grip_sensor_n is not None):
        del channels["grip_force"]
    run = {} if law is None else {"law": law.name}
    return BenchRecord("bus", experiment, time_s, channels, hold="staircase", run=run)


def record(loader: Loader, time_s: float = 60.0) -> BenchRecord:
    """Design a signal for all parameters of a loader, and ``play`` it; the motor moves the column. Keep hands off.

    Args:
        loader: The loader, with a ``bus``.
        time_s: Length of the record.

    Raises:
        InputError: As in ``excite`` and ``play``.

    Example:
        >>> try:
        ...     ff.bus.record(ff.loader.electric("desktop-yoke"))
        ... except ff.InputError as error:
        ...     print(error)
        desktop-yoke: expected a drive on a bus; add the table [bus] with kind, port and node to its file
    """
    bus_of(loader)
    if not (period := loader["controller.period"]):
        raise InputError("controller.period: a bus requires a digital controller; set it in the loader file")
    (*_, under_law), measured = _PLAYS[loader.drive], ("column_angle", _END[loader.drive], "load_cell_force")
    plan = ExcitationPlan(time_s=time_s, rate_hz=1 / period, to_hz=USUAL_TO_HZ, measured=measured)
    excitation = excite(loader, USUAL_FIT[loader.drive], under_law, plan)
    return play(replace(excitation, signal=_SHARE[loader.drive] * excitation.signal))


def _motor_alone(excitation: Excitation, *, real_time: bool) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Times and channels of a signal that the drive gets by itself."""
    loader, bus = excitation.loader, bus_of(excitation.loader)
    setup, _ = made_of(loader, live_law(None, loader), supervised=False)
    to_rad = 1 / loader["column.base_arm"]
    try:
        drive = _core.BusDrive(setup, bus.engine, by_clock=real_time)
    except OSError as error:
        raise InputError(f"bus: {error}") from error
    rows, ended = drive.play(excitation.signal.tolist(), _MOST_RAD * loader["linkage.ratio"] / to_rad)
    if ended is not None:
        raise InputError(f"bus: the signal ended after {len(rows)} of {len(excitation.signal)} samples: {ended}")
    force, position, base, grip, current, sent = np.array(rows).T
    return sent - sent[0], {
        str(excitation.experiment.drive): excitation.signal,
        "column_angle": base * to_rad,
        "drive_position": position,
        "load_cell_force": force,
        "motor_current": current,
        "grip_force": grip,
    }


def _under_law(excitation: Excitation, law: LawLike, *, real_time: bool) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Times and channels of a signal beside the command of the law, under the supervisor."""
    loader, period = excitation.loader, excitation.loader["controller.period"]
    settles, count = round(_SETTLES_S / period), len(excitation.signal)
    axis = Axis.of(loader, law, bus_of(loader), supervised=True, host=False)
    setup = axis.setup.with_test_signal(excitation.signal.tolist(), settles)
    whole = settles + count + round(_FADES_S / period)
    (running,) = launch([replace(axis, setup=setup)], host=None, real_time=real_time, record=None, history=2 * whole)
    with running:
        running.on()
        # Of the feel's coming, the rest after it, and the signal.
        while (left := whole - running.state.cycle) > 0 and running.state.name != "tripped" and not running.state.ended:
            running.wait(min(left, _LOOKS), timeout_s=inf)
    rows = dict(zip(COLUMNS, running.history().T, strict=True))
    active = np.flatnonzero(rows["state"] == STATES.index("active"))
    begin = int(active[0]) + settles + 1 if len(active) else len(rows["state"])
    during = {name: row[begin : begin + count] for name, row in rows.items()}
    if len(during["state"]) < count or (during["state"] != STATES.index("active")).any():
        trips = ", ".join(trip.name for trip in running.trips) or "the loop ended"
        raise InputError(
            f"bus: the signal ended early: {trips}; lower the limits of the signal, such as --limit-travel '2 deg'"
        )
    lost = during["sampled"] == 0
    if lost.mean() > _LOST:
        raise InputError(
            f"bus: {lost.mean():.1%} of the samples were lost, expected at most {_LOST:.0%}; check cable and supply"
        )
    # The request that brings a sample goes with the command of the cycle before. A cycle counts as late from the beat it missed.
    sent_s = (rows["time_s"] - period * rows["missed"] + rows["late_s"])[begin - 1 : begin - 1 + count]
    known = ~(lost | _stale(during))

    def sensed(name: str) -> NDArray[np.float64]:
        return np.asarray(np.interp(sent_s, sent_s[known], during[name][known]), dtype=np.float64)

    return sent_s - sent_s[0], {
        # What the supervisor cuts off beyond the current's limit, the model's current loop does.
        str(excitation.experiment.drive): excitation.signal,
        "column_angle": sensed("column_angle_rad"),
        _END[loader.drive]: sensed("drive_position_m"),
        "load_cell_force": sensed("load_cell_force_n"),
        "grip_force": sensed("grip_force_n"),
    }


def _evenly(
    sent_s: NDArray[np.float64], channels: Mapping[str, Any], drive: str, period: float
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Times at whole periods, and channels there, of commands that were sent early or late, or not at all.

    A command holds until the next is sent: the drive has its mean over each period, ``u_k = (1/T) int u dt``. The sensors have a
    cubic spline through their samples.
    """
    edges = np.arange(int(sent_s[-1] / period) + 1, dtype=np.float64) * period
    held = np.concatenate([[0.0], np.cumsum(channels[drive][:-1] * np.diff(sent_s))])
    even = {name: CubicSpline(sent_s, values)(edges[:-1]) for name, values in channels.items() if name != drive}
    return edges[:-1], {drive: np.diff(np.interp(edges, sent_s, held)) / period, **even}


def _stale(rows: Mapping[str, NDArray[np.float64]]) -> NDArray[np.bool_]:
    """Samples in which no sensor differs from the sample before: a drive that was held up sends its last one again.

    At rest the steps of coarse sensors do the same for longer than a drive may be silent.
    """
    names = ("column_angle_rad", "drive_position_m", "load_cell_force_n")
    same = np.all([np.diff(rows[name], prepend=np.nan) == 0 for name in names], axis=0)
    starts = np.flatnonzero(np.diff(same.astype(int), prepend=0) == 1)
    ends = np.flatnonzero(np.diff(same.astype(int), append=0) == -1) + 1
    for start, end in zip(starts, ends, strict=True):
        same[start:end] = end - start <= _GAP
    return np.asarray(same)


PLAYED = ("column_angle", "drive_position", "load_cell_force", "motor_current")
"""Channels that ``play`` records."""
