"""Steps, their folders, and the finished steps of an interrupted run: ``steps.json``.

A step is done if what it was made from is what it would be made from now, by the SHA-256 of both, and all files that it wrote are
there as it wrote them. Its outcome is then read, and not computed again.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from forcefeel.files import write_whole

BENCH, IDENTIFICATION, LAW, ENVELOPE, TESTS = "0-bench", "1-identification", "2-law", "3-envelope", "4-tests"
"""Folder of each step; the first where the machine is recorded, or simulated."""

STEPS = (IDENTIFICATION, LAW, ENVELOPE, TESTS)

STATE = "steps.json"
"""File of the finished steps."""

Outcome = TypeVar("Outcome")


def digest(*parts: object) -> str:
    """SHA-256 of values that JSON or text can hold, and of the program's version."""
    text = json.dumps([version("forcefeel"), *parts], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


@dataclass
class State:
    """The state of a folder.

    Attributes:
        out: The folder.
        done: By step: the hash of its inputs, of each file that it wrote, and its outcome.
        resumed: Steps that were not made again.
    """

    out: Path
    done: dict[str, dict[str, Any]] = field(default_factory=dict)
    resumed: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, out: Path) -> "State":
        """The state of a folder; empty without a valid file."""
        try:
            read = json.loads((out / STATE).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            read = {}
        return cls(out, read if isinstance(read, dict) else {})

    def step(self, name: str, inputs: str, kind: type[Outcome], make: Callable[[Path], Outcome]) -> Outcome:
        """The outcome of a step, from a complete earlier run or made now and stored.

        Args:
            name: The step, and its folder.
            inputs: Hash of what it is made from.
            kind: The dataclass of its outcome.
            make: Makes it: writes its folder, returns the outcome.
        """
        adapter = TypeAdapter(kind)
        stored = self.done.get(name)
        if isinstance(stored, dict) and stored.get("inputs") == inputs and stored.get("files") == self._files(name):
            try:
                outcome = adapter.validate_python(stored.get("outcome"))
            except ValidationError:
                pass
            else:
                self.resumed.append(name)
                return outcome
        outcome = make(self.out / name)
        self.done = {key: entry for key, entry in self.done.items() if key < name}  # later steps are outdated
        dumped = adapter.dump_python(outcome, mode="json")
        self.done[name] = {"inputs": inputs, "files": self._files(name), "outcome": dumped}
        write_whole(self.out / STATE, json.dumps(self.done, indent=1) + "\n")
        return outcome

    def _files(self, name: str) -> Mapping[str, str]:
        """SHA-256 of every file of a step's folder."""
        folder = self.out / name
        paths = sorted(path for path in folder.rglob("*") if path.is_file()) if folder.is_dir() else []
        return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}
