"""The chunks of a sweep on a Dask cluster. Each chunk has an index, so that none counts twice."""

import asyncio
import contextlib
import logging
import time
import uuid
from collections.abc import Coroutine, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, named_extra
from forcefeel.sweep.chunk import measure, nominal
from forcefeel.sweep.plan import Sweep

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_S = 5.0
"""Timeout of the scheduler, and then of its first worker, s."""

ALONE_S = 30.0
"""Timeout of a scheduler without workers, s."""

_POLL_S, _LOOK_S = 0.05, 2.0


def compute(sweep: Sweep, chunks: Sequence[int], address: str) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Compute chunks on a cluster, each on one thread of a worker; those of a lost worker go to another.

    Args:
        sweep: The sweep.
        chunks: Indexes of the chunks.
        address: The scheduler's, such as ``tcp://host:8786``.

    Yields:
        Index and measures of each chunk as it is done.

    Raises:
        InputError: If Dask is not installed, the scheduler cannot be reached or is lost, it has no workers, or a worker lacks
            forcefeel or computes other numbers.
    """
    with _client(address) as client:
        expected, name = nominal(sweep), uuid.uuid4().hex
        futures: dict[Future, int] = {
            client.submit(on_worker, sweep, index, expected, key=f"forcefeel-{name}-{index}", pure=False): index
            for index in chunks
        }
        try:
            for future in _finished(client, list(futures), address):
                yield futures.pop(future), _result(future, address)
                future.release()
        finally:
            with contextlib.suppress(Exception):  # a scheduler that is lost has nothing to cancel
                client.cancel(list(futures), force=True)


def on_worker(sweep: Sweep, index: int, expected: NDArray[np.float64]) -> NDArray[np.float64]:
    """One chunk, on a worker.

    Raises:
        InputError: If the engine there gives other numbers for the nominal loader than ``expected``.
    """
    if nominal(sweep).tobytes() != expected.tobytes():
        raise InputError(
            "a worker's engine gives other numbers than the one here; install the same forcefeel on machines of one kind"
        )
    return measure(sweep, sweep.chunks[index], threads=1)


@contextlib.contextmanager
def _client(address: str) -> "Iterator[Client]":
    """A connection to a scheduler that has workers."""
    with named_extra():
        from distributed import Client, Security  # noqa: PLC0415  an optional extra
        from distributed.comm import connect  # noqa: PLC0415

    async def knock() -> None:
        comm = await connect(address, timeout=CONNECT_S, **Security().get_connection_args("client"))
        await comm.close()

    with _quiet():
        try:
            _run(knock())  # a Client that fails leaves threads behind
            client = Client(address, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(
                f"--scheduler: {address} cannot be reached ({_line(error)}); expected the address of a running Dask scheduler "
                "such as tcp://host:8786"
            ) from error
        try:
            _check_workers(client, address)
            yield client
        finally:
            client.close(timeout=CONNECT_S)


def _run(task: Coroutine[object, object, None]) -> None:
    """Runs a task in a thread of its own: a notebook's already has a loop."""
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, task).result()


def _check_workers(client: "Client", address: str) -> None:
    """Refuse a cluster without workers, or with a worker that has another forcefeel or none."""
    try:
        client.wait_for_workers(1, timeout=CONNECT_S)
    except TimeoutError as error:
        raise InputError(
            f"--scheduler: {address} has no workers; start some on the computing machines: dask worker {address}"
        ) from error
    # A function of the standard library: one of this package would stop a worker without it.
    for worker, worker_version in client.run(version, "forcefeel", on_error="return").items():
        if isinstance(worker_version, PackageNotFoundError):
            raise InputError(f"--scheduler: the worker {worker} has no forcefeel; install {version('forcefeel')} there")
        if worker_version != version("forcefeel"):
            own_version = version("forcefeel")
            raise InputError(
                f"--scheduler: the worker {worker} has forcefeel {worker_version}, expected {own_version}; install that "
                "version there"
            )


def _finished(client: "Client", futures: "list[Future]", address: str) -> "Iterator[Future]":
    """Each future as it finishes, well or badly."""
    from distributed import as_completed  # noqa: PLC0415

    waiting = as_completed(futures, loop=client.loop)
    seen = looked = time.monotonic()
    while not waiting.is_empty():
        if batch := waiting.next_batch(block=False):
            seen = time.monotonic()
            yield from batch
            continue
        time.sleep(_POLL_S)
        if time.monotonic() - looked > _LOOK_S:
            looked = time.monotonic()
            seen = looked if _has_workers(client) else seen
        if time.monotonic() - seen > ALONE_S:
            raise InputError(f"--scheduler: all workers of {address} are gone; start some, then resume")


def _has_workers(client: "Client") -> bool:
    with contextlib.suppress(OSError):  # lost: its futures end as cancelled
        return bool(client.nthreads())
    return False


def _result(future: "Future", address: str) -> NDArray[np.float64]:
    from distributed import KilledWorker  # noqa: PLC0415

    if future.status == "cancelled":
        raise InputError(f"--scheduler: {address} is lost; start it again, then resume")
    try:
        result: Any = future.result(timeout=CONNECT_S)
    except ImportError as error:
        raise InputError(
            f"--scheduler: a worker of {address} cannot import what it needs ({error}); install forcefeel there"
        ) from error
    except KilledWorker as error:
        raise InputError(
            f"--scheduler: several workers of {address} died, one after another, at the same runs ({_line(error)})"
        ) from error
    except (OSError, asyncio.CancelledError) as error:
        raise InputError(f"--scheduler: {address} is lost ({_line(error)}); start it again, then resume") from error
    return np.asarray(result, dtype=np.float64)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's logs of connections; errors report them."""
    logger = logging.getLogger("distributed.client")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def _line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
