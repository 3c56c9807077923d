"""Experiments on a bench: the closed loop and the drive."""

from dataclasses import dataclass
from enum import StrEnum

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC, a_drive
from forcefeel.units import show


class Loop(StrEnum):
    """Which loop is closed."""

    SERVO_OPEN = "servo-open"
    """None: the test signal alone drives the amplifier, the column hangs on the servo, the feel computer is off."""
    SERVO_CLOSED = "servo-closed"
    """The position loop, eq. (13) with delta = 0; the feel computer is off."""
    MOTOR_OPEN = "motor-open"
    """None: the test current alone drives the motor, the column hangs on it, the feel computer is off."""
    LOADER = "loader"
    """The whole loader under its law, the original one if no other is given."""


class Drive(StrEnum):
    """Input that moves the loader."""

    TEST_SIGNAL = "test_signal"
    """A voltage at the amplifier's input, beside the law's command."""
    COMMAND_SIGNAL = "command_signal"
    """A voltage that the law adds to its command: a digital controller samples it and sends it on after its delay."""
    TEST_CURRENT = "test_current"
    """A current asked of the motor's current loop, beside the law's command."""
    COMMAND_CURRENT = "command_current"
    """A current that the law adds to its command: sampled and sent on after the controller's delay."""
    PILOT_FORCE = "pilot_force"
    """A force at the grip."""
    RELEASE = "release"
    """The grip is held at an angle, then let go."""


_MADE_FOR = {
    Loop.SERVO_OPEN: HYDRAULIC,
    Loop.SERVO_CLOSED: HYDRAULIC,
    Loop.MOTOR_OPEN: ELECTRIC,
    Drive.TEST_SIGNAL: HYDRAULIC,
    Drive.COMMAND_SIGNAL: HYDRAULIC,
    Drive.TEST_CURRENT: ELECTRIC,
    Drive.COMMAND_CURRENT: ELECTRIC,
}
"""Loops and drives that only loaders with one kind of drive have."""

_ALONE = {Loop.MOTOR_OPEN: Drive.TEST_CURRENT, Loop.LOADER: Drive.PILOT_FORCE}
"""Default drive of a loop; of the others, the test signal."""


@dataclass(frozen=True)
class Experiment:
    """A closed loop and its drive.

    Attributes:
        loop: Which loop is closed.
        drive: Input that moves the loader.

    Raises:
        InputError: When built, if the open servo or the open motor is released, or loop and drive belong to different kinds of
            loader.

    Example:
        >>> ff.bench.Experiment.read("servo-closed").loop.value
        'servo-closed'
    """

    loop: Loop
    drive: Drive = Drive.TEST_SIGNAL

    def __post_init__(self) -> None:
        if self.loop is Loop.SERVO_OPEN and self.drive is Drive.RELEASE:
            raise InputError(
                "experiment: a release of the open servo has no rest to begin from; close its position loop"
            )
        if self.loop is Loop.MOTOR_OPEN and self.drive is Drive.RELEASE:
            raise InputError(
                "experiment: a release of the open motor has no rest to begin from; take 'release', under the law"
            )
        made_for = {_MADE_FOR[part] for part in (self.loop, self.drive) if part in _MADE_FOR}
        if len(made_for) > 1:
            raise InputError(
                f"experiment: {self.loop} and {self.drive} do not go together: one is of a {HYDRAULIC} drive, the other of an "
                f"{ELECTRIC} one; a motor is driven by {Drive.TEST_CURRENT} or {Drive.COMMAND_CURRENT}, a valve by "
                f"{Drive.TEST_SIGNAL} or {Drive.COMMAND_SIGNAL}"
            )

    def __str__(self) -> str:
        return f"{self.loop} {self.drive}"

    @property
    def made_for(self) -> str | None:
        """The kind of loader, hydraulic or electric, if only one kind has this experiment; else ``None``."""
        return _MADE_FOR.get(self.loop) or _MADE_FOR.get(self.drive)

    @classmethod
    def read(cls, text: str) -> "Experiment":
        """An experiment from text: ``servo-closed``, ``loader test_signal``, ``servo-closed release``, ``release``, ``sweep``.

        Default drives: the test signal for a servo, the test current for ``motor-open``, the pilot's force for the loader.
        ``release`` and ``sweep`` alone mean the loader released and the loader under a pilot's force.

        Raises:
            InputError: If the text names no experiment.
        """
        words = text.strip().lower().replace(",", " ").split()
        match words:
            case ["sweep"]:
                return cls(Loop.LOADER, Drive.PILOT_FORCE)
            case ["release"]:
                return cls(Loop.LOADER, Drive.RELEASE)
            case [loop] if loop in set(Loop):
                return cls(Loop(loop), _ALONE.get(Loop(loop), Drive.TEST_SIGNAL))
            case [loop, drive] if loop in set(Loop) and drive in set(Drive):
                return cls(Loop(loop), Drive(drive))
        raise InputError(
            f"experiment: expected {', '.join(Loop)}, release or sweep, or a loop and its drive ({', '.join(Drive)}), such as "
            f"'servo-closed release'; got {show(text)}"
        )


_INSTEAD = {
    HYDRAULIC: "servo-open, servo-closed or loader, driven by test_signal, command_signal or pilot_force, and release",
    ELECTRIC: "motor-open or loader, driven by test_current, command_current or pilot_force, and release",
}


def check_experiment(experiment: Experiment, loader: Loader, where: str = "experiment") -> None:
    """Refuse an experiment that the drive of a loader does not support.

    Raises:
        InputError: If so, with the supported experiments.
    """
    if experiment.made_for not in (None, loader.drive):
        raise InputError(
            f"{where}: {experiment} is made for {a_drive(str(experiment.made_for))}, and {loader.name} has "
            f"{a_drive(loader.drive)}; for that there are {_INSTEAD[loader.drive]}"
        )
