"""Experiments on a bench: which loop is closed, and what moves the loader."""

from dataclasses import dataclass
from enum import StrEnum

from forcefeel.errors import InputError
from forcefeel.units import show


class Loop(StrEnum):
    """Which loop is closed.

    Example:
        >>> import forcefeel as ff
        >>> [loop.value for loop in ff.bench.Loop]
        ['servo-open', 'servo-closed', 'loader']
    """

    SERVO_OPEN = "servo-open"
    """None: the test signal alone drives the amplifier, the column hangs on the servo, the feel computer is off."""
    SERVO_CLOSED = "servo-closed"
    """The position loop, eq. (13) with delta = 0; the feel computer is off."""
    LOADER = "loader"
    """The whole loader under its law, the original one if no other is given."""


class Drive(StrEnum):
    """What moves it.

    Example:
        >>> import forcefeel as ff
        >>> [drive.value for drive in ff.bench.Drive]
        ['test_signal', 'command_signal', 'pilot_force', 'release']
    """

    TEST_SIGNAL = "test_signal"
    """A voltage at the amplifier's input, beside the law's command."""
    COMMAND_SIGNAL = "command_signal"
    """A voltage that the law adds to its command: a digital controller samples it and sends it on after its delay."""
    PILOT_FORCE = "pilot_force"
    """A force at the grip."""
    RELEASE = "release"
    """The grip is held at an angle, then let go."""


@dataclass(frozen=True)
class Experiment:
    """A loop and what drives it.

    Attributes:
        loop: Which loop is closed.
        drive: What moves the loader.

    Raises:
        InputError: When built, if the open servo is released: nothing holds its piston.

    Example:
        >>> import forcefeel as ff
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

    def __str__(self) -> str:
        return f"{self.loop} {self.drive}"

    @classmethod
    def read(cls, given: str) -> "Experiment":
        """An experiment from text: ``servo-closed``, ``loader test_signal``, ``servo-closed release``, ``release``, ``sweep``.

        A servo alone is driven by the test signal unless something else is said, the loader by the pilot's force; ``release`` and
        ``sweep`` by themselves are the loader let go and the loader under a pilot's force.

        Raises:
            InputError: If the words are no experiment.
        """
        words = given.strip().lower().replace(",", " ").split()
        match words:
            case ["sweep"]:
                return cls(Loop.LOADER, Drive.PILOT_FORCE)
            case ["release"]:
                return cls(Loop.LOADER, Drive.RELEASE)
            case [loop] if loop in set(Loop):
                return cls(Loop(loop), Drive.PILOT_FORCE if loop == Loop.LOADER else Drive.TEST_SIGNAL)
            case [loop, drive] if loop in set(Loop) and drive in set(Drive):
                return cls(Loop(loop), Drive(drive))
        raise InputError(
            f"experiment: expected {', '.join(Loop)}, release or sweep, or a loop and what drives it ({', '.join(Drive)}), such as "
            f"'servo-closed release'; got {show(given)}"
        )
