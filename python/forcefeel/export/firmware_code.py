"""Export of a law as firmware: the Rust code of simulation and live loop, compiled for a target, with header and golden vectors.

The library is one of the installation, or cargo compiles it: ``firmware_library.py``.
"""

from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import BoardAxis, safety_functions
from forcefeel.errors import InputError
from forcefeel.export.c_code import about, rendered
from forcefeel.export.exported import Exported
from forcefeel.export.firmware_board import BOARD, BOARD_FILES, BOARD_SAMPLES, BOARD_TARGET, board_fields, board_files
from forcefeel.export.firmware_library import firmware_library, library_origin, target_of
from forcefeel.export.golden import golden_flights, recorded, spelled_rows
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.surface import has_surface
from forcefeel.simulation.inputs.signals import Chirp
from forcefeel.simulation.scenario import Scenario

BOARDS = {"thumbv7em-none-eabihf": "hard -mfpu=auto", "thumbv7em-none-eabi": "soft"}
"""Targets with an example for a bare board, and how floating-point numbers are passed there."""

_OFF, _ACTIVE = 0, 2
_EMERGENCY_STOP, _ACKNOWLEDGED, _DRIVE_ACTS = 1, 4, 16
_SEED = 21
_PART = 3334
_HERE = Path(__file__).parent
_FILES = {
    "data.h": "{}_data.h",
    "main.c": "{}_main.c",
    "golden.h": "{}_golden.h",
    "test.c": "{}_test.c",
    "forcefeel.h": "forcefeel.h",
    "Makefile": "Makefile",
    "README.md": "README.md",
}
_OF_EXAMPLE = ("reset.c", "board.ld")
_ON_BOARD = {name: name for name in ("board.h", "Makefile", "telemetry.py")}
_NOT_ON_BOARD = ("main.c", "test.c", "Makefile")
_LIBRARY, _LICENSES = "libforcefeel.a", "LICENSES.txt"


def firmware_names(name: str, triple: str | None) -> tuple[str, ...]:
    """File names of :func:`firmware_files`."""
    own = (file.format(name) for file in _own(triple).values())
    board = (*_ON_BOARD, *BOARD_FILES) if triple == BOARD else _OF_EXAMPLE if triple in BOARDS else ()
    return (*own, *board, _LICENSES, _LIBRARY)


def firmware_files(exported: Exported, triple: str | None, *, single: bool) -> dict[str, str | bytes]:
    """Files by name for the target ``triple``, or the board of that name; default: this machine.

    Raises:
        InputError: If the law is not a sampled one, there is neither a library for the target nor what compiles one, or the board
            cannot run it.
    """
    numbers = exported.sampled()
    board = triple == BOARD
    if board and not single:
        raise InputError(f"single: {BOARD} computes in single precision, got double; give --single")
    triple = BOARD_TARGET if board else target_of(triple)
    library = firmware_library(triple, single=single)
    axis = board_axis(exported)
    inputs, words = golden_inputs(exported)
    if board:
        inputs, words = inputs[:BOARD_SAMPLES], words[:BOARD_SAMPLES]
    if single:
        inputs = inputs.astype(np.float32).astype(np.float64)
    answers, states = axis.answers(inputs, words.tolist(), single=single)
    loader = exported.loader
    functions = safety_functions(loader.si_values, loader.drive, numbers.period_s)
    fields = about(exported, numbers, single=single) | {
        "triple": triple,
        "float_abi": None if board else BOARDS.get(triple),
        "board": board,
        "functions": [(name, does) for name, does, *_ in functions],
        "samples": len(inputs),
        "given": spelled_rows(inputs, single=single),
        "words": _words(words[:, :7]),
        "answers": spelled_rows(answers[:, :4], single=single),
        "states": _words(states),
        "periods": _periods_until_on(exported),
        "origin": library_origin(triple, single=single),
        "surface": has_surface(loader),
        **golden_flights(loader, partial(axis.added, single=single), single=single),
    }
    fields |= _numbers(exported, axis) | (board_fields(loader) if board else {})
    files = rendered("firmware", _own(BOARD if board else triple), fields)
    if board:
        files |= rendered(f"board/{BOARD}", _ON_BOARD, fields) | board_files()
    elif triple in BOARDS:
        files |= {name: (_HERE / "board" / name).read_text(encoding="utf-8") for name in _OF_EXAMPLE}
    files[_LICENSES] = (_HERE / "firmware" / _LICENSES).read_text(encoding="utf-8")
    return files | {_LIBRARY: library}


def _own(triple: str | None) -> dict[str, str]:
    """Templates and file names of the library's own files."""
    return {name: file for name, file in _FILES.items() if triple != BOARD or name not in _NOT_ON_BOARD}


