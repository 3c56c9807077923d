"""The options of a run of two linked loaders: the second pilot, and what happens to the link."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

from cyclopts import Group

from forcefeel.cli.options import option
from forcefeel.cli.scenario_inputs import START_S, InputKind
from forcefeel.cli.scenario_options import ScenarioOptions
from forcefeel.cli.scenario_text import seconds, value
from forcefeel.errors import InputError, suggestion
from forcefeel.loader.arms import Arm
from forcefeel.units import show

if TYPE_CHECKING:
    from forcefeel.linked import LinkedScenario
    from forcefeel.loader.project import Project
    from forcefeel.simulation.inputs import Force

LINKED = Group("Second pilot and link of a project", sort_key=30)


@dataclass(frozen=True, kw_only=True)
class LinkedOptions(ScenarioOptions):
    """The options as given; ``None`` is not given."""

    link: Annotated[str | None, option("Link of the project.", LINKED, default="the only one", metavar="NAME")] = None
    second_force: Annotated[
        str | None,
        option("Step of force of the second pilot, such as '-40 lb'.", LINKED, default="hands off", metavar="FORCE"),
    ] = None
    second_start: Annotated[
        str | None, option("Start of the second pilot's force.", LINKED, default="0.1 s", metavar="TIME")
    ] = None
    second_width: Annotated[
        str | None, option("Length of the second pilot's force.", LINKED, default="to the end", metavar="TIME")
    ] = None
    second_arm: Annotated[
        Arm | None, option("Second pilot's arm at the grip, as for --arm.", LINKED, default="the loader's")
    ] = None
    disconnect: Annotated[str | None, option("Time at which the link is opened.", LINKED, metavar="TIME")] = None
    jam: Annotated[
        str | None,
        option("Column that jams and when, such as '0.5 s: pitch-first-officer'.", LINKED, metavar="TIME: AXIS"),
    ] = None
    priority: Annotated[
        str | None,
        option(
            "Pilot who presses the priority button and from when on, such as '0.5 s: stick-pitch-first-officer'.",
            LINKED,
            metavar="TIME: AXIS",
        ),
    ] = None

    def linked_project(self, path: Path | None) -> "Project | None":
        """The project of ``path``, with ``--set`` for each loader and each pilot's arm at its own; ``None`` for a loader.

        Raises:
            InputError: As ``project``; if the project has several links and none is named; or options of a link are given
                with a loader.
        """
        project = replace(self, arm=None).project(path)
        if project is None:
            self._refuse_linked()
            return None
        arms = dict(zip(project.links[self.link_name(project)].between, ("--arm", "--second-arm"), strict=True))
        values = {"--arm": self.arm, "--second-arm": self.second_arm}
        loaders = {
            axis: self.armed(arms[axis], loader, values[arms[axis]]) if axis in arms else loader
            for axis, loader in project.loaders.items()
        }
        return replace(project, loaders=loaders)

    def link_name(self, project: "Project") -> str:
        """The link to simulate.

        Raises:
            InputError: If the project has several links and the option names none of them.
        """
        names = [*project.links]
        if self.link is None and len(names) > 1:
            raise InputError(f"--link: expected one of {', '.join(names)}, got none; name the link to simulate")
        if self.link is not None and self.link not in names:
            raise InputError(
                f"--link: expected {' or '.join(names)}, got {show(self.link)}{suggestion(self.link, names)}"
            )
        return self.link or names[0]

    def linked_scenario(self, project: "Project") -> "LinkedScenario":
        """What both pilots do, and what happens to the link.

        Raises:
            InputError: If an option is bad.
        """
        from forcefeel.linked import Button, Jam, LinkedScenario

        first = self.scenario(project.loaders[project.links[self.link_name(project)].between[0]])
        opened = None if self.disconnect is None else seconds("--disconnect", self.disconnect)
        between = project.links[self.link_name(project)].between
        jam, button = _event(Jam, "--jam", self.jam), _event(Button, "--priority", self.priority)
        events = {"--jam": jam, "--priority": button}
        times = {"--disconnect": opened, **{name: event.at_s for name, event in events.items() if event is not None}}
        for name, time in times.items():
            if time is not None and not 0 < time <= first.duration_s:
                raise InputError(f"{name}: expected a time within the run of {first.duration_s:g} s, got {time:g} s")
        for name, event in events.items():
            if event is not None and event.axis not in between:
                raise InputError(
                    f"{name}: expected {' or '.join(between)}, got {show(event.axis)}; name an axis of the link"
                )
        if self.change:
            raise InputError("--change: is for one loader; leave it out, or simulate the loader of one axis")
        if self.input is InputKind.RELEASE:
            if self.second_force is not None:
                raise InputError("--second-force: given with --input release, which is of both hands; leave one out")
            return LinkedScenario(first, first.force, opened, jam, button)
        return LinkedScenario(first, self._second(), opened, jam, button)

    def _second(self) -> "Force":
        from forcefeel.simulation import inputs

        if self.second_force is None:
            for name, text in (("--second-start", self.second_start), ("--second-width", self.second_width)):
                if text is not None:
                    raise InputError(f"{name}: requires a --second-force; add one or leave it out")
            return inputs.HandsOff()
        force = value("--second-force", self.second_force, "N", "-40 lb")
        start = START_S if self.second_start is None else seconds("--second-start", self.second_start)
        if self.second_width is None:
            return inputs.Step(force, start)
        return inputs.Pulse(force, start, seconds("--second-width", self.second_width))

    def _refuse_linked(self) -> None:
        second = {name: getattr(self, name) for name in ("second_force", "second_start", "second_width", "second_arm")}
        for name, given in {
            "link": self.link,
            **second,
            "disconnect": self.disconnect,
            "jam": self.jam,
            "priority": self.priority,
        }.items():
            if given is not None:
                raise InputError(
                    f"--{name.replace('_', '-')}: is for two linked axes; name a project file with a table [links], such as "
                    "examples/cockpit/transport-column.toml, or leave it out"
                )


Event = TypeVar("Event")


def _event(kind: Callable[[str, float], Event], name: str, text: str | None) -> Event | None:
    """A time and an axis as an event."""
    if text is None:
        return None
    time, colon, axis = text.partition(":")
    if not colon:
        raise InputError(f"{name}: expected a time and an axis such as '0.5 s: pitch-first-officer', got {show(text)}")
    return kind(axis.strip(), seconds(name, time.strip()))
