"""The first minutes with a drive: its nodes, how fast it answers, whether it stops by itself, which way it counts."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, isfinite

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.bus.host import check_host
from forcefeel.bus.load import bus_load
from forcefeel.bus.result import BusCheck, BusDelay, BusNode, Finding
from forcefeel.errors import InputError
from forcefeel.live.bus import bus_of
from forcefeel.live.setup import live_law, made_of
from forcefeel.loader.bus import ANALOG, ETHERCAT, Bus
from forcefeel.loader.consistency import MOST_UNDER_WAY
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.units import to_text

COMMANDS = 1000
"""Commands by which delay and jitter are measured."""

_QUANTILE = 0.99
_SHARE = 0.1
"""Of the drive's largest command, the most by which a direction is tested."""
_RAMP_S = 1.0
_TRAVEL_RAD = 0.02
"""Angle of the column at which a direction counts as found: 1 deg."""
_STEP_S = 0.002
_CLEARED_S = 0.5
_WELL = 20
"""Commands in a row without a fault after which a drive is ready: a slave of EtherCAT comes back to OP."""
_TRIES = 3
_UNASKED = "not moved: the travel is not confirmed as free"

Confirm = Callable[[str], bool]
"""A person's answer to a question: whether it is yes."""
_ODRIVE_S = 0.25
"""By then the heartbeat of an ODrive has told that its watchdog, 0.1 s, has run out."""


def check_bus(loader: Loader, *, move: bool = False, confirm: Confirm | None = None) -> BusCheck:
    """Check the drive of a loader on its bus.

    The drive is powered without torque for the test of its watchdog.

    Args:
        loader: The loader, with a ``bus`` of a drive.
        move: Whether the directions are tested: the motor moves the column by about 1 deg, with at most a tenth of its current.
            Nothing may be in the way.
        confirm: Asks a person before the motor moves, and afterwards whether that was the positive direction; it gets the question.
            Without it both count as confirmed.

    Raises:
        InputError: If the loader has no such bus, or the node is missing, double, of another firmware, or has a fault.

    Example:
        >>> yoke = ff.loader.electric("desktop-yoke")
        >>> try:
        ...     ff.bus.check_bus(yoke)
        ... except ff.InputError as error:
        ...     print(error)
        desktop-yoke: expected a drive on a bus; add the table [bus] with kind, port and node to its file
    """
    bus = bus_of(loader)
    nodes, drive = nodes_of(bus), drive_of(loader)
    delay = _delay(drive.round_trips(COMMANDS), loader)
    watchdog = _watchdog(drive, bus)
    ask = confirm or (lambda _: True)
    directions = _Directions(loader, bus, drive, ask).found() if move and watchdog.ok else ()
    return BusCheck(nodes, bus_load(loader), delay, watchdog, directions, check_host())


def nodes_of(bus: Bus) -> tuple[BusNode, ...]:
    """What each node at a port states of itself.

    Raises:
        InputError: If the port cannot be opened.
    """
    try:
        return tuple(BusNode(*node) for node in _core.bus_nodes(bus.engine))
    except OSError as error:
        raise InputError(f"bus: {error}") from error


def drive_of(loader: Loader) -> _core.BusDrive:
    """The drive of a loader, found on its bus and stopped.

    Raises:
        InputError: If it is missing, double, of another firmware, or cannot be driven.
    """
    setup, _ = made_of(loader, live_law(None, loader), supervised=False)
    try:
        return _core.BusDrive(setup, bus_of(loader).engine)
    except OSError as error:
        raise InputError(f"bus: {error}") from error


def with_delay(loader: Loader, delay: BusDelay) -> Loader:
    """The loader with the measured delay."""
    return loader.replace({"controller.delay": delay.delay_s}, si=True)


def whole_periods(time_s: float, loader: Loader) -> float:
    """The least whole number of periods of a loader's controller in which an answer comes, in s."""
    period = loader["controller.period"]
    return ceil(time_s / period) * period if isfinite(time_s) else time_s


