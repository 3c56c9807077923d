"""The axes of a project in one loop."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from forcefeel.errors import InputError, expect, suggestion
from forcefeel.laws.law import LawLike
from forcefeel.linked.joint import common_step, delay_periods
from forcefeel.live.ending import EndsWithBlock
from forcefeel.live.endpoint import Endpoint, Simulated
from forcefeel.live.live_session import LiveSession
from forcefeel.live.starting import HISTORY, MOST_RECORD_BYTES, Axis, launch, listening, opened_record
from forcefeel.loader.links import AfterBreakout, Link, LinkKind
from forcefeel.loader.project import Project
from forcefeel.simulation.scenario import Scenario
from forcefeel.units import show

_LEAST_HISTORY = 30_000
"""Rows of each axis that are kept in memory: 15 s at 2 kHz."""


class LiveCockpit(EndsWithBlock, Mapping[str, LiveSession]):
    """The running axes of a project by name, from ``start_cockpit``: one thread, one clock, one record.

    Attributes:
        project: The project.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
        >>> with ff.live.start_cockpit(project, "robust", real_time=False) as cockpit:
        ...     cockpit.on()
        ...     cockpit.wait(10_000)
        ...     {axis: session.state.name for axis, session in cockpit.items()}
        {'stick-pitch': 'active', 'stick-pitch-first-officer': 'active'}
    """

    def __init__(self, project: Project, sessions: Mapping[str, LiveSession]) -> None:
        self.project = project
        self._sessions = MappingProxyType(dict(sessions))

    def __getitem__(self, axis: str) -> LiveSession:
        return self._sessions[axis]

    def __iter__(self) -> Iterator[str]:
        return iter(self._sessions)

    def __len__(self) -> int:
        return len(self._sessions)

    def end(self) -> None:
        """End the loop with all drives off and close the record; further calls do nothing."""
        for session in self.values():
            session.end()

    def on(self) -> None:
        """Request power and feel of all axes; each supervisor fades its feel in."""
        for session in self.values():
            session.on()

    def off(self) -> None:
        """Request no power of all axes."""
        for session in self.values():
            session.off()

    def stop(self) -> None:
        """Stop all axes immediately, like an emergency stop."""
        for session in self.values():
            session.stop()

    def acknowledge(self) -> None:
        """Clear the latched trips of all axes whose cause is gone."""
        for session in self.values():
            session.acknowledge()

    def disconnect(self, link: str) -> None:
        """Open a link: an electronic one, or the shaft between two simulated machines.

        Raises:
            InputError: If the project has no such link, or the shaft belongs to real machines.
        """
        for session in self._sides(link):
            session.disconnect()

    def connect(self, link: str) -> None:
        """Close a link that was opened or has uncoupled.

        Raises:
            InputError: As ``disconnect``.
        """
        for session in self._sides(link):
            session.connect()

    def _sides(self, link: str) -> list[LiveSession]:
        links = self.project.pilot_links
        if link not in links:
            known = f"one of {', '.join(links)}" if links else "a link between two pilots in [links] of the project"
            raise InputError(f"link: expected {known}, got {show(link)}{suggestion(link, links)}")
        return [self[axis] for axis in links[link].between]

    def wait(self, cycles: int, timeout_s: float = 60.0) -> None:
        """Wait until each axis has ``cycles`` further cycles, or the loop has ended.

        Raises:
            InputError: If that takes longer than ``timeout_s``.
        """
        for session in self.values():
            session.wait(cycles, timeout_s)


def start_cockpit(  # noqa: PLR0913  keywords of the one call that makes a loop
    project: Project,
    law: LawLike | Mapping[str, LawLike] = None,
    *,
    endpoints: Mapping[str, Endpoint] = MappingProxyType({}),
    real_time: bool = True,
    supervised: bool = True,
    host: str | int | None = None,
    soften: bool = False,
    record: str | Path | None = None,
    record_rate_hz: float | None = None,
    most_bytes: int = MOST_RECORD_BYTES,
    ring: bool = False,
    expected_s: float = 0.0,
) -> LiveCockpit:
    """Start one loop for all axes of a project, in a thread of its own.

    Each axis has its supervisor, its period, a whole multiple of the shortest, and its topics in the record. A mechanical link
    joins the columns of simulated machines; of real ones it is in the machine. An electronic link acts in both feel computers. Its
    share follows both feels, so a start, a trip or a release of the link has no step.

    Args:
        project: The project.
        law: The law of all axes, or of each by its name; as for ``start``.
        endpoints: The machines by axis; default: simulated.
        host: As for ``start``; a datagram has a packet of each axis, in the order of the file.
        soften: As for ``start``.
        real_time: As for ``start``.
        supervised: As for ``start``.
        record: As for ``start``.
        record_rate_hz: As for ``start``; requires axes of one period.
        most_bytes: As for ``start``.
        ring: As for ``start``.
        expected_s: As for ``start``.

    Returns:
        The running axes, a context manager that ends them.

    Raises:
        InputError: If an axis cannot run, with its name; a period is no whole multiple of the shortest, or a link does not fit.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> with ff.live.start_cockpit(project, "robust", real_time=False) as cockpit:
        ...     cockpit.wait(100)
        ...     list(cockpit)
        ['pitch', 'pitch-first-officer']
    """
    expect("project", project, Project, "a Project, such as loader.read_project('cockpit.toml')")
    if strangers := [axis for axis in endpoints if axis not in project.loaders]:
        raise InputError(f"endpoints: expected axes of the project ({', '.join(project.loaders)}), got {strangers[0]}")
    listens = None if host is None else listening(host, supervised=supervised)
    names = list(project.loaders)
    ends = {axis: endpoints.get(axis, Simulated()) for axis in names}
    links, of_axis = [], dict[str, Link]()
    for joint in project.links.values():
        sides = project.sides(joint)
        links.append(
            (
                (names.index(joint.between[0]), names.index(joint.between[1])),
                joint.values.tolist(),
                delay_periods(joint, sides),
                joint.after_breakout is AfterBreakout.UNCOUPLE,
                joint.joins_pilots,
            )
        )
        shaft = joint.kind is LinkKind.MECHANICAL
        if shaft and len({isinstance(ends[axis], Simulated) for axis in joint.between}) > 1:
            raise InputError(
                f"links.{joint.name}: is a shaft between {' and '.join(joint.between)}; expected two real machines or two "
                "simulated ones, got one of each; name the other machine too"
            )
        period = sides[0]["controller.period"]
        for axis in joint.between:
            if joint.joins_pilots:
                of_axis[axis] = joint
            end = ends[axis]
            if shaft and not isinstance(end, Simulated):
                continue
            # In real time the machine goes on after its scenario, so one of a period is as good as none.
            given = end.scenario if isinstance(end, Simulated) else None
            scenario = given or Scenario(duration_s=period, sample_s=period)
            step_s = common_step(joint, sides, scenario)
            if shaft:
                ends[axis] = Simulated(replace(scenario, step_s=step_s))
    axes = []
    for axis, loader in project.loaders.items():
        axis_law = law.get(axis) if isinstance(law, Mapping) else law
        try:
            flaps, listened = project.flap_trim.get(axis, 0.0), listens is not None
            made = Axis.of(
                loader, axis_law, ends[axis], supervised=supervised, host=listened, softens=soften, flap_trim=flaps
            )
        except InputError as error:
            raise InputError(f"axes.{axis}: {error}") from error
        asked = endpoints.get(axis)
        cycles = made.cycles if isinstance(asked, Simulated) and asked.scenario else None
        stops = tuple(names.index(other) for other in project.stops[axis])
        axes.append(replace(made, name=axis, stops=stops, cycles=cycles, link=of_axis.get(axis)))
    kept = opened_record(record, record_rate_hz, most_bytes, expected_s, list(project.loaders.values()), ring=ring)
    sessions = launch(
        axes,
        host=listens,
        real_time=real_time,
        record=kept,
        links=links,
        history=max(_LEAST_HISTORY, 2 * HISTORY // len(axes)),
    )
    return LiveCockpit(project, dict(zip(names, sessions, strict=True)))
