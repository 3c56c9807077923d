"""The pilot's input that the options describe."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import ceil, degrees, floor, isfinite, pi
from typing import TYPE_CHECKING, Literal

from forcefeel.cli.scenario_text import seconds, value, values
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from forcefeel.simulation.inputs import Force


class InputKind(StrEnum):
    """What the pilot does to the grip."""

    STEP = "step"
    PULSE = "pulse"
    DOUBLET = "doublet"
    STOP_TO_STOP = "stop-to-stop"
    CHIRP = "chirp"
    MULTISINE = "multisine"
    RELEASE = "release"
    HANDS_OFF = "hands-off"


class Spacing(StrEnum):
    """How a chirp's frequency runs."""

    LINEAR = "linear"
    LOGARITHMIC = "logarithmic"


_LASTING = (InputKind.STOP_TO_STOP, InputKind.CHIRP, InputKind.MULTISINE)

OPTIONS: Mapping[str, tuple[InputKind, ...]] = {
    "--force": (InputKind.STEP, InputKind.PULSE, InputKind.DOUBLET, *_LASTING),
    "--start": (InputKind.STEP, InputKind.PULSE, InputKind.DOUBLET, InputKind.RELEASE),
    "--width": (InputKind.PULSE, InputKind.DOUBLET),
    "--angle": (InputKind.RELEASE,),
    "--input-duration": _LASTING,
    "--from": (InputKind.CHIRP, InputKind.MULTISINE),
    "--to": (InputKind.CHIRP, InputKind.MULTISINE),
    "--spacing": (InputKind.CHIRP,),
    "--lines": (InputKind.MULTISINE,),
}
"""The inputs that each option is for."""

DURATION_S = dict.fromkeys(InputKind, 2.0) | {
    InputKind.STOP_TO_STOP: 100.0,
    InputKind.CHIRP: 20.0,
    InputKind.MULTISINE: 10.0,
}
"""Length of a run where it is not given."""

START_S, WIDTH_S = 0.1, 0.5
FROM_HZ, TO_HZ = 0.2, 20.0

_MOST_LINES = 10_000


@dataclass(frozen=True)
class InputOptions:
    """The options of an input.

    Attributes:
        kind: Which input.
        given: The options that are given, by name.
        force_n: The force if it is not given.
        duration_s: Length of the run.
        step_s: The engine's step, on which times that are not given fall.

    Raises:
        InputError: If an option is for another input.
    """

    kind: InputKind
    given: Mapping[str, str]
    force_n: float
    duration_s: float
    step_s: float

    def __post_init__(self) -> None:
        for option in self.given:
            if self.kind not in OPTIONS[option]:
                fit = " or ".join(OPTIONS[option])
                raise InputError(f"{option}: is for --input {fit}; the input is {self.kind}, so leave it out")

    def build(self) -> "Force":
        """The input.

        Raises:
            InputError: If an option is bad or missing.
        """
        from forcefeel.simulation import inputs

        match self.kind:
            case InputKind.HANDS_OFF:
                return inputs.HandsOff()
            case InputKind.RELEASE:
                return inputs.Release(self._angle(), self._start())
            case InputKind.STEP:
                return inputs.Step(self._force(), self._start())
            case InputKind.PULSE:
                return inputs.Pulse(self._force(), self._start(), self._time("--width", WIDTH_S))
            case InputKind.DOUBLET:
                return inputs.Doublet(self._force(), self._start(), self._time("--width", WIDTH_S))
            case _:
                return self._lasting()

    def _lasting(self) -> "Force":
        from forcefeel.simulation import inputs

        lasts = self._time("--input-duration", self.duration_s)
        match self.kind:
            case InputKind.STOP_TO_STOP:
                return inputs.StopToStop(self._force(), lasts)
            case InputKind.CHIRP:
                spacing: Literal["linear", "logarithmic"] = (
                    "logarithmic" if self.given.get("--spacing") == Spacing.LOGARITHMIC else "linear"
                )
                band = self._hertz("--from", FROM_HZ), self._hertz("--to", TO_HZ)
                return inputs.Chirp(self._force(), *band, lasts, spacing)
            case _:
                return inputs.Multisine(self._force(), self._lines(lasts), lasts)

    def _force(self) -> float:
        return value("--force", self.given["--force"], "N", "20 lb") if "--force" in self.given else self.force_n

    def _angle(self) -> float:
        if "--angle" not in self.given:
            raise InputError(
                "--angle: expected with --input release the angle at which the grip is held, such as '10 deg'"
            )
        angle = value("--angle", self.given["--angle"], "rad", "10 deg")
        if abs(angle) > pi * (1 + 1e-9):  # 180 deg to rounding
            raise InputError(f"--angle: expected -180 to 180 deg, got {degrees(angle):g} deg")
        return angle

    def _start(self) -> float:
        if self.kind is InputKind.RELEASE and "--start" not in self.given:
            return 0.0
        start = self._time("--start", START_S)
        if start >= self.duration_s:
            raise InputError(
                f"--start: expected a time before the end of the run at {self.duration_s:g} s, got {start:g} s; "
                "let the run last longer"
            )
        return start

    def _time(self, option: str, otherwise: float) -> float:
        if option in self.given:
            return seconds(option, self.given[option])
        return max(round(otherwise / self.step_s), 1) * self.step_s

    def _hertz(self, option: str, otherwise: float) -> float:
        if option not in self.given:
            return otherwise
        return value(option, self.given[option], "rad/s", "2 Hz") / (2 * pi)

    def _lines(self, period_s: float) -> tuple[float, ...]:
        """The lines that are given, or all that there are from one frequency to another."""
        if "--lines" in self.given:
            for option in ("--from", "--to"):
                if option in self.given:
                    raise InputError(f"{option}: given with --lines, which names every line; leave one out")
            return tuple(line / (2 * pi) for line in values("--lines", self.given["--lines"], "rad/s", "2 Hz"))
        low, high = self._hertz("--from", FROM_HZ), self._hertz("--to", TO_HZ)
        first, last = low * period_s * (1 - 1e-9), high * period_s * (1 + 1e-9)  # rounding of whole cycles
        if isfinite(first) and isfinite(last):
            first, last = max(ceil(first), 1), floor(last)
        if not 0 <= last - first < _MOST_LINES:
            raise InputError(
                f"--from, --to: expected 1 to {_MOST_LINES} multiples of {1 / period_s:g} Hz, one over the period, from "
                f"{low:g} Hz to {high:g} Hz, got {max(last - first + 1, 0):.6g}; change the band or --input-duration"
            )
        return tuple(cycles / period_s for cycles in range(int(first), int(last) + 1))
