"""What two pilots do, and what happens to the link between their controls."""

from dataclasses import dataclass, field, replace

from forcefeel.errors import InputError, expect, expect_number
from forcefeel.loader.links import Link, LinkKind
from forcefeel.simulation.inputs import Force, HandsOff, Recorded, Release
from forcefeel.simulation.scenario import Scenario


@dataclass(frozen=True)
class Jam:
    """The column of one side is held from a time on, where it is then.

    Attributes:
        axis: The axis of the column.
        at_s: When.

    Example:
        >>> ff.linked.Jam("pitch-first-officer", at_s=0.5).axis
        'pitch-first-officer'
    """

    axis: str
    at_s: float


@dataclass(frozen=True)
class Button:
    """The pilot of one side presses the priority button from a time on.

    Attributes:
        axis: The axis of the pilot.
        at_s: When.

    Example:
        >>> ff.linked.Button("stick-pitch", at_s=0.5).axis
        'stick-pitch'
    """

    axis: str
    at_s: float


@dataclass(frozen=True)
class LinkedScenario:
    """The inputs of a run of two linked loaders.

    Attributes:
        first: Of the first loader; its lengths of time hold for both.
        second_force: Of the second pilot. A release is of both, from one angle.
        disconnect_s: When the link is opened; it stays open.
        jam: Of one of both columns.
        button: Of one of both pilots, of an electronic link.

    Raises:
        InputError: If a time is out of range, or the link would be loaded before the run begins.

    Example:
        >>> both = ff.linked.LinkedScenario(ff.Scenario(ff.Step(200.0)), second_force=ff.Step(-200.0))
        >>> both.second.force
        Step(force_n=-200.0, start_s=0.0)
    """

    first: Scenario
    second_force: Force = field(default_factory=HandsOff)
    disconnect_s: float | None = None
    jam: Jam | None = None
    button: Button | None = None

    def __post_init__(self) -> None:
        expect("first", self.first, Scenario, "a Scenario, such as Scenario(Step(100.0))")
        for name, value in (
            ("disconnect_s", self.disconnect_s),
            ("jam.at_s", None if self.jam is None else self.jam.at_s),
            ("button.at_s", None if self.button is None else self.button.at_s),
        ):
            if value is not None:
                expect_number(name, value)
                if not 0 < value <= self.first.duration_s:
                    raise InputError(
                        f"{name}: expected a time within the run of {self.first.duration_s:g} s, got {value:g} s"
                    )
        if self.first.feel_changes:
            raise InputError("feel_changes: a run of linked loaders takes none; leave them out")
        forces = (self.first.force, self.second_force)
        released = [force for force in forces if isinstance(force, Release)]
        if released and released[:1] * 2 != list(forces):
            raise InputError("second_force: a release is of both pilots, alike; give both the same Release, or none")
        for force in forces:
            if isinstance(force, Recorded) and force.force_n[0] != 0:
                raise InputError(
                    f"{force.name}: expected a first force of 0, as the link is at rest, got {force.force_n[0]:g} N"
                )

    @property
    def second(self) -> Scenario:
        """The inputs of the second loader."""
        return replace(self.first, force=self.second_force)


def side_and_step(name: str, event: Jam | Button | None, link: Link, step_s: float) -> tuple[int, int] | None:
    """Which side, 0 or 1, and the engine's step; ``None`` without an event.

    Raises:
        InputError: If its axis is not of the link, or a button is not of an electronic link.
    """
    if event is None:
        return None
    if isinstance(event, Button) and link.kind is not LinkKind.ELECTRONIC:
        raise InputError(f"{name}: is of an electronic link, and {link.name} is mechanical; leave it out")
    if event.axis not in link.between:
        raise InputError(f"{name}: expected {' or '.join(link.between)}, got {event.axis!r}")
    return link.between.index(event.axis), on_step(event.at_s, step_s)


def on_step(time_s: float, step_s: float) -> int:
    """The engine's step nearest to a time, at least the first."""
    return max(round(time_s / step_s), 1)
