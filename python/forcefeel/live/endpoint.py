"""Endpoints of a loop: a simulated or a real machine, over the network or on a bus of drives."""

from dataclasses import dataclass

from forcefeel.errors import InputError
from forcefeel.loader.bus import UDP, Bus, Engine
from forcefeel.simulation import Scenario
from forcefeel.units import show


@dataclass(frozen=True)
class Simulated:
    """The nonlinear machine in the loop's own thread, with a simulated hand.

    Attributes:
        scenario: Inputs from the start, as in a simulation: force, release, signals, noise seed, changes of the feel. A run in
            virtual time ends with the scenario; without supervisor its results equal those of ``simulate`` to the last bit. In
            real time it continues.

    Example:
        >>> pushed = ff.live.Simulated(ff.Scenario(ff.Step(20.0)))
        >>> with ff.live.start(ff.digital_elevator(), endpoint=pushed, real_time=False) as running:
        ...     running.wait(100)
    """

    scenario: Scenario | None = None


@dataclass(frozen=True)
class Udp:
    """A machine on the network.

    Attributes:
        address: Its address, ``host:port``.

    Raises:
        InputError: If the address is invalid.

    Example:
        >>> ff.live.Udp("127.0.0.1:5005").address
        '127.0.0.1:5005'
    """

    address: str

    def __post_init__(self) -> None:
        host, colon, port = str(self.address).rpartition(":")
        if not (host and colon and port.isdigit() and 0 < int(port) < 65536):
            raise InputError(f"address: expected host:port, such as 127.0.0.1:5005, got {show(self.address)}")


Endpoint = Simulated | Udp | Bus
"""Any endpoint; ``loader.bus`` is that of a loader file."""


def machine_of(endpoint: Udp | Bus) -> str | Engine:
    """A real machine in the engine's form."""
    if isinstance(endpoint, Udp):
        return endpoint.address
    return Udp(endpoint.port).address if endpoint.kind == UDP else endpoint.engine


def named(endpoint: Udp | Bus) -> str:
    """A real machine in a record."""
    if isinstance(endpoint, Udp) or endpoint.kind == UDP:
        return endpoint.address if isinstance(endpoint, Udp) else endpoint.port
    return f"{endpoint.kind} {endpoint.node} at {endpoint.port}"
