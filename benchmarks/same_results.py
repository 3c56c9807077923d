"""Every command on every built-in loader, its JSON kept: so that a change of the structure can be shown to change no number.

    python benchmarks/same_results.py make BEFORE      with the package as it was
    python benchmarks/same_results.py make AFTER       with the package as it is
    python benchmarks/same_results.py compare BEFORE AFTER

The package is the one that this Python imports. Exit status 1 where a result differs by more than rounding: numbers that differ by
less than 1e-9 of themselves are counted apart, with the largest such difference. A law whose numbers differ by rounding is another
draw of the noise to a loader whose sensors round: there a run differs as between two seeds.
"""

import io
import json
import os
import re
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from math import inf
from pathlib import Path

from forcefeel.cli import main

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LOADERS = ("elevator-1974", "elevator-2khz")
GRID = ("--grid", "stiffness=5, 20, 60 %", "--grid", "frequency=1, 2 Hz", "--grid", "damping=0.2, 0.7")
KNOTS = """\
dynamic pressure (lb/ft^2),stiffness (lb in/rad),frequency (Hz),damping ratio
50,2000,1.2,0.4
200,6000,1.8,0.3
400,9600,2.0,0.2
"""
BENCH = ("--data", f"{EXAMPLES}/bench/multisine.parquet", "--data", f"{EXAMPLES}/bench/sweep.csv")
ROUGH = ("--set", "column.coulomb_friction=2 lb", "--set", "feel.breakout=3 lb", "--set", "linkage.backlash=0.002 in")


ROUNDING = 1e-9
"""Relative: an equation that is worked out in another order, and the search for a margin behind it, differ by some 1e-12."""


RENAMED = {
    "all_at_once": "joint_tolerances",
    "asked": "demands",
    "chance_of_a_correlation": "significance_level",
    "compensator": "law",
    "compensators": "laws",
    "fails_first_nominally": "nominal_first_failure",
    "force_off_by": "force_error",
    "given": "available",
    "gives": "capability",
    "good": "ok",
    "granted": "realtime_status",
    "half_interval_of_data_alone": "half_interval_without_prior",
    "if_known_exactly": "share_at_zero_tolerance",
    "largest_share_standing_still": "peak_holding_share",
    "least_margins": "minimum_margins",
    "left_out": "omitted",
    "lost_most": "worst_case",
    "method": "law",
    "methods": "laws",
    "not_told_apart": "inseparable",
    "outside_the_programme": "tests_not_simulated",
    "passes": "nominal_share",
    "passes_worst": "worst_case_share",
    "programme": "test_plan",
    "share_asked_for": "required_share",
    "shares_even_in_proportion": "shares_log_weighted",
    "standing": "status",
    "tally": "outcome_counts",
    "words": "summary",
}
"""Keys of BEFORE by what they are called now, for results that were made by a package of before."""


def commands() -> Iterator[tuple[str, tuple[str, ...]]]:
    """A name and the words of each call."""
    for loader in LOADERS:
        laws = (
            "original",
            "published",
            "converged",
            *(("load-cell", "h-infinity", "robust") if "2khz" in loader else ()),
        )
        yield f"new-{loader}", ("new", f"{loader}.toml", "--built-in", loader)
        yield f"analyze-{loader}", ("analyze", loader)
        yield f"design-{loader}", ("design", loader)
        yield f"law-{loader}", ("law", loader, "--law", "report")
        yield f"law-converge-{loader}", ("law", loader, "--law", "report", "--converge", "--units", "si")
        for law in laws:
            yield f"simulate-{loader}-{law}", ("simulate", loader, "--law", law)
        yield (
            f"simulate-rough-{loader}",
            ("simulate", loader, "--law", "original", *ROUGH, "--input", "release", "--angle", "10 deg"),
        )
        yield f"simulate-chirp-{loader}", ("simulate", loader, "--law", "original", "--input", "chirp", "--units", "si")
        yield f"sweep-{loader}", ("sweep", loader, "--runs", "64", "--law", laws[-1])
        yield (
            f"sweep-grid-{loader}",
            ("sweep", loader, "--law", "original", "--grid", "feel.stiffness=1000..9000 lb in/rad:8"),
        )
        yield f"qualify-{loader}", ("qualify", loader, "--compare")
        yield f"qualify-rough-{loader}", ("qualify", loader, "--law", laws[-1], *ROUGH)
        yield f"envelope-{loader}", ("envelope", loader, "--compare", "--draws", "8", *GRID)
        yield f"choice-{loader}", ("law", loader, "--law", "auto", *GRID)
        yield f"frontier-{loader}", ("frontier", loader, *GRID)
        yield (
            f"excite-{loader}",
            ("excite", loader, "--fit", "linkage.stiffness,column.inertia", "--out", f"{loader}.csv", "--time", "20"),
        )
    yield "schedule", ("schedule", LOADERS[1], "--knots", "knots.csv")
    yield "identify", ("identify", f"{EXAMPLES}/bench/loader.toml", *BENCH, "--fit", "k,c,J,C_i")
    yield "resonance", ("resonance", LOADERS[0], *BENCH[:2])
    yield "reproduce", ("reproduce",)


