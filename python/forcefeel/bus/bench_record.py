"""A bench signal on a drive's bus: the record that an identification reads."""

from math import radians
from typing import Any

import numpy as np

from forcefeel import _core
from forcefeel.bench.excitation import Excitation
from forcefeel.bench.experiments import Drive, Loop
from forcefeel.bench.records import BenchRecord
from forcefeel.bus.check import bus_of
from forcefeel.errors import InputError
from forcefeel.live.setup import live_law, made_of
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.units import to_text

_EVEN = 0.1
"""Share of a period by which commands may come off their times and count as even."""

_GAP = 5.0
"""Periods that a record may lack, as in any bench record."""

_MOST_RAD = radians(15.0)
"""Angle of the column at which a signal is stopped."""


def play(excitation: Excitation, *, real_time: bool = True) -> BenchRecord:
    """Give the motor of a loader a bench signal over its bus, and record its sensors.

    The motor alone moves the column, without a law: keep hands off, and free its travel. The drive stops at the end, at 15 deg from
    where the column began, at a fault, and where it does not answer.

    Args:
        excitation: A signal of the experiment ``motor-open``, at the rate of the loader's controller.
        real_time: Play by the clock; otherwise as fast as the drive answers: for an emulator without a clock.

    Raises:
        InputError: If the signal is for another experiment or of another rate, the loader has no bus with a load cell and a column
            encoder, the drive stopped early, or this computer missed more than 5 periods in a row.

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
    loader, experiment = excitation.loader, excitation.experiment
    bus = bus_of(loader)
    if experiment.loop is not Loop.MOTOR_OPEN or experiment.drive is not Drive.TEST_CURRENT:
        raise InputError(
            f"experiment: a bus plays motor-open, got {experiment}; choose it with --experiment motor-open"
        )
    if not bus.senses:
        raise InputError(
            "bus: a bench record requires a load cell and an encoder at the column; add load_cell and column_gear"
        )
    step, period = float(excitation.time_s[1] - excitation.time_s[0]), loader["controller.period"]
    if abs(step - period) > 1e-6 * period:  # of times with nine digits
        rate, got = to_text(1 / period, 6), to_text(1 / step, 6)
        raise InputError(f"rate: expected the controller's, {rate} Hz, got {got} Hz; use --rate {rate}")
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
    if real_time and (longest := float(np.diff(sent).max())) > _GAP * period:
        raise InputError(
            f"bus: a command came {1e3 * longest:.1f} ms after the one before, expected at most {_GAP:g} periods of "
            f"{1e3 * period:g} ms; run it on an idle computer with real-time priority"
        )
    # Where a command came late, those after it are as late.
    even = not real_time or float(np.abs(sent - sent[0] - excitation.time_s).max()) < _EVEN * period
    time_s = excitation.time_s if even else sent - sent[0]
    channels: dict[str, Any] = {
        str(experiment.drive): excitation.signal,
        "column_angle": base * to_rad,
        "drive_position": position,
        "load_cell_force": force,
        "motor_current": current,
    }
    if has_grip_sensor(loader) and bus.grip_sensor_n is not None:
        channels["grip_force"] = grip
    return BenchRecord("bus", experiment, time_s, channels, hold="staircase")


PLAYED = ("column_angle", "drive_position", "load_cell_force", "motor_current")
"""Channels that ``play`` records."""
