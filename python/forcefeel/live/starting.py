"""Start of a loop."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite
from pathlib import Path
from typing import Any

from forcefeel import _core
from forcefeel.envelope.softening import soften
from forcefeel.errors import InputError, expect_number
from forcefeel.files import check_output_file
from forcefeel.laws.law import Law, LawLike
from forcefeel.live.bus import check_bus
from forcefeel.live.endpoint import Endpoint, Simulated, machine_of, named
from forcefeel.live.live_session import LiveSession, programmed
from forcefeel.live.loop_settings import LoopSettings
from forcefeel.live.setup import feel_numbers, live_law, made_of, script_of
from forcefeel.loader.bus import Bus
from forcefeel.loader.links import Link
from forcefeel.loader.loader import Loader
from forcefeel.loader.softened_feel import SoftenedFeel
from forcefeel.simulation.engine import engine_changes
from forcefeel.tables.mcap_table import RECORD, SIMULATED
from forcefeel.tables.table import MOST_BYTES
from forcefeel.units import UnitSystem, show

MOST_RECORD_BYTES = MOST_BYTES
"""Default largest size of a record, the limit for reading: 1 hour at 1 kHz."""

LEAST_RECORD_BYTES = 2**20

RING_PARTS = 2

HISTORY = 120_000
"""Rows of a loop that are kept in memory: a minute at 2 kHz."""


def start(  # noqa: PLR0913  keywords of the one call that makes a loop
    loader: Loader,
    law: LawLike = None,
    *,
    endpoint: Endpoint = Simulated(),  # noqa: B008  frozen
    real_time: bool = True,
    supervised: bool = True,
    host: str | int | None = None,
    soften: bool = False,
    record: str | Path | None = None,
    record_rate_hz: float | None = None,
    most_bytes: int = MOST_RECORD_BYTES,
    ring: bool = False,
    expected_s: float = 0.0,
) -> LiveSession:
    """Start the loop of a loader in its own thread.

    Args:
        loader: The loader, with a digital controller of 250 Hz to 5 kHz.
        law: The law, as in ``Law.of``; default: the law of the loader's drive.
        endpoint: The machine: ``Simulated()``, ``Udp("host:port")``, or a drive on a bus, such as ``loader.bus``.
        real_time: Run by the clock; otherwise as fast as possible.
        supervised: Whether the supervisor is active. Without it the law drives from the first sample: only for comparison with a
            simulation, never with a machine.
        host: Port for an aircraft simulator, with the packets of ``docs/reference/host.md``: a UDP port for programs on this
            machine, or ``"address:port"``; port 0 takes a free one, see ``running.host``. It sets trim, spring factor,
            shaker and what acts beside the feel, but does not start the feel.
        soften: Whether a feel that the drive does not render is softened to the nearest that it does (``envelope.soften``), and so
            are values of the simulator, which are refused otherwise; see ``running.softened`` and ``running.host``.
        record: File for all inputs and outputs, ``.mcap``. It is always readable and at most ``most_bytes`` long.
        record_rate_hz: Rows per second, the loop's rate over a whole number; default: every cycle. Trips and other events are
            recorded in any case, with all cycles of the second before and after a change of the trips.
        most_bytes: Largest size of the record.
        ring: Whether the oldest rows are dropped at ``most_bytes``; otherwise the record ends there. A ring has two parts of half
            the size: ``run.mcap`` with the newest rows, ``run-previous.mcap`` with those before.
        expected_s: Expected duration, s: at the start the disk must have space for such a record. Space for the next seconds is
            always reserved; on a full disk the record ends readable, and ``state.record_ended`` contains the reason.

    Returns:
        The running loop, a context manager that ends it.

    Raises:
        InputError: If the loader has no such controller, the law does not fit it, an address, a port or the file cannot be used,
            or the disk lacks space for the record; if a bus has no such node, two of its number, or one that cannot be driven.

    Example:
        >>> with ff.live.start(ff.digital_elevator(), "robust", real_time=False) as running:
        ...     running.on()
        ...     running.wait(10_000)
        ...     running.state.name
        'active'
    """
    listens = None if host is None else listening(host, supervised=supervised)
    axis = Axis.of(loader, law, endpoint, supervised=supervised, host=listens is not None, softens=soften)
    kept = opened_record(record, record_rate_hz, most_bytes, expected_s, [loader], ring=ring)
    (running,) = launch([axis], host=listens, real_time=real_time, record=kept)
    return running


@dataclass(frozen=True, eq=False)
class Axis:
    """A loader of a loop in the engine's form.

    Attributes:
        loader, law, endpoint: As of ``start``.
        driven_by: The law, designed.
        setup: What its loop is made of.
        script: What is done to its simulated machine.
        requests: Planned requests, each with its cycle.
        cycles: Cycles of its scenario; ``None`` without one.
        name: Its name in a cockpit; empty for a single loader.
        stops: Places of the axes that stop with it.
        link: Its link to another axis.
    """

    loader: Loader
    law: LawLike
    endpoint: Endpoint
    driven_by: Law
    setup: _core.LiveSetup
    script: Any
    requests: list[tuple[int, str, list[float]]]
    cycles: int | None
    name: str = ""
    stops: tuple[int, ...] = ()
    link: Link | None = None
    softened: SoftenedFeel | None = None

    @classmethod
    def of(
        cls,
        loader: Loader,
        law: LawLike,
        endpoint: Endpoint,
        *,
        supervised: bool,
        host: bool,
        softens: bool = False,
        flap_trim: float = 0.0,
    ) -> "Axis":
        """A loader with its law and its machine.

        Raises:
            InputError: As ``start``.
        """
        softened = soften(loader) if softens else None
        loader = softened.loader if softened else loader
        driven_by = live_law(law, loader)
        if isinstance(endpoint, Bus):
            check_bus(endpoint, loader, driven_by)
        scenario = endpoint.scenario if isinstance(endpoint, Simulated) else None
        setup, steps = made_of(
            loader,
            driven_by,
            supervised=supervised,
            scenario=scenario,
            host=host,
            soften=softens,
            flap_trim=flap_trim,
        )
        period, _ = steps.timing or (1, 0)
        script, cycles, requests = None, None, []
        if scenario is not None:
            # Changes of the scenario are planned; later requests come through the ring.
            for begin, end, values, observer in engine_changes(loader, scenario, steps, driven_by):
                if begin % period or end % period:
                    raise InputError(
                        "feel change: expected times at whole periods, because a live loop changes its feel at samples"
                    )
                requests.append((begin // period, "feel", feel_numbers(values, observer, (end - begin) // period)))
            script = script_of(steps, scenario)
            cycles = -(-len(steps.inputs["force"]) // period)
        return cls(loader, law, endpoint, driven_by, setup, script, requests, cycles, softened=softened)

    @property
    def settings(self) -> LoopSettings:
        """Requested settings at the start."""
        simulated = isinstance(self.endpoint, Simulated)
        if self.softened is None:
            return LoopSettings(self.loader, self.law, simulated, link=self.link)
        return LoopSettings(
            self.loader, self.law, simulated, link=self.link, soften=True, programmed=programmed(self.softened)
        )


Recorded = tuple[Path, tuple[int, bool], int, int]
"""A record for the engine: file, size and whether it is a ring, expected rows, cycles from a row to the next."""


def launch(
    axes: Sequence[Axis],
    *,
    host: str | None,
    real_time: bool,
    record: Recorded | None,
    links: Sequence[tuple[tuple[int, int], list[float], int | None, bool, bool]] = (),
    history: int = HISTORY,
) -> list[LiveSession]:
    """Start the thread of a loop with all its axes.

    Raises:
        InputError: If an address, a port or the file cannot be used, or a period is no whole multiple of the shortest.
    """
    periods = [axis.loader["controller.period"] for axis in axes]
    base = min(periods)
    every = [round(period / base) for period in periods]
    for axis, period, beats in zip(axes, periods, every, strict=True):
        if abs(period - beats * base) > _ROUNDING * period:
            raise InputError(
                f"axes.{axis.name}: controller.period: expected a whole multiple of the shortest, {1e3 * base:g} ms, got "
                f"{1e3 * period:g} ms; change one in its file"
            )
    lasts = [axis.cycles * beats for axis, beats in zip(axes, every, strict=True) if axis.cycles is not None]
    try:
        loops = _core.start_loops(
            [
                (
                    axis.setup,
                    axis.script,
                    None if isinstance(axis.endpoint, Simulated) else machine_of(axis.endpoint),
                    axis.requests,
                    beats,
                    list(axis.stops),
                    (f"/{axis.name}" if axis.name else "", about_axis(axis)),
                )
                for axis, beats in zip(axes, every, strict=True)
            ],
            base,
            links=links,
            host=host,
            real_time=real_time,
            beats=max(lasts) if lasts and not real_time else None,
            record=record,
            history=history,
        )
    except OSError as error:
        raise InputError(f"cannot start: {error}") from error
    return [LiveSession(loop, axis.settings, axis.driven_by) for axis, loop in zip(axes, loops, strict=True)]


def opened_record(
    record: str | Path | None,
    rate_hz: float | None,
    most_bytes: int,
    expected_s: float,
    loaders: Sequence[Loader],
    *,
    ring: bool,
) -> Recorded | None:
    """The record of some loaders.

    Raises:
        InputError: If file, rate or size cannot be.
    """
    if record is None:
        if rate_hz is not None or ring:
            raise InputError("rate and ring: require a record; name one, on the command line with --out")
        return None
    rates = {1 / loader["controller.period"] for loader in loaders}
    if rate_hz is not None and len(rates) > 1:
        raise InputError("rate of the record: expected none, since the axes have different periods; omit it")
    every = 1 if rate_hz is None else _every(rate_hz, min(rates))
    rows = sum(_cycles(expected_s, loader) for loader in loaders) // every
    return _file(record), (_size(most_bytes, ring=ring), ring), rows, every


def listening(host: str | int, *, supervised: bool) -> str:
    """Host port as ``address:port``; a port without address is on this machine.

    Raises:
        InputError: If it is invalid, or without supervisor.
    """
    address, _, port = str(host).rpartition(":")
    if isinstance(host, bool) or not (port.isdecimal() and int(port) < _PORTS):
        raise InputError(
            f"host: expected a UDP port such as 8732, or address:port such as 0.0.0.0:8732, got {show(host)}"
        )
    if not supervised:
        raise InputError("host: requires the supervisor, which fades out a silent host; omit supervised=False or host")
    return f"{address or '127.0.0.1'}:{port}"


_PORTS = 65536


def previous_part(record: Path) -> Path:
    """File of the older rows of a ring."""
    return record.with_stem(f"{record.stem}-previous")


def _file(record: str | Path) -> Path:
    path = Path(record)
    if path.suffix != RECORD:
        raise InputError(f"record: expected a file that ends in {RECORD}, got {show(str(record))}")
    check_output_file(path)
    check_output_file(previous_part(path))
    return path


def _size(most_bytes: int, *, ring: bool) -> int:
    least, most = (
        (RING_PARTS * LEAST_RECORD_BYTES, RING_PARTS * MOST_RECORD_BYTES) if ring else (LEAST_RECORD_BYTES, None)
    )
    if most_bytes < least or (most is not None and most_bytes > most):
        limits = f"at least {least:,}" if most is None else f"{least:,} to {most:,}"
        raise InputError(f"size of the record: expected {limits} bytes, got {most_bytes:,}")
    return most_bytes


def _every(rate_hz: float, loop_hz: float) -> int:
    """Cycles from a row to the next.

    Raises:
        InputError: If it is no whole number, with the nearest rates.
    """
    expect_number("record_rate_hz", rate_hz)
    if not 0 < rate_hz <= loop_hz * (1 + _ROUNDING):
        raise InputError(
            f"rate of the record: expected above 0 Hz, at most the loop's {loop_hz:g} Hz, got {rate_hz:g} Hz"
        )
    cycles = loop_hz / rate_hz
    if abs(cycles - round(cycles)) > _ROUNDING * cycles:
        nearest = " or ".join(f"{loop_hz / whole:.10g} Hz" for whole in (ceil(cycles), floor(cycles)))
        raise InputError(
            f"rate of the record: expected the loop's {loop_hz:g} Hz over a whole number, got {rate_hz:g} Hz; use {nearest}"
        )
    return round(cycles)


_ROUNDING = 1e-9
"""Relative error of a rate with 10 digits."""


def _cycles(lasts_s: float, loader: Loader) -> int:
    """Cycles of a run of this duration; 0 for an unlimited run."""
    expect_number("expected_s", lasts_s)
    return ceil(max(lasts_s, 0.0) / loader["controller.period"]) if isfinite(lasts_s) else 0


def about_axis(axis: Axis) -> dict[str, str]:
    """Metadata of an axis' record; of a softened feel what became of it."""
    about = about_run(axis.loader, axis.driven_by.name, axis.endpoint)
    return about if axis.softened is None else {**about, "softened": axis.softened.sentence(UnitSystem.SI) or "no"}


def about_run(loader: Loader, law: str, endpoint: Endpoint) -> dict[str, str]:
    """Metadata of a record."""
    from importlib.metadata import version  # noqa: PLC0415  for records alone

    return {
        "forcefeel": version("forcefeel"),
        "loader": loader.name,
        "loader_hash": loader.fingerprint,
        "drive": loader.drive,
        "machine": SIMULATED if isinstance(endpoint, Simulated) else named(endpoint),
        "law": law,
        "period_s": repr(loader["controller.period"]),
    }
