"""Export of a law as C99 from the operations of the simulated controller, with golden vectors.

``forcefeel._core.ExportedLaw`` traces a period of the controller; this module writes the files.
"""

import hashlib
import math
import struct
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import ExportedLaw, LawSource
from forcefeel.errors import InputError
from forcefeel.export.cost import measured
from forcefeel.export.exported import Exported
from forcefeel.export.golden import (
    INPUTS,
    PART,
    RELEASED_RAD,
    golden_columns,
    golden_flights,
    golden_inputs,
    golden_tunings,
    spelled_rows,
    within_ranges,
)
from forcefeel.export.trace_map import commented, trace_html, trace_json
from forcefeel.export.tunable import Tunable
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.surface import has_surface
from forcefeel.templating import environment

_FILES = {
    "law.h": "{}_law.h",
    "data.h": "{}_data.h",
    "law.c": "{}_law.c",
    "main.c": "{}_main.c",
    "golden.h": "{}_golden.h",
    "test.c": "{}_test.c",
    "Makefile": "Makefile",
    "README.md": "README.md",
}


TRACE = ("trace.json", "trace.html")
"""Files that map each statement of the C to its origin."""


def c_names(name: str) -> tuple[str, ...]:
    """File names of :func:`c_files`."""
    return (*(file.format(name) for file in _FILES.values()), *TRACE)


def c_files(
    exported: Exported, *, single: bool, measure: bool = False, axis: Mapping[str, object] | None = None
) -> dict[str, str | bytes]:
    """Files by name; ``single`` for a target with single precision; ``measure`` states the cost on installed targets.

    ``axis``: fields on the supervised law, if that is in the folder too.

    Raises:
        InputError: If the law is not a sampled one, or does not stabilize the loader, so that there is no reference.
    """
    law, numbers = exported.law, exported.sampled()
    of_law = partial(
        traced_law, exported.loader, law, numbers, single=single, linked=exported.linked, tunable=exported.tunable
    )
    simulated = traced = of_law()
    source = traced.source(exported.name)
    inputs, pairs = golden_inputs(exported)
    if single:
        inputs = inputs.astype(np.float32).astype(np.float64)
    inputs = within_ranges(inputs, source)
    fields = (
        {"tunable": (), "axis": axis}
        | about(exported, numbers, single=single)
        | _of_source(source, exported.name, single=single)
    )
    if exported.tunable:
        tunings = golden_tunings(exported, single=single)
        simulated = of_law(tunings=tunings)
        fields |= _of_tuning(exported.tunable, tunings, [setting for setting, _ in pairs], single=single)
    answers = np.vstack(
        [simulated.answers(inputs[k : k + PART], pairs[k : k + PART]) for k in range(0, len(inputs), PART)]
    )
    if exported.tunable and not np.isfinite(answers).all():
        raise InputError("tunable: the feel diverges somewhere in the ranges; narrow them")
    columns = golden_columns(exported)
    fields |= {
        "costs": (),
        "samples": len(inputs),
        "part": PART,
        "columns": columns,
        "added": "added_force" in columns,
        "linked": exported.linked,
        "surface": has_surface(exported.loader),
        **golden_flights(exported.loader, traced.added, single=single),
        "given": spelled_rows(inputs[:, [INPUTS.index(name) for name in columns]], single=single),
        "pairs": ",\n".join(f"    {{{a}, {b}}}" for a, b in pairs),
        "answers": spelled_rows(answers, single=single),
    }
    if measure:
        fields["costs"] = measured(rendered("c", _FILES, fields), fields, f"{exported.name}_law.c")
    return with_trace(rendered("c", _FILES, fields), f"{exported.name}_law.c", exported.name)


def with_trace(files: dict[str, str | bytes], file: str, name: str) -> dict[str, str | bytes]:
    """Files and the map from each statement of one to its origin."""
    code = str(files[file])
    return files | dict(zip(TRACE, (trace_json(file, code, name), trace_html(file, code, name)), strict=True))


def rendered(kind: str, files: Mapping[str, str], fields: Mapping[str, object]) -> dict[str, str | bytes]:
    """Files by name, each from its template of an export of this kind."""
    templates = environment(html=False)
    return {
        name.format(fields["name"]): templates.get_template(f"export/{kind}/{template}.j2").render(fields)
        for template, name in files.items()
    }


def traced_law(
    loader: Loader,
    law: Law,
    numbers: SampledLaw,
    *,
    single: bool,
    linked: bool = False,
    tunable: Sequence[Tunable] = (),
    tunings: NDArray[np.float64] | None = None,
) -> ExportedLaw:
    """The law and its feel for the tracer; with values of tunable rows, (tunings, rows), the reference, a setting for each."""
    feel = law.feel if law.feel is not None else np.array([[loader[key] for key in FEEL_SETTING]])
    values, observers = loader.rows(FEEL_SETTING, feel), numbers.rows()
    if tunings is not None:
        values, observers = (np.repeat(rows, len(tunings), axis=0) for rows in (values, observers))
        values[:, [row.place for row in tunable]] = tunings
    return ExportedLaw(
        values,
        observers,
        states=numbers.states,
        period_s=numbers.period_s,
        single=single,
        linked=linked,
        tunable=[(row.place, (row.low, row.high)) for row in tunable if tunings is None],
        curve=loader.force_curve.arrays if loader.force_curve else None,
        cancellation=law.cancellation.numbers if law.cancellation else None,
    )