def _delay(times: list[float], loader: Loader) -> BusDelay:
    limit = MOST_UNDER_WAY * loader["controller.period"]
    answered = np.array([took for took in times if took < float("inf")])
    if not len(answered):
        nan = float("nan")
        return BusDelay(0, len(times), nan, nan, nan, nan, limit)
    p99 = float(np.quantile(answered, _QUANTILE))
    # A sample is answered in the first cycle that has it.
    return BusDelay(
        len(answered),
        len(times),
        float(np.median(answered)),
        p99,
        float(answered.max()),
        whole_periods(p99, loader),
        limit,
    )


def _watchdog(drive: _core.BusDrive, bus: Bus) -> Finding:
    """Powers the drive without torque, is silent for twice the watchdog, and looks whether the drive noticed."""
    name = "drive watchdog"
    # Since the last command its watchdog may have run out.
    _stop(drive)
    if why := drive.power_up():
        _stop(drive)
        return Finding(name, False, why, "clear the fault first, or set safety.power_time")
    before = drive.exchange(0.0, enable=True)
    set_by_bus = not bus.kind.startswith("odrive")
    silence = 2 * bus.watchdog_s if set_by_bus else _ODRIVE_S
    time.sleep(silence)
    after = [drive.exchange(0.0, enable=True) for _ in range(2)][-1]
    _stop(drive)
    if before is None or after is None:
        return Finding(name, False, "no answer while the drive was powered", "check cable and supply")
    if before[1]:
        return Finding(name, False, "; ".join(_core.drive_fault(before[1]) or ()), "clear the fault first")
    stopped = "; ".join(_core.drive_fault(after[1]) or ())
    if stopped.startswith("drive watchdog"):
        return Finding(name, True, f"stopped by itself within {to_text(silence, 3)} s", "")
    remedy = (
        "set watchdog in [bus]"
        if set_by_bus
        else "with odrivetool set axis.config.enable_watchdog and watchdog_timeout = 0.1"
    )
    return Finding(name, False, stopped or f"still powered after {to_text(silence, 3)} s without a command", remedy)


def _stop(drive: _core.BusDrive) -> None:
    """Stops the drive, and waits until it has cleared its fault and is ready: it states none for some commands in a row."""
    until, well = time.monotonic() + _CLEARED_S, 0
    while (answer := drive.exchange(0.0, enable=False)) is not None and well < _WELL and time.monotonic() < until:
        well = 0 if answer[1] else well + 1
        time.sleep(_STEP_S)


