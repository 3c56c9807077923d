"""A sweep's folder: ``plan.json`` first, then each finished chunk; at the end ``runs.nc`` in place of the chunks."""

import contextlib
import io
import json
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.files import check_output_file, make_folder, write_whole, written_whole
from forcefeel.json_values import json_text
from forcefeel.simulation.outcome import measures_of
from forcefeel.sweep.identity import differences, digest, identity
from forcefeel.sweep.plan import Sweep
from forcefeel.sweep.result import STATUSES, SweepResult, as_dataset
from forcefeel.units import show

PLAN, CHUNKS, RUNS = "plan.json", "chunks", "runs.nc"
"""Names in the folder."""

REPORT = ("sweep.html", "summary.json", "envelope.csv")
"""Files of the report."""

_OWN = re.compile(r"\.?\d{5,}\.npy(\.\w{8})?")
"""Name of a chunk, or of one that was being written when a run was killed."""

_HALF_WRITTEN = re.compile(rf"\.({re.escape(PLAN)}|{re.escape(RUNS)})\.\w{{8}}")
"""Name of what a run was writing when it was killed."""

_SHOWN = 5
"""Differences between two plans that a message lists."""


@dataclass(frozen=True)
class Folder:
    """The folder of one sweep.

    Attributes:
        path: Its path.
        sweep: Its sweep.
    """

    path: Path
    sweep: Sweep

    @cached_property
    def plan(self) -> dict[str, Any]:
        """Contents of ``plan.json`` for this sweep."""
        document = identity(self.sweep)
        return {"sweep": digest(document), **document}

    def open(self, *, resume: bool, replace: bool) -> None:
        """Prepare the folder for the sweep: new, or with the finished chunks of this sweep.

        Args:
            resume: Continue with the stored chunks.
            replace: Remove the stored sweep and begin anew.

        Raises:
            InputError: If the folder cannot be made or written, or holds another sweep, or this one without ``resume``.
        """
        make_folder(self.path, "a folder for the sweep")
        for name in (PLAN, RUNS, *REPORT):
            check_output_file(self.path / name)
        for path in self.path.glob(".*"):
            if _HALF_WRITTEN.fullmatch(path.name):
                path.unlink()
        stored = self._stored_plan() if not replace else None
        if stored is not None:
            self._check(stored, resume=resume)
            return
        if not replace:
            self._check_empty()
        self._clear()
        write_whole(self.path / PLAN, json_text(self.plan))
        (self.path / CHUNKS).mkdir(exist_ok=True)

    def _check(self, stored: Mapping[str, Any], *, resume: bool) -> None:
        """Refuse a folder with another plan, or with this plan without ``resume``."""
        if stored.get("sweep") != self.plan["sweep"]:
            changes = differences(stored, self.plan)
            more = f", and {len(changes) - _SHOWN} more" if len(changes) > _SHOWN else ""
            raise InputError(
                f"{self.path}: holds another sweep ({'; '.join(changes[:_SHOWN])}{more}); name another folder with --out, or "
                "--replace to replace it"
            )
        if not resume:
            state = "all" if self.finished else f"{self.kept_runs():,} of"
            contents = f"{state} {self.sweep.total:,} runs of this very sweep"
            go_on = "write its page anew" if self.finished else "go on with it"
            raise InputError(f"{self.path}: holds {contents}; --resume to {go_on}, --replace to begin anew")

    def _check_empty(self) -> None:
        """Refuse a folder without a plan but with files of the names of a sweep, which may be of other origin."""
        self._check_chunks()
        existing = [name for name in (RUNS, *REPORT) if (self.path / name).exists()]
        if existing:
            raise InputError(
                f"{self.path}: holds {existing[0]}, but no {PLAN} that says of what sweep; name another folder, or --replace to "
                "replace it"
            )

    def _stored_plan(self) -> dict[str, Any] | None:
        """The plan in the folder, or ``None``."""
        path = self.path / PLAN
        try:
            stored = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, RecursionError) as error:  # brackets a thousand deep
            raise InputError(f"{path}: cannot be read ({error}); --replace to begin anew") from error
        if not isinstance(stored, dict):
            raise InputError(f"{path}: is no plan of a sweep; --replace to begin anew")
        return stored

    def _clear(self) -> None:
        """Remove a sweep except its plan, which identifies the remaining chunks."""
        from forcefeel.page.script import SCRIPT  # noqa: PLC0415  Plotly

        self._check_chunks()
        try:
            for name in (RUNS, *REPORT):
                (self.path / name).unlink(missing_ok=True)
            if not any(self.path.glob("*.html")):  # other pages use it too
                (self.path / SCRIPT).unlink(missing_ok=True)
            self._drop_chunks()
        except OSError as error:
            raise InputError(f"{error.filename}: cannot be removed ({error.strerror}); name another folder") from error

    def _check_chunks(self) -> None:
        """Refuse a folder of chunks of other origin, which is never removed."""
        chunks = self.path / CHUNKS
        if not chunks.exists():
            return
        strange = [path.name for path in chunks.iterdir() if not _OWN.fullmatch(path.name)] if chunks.is_dir() else []
        if strange:
            why = f"holds {show(min(strange))}, which no sweep wrote"
        elif not chunks.is_dir() or chunks.is_symlink():
            why = "is no folder that a sweep made"
        elif not (self.path / PLAN).exists():
            why = f"has no {PLAN} beside it that says of what sweep"
        else:
            return
        raise InputError(f"{chunks}: {why}; move it away, or name another folder")

    def _drop_chunks(self) -> None:
        """Remove the chunks, and their folder if empty."""
        chunks = self.path / CHUNKS
        if not chunks.exists():
            return
        for path in chunks.iterdir():
            if _OWN.fullmatch(path.name):
                path.unlink()
        if not any(chunks.iterdir()):
            chunks.rmdir()

    def _chunk(self, index: int) -> Path:
        return self.path / CHUNKS / f"{index:05d}.npy"

    def keep(self, index: int, measured: NDArray[np.float64]) -> None:
        """Write a finished chunk, whole."""
        data = io.BytesIO()
        np.save(data, measured)
        write_whole(self._chunk(index), data.getvalue())

    def kept(self) -> set[int]:
        """Indexes of the finished chunks, without damaged ones; all of a sweep with results."""
        if self.finished:
            return set(range(len(self.sweep.chunks)))
        return {index for index in range(len(self.sweep.chunks)) if self._stored(index) is not None}

    def _stored(self, index: int) -> NDArray[np.float64] | None:
        """Measures of a finished chunk, read as they are used; ``None`` if it is missing or damaged."""
        expected = len(self.sweep.chunks[index]), len(measures_of(self.sweep.loader.drive))
        try:
            measured = np.load(self._chunk(index), mmap_mode="r", allow_pickle=False)
        except (OSError, ValueError, EOFError):
            return None
        return measured if measured.shape == expected and measured.dtype == np.float64 else None

    @property
    def finished(self) -> bool:
        """Whether the results of all runs exist."""
        return (self.path / RUNS).exists()

    def kept_runs(self) -> int:
        """Number of finished runs."""
        return sum(len(self.sweep.chunks[index]) for index in self.kept())

    def finish(self) -> None:
        """Write the results, a chunk at a time, and remove the chunks.

        Raises:
            InputError: If there is no room for them, or a chunk was removed.
        """
        import h5py  # noqa: PLC0415  only here

        self._check_room()
        with written_whole(self.path / RUNS) as aside:
            _write_frame(self._chunk_data(0), self.sweep.total, aside)
            with h5py.File(aside, "a") as file:
                for index, runs in enumerate(self.sweep.chunks):
                    for name, variable in self._chunk_data(index).variables.items():
                        file[name][runs.start : runs.stop] = _letters(variable.values)
        with contextlib.suppress(OSError):  # the results exist
            self._drop_chunks()

    def _chunk_data(self, index: int) -> xr.Dataset:
        """The runs of a chunk.

        Raises:
            InputError: If it was removed.
        """
        measured = self._stored(index)
        if measured is None:
            raise InputError(f"{self._chunk(index)}: was removed or damaged; --resume to compute it again")
        data = as_dataset(self.sweep, self.sweep.chunks[index], measured)
        data["status"] = "run", data["status"].values.astype(_STATUS), {"_Encoding": "utf-8"}
        return data

    def _check_room(self) -> None:
        """Refuse a disk without room for the results: HDF5 notices that only as it closes the file, and then crashes."""
        columns = len(measures_of(self.sweep.loader.drive)) + len(self.sweep.axes) + len(self.sweep.varied)
        runs = len(self.sweep.chunks) * len(self.sweep.chunks[0])
        needed = runs * (8 * columns + _STATUS.itemsize) + _STRUCTURE_BYTES
        free = shutil.disk_usage(self.path).free
        if free < needed:
            raise InputError(
                f"{self.path / RUNS}: takes {needed / 2**20:,.1f} MB, and the disk has {free / 2**20:,.1f} MB free; make room, "
                "then --resume"
            )

    def result(self) -> SweepResult:
        """The results, whose values are read from the folder as they are used.

        Raises:
            InputError: If they cannot be read, or are not those of the sweep.
        """
        path = self.path / RUNS
        try:
            runs = xr.open_dataset(path, engine="h5netcdf", cache=False)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path}: cannot be read ({error}); --replace to begin anew") from error
        if runs.sizes.get("run") != self.sweep.total or not {*measures_of(self.sweep.loader.drive)} <= {*runs}:
            raise InputError(f"{path}: does not hold the {self.sweep.total:,} runs; --replace to begin anew")
        return SweepResult(self.sweep, runs)


def _write_frame(data: xr.Dataset, total: int, path: Path) -> None:
    """Write a file with the variables of ``data``, its first run ``total`` times.

    Not of unlimited length, which takes xarray a look at every variable for each of them; not by ``to_netcdf``, which
    imports dask's cluster to ask whether one is there.
    """
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415  only here

    def longer(variables: Mapping[Any, xr.DataArray]) -> dict[Any, Any]:
        return {name: ("run", np.broadcast_to(each[0], total), each.attrs) for name, each in variables.items()}

    with contextlib.closing(H5NetCDFStore.open(path, mode="w", lock=Lock())) as store:
        xr.Dataset(longer(data.data_vars), longer(data.coords), data.attrs).dump_to_store(store)


def _letters(values: NDArray[Any]) -> NDArray[Any]:
    """Text of a fixed length letter by letter, as a file has it; numbers as they are."""
    return values.view("S1").reshape(len(values), -1) if values.dtype == _STATUS else values


_STRUCTURE_BYTES = 2**20
"""Room for what is in a file beside its numbers, amply."""

_STATUS = np.dtype(f"S{max(map(len, STATUSES))}")
"""Status in a file, in letters of a fixed number: a reader reads text of any length whole."""