def about(exported: Exported, numbers: SampledLaw, *, single: bool) -> dict[str, object]:
    """Fields on loader and law for all files."""
    loader, law = exported.loader, exported.law
    suffix = "F" if single else ""
    limit = "current_loop.current_limit" if loader.drive == ELECTRIC else "amplifier.current_limit"
    return {
        "name": exported.name,
        "law": law.name,
        "law_states": numbers.states,
        "friction": numbers.knows_friction,
        "cancellation": law.cancellation is not None,
        "loader": loader.name,
        "sha256": loader.fingerprint,
        "single": single,
        "real": "float" if single else "double",
        "zero": f"0.0{suffix}",
        "one": f"1.0{suffix}",
        "half": f"0.5{suffix}",
        "period_s": f"{numbers.period_s!r}{suffix}",
        "delay_s": f"{numbers.delay_s!r}{suffix}",
        "period": f"{numbers.period_s * 1e3:.6g} ms",
        "delay": f"{numbers.delay_s * 1e3:.6g} ms",
        "base_arm": f"{loader['column.base_arm']!r}{suffix}",
        "settings": numbers.settings,
        "feel": [", ".join(f"{value:.6g}" for value in row) for row in exported.settings],
        "command_unit": "A" if loader.drive == ELECTRIC else "V",
        "limits": f"{limit} of {loader[limit]:.6g} A",
    }


def _of_tuning(
    tunable: Sequence[Tunable], tunings: NDArray[np.float64], tuned: list[int], *, single: bool
) -> dict[str, object]:
    """Fields on the rows that a program tunes, and the values of the golden vectors."""

    def spelled(value: float) -> str:
        return spelled_rows(np.array([[value]]), single=single).strip("{ }")

    return {
        "released": RELEASED_RAD,
        "tunable": [
            {
                "key": row.key,
                "name": row.name,
                "unit": row.row.unit_si,
                "meaning": row.row.meaning,
                "own": spelled(own),
                "low": spelled(low),
                "high": spelled(high),
            }
            for row, own, low, high in zip(tunable, *tunings[:3], strict=True)
        ],
        "tunings": spelled_rows(tunings, single=single),
        "tuned": ",\n".join("    " + ", ".join(map(str, tuned[k : k + 40])) for k in range(0, len(tuned), 40)),
    }


def _of_source(source: LawSource, name: str, *, single: bool) -> dict[str, object]:
    plain, looped = source.operations
    settings = len(source.own[1])
    same, own = ({"members": members, "held": held} for members, held in (source.same, source.own))
    code = "".join((*source.functions, source.step, source.reset, source.hinge_moment, *source.same[1], *source.own[1]))
    return {
        "states": source.states,
        "step": commented(source.step, settings=settings),
        "functions": [commented(function, settings=settings).rstrip("\n") for function in source.functions],
        "reset": commented(source.reset, settings=settings),
        "hinge_moment": commented(source.hinge_moment, settings=settings),
        "same": same,
        "own": own,
        "code": code,
        "ready": f"0x{hashlib.sha256(code.encode()).hexdigest()[:8].upper()}U",
        "bits": "uint32_t" if single else "uint64_t",
        "infinity": spelled_bits(math.inf, single=single, shifted=True),
        "checks": [range_check(name, *of, single=single) for of in source.inputs] + _of_settings(name, source),
        "ranges": dict.fromkeys(INPUTS, "not read")
        | {name: f"{low:.6g} to {high:.6g}" for name, (low, high) in source.inputs},
        "operations": f"{plain} as written, {looped} in loops over data",
    }


def range_check(name: str, of: str, ends: tuple[float, float], *, single: bool) -> str:
    """C condition that an input is within its range, which is symmetric or starts at zero."""
    low, high = ends
    if low < 0.0:
        return f"({name}_size(in->{of}) <= {spelled_bits(high, single=single, shifted=True)})"
    return f"({name}_bits(in->{of} + {'0.0F' if single else '0.0'}) <= {spelled_bits(high, single=single)})"


def _of_settings(name: str, source: LawSource) -> list[str]:
    settings = len(source.own[1])
    return [f"(in->{of} < {name}_SETTINGS)" for of in ("from", "to")] if settings > 1 else []


def spelled_bits(value: float, *, single: bool, shifted: bool = False) -> str:
    """C literal of the bits of a nonnegative number, optionally with the sign shifted out."""
    size, word = ("<f", "<I") if single else ("<d", "<Q")
    (bits,) = struct.unpack(word, struct.pack(size, value))
    return f"0x{bits << shifted:X}{'U' if single else 'ULL'}"
