"""A loop begun."""

from math import ceil, isfinite
from pathlib import Path

from forcefeel import _core
from forcefeel.errors import InputError, expect_number
from forcefeel.files import check_output_file
from forcefeel.laws.law import LawLike
from forcefeel.live.endpoint import Endpoint, Simulated, Udp
from forcefeel.live.live_session import LiveSession
from forcefeel.live.loop_settings import LoopSettings
from forcefeel.live.setup import feel_numbers, live_law, made_of, script_of
from forcefeel.loader.loader import Loader
from forcefeel.simulation.engine import engine_changes
from forcefeel.tables.mcap_table import SIMULATED
from forcefeel.tables.table import MOST_BYTES
from forcefeel.units import show

RECORD = ".mcap"
"""What the name of a record ends with."""

MOST_RECORD_BYTES = MOST_BYTES
"""Default largest size of a record, the largest file that is read: 1.1 hours at 1 kHz."""

LEAST_RECORD_BYTES = 2**20


def start(  # noqa: PLR0913  keywords of the one call that makes a loop
    loader: Loader,
    law: LawLike = None,
    *,
    endpoint: Endpoint = Simulated(),  # noqa: B008  frozen
    real_time: bool = True,
    supervised: bool = True,
    host: str | int | None = None,
    record: str | Path | None = None,
    most_bytes: int = MOST_RECORD_BYTES,
    expected_s: float = 0.0,
) -> LiveSession:
    """Starts the loop of a loader in a thread of its own.

    Args:
        loader: The loader, with a digital controller of 250 Hz to 5 kHz.
        law: As ``Law.of`` takes it; the law of the loader's drive if not given.
        endpoint: What is at the other end: ``Simulated()``, or ``Udp("host:port")``.
        real_time: By the clock; otherwise as fast as it goes.
        supervised: Whether the supervisor looks on. Without it the law drives from the first sample on: for comparisons with a
            simulation, never for a machine.
        host: Where an aircraft simulator is listened to, with the packets of ``docs/reference/host.md``: a UDP port, of which only
            programs on this machine know, or ``"address:port"``; port 0 for any that is free, which ``running.host`` tells. It
            sets the feel's surroundings, and starts nothing.
        record: File for all that goes in and out, ``.mcap``. It is whole at any moment, and grows no larger than ``most_bytes``.
        most_bytes: See there.
        expected_s: How long it is to run, s: the disk must have room for a record of so long when it starts. Room for the next
            seconds is reserved at any time; where there is none left, the record ends, whole, and ``state.record_ended`` says why.

    Returns:
        The loop under way: a context manager that ends it.

    Raises:
        InputError: If the loader has no such controller, the law is none for it, an address, a port or the file cannot be used, or
            the disk has no room for the record.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), "robust", real_time=False) as running:
        ...     running.on()
        ...     running.wait(10_000)
        ...     running.state.name
        'active'
    """
    driven_by = live_law(law, loader)
    listens = None if host is None else _listens(host, supervised=supervised)
    scenario = endpoint.scenario if isinstance(endpoint, Simulated) else None
    setup, steps = made_of(loader, driven_by, supervised=supervised, scenario=scenario)
    period, _ = steps.timing or (1, 0)
    script, cycles, requests = None, None, []
    if scenario is not None:
        # The first changes of the feel are planned; what is asked for later comes by the ring.
        for begin, end, values, observer in engine_changes(loader, scenario, steps, driven_by):
            if begin % period or end % period:
                raise InputError(
                    "feel change: a live loop changes its feel at samples; give times that are whole periods"
                )
            requests.append((begin // period, "feel", feel_numbers(values, observer, (end - begin) // period)))
        script = script_of(steps, scenario)
        samples = -(-len(steps.inputs["force"]) // period)
        cycles = None if real_time else samples
    try:
        loop = _core.LiveLoop(
            setup,
            script=script,
            address=endpoint.address if isinstance(endpoint, Udp) else None,
            host=listens,
            real_time=real_time,
            cycles=cycles,
            requests=requests,
            record=None
            if record is None
            else (*_file(record, most_bytes), _cycles(expected_s, loader), about_run(loader, driven_by.name, endpoint)),
        )
    except OSError as error:
        raise InputError(f"cannot start: {error}") from error
    return LiveSession(loop, LoopSettings(loader, law, isinstance(endpoint, Simulated)), driven_by)


def _listens(host: str | int, *, supervised: bool) -> str:
    """Where a host is listened to, as ``address:port``; of a port alone, on this machine.

    Raises:
        InputError: If it is none, or nobody would look on.
    """
    address, _, port = str(host).rpartition(":")
    if isinstance(host, bool) or not (port.isdecimal() and int(port) < _PORTS):
        raise InputError(
            f"host: expected a UDP port such as 8732, or address:port such as 0.0.0.0:8732, got {show(host)}"
        )
    if not supervised:
        raise InputError("host: only the supervisor fades a silent host out; leave supervised=False or host out")
    return f"{address or '127.0.0.1'}:{port}"


_PORTS = 65536


def _file(record: str | Path, most_bytes: int) -> tuple[Path, int]:
    path = Path(record)
    if path.suffix != RECORD:
        raise InputError(f"record: expected a file that ends in {RECORD}, got {show(str(record))}")
    if most_bytes < LEAST_RECORD_BYTES:
        raise InputError(f"most_bytes: expected at least {LEAST_RECORD_BYTES:,}, got {most_bytes}")
    check_output_file(path)
    return path, most_bytes


def _cycles(lasts_s: float, loader: Loader) -> int:
    """Cycles of a run that lasts so long; none where it lasts until it is ended."""
    expect_number("expected_s", lasts_s)
    return ceil(max(lasts_s, 0.0) / loader["controller.period"]) if isfinite(lasts_s) else 0


def about_run(loader: Loader, law: str, endpoint: Endpoint) -> dict[str, str]:
    """What a record says of itself."""
    from importlib.metadata import version  # noqa: PLC0415  for records alone

    return {
        "forcefeel": version("forcefeel"),
        "loader": loader.name,
        "loader_hash": loader.fingerprint,
        "drive": loader.drive,
        "machine": endpoint.address if isinstance(endpoint, Udp) else SIMULATED,
        "law": law,
        "period_s": repr(loader["controller.period"]),
    }
