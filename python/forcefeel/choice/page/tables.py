"""Tables of a comparison of laws: shares, margins, noise and demand, poles, settings."""

from math import degrees, inf, isfinite

from forcefeel.choice import Choice, LawScores, Score
from forcefeel.choice.demand import AnyDemand, demand_shares
from forcefeel.conclusions import capital, share_text
from forcefeel.envelope.settings import AXES
from forcefeel.linear.modes import Mode
from forcefeel.loops.margins import LoopMargins
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, heading_text, number_text, prose_html
from forcefeel.units import FORCE, HERTZ, UnitSystem

_MOST_HZ = 1000.0
"""Poles above this frequency belong to sampling and delay."""


def shares(scored: LawScores, choice: Choice | None) -> Table:
    """Shares of the settings that each law renders, and its costliest case."""
    rows = []
    for score in scored.scores:
        if score.over is None:
            continue
        taken = choice is not None and score.name == choice.chosen
        law_shares, lost = score.over.shares, score.over.worst_case
        numbers = (law_shares.worst_case_share, law_shares.nominal_share, law_shares.stable_worst, law_shares.stable)
        quiet = NONE if score.over.quiet is None else share_text(score.over.quiet)
        most = f"{lost.case}, {share_text(lost.lost)}" if lost else NONE
        name = words(f"{capital(score.name)}{', chosen' if taken else ''}")
        rows.append((name, *(number(share_text(share)) for share in numbers), number(quiet), words(prose_html(most))))
    head = heads("Law", "Passes in every case", "Passes", "Stable in every case", "Stable", "Quiet in contact")
    return Table((*head, Cell("Most of what passes is lost with")), tuple(rows))


def laws(scored: LawScores) -> Table:
    """Description of each law."""
    rows = tuple((words(capital(score.name)), words(prose_html(score.summary))) for score in scored.scores)
    return Table((Cell("Law"), Cell("Description")), rows)


def margins(scored: LawScores) -> Table:
    """Margins at the loader's own setting, and the smallest of each over the corners of the grid."""
    rows = []
    for score in scored.scores:
        rows.append((words(capital(score.name)), *_margins(score.own.margins)))
        if score.over is not None:
            rows.append((words(""), *_margins(score.over.margins, "least")))
    head = (
        "Law",
        "At",
        "Gain may fall to",
        "Gain may grow",
        "Phase, deg",
        "More delay, ms",
        "Disk",
        "Crossover, Hz",
    )
    return Table((Cell(head[0]), Cell(head[1]), *(Cell(text, "number") for text in head[2:])), tuple(rows))


def _margins(margins: LoopMargins, where: str = "own setting") -> tuple[Cell, ...]:
    if margins.disk == 0:
        return (Cell(where), number("unstable", bad=True), *(number(NONE) for _ in range(5)))
    return (
        Cell(where),
        number("nothing" if margins.gain_down == 0 else number_text(margins.gain_down, 3)),
        number("unlimited" if margins.gain_up == inf else f"{number_text(margins.gain_up, 3)} times"),
        number(NONE if margins.phase_rad == inf else number_text(degrees(margins.phase_rad), 3)),
        number(NONE if margins.delay_s == inf else number_text(1e3 * margins.delay_s, 3)),
        number(number_text(margins.disk, 2)),
        number(
            number_text(HERTZ.from_si(margins.crossover_rad_per_s, UnitSystem.SI), 3)
            if isfinite(margins.crossover_rad_per_s)
            else NONE
        ),
    )


def demands(scored: LawScores, system: UnitSystem) -> Table:
    """Demand of releases on the drive, and effect of the noise."""
    rows = []
    for score in scored.scores:
        rows.append(
            (
                words(capital(score.name)),
                Cell("own setting"),
                *_demand(score.own.demand),
                *_noise(scored, score, system),
            )
        )
        if score.over is not None:
            empty = [number(NONE)] * (2 * scored.sampled)
            rows.append((words(""), Cell("largest"), *_demand(score.over.demand), *empty))
    noise = ("Noise, angle, 0.001 deg", heading_text("Noise, on a hand", FORCE, system)) if scored.sampled else ()
    head = (*(f"Peak {name}" for name in demand_shares(scored.scores[0].own.demand)), *noise)
    return Table((Cell("Law"), Cell("At"), *(Cell(text, "number") for text in head)), tuple(rows))


def _demand(demand: AnyDemand) -> tuple[Cell, ...]:
    return tuple(
        number(share_text(share) if isfinite(share) else NONE, bad=share >= 1)
        for share in demand_shares(demand).values()
    )


def _noise(scored: LawScores, score: Score, system: UnitSystem) -> tuple[Cell, ...]:
    noise = score.own.noise
    if noise is None or not scored.sampled:
        return ()
    return (
        number(number_text(1e3 * degrees(noise.angle_rad), 3) if isfinite(noise.angle_rad) else "unstable"),
        number(number_text(FORCE.from_si(noise.force_n, system), 3) if isfinite(noise.force_n) else "unstable"),
    )


def poles(score: Score) -> Table:
    """Modes of the closed loop up to ``_MOST_HZ``."""
    rows = tuple(
        _mode(mode) for mode in score.own.modes if HERTZ.from_si(mode.frequency_rad_per_s, UnitSystem.SI) <= _MOST_HZ
    )
    return Table(heads("Pole", "Frequency, Hz", "Damping ratio", "Real part, 1/s", "Imaginary part, 1/s"), rows)


def _mode(mode: Mode) -> tuple[Cell, ...]:
    swings = mode.imaginary_per_s > 0
    return (
        words("oscillates" if swings else "decays" if mode.real_per_s < 0 else "grows", bad=mode.real_per_s >= 0),
        number(number_text(HERTZ.from_si(mode.frequency_rad_per_s, UnitSystem.SI), 3)),
        number(number_text(mode.damping_ratio, 3) if swings else NONE),
        number(number_text(mode.real_per_s, 3)),
        number(f"±{number_text(mode.imaginary_per_s, 3)}" if swings else NONE),
    )


def grid(scored: LawScores, system: UnitSystem) -> Table:
    """The settings."""
    rows = []
    for name, axis in AXES.items():
        values = getattr(scored.plan.settings, name)
        texts = ", ".join(number_text(axis.unit.from_si(value, system), 3) for value in values)
        rows.append((words(prose_html(capital(axis.title))), words(texts), Cell(axis.unit.shown(system))))
    return Table((Cell("Axis"), Cell("Values"), Cell("Unit")), tuple(rows))
