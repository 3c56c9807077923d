"""What a cycle of a loop takes of its bus, reckoned frame by frame."""

from forcefeel import _core
from forcefeel.bus.result import BusFrame, BusLoad
from forcefeel.errors import InputError
from forcefeel.live.bus import bus_of
from forcefeel.loader.loader import Loader


def bus_load(*loaders: Loader) -> BusLoad:
    """Compute the time that a cycle of the loop takes of a bus, with the most bits that stuffing may add.

    It is the least: an adapter and a drive take their own time, which ``check_bus`` measures.

    Args:
        loaders: The loaders of the axes at one port, each with a ``bus`` of a drive.

    Raises:
        InputError: If there is no loader, or one has no such bus; if their ports or periods differ.

    Example:
        >>> from dataclasses import replace
        >>> yoke = ff.loader.electric("desktop-yoke").replace({"controller.period": "1 ms", "controller.delay": "1 ms"})
        >>> bus = ff.loader.Bus("moteus", "can0", load_cell_n=400.0, column_gear=1.0)
        >>> load = ff.bus.bus_load(*(replace(yoke, bus=replace(bus, node=node)) for node in (1, 2, 3)))
        >>> f"{load.share:.0%}", load.ok
        ('99%', True)
    """
    buses = [bus_of(loader) for loader in loaders]
    if (
        not loaders
        or len({bus.port for bus in buses}) > 1
        or len({loader["controller.period"] for loader in loaders}) > 1
    ):
        raise InputError("loaders: expected one or more of one port and one controller.period; give those of each port")
    frames = tuple(BusFrame(*frame) for bus in buses for frame in _core.bus_frames(bus.engine))
    return BusLoad(frames, loaders[0]["controller.period"])
