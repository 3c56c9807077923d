"""A sweep's folder: ``plan.json`` first, then each finished chunk, whole; at the end ``runs.nc``, and the chunks go."""

import contextlib
import io
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.files import check_output_file, make_folder, write_whole
from forcefeel.json_values import json_text
from forcefeel.simulation.outcome import measures_of
from forcefeel.sweep.identity import differences, digest, identity
from forcefeel.sweep.plan import Sweep
from forcefeel.units import show

PLAN, CHUNKS, RUNS = "plan.json", "chunks", "runs.nc"
"""Names in the folder."""

REPORT = ("sweep.html", "summary.json", "envelope.csv")
"""What the report adds to it."""

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
        path: Where.
        sweep: The sweep that it holds, or will.
    """

    path: Path
    sweep: Sweep

    @cached_property
    def plan(self) -> dict[str, Any]:
        """What ``plan.json`` holds of this sweep."""
        document = identity(self.sweep)
        return {"sweep": digest(document), **document}

    def open(self, *, resume: bool, replace: bool) -> None:
        """Makes the folder ready for the sweep: new, or with what is finished of this very one.

        Args:
            resume: Go on with what is there.
            replace: Begin anew: the sweep that is there goes.

        Raises:
            InputError: If the folder cannot be made or written, or holds a sweep that is not to go on or another one.
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
        """Refuses a folder whose plan is another one, or this one if it is not to go on."""
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
        """Refuses a folder without a plan that holds files of the names that a sweep writes: they may be somebody's."""
        self._check_chunks()
        existing = [name for name in (RUNS, *REPORT) if (self.path / name).exists()]
        if existing:
            raise InputError(
                f"{self.path}: holds {existing[0]}, but no {PLAN} that says of what sweep; name another folder, or --replace to "
                "replace it"
            )

    def _stored_plan(self) -> dict[str, Any] | None:
        """The plan in the folder; nothing if there is none."""
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
        """Removes a sweep but for its plan, which is what says that the chunks that are left are of a sweep."""
        from forcefeel.page.script import SCRIPT  # noqa: PLC0415  Plotly

        self._check_chunks()
        try:
            for name in (RUNS, *REPORT):
                (self.path / name).unlink(missing_ok=True)
            if not any(self.path.glob("*.html")):  # other pages draw with it too
                (self.path / SCRIPT).unlink(missing_ok=True)
            self._drop_chunks()
        except OSError as error:
            raise InputError(f"{error.filename}: cannot be removed ({error.strerror}); name another folder") from error

    def _check_chunks(self) -> None:
        """Refuses a folder of chunks that no sweep made: it is never removed."""
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
        """Removes the chunks, and their folder if nothing else is in it."""
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

    @property
    def _measures(self) -> tuple[str, ...]:
        return tuple(measures_of(self.sweep.loader.drive))

    def keep(self, index: int, measured: NDArray[np.float64]) -> None:
        """Writes a finished chunk, whole."""
        data = io.BytesIO()
        np.save(data, measured)
        write_whole(self._chunk(index), data.getvalue())

    def kept(self) -> dict[int, NDArray[np.float64]]:
        """The finished chunks by their index; one that is damaged is not finished."""
        if self.finished:
            return self._all_kept()
        chunks = {}
        for index, runs in enumerate(self.sweep.chunks):
            try:
                measured = np.load(self._chunk(index), allow_pickle=False)
            except (OSError, ValueError, EOFError):
                continue
            if measured.shape == (len(runs), len(self._measures)) and measured.dtype == np.float64:
                chunks[index] = measured
        return chunks

    def _all_kept(self) -> dict[int, NDArray[np.float64]]:
        """The chunks of a sweep that is done, from its results."""
        folder = self.path / RUNS
        try:
            with xr.open_dataset(io.BytesIO(folder.read_bytes()), engine="scipy") as stored:
                measured = np.column_stack([stored[name].values for name in self._measures])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{folder}: cannot be read ({error}); --replace to begin anew") from error
        if measured.shape != (self.sweep.total, len(self._measures)):
            raise InputError(
                f"{folder}: holds {len(measured):,} runs, not {self.sweep.total:,}; --replace to begin anew"
            )
        return {index: measured[runs.start : runs.stop] for index, runs in enumerate(self.sweep.chunks)}

    @property
    def finished(self) -> bool:
        """Whether the results of all runs are there."""
        return (self.path / RUNS).exists()

    def kept_runs(self) -> int:
        """How many runs are finished."""
        return sum(map(len, self.kept().values()))

    def finish(self, runs: xr.Dataset) -> None:
        """Writes the results; the chunks, which are all in them, go."""
        write_whole(self.path / RUNS, bytes(runs.to_netcdf(None, engine="scipy", format="NETCDF3_64BIT")))
        with contextlib.suppress(OSError):  # the results are there
            self._drop_chunks()
