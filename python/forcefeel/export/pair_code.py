"""Export of an electronic link between two exported laws as C99, with golden vectors that a simulation of the pair recorded.

``forcefeel._core.ExportedPair`` traces a sample of the link; a shaft is in the machine, and has a note only.
"""

import hashlib
import re
from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import ExportedPair
from forcefeel.errors import InputError
from forcefeel.export.c_code import (
    TRACE,
    about,
    rendered,
    spelled_bits,
    traced_law,
    with_trace,
)
from forcefeel.export.exported import Exported
from forcefeel.export.golden import INPUTS, spelled_rows, within_ranges
from forcefeel.export.trace_map import commented
from forcefeel.linked.engine import linked_samples
from forcefeel.linked.joint import delay_periods
from forcefeel.linked.scenario import Button, LinkedScenario
from forcefeel.loader.links import LINK_TABLE, Link, LinkKind
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import with_unit
from forcefeel.loader.project import Project
from forcefeel.simulation.inputs import Recorded
from forcefeel.simulation.scenario import Scenario
from forcefeel.units import UnitSystem

PAIR_PART = 2000
"""Samples of each part of the golden vectors."""

PARTS = ("opposed hands", "the second pilot's button", "a disconnect")

_FILES = {
    "pair.h": "{}.h",
    "pair.c": "{}.c",
    "pair_main.c": "{}_main.c",
    "pair_golden.h": "{}_golden.h",
    "pair_test.c": "{}_test.c",
    "pair_Makefile": "Makefile",
    "pair_README.md": "README.md",
}

_BEYOND, _PUSHES, _SEED = 1.4, 8, 36
"""Largest torque of the hands as a share of the breakout's, random forces of each, and their seed."""

_SHARES = (1.0, 0.1, 0.01)
"""Factors on the hands: with a feel that is heavy for a drive, a large one can diverge."""


