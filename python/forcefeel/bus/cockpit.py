"""The drives of a project's axes on their buses, one after the other: a check of each, with the delay of all together."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from forcefeel.bus.check import Confirm, check_bus, drive_of, whole_periods
from forcefeel.bus.load import bus_load
from forcefeel.bus.result import BusCheck, BusNode, Finding
from forcefeel.errors import InputError
from forcefeel.live.bus import bus_of
from forcefeel.loader.bus import ANALOG, ETHERCAT
from forcefeel.loader.loader import Loader
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


def check_cockpit(project: Project, *, move: bool = False, confirm: Confirm | None = None) -> CockpitBusCheck:
    """Check the drive of each axis of a project with ``check_bus``.

    A loop asks all drives of a port in one period, so their delay is that of the sum of their times: ``T ceil(sum t_99 / T)``.

    Args:
        project: The project; each of its loaders has a ``bus`` of a drive.
        move: Whether the directions are tested, one axis after the other.
        confirm: As of ``check_bus``.

    Raises:
        InputError: As ``check_bus``, with the axis, before anything is powered; also if two axes have one node at one port.

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
                # On EtherCAT the place on the wire is the number.
                also = "" if bus.kind in {ETHERCAT, ANALOG} else ", and the drive's number with the maker's tool"
                raise InputError(
                    f"{project.path}: axes.{axis}: expected a node of its own at {bus.port}, got {node}, which {other} has; change "
                    f"[bus] {key}{also}"
                )
    project.each(lambda _, loader: _check_drive(loader))
    checks = project.each(lambda _, loader: check_bus(loader, move=move, confirm=confirm))
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


def _check_drive(loader: Loader) -> None:
    """Refuses a drive that cannot be driven; the port is free again."""
    drive_of(loader)
