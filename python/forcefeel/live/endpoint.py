"""What is at the other end of a loop."""

from dataclasses import dataclass

from forcefeel.errors import InputError
from forcefeel.simulation import Scenario
from forcefeel.units import show


@dataclass(frozen=True)
class Simulated:
    """The nonlinear machine, in the loop's own thread, under a simulated hand.

    Attributes:
        scenario: What is done to it from its beginning on, as in a simulation: its force, a release, signals, noise's seed,
            changes of the feel. A run in virtual time ends with it, and gives the numbers of ``simulate`` to the last bit where
            nobody supervises; in real time it goes on.

    Example:
        >>> import forcefeel as ff
        >>> pushed = ff.live.Simulated(ff.Scenario(ff.Step(20.0)))
        >>> with ff.live.start(ff.digital_elevator(), endpoint=pushed, real_time=False) as running:
        ...     running.wait(100)
    """

    scenario: Scenario | None = None


@dataclass(frozen=True)
class Udp:
    """A machine over the network.

    Attributes:
        address: Where it listens, ``host:port``.

    Raises:
        InputError: If the address is none.

    Example:
        >>> import forcefeel as ff
        >>> ff.live.Udp("127.0.0.1:5005").address
        '127.0.0.1:5005'
    """

    address: str

    def __post_init__(self) -> None:
        host, colon, port = str(self.address).rpartition(":")
        if not (host and colon and port.isdigit() and 0 < int(port) < 65536):
            raise InputError(f"address: expected host:port, such as 127.0.0.1:5005, got {show(self.address)}")


Endpoint = Simulated | Udp
"""The kinds of machine."""