@dataclass(frozen=True)
class _Directions:
    """A test of the directions: a torque that rises until the column moves."""

    loader: Loader
    bus: Bus
    drive: _core.BusDrive
    confirm: Confirm

    def found(self) -> tuple[Finding, ...]:
        if not isfinite(self._largest()):
            remedy = "add current_loop.current_limit to the loader file"
            return (Finding(self._name, False, "not moved: its largest current is unknown", remedy),)
        unit = "A" if self.loader.drive == ELECTRIC else "V"
        most = f"{to_text(_SHARE * self._largest(), 3)} {unit}"
        if not self.confirm(
            f"{self.loader.name}: up to {most} will move the column by about {np.degrees(_TRAVEL_RAD):.0f} deg. Is the travel free?"
        ):
            return (Finding(self._name, False, _UNASKED, "free the travel, and keep hands off"),)
        for _ in range(_TRIES):
            moved, whole = self._moved()
            if whole:
                return self._judged(moved)
        return (Finding(self._name, False, "a fault, or no answer, while it was powered", "check cable and supply"),)

    def _moved(self) -> tuple[NDArray[np.float64], bool]:
        """Change of the sensors under a current that rises until the column moves; whether all answers came."""
        _stop(self.drive)
        start = self.drive.exchange(0.0, enable=False)
        if start is None:
            return np.empty((0, 4)), False
        if self.drive.power_up():
            _stop(self.drive)
            return np.empty((0, 4)), False
        rows, begun = [start[0]], time.monotonic()
        most = _SHARE * self._largest()
        try:
            while (share := (time.monotonic() - begun) / _RAMP_S) < 1:
                answer = self.drive.exchange(share * most, enable=True)
                if answer is None or answer[1]:
                    return np.empty((0, 4)), False
                rows.append(answer[0])
                if abs(self._angle(answer[0][1] - start[0][1])) > _TRAVEL_RAD:
                    break
                time.sleep(_STEP_S)
        finally:
            _stop(self.drive)
        return np.array(rows) - np.array(start[0]), True

    @property
    def _name(self) -> str:
        return "valve" if self.bus.kind == ANALOG else "motor"

    def _largest(self) -> float:
        """Largest command, A of a motor, V of a valve: an amplifier without a limit has that of the output."""
        if self.loader.drive == ELECTRIC:
            return self.loader["current_loop.current_limit"]
        limit = self.loader["amplifier.current_limit"] / self.loader["amplifier.admittance"]
        return min(limit, abs(self.bus.output_v or 0.0))

    def _angle(self, position: float) -> float:
        """Angle of the column where the drive's end is, with a stiff link."""
        return position / (self.loader["linkage.ratio"] * self.loader["column.base_arm"])

    def _judged(self, moved: NDArray[np.float64]) -> tuple[Finding, ...]:
        force, position, base, _ = moved[-1]
        angle = float(self._angle(position))
        valve = self.bus.kind == ANALOG
        drive, column = self._name, "column_range" if valve else "column_gear"
        if abs(angle) < _TRAVEL_RAD:
            stated = f"moved by {to_text(np.degrees(angle), 3)} deg at {_SHARE:.0%} of its largest command"
            check = "output_object and the supply's pressure" if valve else "gear and motor.torque_constant"
            return (Finding(drive, False, stated, f"free the column; check {check}"),)
        opposite = (
            "negate output in [bus]"
            if valve
            else "calibrate the drive: its torque and its position have opposite signs"
        )
        turned = f"{to_text(np.degrees(angle), 3)} deg"
        findings = [Finding(drive, angle > 0, turned, "" if angle > 0 else opposite)]
        if self.bus.senses:
            ratio = base / (position / self.loader["linkage.ratio"])
            ok = bool(0.5 < ratio < 2)  # the link's stretch is small; another gear is not
            other = "position" if valve else "gear"
            counted = self.bus.kind == ETHERCAT
            scales = f"{column}, {other}, encoder_counts and column_counts" if counted else f"{column} and {other}"
            remedy = f"negate {column}, or {other}, in [bus]" if ratio < 0 else f"check {scales} in [bus]"
            name = "column sensor" if valve else "column encoder"
            findings.append(Finding(name, ok, f"{to_text(ratio, 3)} of the {drive}'s angle", "" if ok else remedy))
        if self.bus.load_cell_n is not None:
            # The motor pushes the column: of the greatest push, whatever the link swings.
            force = float(moved[np.argmax(np.abs(moved[:, 0])), 0])
            ok = bool(force * angle > 0)
            findings.append(
                Finding("load cell", ok, f"{to_text(force, 3)} N", "" if ok else "negate load_cell in [bus]")
            )
        if all(finding.ok for finding in findings) and not self.confirm(
            f"{self.loader.name}: the column moved. Was that its positive direction?"
        ):
            keys = ("output", "position", "column_range") if valve else ("gear", "column_gear")
            keys = (*keys, "load_cell") if self.bus.load_cell_n is not None else keys
            findings[0] = Finding(
                drive, False, f"{turned}, in the negative direction", f"negate {', '.join(keys)} in [bus]"
            )
        return tuple(findings)
