"""Makes ``demo/engine.js``, what the live loader runs on: the compiled model, its laws and the rule, as text. ``make demo``.

A page that is opened from a file may load scripts and nothing else, so all of it is one script.
"""

import base64
import gzip
import json
import sys
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

import forcefeel as ff
from forcefeel import _core
from forcefeel.envelope.releases import Record
from forcefeel.files import write_whole
from forcefeel.loader.parameters import INDEX
from forcefeel.loader.timing import controller_steps
from forcefeel.qualification.batch_verdicts import NAMES, tolerance_rows
from forcefeel.qualification.release import REST

ROOT = Path(__file__).parents[1]
ENGINE = ROOT / "docs" / "demo" / "engine.js"
WASM = ROOT / "target" / "wasm32-unknown-unknown" / "release" / "forcefeel_browser.wasm"

FREQUENCIES_HZ = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)
DAMPINGS = (0.1, 0.2, 0.4, 0.7, 1.0)
"""Feels for which each law is designed; the inertia stays, so that the spring follows the frequency."""

LAWS = {"original": ff.elevator, "published": ff.elevator, "robust": ff.digital_elevator}
"""Laws and the loader of each: the report's are analog."""

ORIGINAL, GAINS, SAMPLED = range(3)
STEP_S = 1e-3
PERIODS = 6
"""Periods of a release, as in an envelope of simulated ones."""
TAIL = 0.1
MOST_TOLERANCES = 10


def with_feel(loader: ff.Loader, frequency_hz: float, damping: float) -> ff.Loader:
    """The loader with another spring and damping."""
    inertia, frequency = loader["feel.inertia"], 2 * pi * frequency_hz
    return loader.replace(
        {"feel.damping": 2 * damping * frequency * inertia, "feel.stiffness": frequency**2 * inertia}, si=True
    )


def law_numbers(loader: ff.Loader, law: ff.Law) -> tuple[int, list[float]]:
    """Kind and numbers of a law as ``crates/browser`` takes them."""
    engine = law.engine(loader)
    if (sampled := engine.get("observers")) is not None:
        return SAMPLED, sampled[0].tolist()
    gains = engine["law"]
    if gains is None:
        return ORIGINAL, []
    return GAINS, [*gains.gains, gains.load_cell_arm, float(gains.displacement_unit == "V")]


def timing(loader: ff.Loader) -> tuple[float, int, int]:
    """Step in s, steps in a period and in its delay; a period of none for an analog law."""
    if not loader["controller.period"]:
        return STEP_S, 0, 0
    step_s, (period, delay) = controller_steps(loader, STEP_S)
    return step_s, period, delay


def setup(loader: ff.Loader, law: ff.Law, held_rad: float) -> list[float]:
    """A loader as ``crates/browser`` takes it."""
    kind, numbers = law_numbers(loader, law)
    room = [0.0] * (_core.OBSERVER_NUMBERS - len(numbers))
    return [*loader.si_values.tolist(), *timing(loader), held_rad, kind, *numbers, *room]


def data() -> dict[str, Any]:
    """Loaders, laws by feel, and the rule by which ``envelope`` judges."""
    rules = ff.qualification.load_rules()
    test, rule = rules.of("release", "pitch"), rules.release
    tolerances = tolerance_rows(test)
    shares = [rule.residual_band, rule.high, rule.low, TAIL, REST, len(tolerances)]
    padding = np.zeros((MOST_TOLERANCES - len(tolerances), tolerances.shape[1]))
    feels = []
    for frequency in FREQUENCIES_HZ:
        for damping in DAMPINGS:
            record = Record.of(2 * pi * frequency, damping, PERIODS)
            laws = {}
            for name, base in LAWS.items():
                loader = with_feel(base(), frequency, damping)
                laws[name] = law_numbers(loader, ff.Law.of(name, loader))
            values = with_feel(ff.elevator(), frequency, damping)
            feels.append(
                {
                    "frequency": frequency,
                    "damping": damping,
                    "values": [values["feel.damping"], values["feel.stiffness"]],
                    "sample": record.step_s,
                    "duration": record.duration_s,
                    "laws": laws,
                }
            )
    return {
        "places": dict(INDEX),
        "loaders": {
            name: {"values": base().si_values.tolist(), "timing": timing(base())} for name, base in LAWS.items()
        },
        "numbers": _core.OBSERVER_NUMBERS,
        "frequencies": FREQUENCIES_HZ,
        "dampings": DAMPINGS,
        "feels": feels,
        "rule": [*shares, *tolerances.ravel().tolist(), *padding.ravel().tolist()],
        "quantities": NAMES,
        "title": f"{rules.title}, test {test.number}",
    }


def main() -> None:
    packed = base64.b64encode(gzip.compress(WASM.read_bytes(), 9, mtime=0)).decode()
    text = "// Made by make demo from crates/browser and the package: see docs/live_loader.py.\nconst forcefeelEngine = {\n"
    text += f'"wasm": "{packed}",\n"data": {json.dumps(data(), separators=(",", ":"))}\n}};\n'
    write_whole(ENGINE, text)
    sys.stdout.write(f"docs/demo/engine.js: {len(text):,} bytes\n")


if __name__ == "__main__":
    main()