def make(folder: Path) -> None:
    """Runs each command in a folder and keeps what it prints."""
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    Path("knots.csv").write_text(KNOTS)
    for name, words in commands():
        takes_out = words[0] not in {"new", "analyze", "reproduce", "resonance", "excite"} and (
            words[:1] != ("law",) or "report" not in words
        )
        out = ("--out", name) if takes_out else ()
        status, text = _called((*words, *out, "--json"))
        Path(f"{name}.txt").write_text(f"{status}\n{text}")
        print(name, status, flush=True)


def _called(words: tuple[str, ...]) -> tuple[object, str]:
    printed, errors, status = io.StringIO(), io.StringIO(), 0
    sys.argv = ["forcefeel", *words]
    with redirect_stdout(printed), redirect_stderr(errors):
        try:
            main()
        except SystemExit as ended:
            status = ended.code
    return status, printed.getvalue() or errors.getvalue()


def compare(before: Path, after: Path) -> int:
    """The results that differ by more than rounding, by their place; how many files do."""
    wrong, rounded, largest = 0, 0, 0.0
    befores = {_name_now(path.name): path for path in before.glob("*.txt")}
    afters = {path.name: path for path in after.glob("*.txt")}
    names = sorted({*befores, *afters})
    for name in names:
        there, here = befores.get(name), afters.get(name)
        if there is None or here is None:
            print(f"{name}: only in {after if there is None else before}")
            wrong += 1
            continue
        differences = list(_differences(*(_read(path) for path in (there, here))))
        lines = [line for line, size in differences if size > ROUNDING]
        wrong += bool(lines)
        rounded += bool(differences) and not lines
        largest = max([largest, *(size for _, size in differences if size <= ROUNDING)])
        for line in lines[:5]:
            print(f"{name}: {line}")
    print(f"{len(names)} results, {wrong} differ; {rounded} more by rounding, {largest:.1e} of a number at most")
    return wrong


def _read(path: Path) -> object:
    status, _, text = path.read_text().partition("\n")
    try:
        return [status, json.loads(text)]
    except ValueError:
        return [status, text]


def _differences(there: object, here: object, place: str = "") -> Iterator[tuple[str, float]]:
    """Where two documents differ, and by how much of the number; infinitely where they are no numbers."""
    if isinstance(there, dict) and isinstance(here, dict):
        there = {_key_now(key, here): value for key, value in there.items()}
        for key in {**there, **here}:
            if key in there and key in here:
                yield from _differences(there[key], here[key], f"{place}.{key}")
            else:
                yield f"{place}.{key}: only {'before' if key in there else 'after'}", inf
    elif isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        for k, (one, two) in enumerate(zip(there, here, strict=True)):
            yield from _differences(one, two, f"{place}[{k}]")
    elif there != here and not (isinstance(there, str) and _name_now(there) == here):
        numbers = isinstance(there, float) and isinstance(here, float)
        size = abs(there - here) / max(abs(there), abs(here)) if numbers else inf
        yield f"{place}: {str(there)[:80]} before, {str(here)[:80]} after", size


def _name_now(text: str) -> str:
    """A text of BEFORE with the loader and the command of then as they are called now."""
    text = re.sub(r"\belevator\b(?!-(2khz|electric|1974))", "elevator-1974", text)
    return re.sub(r"\bcompensate(?=[-.])", "law", text)


def _key_now(key: str, here: dict[str, object]) -> str:
    """What a key of before is called in the same document of now."""
    now = RENAMED.get(key, key)
    return now if key not in here and now in here else key


if __name__ == "__main__":
    what, *folders = sys.argv[1:]
    if what == "make":
        make(Path(folders[0]))
    else:
        sys.exit(1 if compare(*map(Path, folders)) else 0)
