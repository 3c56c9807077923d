"""Identity of a sweep as plain data: ``plan.json``."""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from forcefeel.loader.parameters import table
from forcefeel.simulation.outcome import measures_of
from forcefeel.sweep.chunk import nominal
from forcefeel.sweep.plan import Sweep

FORMAT = 4
"""Version of the plan, the chunks and the results; a new one where any of them changes."""

_NOMINAL, _DERIVED = "nominal.", ("sweep",)
"""Section of the plan that follows from the rest."""

_LONG = 64
"""Numbers of a row that is written out; a longer one is told by its hash."""


def identity(sweep: Sweep) -> dict[str, Any]:
    """The sweep as plain data, every number in SI units and to the last bit.

    ``nominal`` is the result of the engine for the nominal loader: an engine or a processor with other numbers makes another
    sweep.
    """
    loader, law = sweep.loader, sweep.nominal_law
    document = {
        "format": FORMAT,
        "forcefeel": version("forcefeel"),
        "loader": {
            "name": loader.name,
            "values": {key: loader[key] for key in table(loader.drive)},
            **loader.curves,
        },
        "scenario": sweep.scenario,
        "law": sweep.law if sweep.redesigned else law.sampled or law.numbers.as_json() or law.numbers.kind,
        "runs": {"total": sweep.total, "machines": sweep.machines, "chunk": len(sweep.chunks[0])},
        "seed": sweep.seed,
        "varied": sweep.varied,
        "grid": sweep.axes,
        "nominal": dict(zip(measures_of(loader.drive), nominal(sweep).tolist(), strict=True)),
    }
    exact: dict[str, Any] = json.loads(json.dumps(_exact(document), allow_nan=False))
    return exact


def digest(document: Mapping[str, Any]) -> str:
    """Unique name of a plan."""
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:16]


def differences(stored: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Differences of two plans: ``runs.total: 1000 there, 500 here``."""
    old_leaves, new_leaves = dict(_leaves(stored)), dict(_leaves(new))
    keys = [
        key
        for key in {**old_leaves, **new_leaves}
        if old_leaves.get(key) != new_leaves.get(key) and key not in _DERIVED
    ]
    changed_keys = [key for key in keys if not key.startswith(_NOMINAL)]
    lines = [
        f"{key}: {old_leaves.get(key, 'nothing')} there, {new_leaves.get(key, 'nothing')} here" for key in changed_keys
    ]
    return lines or ["the engine here gives other numbers for the nominal loader than the one that began it"]


def _leaves(document: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(document, Mapping):
        for key, value in document.items():
            yield from _leaves(value, f"{path}.{key}" if path else key)
    else:
        yield path, json.dumps(document)


def _exact(value: Any) -> Any:
    """``value`` as JSON without loss."""
    match value:
        case float():
            return value if math.isfinite(value) else str(value)
        case Mapping():
            return {str(key): _exact(item) for key, item in value.items()}
        case np.ndarray() | list() | tuple():
            return _row(value)
    if is_dataclass(value):
        values = {field.name: _exact(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__, **values}
    return value


def _row(row: Any) -> Any:
    if len(row) <= _LONG:
        return [_exact(item) for item in (row.tolist() if isinstance(row, np.ndarray) else row)]
    numbers = np.asarray(row, dtype=np.float64)
    return {"numbers": len(row), "sha256": hashlib.sha256(numbers.tobytes()).hexdigest()}
