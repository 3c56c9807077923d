"""What a check of a bus finds."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """A property, whether it is as it should be, and the remedy where it is not.

    Attributes:
        name: The property.
        ok: Whether it is as it should be.
        stated: What was found.
        remedy: The remedy, often a command; empty if it is well.

    Example:
        >>> ff.bus.Finding("memory lock", True, "unlimited", "").ok
        True
    """

    name: str
    ok: bool
    stated: str
    remedy: str


@dataclass(frozen=True)
class BusNode:
    """What a node states of itself.

    Attributes:
        node: Its number.
        model, firmware, registers: Numbers of its maker; zero where it states none.
        serial: Serial number, hexadecimal.

    Example:
        >>> ff.bus.BusNode(1, 1, 266, 5, "000003e9").node
        1
    """

    node: int
    model: int
    firmware: int
    registers: int
    serial: str


@dataclass(frozen=True)
class BusDelay:
    """Times from a command to its answer, with the drive off.

    Attributes:
        answers: Number of answers; the others were lost.
        commands: Number of commands.
        median_s, p99_s, worst_s: Of the answers.
        delay_s: Whole periods from a sample to the command that answers it: the value for ``controller.delay``.
        limit_s: The longest ``controller.delay`` of the loader, a number of its periods.

    Example:
        >>> ff.bus.BusDelay(1000, 1000, 1e-4, 2e-4, 3e-4, 1e-3, limit_s=7e-3).ok
        True
    """

    answers: int
    commands: int
    median_s: float
    p99_s: float
    worst_s: float
    delay_s: float
    limit_s: float

    @property
    def ok(self) -> bool:
        """Whether the drive answers, and soon enough."""
        return self.answers > 0 and self.delay_s <= self.limit_s


@dataclass(frozen=True)
class BusFrame:
    """A frame on a bus.

    Attributes:
        name: ``command``, ``request``, ``answer`` or ``heartbeat``; of EtherCAT ``frame``, and ``slave``, which it passes.
        bytes: Its data; of EtherCAT the whole Ethernet frame.
        bits: Bits on the wire, the most that stuffing may add included.
        time_s: Their time.
        every_s: Period in which it comes; ``None`` for each cycle.

    Example:
        >>> ff.bus.BusFrame("command", 4, 95, 95e-6, None).time_s
        9.5e-05
    """

    name: str
    bytes: int
    bits: int
    time_s: float
    every_s: float | None


@dataclass(frozen=True)
class BusLoad:
    """The time that a cycle takes of a bus.

    Attributes:
        frames: Frames of all axes.
        period_s: Period of the loop.

    Example:
        >>> frames = (ff.bus.BusFrame("command", 4, 95, 95e-6, None), ff.bus.BusFrame("heartbeat", 8, 135, 135e-6, 1e-2))
        >>> load = ff.bus.BusLoad(frames, 1e-3)
        >>> f"{load.time_s:.4g} s", f"{load.share:.4g}", load.ok
        ('0.0001085 s', '0.1085', True)
    """

    frames: tuple[BusFrame, ...]
    period_s: float

    @property
    def time_s(self) -> float:
        """Time of a cycle; a frame that comes less often with its share."""
        return sum(
            frame.time_s * (1.0 if frame.every_s is None else self.period_s / frame.every_s) for frame in self.frames
        )

    @property
    def share(self) -> float:
        """Share of the period."""
        return self.time_s / self.period_s

    @property
    def ok(self) -> bool:
        """Whether the bus carries the cycle."""
        return self.share <= 1


@dataclass(frozen=True)
class BusCheck:
    """A check of a loader's bus.

    Attributes:
        nodes: The nodes that answered.
        load: Time that a cycle takes of the bus, reckoned.
        delay: Delay and jitter.
        watchdog: Whether the drive stops by itself when its commands stop.
        directions: Whether motor and sensors count in one direction; empty if nothing was moved.
        host: Properties of this computer.

    Example:
        >>> from dataclasses import replace
        >>> yoke = ff.loader.electric("desktop-yoke")
        >>> yoke = replace(yoke, bus=ff.loader.Bus("moteus", "pty", load_cell_n=400.0, column_gear=1.0))
        >>> with ff.live.BusEmulator([yoke]) as emulator:
        ...     check = ff.bus.check_bus(replace(yoke, bus=replace(yoke.bus, port=emulator.port)))
        >>> [node.node for node in check.nodes], check.directions
        ([1], ())
    """

    nodes: tuple[BusNode, ...]
    load: BusLoad
    delay: BusDelay
    watchdog: Finding
    directions: tuple[Finding, ...]
    host: tuple[Finding, ...]

    @property
    def ok(self) -> bool:
        """Whether bus and drive are well; the host is not counted."""
        return self.load.ok and self.delay.ok and self.watchdog.ok and all(finding.ok for finding in self.directions)
