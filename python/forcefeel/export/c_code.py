"""Export of a law as C99 from the operations of the simulated controller, with golden vectors.

``forcefeel._core.ExportedLaw`` traces a period of the controller; this module writes the files and the inputs of the vectors.
"""

import hashlib
import math
import struct
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import ExportedLaw, LawSource
from forcefeel.errors import InputError
from forcefeel.export.cost import measured
from forcefeel.export.exported import Exported
from forcefeel.export.trace_map import commented, trace_html, trace_json
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.loader.surface import has_surface
from forcefeel.simulation.engine import simulate
from forcefeel.simulation.inputs.signals import Chirp, Release
from forcefeel.simulation.scenario import Scenario
from forcefeel.templating import environment

PART = 3334
"""Samples of each of release, sweep and random input."""

_SEED = 20
_RELEASED_RAD = 0.1
_SHARES = (1.0, 0.1, 0.01)
"""Factors on release and sweep: with a feel that is heavy for the drive, a large one can diverge."""

_ALWAYS = ("force", "position", "base", "grip", "trim", "stiffness_factor", "shaker")
_CHANGING = ("blend",)
_ADDED = ("added_force", "added_stiffness", "added_damping")
INPUTS = (*_ALWAYS, *_CHANGING, *_ADDED)
"""Inputs of the law each period: those of a law for several settings, and of a loader with a surface, among them."""

_FLIGHT = {
    "dynamic_pressure": ("in Pa", 0.0, 2e4),
    "true_airspeed": ("in m/s", 0.0, 250.0),
    "angle_of_attack": ("in rad", -0.3, 0.3),
    "sideslip": ("in rad", -0.3, 0.3),
    "roll_rate": ("in rad/s", -1.0, 1.0),
    "pitch_rate": ("in rad/s", -1.0, 1.0),
    "yaw_rate": ("in rad/s", -1.0, 1.0),
    "load_factor": ("in g", -1.0, 3.0),
    "mach": ("Mach number", 0.0, 1.2),
    "tab": ("angle of the trim tab in rad", -0.3, 0.3),
    "angle": ("of the control in rad", -0.3, 0.3),
}
"""What a hinge moment is given: unit, and between which values the golden vectors lie."""
_FLIGHTS = 500

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


def c_files(exported: Exported, *, single: bool, measure: bool = False) -> dict[str, str | bytes]:
    """Files by name; ``single`` for a target with single precision; ``measure`` states the cost on installed targets.

    Raises:
        InputError: If the law is not a sampled one, or does not stabilize the loader, so that there is no reference.
    """
    law, numbers = exported.law, exported.sampled()
    traced = traced_law(exported.loader, law, numbers, single=single, linked=exported.linked)
    source = traced.source(exported.name)
    inputs, pairs = golden_inputs(exported)
    if single:
        inputs = inputs.astype(np.float32).astype(np.float64)
    inputs = within_ranges(inputs, source)
    answers = np.vstack(
        [traced.answers(inputs[k : k + PART], pairs[k : k + PART]) for k in range(0, len(inputs), PART)]
    )
    fields = about(exported, numbers, single=single) | _of_source(source, exported.name, single=single)
    added = exported.linked or has_surface(exported.loader)
    columns = _ALWAYS + _CHANGING * (numbers.settings > 1) + _ADDED * added
    fields |= {
        "costs": (),
        "samples": len(inputs),
        "part": PART,
        "columns": columns,
        "added": added,
        "linked": exported.linked,
        "surface": has_surface(exported.loader),
        **golden_flights(exported.loader, traced.added, single=single),
        "given": spelled_rows(inputs[:, [INPUTS.index(name) for name in columns]], single=single),
        "pairs": ",\n".join(f"    {{{a}, {b}}}" for a, b in pairs),
        "answers": spelled_rows(answers, single=single),
    }
    if measure:
        fields["costs"] = measured(rendered("c", _FILES, fields), fields)
    return with_trace(rendered("c", _FILES, fields), f"{exported.name}_law.c", exported.name)


def with_trace(files: dict[str, str | bytes], file: str, name: str) -> dict[str, str | bytes]:
    """Files and the map from each statement of one to its origin."""
    code = str(files[file])
    return files | dict(zip(TRACE, (trace_json(file, code, name), trace_html(file, code, name)), strict=True))


def golden_flights(
    loader: Loader, added: Callable[[NDArray[np.float64]], NDArray[np.float64]], *, single: bool
) -> dict[str, object]:
    """Numbers of a flight with their units; of a loader with a surface, random flights, and what it adds in them."""
    numbers = {name: unit for name, (unit, *_) in _FLIGHT.items()}
    if not has_surface(loader):
        return {"flight": numbers}
    low, high = np.array([limits for _, *limits in _FLIGHT.values()]).T
    flights = np.random.default_rng(_SEED).uniform(low, high, (_FLIGHTS, len(_FLIGHT)))
    if single:
        flights = flights.astype(np.float32).astype(np.float64)
    return {
        "flight": numbers,
        "flights": _FLIGHTS,
        "flown": spelled_rows(flights, single=single),
        "adds": spelled_rows(added(flights), single=single),
    }


