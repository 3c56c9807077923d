"""Release test of a rule and contact, on the nominal plant, hands off, at knots and between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.cases import NOMINAL
from forcefeel.envelope.contact import quiet_in_few
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.machines import full_rows
from forcefeel.envelope.releases import Record
from forcefeel.envelope.settings import AXES
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import Loader
from forcefeel.qualification import Rules
from forcefeel.qualification.batch_verdicts import judge_releases
from forcefeel.qualification.release_batch import measure_releases
from forcefeel.qualification.throw import Throw
from forcefeel.simulation import RunStatus, Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Release
from forcefeel.simulation.scenario import LONGEST_STEP_S

PASSES, DIVERGES, NOT_JUDGED, NOT_QUIET = "passes", "diverges", "not judged", "not quiet in contact"
"""Outcomes other than the first failing figure. ``NOT_JUDGED``: the feel's damping is below the range of an envelope.
``NOT_QUIET``: the release passes, but the column is not quiet in one of ``envelope.contact.FEW_CONTACTS``."""

_BAND = np.log(2) / 2
"""Feels within half an octave have the same record."""


@dataclass(frozen=True)
class ReleaseTest:
    """Release test.

    Attributes:
        rules: The rule.
        angle_rad: Release angle: the rule's largest share of the throw's shorter side.
        travel_rad: The throw from end to end.
    """

    rules: Rules
    angle_rad: float
    travel_rad: float

    @classmethod
    def of(cls, rules: Rules, loader: Loader) -> "ReleaseTest":
        """Test for a loader with its stops."""
        throw = Throw.of(loader)
        return cls(rules, throw.release_rad(rules), throw.travel_rad)

    def outcomes(self, loader: Loader, feel: NDArray[np.float64], laws: SampledLaw, threads: int) -> list[str]:
        """Outcome for each feel (settings, 3) with its law: ``passes``, the first failing figure, or ``NOT_QUIET``."""
        frequency, damping = _core.feel_frequencies(feel)
        outcome = np.full(len(feel), NOT_JUDGED, dtype=object)
        judged = np.flatnonzero(damping >= AXES["damping"].low)
        bands = np.floor(np.log(frequency[judged]) / _BAND)
        for band in np.unique(bands):
            which = judged[bands == band]
            record = _record(frequency[which].min(), damping[which].min(), loader["controller.period"])
            for chunk in record.chunks(len(which)):
                some = which[chunk]
                outcome[some] = self._judged(loader, feel[some], laws.some(some), record, threads)
        if len(good := np.flatnonzero(outcome == PASSES)):
            law = Law.of(laws.some(good), loader)
            outcome[good[~quiet_in_few(loader, law, feel[good], threads=threads)]] = NOT_QUIET
        return outcome.tolist()

    def _judged(
        self, loader: Loader, feel: NDArray[np.float64], laws: SampledLaw, record: Record, threads: int
    ) -> list[str]:
        rows = full_rows(loader, NOMINAL, feel, Law.of(laws, loader))
        step = min(record.step_s, LONGEST_STEP_S)
        scenario = Scenario(Release(self.angle_rad), record.duration_s, step, record.step_s)
        runs = batch_outputs(loader, scenario, rows, laws, keep=["column_angle_rad"], first_run=None, threads=threads)
        ideal = ideal_releases(feel, self.angle_rad, record.step_s, record.samples)
        measured, reference = (
            measure_releases(record.time_s, angles, held=1, rules=self.rules.release, threads=threads)
            for angles in (runs["column_angle_rad"], ideal)
        )
        test = self.rules.of("release", "pitch")
        verdicts = judge_releases(measured, reference, test, travel=self.travel_rad)
        diverged = runs["status"] == RunStatus.DIVERGED
        return [
            DIVERGES if gone else PASSES if good else verdicts.names[first]
            for gone, good, first in zip(diverged, verdicts.passed, verdicts.first_failing, strict=True)
        ]


def _record(frequency: float, damping: float, period_s: float) -> Record:
    """Record of an envelope with samples at whole periods of the controller."""
    usual = Record.of(frequency, damping)
    step = max(1, round(usual.step_s / period_s)) * period_s
    return Record(step, int(np.ceil(usual.duration_s / step)) + 1)