@dataclass(frozen=True, eq=False)
class PairExport:
    """A link of a project and the exported laws of its sides.

    Attributes:
        project: The project.
        link: The link.
        name: Prefix of file names and C identifiers.
        sides: The laws, each ``linked`` if the link is electronic.

    Raises:
        InputError: If the link is electronic and a side has rows that a program tunes.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
        >>> link = project.links["stick-pitch"]
        >>> law = ff.export.Exported.of("robust", project.loaders["stick-pitch"], "first")
        >>> ff.export.PairExport.of(project, link, "cockpit", (law, law)).name
        'cockpit_stick_pitch_link'
    """

    project: Project
    link: Link
    name: str
    sides: tuple[Exported, Exported]

    def __post_init__(self) -> None:
        if self.electronic and any(side.tunable for side in self.sides):
            raise InputError("tunable: the code of an electronic link has fixed feels; export its sides without")

    @classmethod
    def of(cls, project: Project, link: Link, prefix: str, sides: tuple[Exported, Exported]) -> "PairExport":
        """A link, its name in C made of the prefix and its own."""
        return cls(project, link, f"{prefix}_{re.sub('[^A-Za-z0-9]', '_', link.name)}_link", sides)

    @property
    def electronic(self) -> bool:
        """Whether it acts in the feel computers."""
        return self.link.kind is LinkKind.ELECTRONIC

    @property
    def own(self) -> Project:
        """The project with the first feel setting of each law."""
        loaders = {
            axis: side.loader.replace(dict(zip(FEEL_SETTING, side.settings[0].tolist(), strict=True)), si=True)
            for axis, side in zip(self.link.between, self.sides, strict=True)
        }
        return replace(self.project, loaders={**self.project.loaders, **loaders})

    def traced(self, *, single: bool) -> ExportedPair:
        """The pair for the tracer.

        Raises:
            InputError: If a law is analog, or the delay is not whole periods.
        """
        first, second = (
            traced_law(side.loader, side.law, side.sampled(), single=single, linked=True) for side in self.sides
        )
        delay = delay_periods(self.link, (self.sides[0].loader, self.sides[1].loader))
        uncouples = self.link.after_breakout.value == "uncouple"
        return ExportedPair(first, second, self.link.values, delay=delay or 1, uncouples=uncouples)

    def recorded(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Inputs (samples, 27) of the pair, and what the simulation sampled (samples, 13), of each part."""
        for share in _SHARES:
            parts = [self._part(part, share) for part in range(len(PARTS))]
            inputs, sampled = (np.vstack(rows) for rows in zip(*parts, strict=True))
            if np.isfinite(sampled).all():
                return inputs, sampled
        raise InputError(
            f"links.{self.link.name}: the pair diverges under small forces, so there is no reference for the export; "
            "run forcefeel simulate on the project, and mend the link or the laws"
        )

    def _part(self, part: int, share: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        period = self.sides[0].law.period_s or 0.0
        duration, half = PAIR_PART * period, PAIR_PART // 2
        times = np.linspace(0.0, duration, _PUSHES + 1)
        draws = np.random.default_rng(_SEED + part)
        hands = [
            Recorded(times, share * sign * np.r_[0.0, self._largest(side) * draws.uniform(0.2, 1.0, _PUSHES)])
            for side, sign in enumerate((1.0, -1.0))
        ]
        scenario = LinkedScenario(
            Scenario(hands[0], duration, sample_s=period),
            second_force=hands[1],
            button=Button(self.link.between[1], half * period) if part == 1 else None,
            disconnect_s=half * period if part == 2 else None,
        )
        sampled = linked_samples(
            self.own, self.link.name, scenario, (self.sides[0].law.some([0]), self.sides[1].law.some([0]))
        )[:PAIR_PART]
        inputs = np.zeros((PAIR_PART, 2 * len(INPUTS) + 5))
        for side in range(2):
            first = side * len(INPUTS)
            inputs[:, first : first + 4] = sampled[:, 5 * side : 5 * side + 4]
            inputs[:, first + INPUTS.index("stiffness_factor")] = 1.0
        inputs[:, -5:-3] = sampled[:, 10:12]
        inputs[half:, -2] = part == 1
        inputs[half:, -1] = part == 2
        return inputs, sampled

    def _largest(self, side: int) -> float:
        """The largest force of a hand."""
        loader, breakout = self.sides[side].loader, self.link["breakout"]
        of_pilot = loader["pilot.force"]
        return min(of_pilot, _BEYOND * breakout / loader["column.grip_arm"]) if isfinite(breakout) else of_pilot


def pair_names(name: str, *, electronic: bool) -> tuple[str, ...]:
    """File names of :func:`pair_files`."""
    return (*(file.format(name) for file in _FILES.values()), *TRACE) if electronic else ("README.md",)


def pair_files(pair: PairExport, *, single: bool) -> dict[str, str | bytes]:
    """Files by name; ``single`` for a target with single precision.

    Raises:
        InputError: If a law is analog, or the pair cannot be simulated.
    """
    link = pair.link
    fields = {"name": pair.name, "link": link.name, "axes": link.between, "electronic": pair.electronic}
    if not pair.electronic:
        return rendered("c", {"pair_README.md": "README.md"}, fields)
    traced = pair.traced(single=single)
    sample, step = traced.source(pair.name)
    sample, halving = commented(sample), commented(step) if step else ""
    code = sample + halving
    inputs, _ = pair.recorded()
    if single:
        inputs = inputs.astype(np.float32).astype(np.float64)
    for k, side in enumerate(pair.sides):
        law = slice(k * len(INPUTS), (k + 1) * len(INPUTS))
        source = traced_law(side.loader, side.law, side.sampled(), single=single, linked=True).source(side.name)
        inputs[:, law] = within_ranges(inputs[:, law], source)
    answers = np.vstack(
        [traced.answers(inputs[k : k + PAIR_PART]) for k in range(0, len(inputs), PAIR_PART)],
    )
    first, second = (about(side, side.sampled(), single=single) for side in pair.sides)
    sensors = [*range(4), *range(len(INPUTS), len(INPUTS) + 4), *range(2 * len(INPUTS), 2 * len(INPUTS) + 2)]
    fields |= (
        first
        | fields
        | {
            "first": pair.sides[0].name,
            "second": pair.sides[1].name,
            "units": [first["command_unit"], second["command_unit"]],
            "delay": delay_periods(link, (pair.sides[0].loader, pair.sides[1].loader)),
            "rows": {
                row.name: with_unit(row, link[row.name], UnitSystem.SI) if link[row.name] != inf else "none"
                for row in LINK_TABLE.values()
                if row.name != "delay"
            },
            "after": link.after_breakout.value,
            "fade_s": f"{pair.sides[0].loader['safety.fade_time']!r}{'f' if single else ''}",
            "code": code,
            "sample": sample,
            "halving": halving,
            "halvings": f"{traced.HALVINGS}U",
            "ready": f"0x{hashlib.sha256(code.encode()).hexdigest()[:8].upper()}U",
            "bits": "uint32_t" if single else "uint64_t",
            "infinity": spelled_bits(inf, single=single, shifted=True),
            "samples": len(inputs),
            "part": PAIR_PART,
            "parts": PARTS,
            "given": spelled_rows(inputs[:, sensors], single=single),
            "flags": _flags(inputs[:, -3:]),
            "answers": spelled_rows(answers[:, :12], single=single),
            "answer_flags": _flags(answers[:, 12:]),
        }
    )
    return with_trace(rendered("c", _FILES, fields), f"{pair.name}.c", pair.name)


def _flags(rows: NDArray[np.float64]) -> str:
    return ",\n".join(f"    {{{', '.join(str(int(flag)) for flag in row)}}}" for row in rows)
