"""The drives of a project's axes on their buses, one after the other: a check of each, with the delay of all together."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from forcefeel.bus.check import check_bus, nodes_of, whole_periods
from forcefeel.bus.load import bus_load
from forcefeel.bus.result import BusCheck, BusNode, Finding
from forcefeel.errors import InputError
from forcefeel.live.bus import bus_of
from forcefeel.loader.bus import Bus
from forcefeel.loader.project import Project


@dataclass(frozen=True)
class CockpitBusCheck:
    """Checks of a project's axes.

    Attributes:
        axes: The check of each axis; axes of one port have one load, and a delay in which all of them answer.
        others: By port, the nodes that belong to no axis.
        host: Properties of this computer.
    """

    axes: Mapping[str, BusCheck]
    others: Mapping[str, tuple[BusNode, ...]]
    host: tuple[Finding, ...]

    @property
    def ok(self) -> bool:
        """Whether all buses and drives are well; the host is not counted."""
        return all(check.ok for check in self.axes.values())


def check_cockpit(project: Project, *, move: bool = False) -> CockpitBusCheck:
    """Check the drive of each axis of a project with ``check_bus``.

    A loop asks all drives of a port in one period, so their delay is that of the sum of their times: ``T ceil(sum t_99 / T)``.

    Args:
        project: The project; each of its loaders has a ``bus`` of a drive.
        move: Whether the directions are tested, one axis after the other.

    Raises:
        InputError: Before anything is powered, if two axes have one node at one port, or the node of an axis is missing or there
            twice; otherwise as ``check_bus``, with the axis.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/cockpit.toml")
        >>> try:
        ...     ff.bus.check_cockpit(project)
        ... except ff.InputError as error:
        ...     print(str(error).partition("; ")[0])
        examples/cockpit/cockpit.toml: axes.pitch: elevator-2khz: expected a drive on a bus
    """
    buses = project.each(lambda _, loader: bus_of(loader))
    taken: dict[tuple[str, int], str] = {}
    for axis, bus in buses.items():
        for key, node in (("node", bus.node), ("input_node", bus.input_node)):
            if node is not None and (other := taken.setdefault((bus.port, node), axis)) != axis:
                raise InputError(
                    f"{project.path}: axes.{axis}: expected a node of its own at {bus.port}, got {node}, which {other} has; change "
                    f"[bus] {key}, and the drive's number with the maker's tool"
                )
    project.each(lambda axis, _: _check_alone(buses[axis]))
    checks = project.each(lambda _, loader: check_bus(loader, move=move))
    together = {
        axis: sum(checks[other].delay.p99_s for other in buses if buses[other].port == bus.port)
        for axis, bus in buses.items()
    }
    loads = {
        port: bus_load(*(project.loaders[axis] for axis, bus in buses.items() if bus.port == port))
        for port in {bus.port for bus in buses.values()}
    }
    axes = {
        axis: replace(
            check,
            load=loads[buses[axis].port],
            delay=replace(check.delay, delay_s=whole_periods(together[axis], project.loaders[axis])),
        )
        for axis, check in checks.items()
    }
    others = {
        bus.port: tuple(node for node in checks[axis].nodes if (bus.port, node.node) not in taken)
        for axis, bus in buses.items()
    }
    return CockpitBusCheck(MappingProxyType(axes), MappingProxyType(others), next(iter(checks.values())).host)


def _check_alone(bus: Bus) -> None:
    """Refuses a node that is not there, or twice."""
    nodes = nodes_of(bus)
    serials = [node.serial for node in nodes if node.node == bus.node]
    if not serials:
        there = f"node {', '.join(str(node.node) for node in nodes)}" if nodes else "no other node"
        raise InputError(
            f"bus: {bus.port}: expected node {bus.node}, got no answer from it and {there}; "
            "check power, cable, adapter, and kind and node of [bus]"
        )
    if len(serials) > 1:
        raise InputError(
            f"bus: {bus.port}: expected one node {bus.node}, got {len(serials)}, with the serial numbers "
            f"{' and '.join(serials)}; give each a number of its own with the maker's tool"
        )
