"""Conclusions from a sweep, in sentences."""

from math import isfinite

import numpy as np

from forcefeel.conclusions import Conclusions, capital, interval_text, of_result, share_text
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.simulation import RunStatus
from forcefeel.simulation.demanded import demanded, peaks
from forcefeel.simulation.limits_met import goes_to_a_place, keeps_moving
from forcefeel.sweep.result import IMPOSSIBLE, SweepResult
from forcefeel.sweep.summary import Spread, Summary, measure_name
from forcefeel.units import Unit, UnitSystem, to_text

_DEMAND = 2
"""Measures of the motion in the findings."""

_LISTED = 3
"""Number of named parameters in a sentence."""

_WEAK = 0.1
"""Rank correlation that is not mentioned: the parameter accounts for a hundredth of the spread."""

_WHY_NONE = {
    "overshoot": "the column ends where it began, meets a stop, or the run ends before the overshoot is known",
    "period_s": "the column does not swing for a whole period, or meets a stop",
    "settling_time_s": "the column still moves at the end",
}
"""Reasons why a run that did not diverge has no measure."""

_NOTHING = 1e-9
"""Largest measure in SI units that counts as zero."""

_FEW = 1e-6
"""Spread, as a share of the value, that counts as zero."""


def main_measures(result: SweepResult, summary: Summary) -> tuple[str, ...]:
    """The relevant measures under the sweep's input that differ between its runs, the most important first."""
    force = result.sweep.scenario.force
    if goes_to_a_place(force):
        motion: tuple[str, ...] = ("overshoot", "final_angle_rad", "settling_time_s", "period_s")
    elif keeps_moving(force):
        motion = ("maximum_angle_rad", "minimum_angle_rad")
    else:
        motion = ("maximum_angle_rad", "minimum_angle_rad", "final_angle_rad", "settling_time_s", "last_swing_rad")
    most = (row.peak for row in peaks(result.sweep.loader.drive))
    return tuple(name for name in (*motion, *most) if _differs(summary.spreads[name]))


def _differs(spread: Spread) -> bool:
    width = spread.highest - spread.lowest
    return spread.runs > 1 and width > _FEW * max(abs(spread.lowest), abs(spread.highest))


@of_result
def sweep_conclusions(result: SweepResult, summary: Summary, units: UnitSystem) -> Conclusions:
    """The conclusions of a sweep, with numbers in ``units``."""
    measures = main_measures(result, summary)
    words = _Words(result, summary, units)
    sentences = [
        words.ended(),
        *(words.spread(name) for name in measures[: _DEMAND + 1] if not result.sweep.axes),
        *(words.extremes(name) for name in measures[:_DEMAND] if result.sweep.axes),
        words.demand(),
        words.impossible(),
        result.sweep.nominal_law.made_for_another(result.sweep.loader),
    ]
    ok = bool(result.sweep.axes) or summary.share(RunStatus.DIVERGED).runs == 0
    return Conclusions(ok, words.verdict(measures), tuple(filter(None, sentences)))


def value_with_unit(measured_in: Unit, value: float, units: UnitSystem) -> str:
    """A measure's SI value with its display unit."""
    return f"{number_of(measured_in, value, units)} {measured_in.shown(units)}".rstrip()


def number_of(measured_in: Unit, value: float, units: UnitSystem) -> str:
    """A measure's SI value in its display unit, a dash without a value; rounding errors are zero."""
    if not isfinite(value):
        return "–"
    number = measured_in.from_si(value, units) if abs(value) > _NOTHING else 0.0
    return to_text(number, 3).replace("-", "\N{MINUS SIGN}")


def correlation_text(rho: float) -> str:
    """A correlation with its sign."""
    return f"{rho:+.2f}".replace("-", "\N{MINUS SIGN}")