def rendered(kind: str, files: Mapping[str, str], fields: Mapping[str, object]) -> dict[str, str | bytes]:
    """Files by name, each from its template of an export of this kind."""
    templates = environment(html=False)
    return {
        name.format(fields["name"]): templates.get_template(f"export/{kind}/{template}.j2").render(fields)
        for template, name in files.items()
    }


def traced_law(loader: Loader, law: Law, numbers: SampledLaw, *, single: bool, linked: bool = False) -> ExportedLaw:
    """The law and its feel for the tracer."""
    feel = law.feel if law.feel is not None else np.array([[loader[key] for key in FEEL_SETTING]])
    return ExportedLaw(
        loader.rows(FEEL_SETTING, feel),
        numbers.rows(),
        states=numbers.states,
        period_s=numbers.period_s,
        single=single,
        linked=linked,
        curve=loader.force_curve.arrays if loader.force_curve else None,
        cancellation=law.cancellation.numbers if law.cancellation else None,
    )


def golden_inputs(exported: Exported) -> tuple[NDArray[np.float64], list[tuple[int, int]]]:
    """Inputs (samples, 11) and settings of release, sweep and random input from a run of the loader.

    In the random part the settings, trim, spring factor and shaker change, and what a surface adds.
    """
    loader = exported.loader
    period = exported.law.period_s or 0.0
    law = exported.law.some([0])
    own = loader.replace(dict(zip(FEEL_SETTING, exported.settings[0].tolist(), strict=True)), si=True)
    force = loader["pilot.force"]
    duration = PART * period
    parts = [
        recorded(
            own, law, lambda share: Scenario(Release(_RELEASED_RAD * share), duration_s=duration, sample_s=period)
        ),
        recorded(
            own,
            law,
            lambda share: Scenario(
                Chirp(0.3 * share * force, 0.2, 20.0, duration), duration_s=duration, sample_s=period
            ),
        ),
    ]
    random = np.random.default_rng(_SEED)
    size = np.abs(np.vstack(parts)[:, :3]).max(axis=0)
    noise = np.zeros((PART, len(INPUTS)))
    noise[:, :3] = size * random.standard_normal((PART, 3)).cumsum(axis=0) / 20
    noise[:, 3] = has_grip_sensor(loader) * force * random.uniform(-1, 1, PART)
    noise[:, 4:7] = [0.0, 1.0, 0.0] + [0.02, 0.2, 0.5] * random.uniform(-1, 1, (PART, 3))
    if exported.linked or has_surface(loader):
        beside = [0.1 * force, loader["feel.stiffness"], loader["feel.damping"]]
        noise[:, 8:] = beside * random.uniform(-0.5, 1, (PART, 3))
    pairs = [(0, 0)] * (2 * PART)
    count = len(exported.settings)
    for k in range(PART):
        block, within = divmod(k, 200)  # a tenth of a second with shares, then a constant one
        noise[k, 7] = within / 100 if count > 1 and within < 100 else 0.0
        pairs.append((block % count, (block + 1) % count))
    return np.vstack([*parts, noise]), pairs


def recorded(loader: Loader, law: Law, scenario: Callable[[float], Scenario]) -> NDArray[np.float64]:
    """Sensor values at each sample of ``scenario(1.0)``, or of a smaller one if that diverges.

    Raises:
        InputError: If the smallest diverges too.
    """
    for share in _SHARES:
        outputs = simulate(loader, scenario(share), law).outputs
        if np.isfinite(outputs["column_angle_rad"]).all():
            break
    else:
        feel = ", ".join(f"{loader[key]:.6g}" for key in FEEL_SETTING)
        raise InputError(
            f"law: {loader.name} diverges with {law.name} at I, B, G = {feel} (SI units), so there is no reference for the export; "
            "use settings that this loader can render, or another law"
        )
    position = "drive_position_m" if loader.drive == ELECTRIC else "piston_position_m"
    samples = np.zeros((PART, len(INPUTS)))
    base = outputs["column_angle_rad"] * loader["column.base_arm"]
    for column, values in enumerate((outputs["load_cell_force_n"], outputs[position], base)):
        samples[:, column] = values[:PART]
    samples[:, 5] = 1.0
    return samples


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


def within_ranges(inputs: NDArray[np.float64], source: LawSource) -> NDArray[np.float64]:
    """Inputs (samples, 11), clipped to the ranges of the law's inputs."""
    clipped = inputs.copy()
    for name, (low, high) in source.inputs:
        column = INPUTS.index(name)
        clipped[:, column] = clipped[:, column].clip(low, high)
    return clipped


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
        "checks": [_check(name, *of, single=single) for of in source.inputs] + _of_settings(name, source),
        "ranges": dict.fromkeys(INPUTS, "not read")
        | {name: f"{low:.6g} to {high:.6g}" for name, (low, high) in source.inputs},
        "operations": f"{plain} as written, {looped} in loops over data",
    }


def _check(name: str, of: str, ends: tuple[float, float], *, single: bool) -> str:
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


def spelled_rows(numbers: NDArray[np.float64], *, single: bool) -> str:
    """C literals that are exact to the last bit."""

    def spelled(value: float) -> str:
        if not math.isfinite(value):
            return "NAN" if math.isnan(value) else "INFINITY" if value > 0 else "-INFINITY"
        return f"{np.float32(value)!s}F" if single else repr(value)

    return ",\n".join(f"    {{{', '.join(map(spelled, row))}}}" for row in numbers.tolist())
