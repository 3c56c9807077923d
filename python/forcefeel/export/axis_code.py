"""Export of an axis as C99: law, feel and supervisor, from the operations of the firmware and the live loop, with golden vectors.

``forcefeel._core.ExportedLaw.axis_source`` traces a period; ``forcefeel._core.BoardAxis`` gives the reference.
"""

import hashlib
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import safety_functions
from forcefeel.errors import InputError
from forcefeel.export.axis_golden import axis_inputs
from forcefeel.export.c_code import about, range_check, rendered, spelled_bits, traced_law
from forcefeel.export.cost import measured
from forcefeel.export.exported import Exported
from forcefeel.export.firmware_code import board_axis
from forcefeel.export.golden import spelled_rows
from forcefeel.export.sections import SUPERVISED
from forcefeel.export.trace_map import commented, trace_html, trace_json

_FILES = {
    "axis.h": "{}.h",
    "axis.c": "{}.c",
    "axis_golden.h": "{}_golden.h",
    "axis_test.c": "{}_test.c",
}
_MAPS = ("axis_trace.json", "axis_trace.html")
_TYPES = {"number": "{}_real", "flag": "bool", "word": "uint32_t"}


def axis_names(name: str) -> tuple[str, ...]:
    """File names of :func:`axis_files`."""
    return (*(file.format(f"{name}_axis") for file in _FILES.values()), *_MAPS)


def axis_fields(exported: Exported, *, single: bool, measure: bool = False) -> dict[str, object]:
    """Fields of the files; ``measure`` states the cost on installed targets.

    Raises:
        InputError: If the law is not a sampled one or has tunable rows, or the loader has no limits.
    """
    numbers = exported.sampled()
    if exported.tunable:
        raise InputError("supervisor: the supervised law has a fixed feel; leave --tunable out")
    loader, name = exported.loader, f"{exported.name}_axis"
    traced = traced_law(loader, exported.law, numbers, single=single, linked=True)
    source = traced.axis_source(name)
    inputs, words = axis_inputs(exported)
    if single:
        inputs = inputs.astype(np.float32).astype(np.float64)
    answers, states = board_axis(exported).answers(inputs, words.tolist(), single=single)
    several = numbers.settings > 1
    members, settings = source.own
    code = "".join((*source.functions, source.period, *settings))
    fields: dict[str, object] = about(exported, numbers, single=single) | {
        "name": name,
        "states": [(state, _TYPES[kind].format(name)) for state, kind, _ in source.states],
        "first": [(state, _first(kind, value, single=single)) for state, kind, value in source.states],
        "costs": (),
        "operations": source.operations,
        "functions": [commented(text, SUPERVISED, settings=numbers.settings).rstrip("\n") for text in source.functions],
        "members": source.members,
        "period": commented(source.period, SUPERVISED, settings=numbers.settings),
        "several": several,
        "blend": range_check(name, "blend", (0.0, 1.0), single=single),
        "numbers": (members, settings),
        "pointers": [f"&settings[in->{of}]" for of in ("from", "to") if f"{name}_setting *{of}" in source.period],
        "code": code,
        "ready": f"0x{hashlib.sha256(code.encode()).hexdigest()[:8].upper()}U",
        "bits": "uint32_t" if single else "uint64_t",
        "infinity": spelled_bits(float("inf"), single=single, shifted=True),
        "safety": [
            (function, does)
            for function, does, *_ in safety_functions(loader.si_values, loader.drive, numbers.period_s)
        ],
        "samples": len(inputs),
        "given": spelled_rows(inputs[:, [*range(7 + several), 8, 9, 10]], single=single),
        "words": _words(words[:, 0 if several else 2 :]),
        "answers": spelled_rows(answers, single=single),
        "must": _words(states),
    }
    if measure:
        fields["costs"] = measured(rendered("c", _FILES, fields), fields, f"{name}.c", "axis_cost.c")
    return fields


def axis_files(fields: Mapping[str, object]) -> dict[str, str | bytes]:
    """Files by name of :func:`axis_fields`."""
    files, source = rendered("c", _FILES, fields), f"{fields['name']}.c"
    of = (source, str(files[source]), str(fields["name"]), SUPERVISED)
    return files | dict(zip(_MAPS, (trace_json(*of), trace_html(*of, document=_MAPS[0])), strict=True))


def _first(kind: str, value: float, *, single: bool) -> str:
    """C literal of a state where the axis is off."""
    if kind == "flag":
        return "true" if value else "false"
    if kind == "word":
        return f"{value:.0f}U"
    return spelled_rows(np.array([[value]]), single=single).strip("{ }")


def _words(words: NDArray[np.integer]) -> str:
    return ",\n".join(f"    {{{', '.join(f'{word}U' for word in row)}}}" for row in words.tolist())