class _Words:
    """Sentences about a sweep."""

    def __init__(self, result: SweepResult, summary: Summary, units: UnitSystem) -> None:
        self._result, self._summary, self._units = result, summary, units
        self._grid = bool(result.sweep.axes)
        self._noun = "loaders" if not self._grid else "settings" if result.sweep.machines == 1 else "runs"

    def verdict(self, measures: tuple[str, ...]) -> str:
        parts = [self._settling()]
        if measures:
            spread = self._summary.spreads[measures[0]]
            low, high = (
                (spread.lowest, spread.highest) if self._grid else (spread.quantile(0.05), spread.quantile(0.95))
            )
            share = "" if self._grid else " (5th to 95th percentile)"
            ends = self._ends(measures[0], low, high)
            parts.append(f"{measure_name(measures[0])} {self._range(measures[0], low, high)}{share}")
            ranking = self._summary.ranking(measures[0])
            # What reads as one number has no cause to name.
            if ranking and not self._grid and ends[0] != ends[1]:
                parts.append(f"{ranking[0][0]} has the largest effect on it")
        return f"{'; '.join(parts)}."

    def _settling(self) -> str:
        total = self._result.sweep.total
        settled, diverged = (self._summary.share(str(status)) for status in (RunStatus.SETTLED, RunStatus.DIVERGED))
        machines = f"{total:,} {self._noun}"
        if keeps_moving(self._result.sweep.scenario.force):
            simulated = total - diverged.runs - self._summary.share(IMPOSSIBLE).runs
            sentence = (
                f"All {machines} stay" if simulated == total else f"{share_text(simulated / total)} of {machines} stay"
            )
            sentence = f"{sentence} within bounds"
        else:
            sentence = (
                f"All {machines} settle"
                if settled.runs == total
                else f"{share_text(settled.share)} of {machines} settle"
            )
        return f"{sentence}, {share_text(diverged.share)} diverge" if diverged.runs else sentence

    def ended(self) -> str:
        """Shares of moving and diverged runs, with confidence."""
        total, time = self._result.sweep.total, to_text(self._result.sweep.scenario.duration_s)
        sentences = []
        moving, diverged = (self._summary.share(str(status)) for status in (RunStatus.MOVING, RunStatus.DIVERGED))
        if moving.runs and not keeps_moving(self._result.sweep.scenario.force):
            sentences.append(
                f"{share_text(moving.share)} still move after {time} s{self._sure(moving.low, moving.high)}."
            )
        if diverged.runs:
            sentences.append(f"{share_text(diverged.share)} diverge{self._sure(diverged.low, diverged.high)}.")
        elif isfinite(diverged.high):
            limit = to_text(100 * diverged.high, 2)
            sentences.append(
                f"None of {total:,} diverges: below {limit} % of all loaders within these tolerances (95 % confidence)."
            )
        return " ".join(sentences)

    def _sure(self, low: float, high: float) -> str:
        if not isfinite(low):
            return ""
        return f" ({interval_text(low, high)} of all loaders within these tolerances, 95 % confidence)"

    def spread(self, name: str) -> str:
        """How a measure is spread, and what makes it differ."""
        spread = self._summary.spreads[name]
        nominal = value_with_unit(spread.unit, spread.nominal, self._units) if isfinite(spread.nominal) else "none"
        middle = self._range(name, spread.quantile(0.05), spread.quantile(0.95))
        whole = self._range(name, spread.lowest, spread.highest)
        ranking = [influence for influence in self._summary.ranking(name) if abs(influence[1]) >= _WEAK][:_LISTED]
        of = ", ".join(f"{key} ({correlation_text(rho)})" for key, rho in ranking)
        goes = f" It is correlated with {of.replace('(', '(rank correlation ', 1)}." if of else ""
        spans = f"nominal {nominal}; {middle} for 90 % of the runs, {whole} for all"
        return f"{capital(measure_name(name))}: {spans}.{self._none(name)}{goes}"

    def _none(self, name: str) -> str:
        """Number of runs that did not diverge without this measure, and the reason."""
        ended = sum(self._summary.share(str(status)).runs for status in (RunStatus.SETTLED, RunStatus.MOVING))
        none = ended - self._summary.spreads[name].runs
        return f" {none:,} have none: {_WHY_NONE[name]}." if none and name in _WHY_NONE else ""

    def extremes(self, name: str) -> str:
        """Settings with the smallest and the largest measure."""
        over = self._result.map(name)
        if not np.isfinite(over.values).any():
            return ""
        places, measured_in = [], self._summary.spreads[name].unit
        for extreme, find in (("smallest", np.nanargmin), ("largest", np.nanargmax)):
            spot = np.unravel_index(int(find(over.values)), over.shape)
            setting = " and ".join(
                f"{key} = {_setting(key, float(over[key].values[k]), self._units)}"
                for key, k in zip(self._result.sweep.axes, spot, strict=True)
            )
            places.append(
                f"{extreme} with {value_with_unit(measured_in, float(over.values[spot]), self._units)} at {setting}"
            )
        statistic = "" if self._result.sweep.machines == 1 else ", median of the machines at a setting"
        return f"{capital(measure_name(name))}{statistic}: {', '.join(places)}."

    def demand(self) -> str:
        """Largest use of the drive."""
        loader = self._result.sweep.loader
        parts = [
            f"{to_text(100 * spread.highest / loader[row.whole], 3)} % of {row.whole_name}"
            for row in demanded(loader)
            if row.peak and (spread := self._summary.spreads[row.peak]).runs
        ]
        used = f"{', '.join(parts[:-1])} and {parts[-1]} are" if len(parts) > 1 else f"{''.join(parts)} is"
        return f"At most {used} used, by nominal ratings." if parts else ""

    def impossible(self) -> str:
        """Impossible machines."""
        if not self._summary.share(IMPOSSIBLE).runs:
            return ""
        reasons = ", ".join(f"in {count:,} {sentence}" for sentence, count in self._result.reasons.items())
        count = self._summary.share(IMPOSSIBLE).runs
        return f"{count:,} {self._noun} are impossible and were not run: {reasons}. To avoid this, use bounds that do not overlap."

    def _ends(self, name: str, low: float, high: float) -> tuple[str, str]:
        measured_in = self._summary.spreads[name].unit
        return number_of(measured_in, low, self._units), number_of(measured_in, high, self._units)

    def _range(self, name: str, low: float, high: float) -> str:
        low_text, high_text = self._ends(name, low, high)
        text = low_text if low_text == high_text else f"{low_text} to {high_text}"
        return f"{text} {self._summary.spreads[name].unit.shown(self._units)}".rstrip()


def _setting(key: str, value: float, units: UnitSystem) -> str:
    return f"{to_text(unit(TABLE[key]).from_si(value, units))} {unit(TABLE[key]).shown(units)}".rstrip()