def board_axis(exported: Exported) -> BoardAxis:
    """Loader, law and supervisor of a board."""
    loader, law, numbers = exported.loader, exported.law, exported.sampled()
    return BoardAxis(
        loader.rows(FEEL_SETTING, exported.settings),
        numbers.rows(),
        period_s=numbers.period_s,
        curve=loader.force_curve.arrays if loader.force_curve else None,
        cancellation=law.cancellation.numbers if law.cancellation else None,
    )


def golden_inputs(exported: Exported) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Inputs, numbers (samples, 11) and words (samples, 8), that reach every state.

    They are: on, a sweep, a sensor with NaN, acknowledgment, on, random input, the emergency stop.
    """
    loader, law = exported.loader, exported.law.some([0])
    period = law.period_s or 0.0
    own = loader.replace(dict(zip(FEEL_SETTING, exported.settings[0].tolist(), strict=True)), si=True)
    duration = _PART * period
    force = 0.1 * loader["pilot.force"]
    sweep = recorded(
        own,
        law,
        lambda share: Scenario(Chirp(share * force, 0.2, 20.0, duration), duration_s=duration, sample_s=period),
        _PART,
    )
    count = len(exported.settings)
    rest, settled = _periods_until_on(exported), round(0.6 / period)
    still = np.repeat(sweep[:1], rest, axis=0)
    stopped = np.repeat(sweep[-1:], settled, axis=0)
    stopped[0, 0] = np.nan
    random = np.random.default_rng(_SEED)
    stirred = np.repeat(sweep[:1], _PART, axis=0)
    stirred[:, 0] += 0.01 * loader["pilot.force"] * random.uniform(-1, 1, _PART)
    # Trim, factor and shaker jump about every tenth of a second; the controller limits their rate.
    stirred[:, 4:7] += np.repeat([0.02, 0.2, 0.5] * random.uniform(-1, 1, (-(-_PART // 150), 3)), 150, axis=0)[:_PART]
    stirred[:, 6] = np.abs(stirred[:, 6])
    stirred[:, 8] = 0.01 * loader["pilot.force"] * random.uniform(-1, 1, _PART)
    beside = [0.1 * loader["feel.stiffness"], 0.1 * loader["feel.damping"]]
    stirred[:, 9:] = beside * random.uniform(-0.5, 1, (_PART, 2))
    inputs = np.vstack([still, sweep, stopped, still, stirred])
    words = np.zeros((len(inputs), 8), dtype=np.int64)
    begins = rest + _PART + settled
    words[:, 2], words[:, 6] = _ACTIVE, _DRIVE_ACTS
    words[0, 2] = words[begins - 10 : begins, 2] = _OFF
    words[begins - 10, 6] |= _ACKNOWLEDGED
    words[begins - 20 : begins - 15, 3] = range(1, 6)  # missing samples
    words[-100:, 6] |= _EMERGENCY_STOP
    last = begins + rest
    for k in range(_PART):
        block, within = divmod(k, 200)
        words[last + k, :2] = block % count, (block + 1) % count
        inputs[last + k, 7] = within / 100 if count > 1 and within < 100 else 0.0
    return inputs, words


def _periods_until_on(exported: Exported) -> int:
    """Periods from the request to an active axis: sensor check, then fade-in of the feel."""
    loader = exported.loader
    return round((loader["safety.stuck_time"] + loader["safety.fade_time"]) / exported.sampled().period_s) + 50


def _words(words: NDArray[np.integer]) -> str:
    return ",\n".join(f"    {{{', '.join(f'{word}U' for word in row)}}}" for row in words.tolist())


def _numbers(exported: Exported, axis: BoardAxis) -> dict[str, object]:
    """Numbers of the loader and the settings, always in double precision."""
    period, at_rest, cancellation, knots, coefficients, points, cancels = axis.loader()
    values = exported.loader.rows(FEEL_SETTING, exported.settings)
    laws = exported.sampled().rows()

    def row(numbers: list[float]) -> str:
        return spelled_rows(np.array([numbers]), single=False).strip()

    def block(rows: list[list[float]]) -> str:
        return f"{{\n{spelled_rows(np.array(rows), single=False)}\n    }}"

    parts = [
        repr(period),
        block(at_rest),
        row(cancellation),
        row(knots),
        block(coefficients),
        f"{points}U",
        f"{cancels}U",
    ]
    return {
        "values": values.shape[1],
        "laws": laws.shape[1],
        "cancellations": len(cancellation),
        "points": len(knots),
        "numbers": ",\n".join(f"    {part}" for part in parts),
        "blocks": ",\n".join(
            f"    {{\n        {row(values_row)},\n        {row(law)}\n    }}"
            for values_row, law in zip(values.tolist(), laws.tolist(), strict=True)
        ),
    }
