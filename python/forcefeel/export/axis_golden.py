"""Inputs of the golden vectors of a supervised law: those of the firmware, then requests, and faults of sensors and loop."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.export.exported import Exported
from forcefeel.export.firmware_code import golden_inputs

_Part = tuple[NDArray[np.float64], NDArray[np.int64]]

_FORCE, _POSITION, _BASE, _TRIM, _SHAKER, _ADDED = 0, 1, 2, slice(4, 7), 6, (8, 9, 10)
_REQUEST, _MISSED, _DELAY, _LATE, _FLAGS, _HOST_AGE = range(2, 8)
_OFF, _PASSIVE, _ACTIVE = 0, 1, 2
_DRIVE_FAULT, _ACKNOWLEDGED, _HOST, _DRIVE_ACTS = 2, 4, 8, 16
_ANGLE_RAD = 0.3
"""Jump of the column's angle: no reading that a prediction explains."""
_LATE_PERIODS = 9
_BEYOND_BRIDGE = 40
"""Samples of a wrong reading, more than are bridged."""
_POWERED = 30
"""Samples that a drive takes to act."""
_THROWN = 220
"""Samples in which the column comes to one and a half times its speed limit, slowly enough for its observer."""
_APART_RAD, _LED = 0.08, 900
"""How far a column is led, farther than its feel is let be ahead of it, and its samples."""
_SHAKEN_RAD, _SHAKEN = 0.03, 40
"""Likewise of a column that is shaken."""


def axis_inputs(exported: Exported) -> _Part:
    """Numbers (samples, 11) and words (samples, 8) for ``BoardAxis.answers``: every state, and faults.

    A fault ends in a trip, an acknowledgment and a new start.
    """
    inputs, words = golden_inputs(exported)
    script = _Script(exported, inputs[:1])
    _requests(script)
    _faults(script)
    numbers, asked = zip((inputs, words), *script.parts, strict=True)
    return np.vstack(numbers), np.vstack(asked)


class _Script:
    """Parts of the golden vectors, each at rest until it is written over."""

    def __init__(self, exported: Exported, rest: NDArray[np.float64]) -> None:
        self.loader, self.rest, self.parts = exported.loader, rest, list[_Part]()
        self.period = exported.sampled().period_s
        self.check = self.samples("safety.stuck_time")
        self.on = self.check + self.samples("safety.fade_time") + 20

    def samples(self, row: str) -> int:
        """Periods of a time of the loader file."""
        return round(self.loader[row] / self.period)

    def part(self, length: int, request: int = _ACTIVE) -> _Part:
        """So many samples more."""
        numbers, asked = np.repeat(self.rest, length, axis=0), np.zeros((length, 8), dtype=np.int64)
        asked[:, _REQUEST], asked[:, _FLAGS] = request, _DRIVE_ACTS
        self.parts.append((numbers, asked))
        return numbers, asked

    def restart(self, length: int) -> _Part:
        """So many samples from a new start, after a stop, an acknowledgment and off."""
        self.part(self.samples("safety.stop_time") + 20)
        _, asked = self.part(10, _OFF)
        asked[0, _FLAGS] |= _ACKNOWLEDGED
        return self.part(length)


def _requests(script: _Script) -> None:
    """Requests that change before they are reached, and what is no number around the feel."""
    check, on = script.check, script.on
    numbers, asked = script.restart(on)
    asked[1:4, _MISSED] = 1, 2, 3  # nothing sampled at the start
    numbers[20:60, _TRIM] = np.nan
    numbers[60:80, _SHAKER] = 0.2
    asked[check + 50 : check + 90, _REQUEST] = _PASSIVE
    script.part(on, _PASSIVE)
    _, asked = script.part(5, _OFF)
    asked[1:3, _FLAGS] |= _DRIVE_FAULT
    script.part(check // 2, _PASSIVE)
    script.part(5, _OFF)
    _, asked = script.part(check + 20, _PASSIVE)
    asked[-2:, _FLAGS] |= _DRIVE_FAULT
    # No number beside the hand's force while the feel comes.
    for added in _ADDED:
        numbers, _ = script.restart(check + 120)
        numbers[check + 100 : check + 105, added] = np.nan
    # A host that falls silent, then goes on; without a host its age counts for nothing.
    silent = script.samples("safety.host_time")
    _, asked = script.restart(check + silent + 200)
    asked[check:, _FLAGS] |= _HOST
    asked[check + 20 : check + silent + 120, _HOST_AGE] = range(silent + 100)
    asked[-20:, _HOST_AGE] = silent
    asked[-20:, _FLAGS] = _DRIVE_ACTS


def _faults(script: _Script) -> None:
    """Samples that are wrong, lost or late, a force and a speed of no hand, faults of drive and loop."""
    loader, check, on = script.loader, script.check, script.on
    arm, silent = loader["column.base_arm"], script.samples("safety.silence_time") + 3
    # An angle that jumps for a sample; silence for too long, after which the sensors stand elsewhere.
    numbers, asked = script.restart(on + 200)
    numbers[on, _BASE] += _ANGLE_RAD * arm
    asked[on + 100, _MISSED] = silent
    numbers[on + 101 :, _BASE] += 0.01 * arm
    _, asked = script.restart(on + silent + 100)
    asked[on : on + 5, _DELAY] = asked[on + 50 : on + 50 + silent, _DELAY] = _LATE_PERIODS
    # A drive position that jumps and stays.
    numbers, _ = script.restart(on + _BEYOND_BRIDGE)
    numbers[on:, _POSITION] += _ANGLE_RAD * arm * loader["linkage.ratio"]
    overrun = script.samples("safety.overrun_time") + 3
    _, asked = script.restart(on + overrun)
    asked[on:, _LATE] = range(1, overrun + 1)
    numbers, _ = script.restart(on + 200)
    numbers[on : on + 100, _FORCE] += np.linspace(0.0, 2.0, 100) * loader["safety.absolute_force"]
    # A drive fault while the feel is there, and while it comes.
    for begins in (on, check + 100):
        numbers, asked = script.restart(begins + 5)
        numbers[begins - 90 :, _FORCE] += 0.2 * loader["pilot.force"]
        asked[begins:, _FLAGS] |= _DRIVE_FAULT
    # A drive that fails before it acts; one that takes its time to act, then stops by itself.
    _, asked = script.restart(check + _POWERED)
    asked[:, _FLAGS] = 0
    asked[-3:, _FLAGS] = _DRIVE_FAULT
    _, asked = script.restart(on + _POWERED)
    asked[: check + _POWERED, _FLAGS] = asked[-3:, _FLAGS] = 0
    # A column that is thrown, its link following.
    numbers, _ = script.restart(on + _THROWN)
    thrown = 0.75 * loader["safety.speed_limit"] * script.period / _THROWN * np.arange(_THROWN) ** 2
    numbers[on:, _BASE] += thrown * arm
    numbers[on:, _POSITION] += thrown * arm * loader["linkage.ratio"]
    # A column that is led away from its feel without a hand, and back beyond it; and one that is shaken, so that the command jumps.
    for apart, length in ((_APART_RAD, _LED), (_SHAKEN_RAD, _SHAKEN)):
        numbers, _ = script.restart(on + length)
        led = apart * np.sin(2.0 * np.pi * np.arange(length) / length)
        numbers[on:, _BASE] += led * arm
        numbers[on:, _POSITION] += led * arm * loader["linkage.ratio"]
    numbers, _ = script.restart(20)
    numbers[10:, _FORCE] = 1.5 * loader["safety.force_range"]
