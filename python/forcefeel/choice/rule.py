"""Rule for the choice of a law.

A law is eligible if, with the nominal plant and hands off,

1. it is stable at the loader's own setting and at every setting of the grid;
2. at the loader's own setting its loop bears twice and half the gain (``LEAST_GAIN``, 6 dB), ``LEAST_PHASE_RAD`` of lag or lead,
   and one more period of delay (a digital loader);
3. it is quiet in contact, clamped and against a stop, at ``LEAST_QUIET`` of the settings (a digital loader);
4. it renders a setting.

The rule takes the eligible law with the largest share of settings within tolerance in every case. Among laws less than ``CLOSE``
behind it, it takes the one with the largest nominal share; among equally close ones, the one with the least noise at the grip. With
a required nominal share, laws that reach it come first; if no law reaches it, those within ``CLOSE`` of the largest.

Margins at other settings are reported, not required: the worst case, with the valve's gain off by its tolerance, contains their
cost.
"""

from dataclasses import dataclass
from math import ceil, degrees, inf, radians

from forcefeel.choice.score import LawScores, Score
from forcefeel.conclusions import capital, share_text
from forcefeel.units import to_text

LEAST_GAIN = 2.0
"""Required gain margin either way, 6 dB: usual in servo practice."""

LEAST_PHASE_RAD = radians(30.0)
"""Required phase margin, usual in servo practice."""

LEAST_PERIODS = 1.0
"""Required delay margin in sample periods: with a hand at the grip, one late sample must not destabilize the loop."""


LEAST_QUIET = 0.9
"""Required share of the settings that do not swing on in contact. Of few settings the others are rounded up: two of 18."""


@dataclass(frozen=True)
class Reserve:
    """Required margins of a loop.

    Attributes:
        gain: Gain factor, either way.
        phase_rad: Phase, lag or lead.
    """

    gain: float
    phase_rad: float


USUAL = Reserve(LEAST_GAIN, LEAST_PHASE_RAD)

MEASURED = Reserve(1.5, radians(25.0))
"""Margins for a loader measured to 1 %. The usual 6 dB include a factor of 1.3 for a valve gain known to 30 %. The usual 30 deg
include some 5 deg for the valve's lag ``2 zeta w / w_n``, 25 to 30 deg at 15 Hz, known to 20 %."""

CLOSE = 0.01
"""Shares that differ by less count as equal: about one setting of a coarse grid."""


@dataclass(frozen=True)
class Remark:
    """Why a law is chosen or not.

    Attributes:
        name: The law.
        eligible: Whether it may be chosen.
        sentence: Why it is chosen, or why not.
    """

    name: str
    eligible: bool
    sentence: str


@dataclass(frozen=True)
class Choice:
    """The chosen law, with reasons.

    Attributes:
        chosen: Its name; ``None`` if no law is eligible.
        remarks: One for each law, the chosen law first.
    """

    chosen: str | None
    remarks: tuple[Remark, ...]


def choose(scored: LawScores, least: float = 0.0, reserve: Reserve = USUAL) -> Choice:
    """Choose among laws with scores over the envelope, by the rule of this module.

    Args:
        scored: The laws with their scores.
        least: Required nominal share; default: 0.
        reserve: Required margins of the loop at the loader's own setting.

    Example:
        >>> grid = {"stiffness": "20, 100 %", "frequency": "2, 3 Hz", "damping": "0.3, 1"}
        >>> scored = ff.choice.score_laws(ff.digital_elevator(), ("observer", "robust"), grid, changes={}, arms=())
        >>> ff.choice.choose(scored).chosen in ("observer", "robust")
        True
    """
    wrong = {score.name: obstacles(score, scored.plan.loader["controller.period"], reserve) for score in scored.scores}
    able = [score for score in scored.scores if not wrong[score.name]]
    best = _best(_reaching(able, least))
    remarks = [
        Remark(score.name, False, f"{capital(score.name)} is not eligible: {'; '.join(wrong[score.name])}.")
        for score in scored.scores
        if wrong[score.name]
    ]
    if best is None:
        return Choice(None, tuple(remarks))
    behind = [Remark(score.name, True, _behind(score, best, least)) for score in able if score is not best]
    return Choice(best.name, (Remark(best.name, True, _why(best, len(able))), *behind, *remarks))


def obstacles(score: Score, period_s: float, reserve: Reserve = USUAL) -> list[str]:
    """Reasons why a law is not eligible; empty for an eligible law."""
    own, margins = score.own, score.own.margins
    if not own.stable:
        return ["it is unstable at the loader's own setting"]
    sentences = []
    if score.over is not None and score.over.shares.stable < 1:
        sentences.append(
            f"it is stable at only {share_text(score.over.shares.stable)} of the settings with the nominal plant"
        )
    if score.over is not None and score.over.quiet is not None and _swings(score.over.quiet, score.over.settings):
        sentences.append(
            f"only {share_text(score.over.quiet)} of the settings are quiet in contact, clamped or against a stop"
        )
    if score.over is not None and not score.over.shares.nominal_share:
        sentences.append("it renders none of the settings")
    if margins.gain_up < reserve.gain or margins.gain_down > 1 / reserve.gain:
        sentences.append(
            f"the stable range of the loop gain is only {to_text(margins.gain_down, 3)} to {to_text(margins.gain_up, 3)} times "
            "its value"
        )
    if margins.phase_rad < reserve.phase_rad:
        sentences.append(f"its phase margin is {to_text(degrees(margins.phase_rad), 3)} deg")
    if period_s and margins.delay_s < LEAST_PERIODS * period_s:
        sentences.append(
            f"its delay margin is {to_text(1e3 * margins.delay_s, 3)} ms, less than a period of {to_text(1e3 * period_s, 3)} ms"
        )
    return sentences


def _swings(quiet: float, settings: int) -> bool:
    """Whether more settings swing on in contact than may."""
    return round((1 - quiet) * settings) > ceil(round((1 - LEAST_QUIET) * settings, 9))


def _best(able: list[Score]) -> Score | None:
    """The best eligible law: by worst-case share, then nominal share, then noise."""
    for key in ("worst_case_share", "nominal_share"):
        most = max((_share(score, key) for score in able), default=0.0)
        able = [score for score in able if _share(score, key) > most - CLOSE]
    return min(able, key=_noise, default=None)


def _reaching(able: list[Score], least: float) -> list[Score]:
    """Laws that reach the required nominal share; if none does, those close to the largest."""
    most = max((_share(score, "nominal_share") for score in able), default=0.0)
    return [
        score
        for score in able
        if _share(score, "nominal_share") >= least or (most < least and _share(score, "nominal_share") > most - CLOSE)
    ]


def _why(best: Score, eligible: int) -> str:
    if best.over is None:
        return f"{capital(best.name)} is stable with the required margins."
    shares = best.over.shares
    what = (
        f"{capital(best.name)} renders {share_text(shares.worst_case_share)} of the settings in every case and "
        f"{share_text(shares.nominal_share)} with the nominal plant"
    )
    if eligible == 1:
        return f"{what}; no other law is eligible."
    return f"{what}: the best of the {eligible} eligible laws."


def _behind(score: Score, best: Score, least: float) -> str:
    """Sentence on the first figure of the rule in which an eligible law is worse."""
    name = capital(score.name)
    share, best_share = _share(score, "nominal_share"), _share(best, "nominal_share")
    if share < min(least, best_share):
        return (
            f"{name} is eligible and renders {share_text(share)} with the nominal plant, less than the required "
            f"{share_text(least)} and "
            f"the {share_text(best_share)} of {best.name}."
        )
    for key, where in (("worst_case_share", "in every case"), ("nominal_share", "with the nominal plant")):
        share, best_share = _share(score, key), _share(best, key)
        if best_share - share >= CLOSE:
            return (
                f"{name} is eligible and renders {share_text(share)} {where}, {best.name} {share_text(best_share)}"
                f"{_better(score, best)}."
            )
    if _noise(best) < _noise(score) < inf:
        return f"{name} is eligible and renders about as much as {best.name}, with more noise at the grip."
    return f"{name} is eligible and renders about as much as {best.name}, which is listed before it."


def _better(score: Score, best: Score) -> str:
    """Clause on figures in which a law is better than the chosen law."""
    given_up = []
    if _share(score, "nominal_share") - _share(best, "nominal_share") >= CLOSE:
        given_up.append(f"more with the nominal plant ({share_text(_share(score, 'nominal_share'))})")
    if _noise(score) < 0.5 * _noise(best):
        given_up.append("less than half the noise at the grip")
    return f"; it has {' and '.join(given_up)}" if given_up else ""


def _share(score: Score, key: str) -> float:
    return float(getattr(score.over.shares, key)) if score.over else 0.0


def _noise(score: Score) -> float:
    return score.own.noise.angle_rad if score.own.noise else inf
