"""Second-order releases of trial I', B', G, judged by the envelope's rule with I, B, G as reference."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import PilotArm
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import Record, carrying, measured, pieces
from forcefeel.qualification.batch_verdicts import judge_releases
from forcefeel.qualification.release_batch import ReleaseBatch


@dataclass(frozen=True, eq=False)
class SettingGroup:
    """Judge of trial responses at settings of one natural frequency.

    Attributes:
        plan: The envelope with rule, angle and throw.
        which: Indices of the settings in the plan.
        feel: Their I, B, G, (settings, 3).
        record: Duration and sampling of releases.
        threads: Number of threads.
    """

    plan: Plan
    which: NDArray[np.intp]
    feel: NDArray[np.float64]
    record: Record
    threads: int
    _ideal: dict[PilotArm | None, ReleaseBatch] = field(default_factory=dict, repr=False)

    def some(self, rows: NDArray[np.intp]) -> "SettingGroup":
        """SettingGroup for a subset of the settings."""
        return replace(self, which=self.which[rows], feel=self.feel[rows], _ideal={})

    def passes(self, trial: NDArray[np.float64], arm: PilotArm | None = None) -> NDArray[np.bool_]:
        """Whether the release of each row I', B', G passes as that of the setting; without inertia it fails.

        Args:
            trial: The trial responses, a row for each setting, without the arm.
            arm: Arm at the grip of both.
        """
        carried = self.carrying(trial, arm)
        heavy = carried[:, 0] > 0
        passing = np.zeros(len(trial), dtype=bool)
        if heavy.any():
            # A row without inertia cannot be released: the setting's own feel replaces it and is not counted.
            feel = np.where(heavy[:, None], carried, self.carrying(self.feel, arm))
            passing = self.judged(self._released(feel), arm) & heavy
        return passing

    def judged(self, angles: NDArray[np.float64], arm: PilotArm | None = None) -> NDArray[np.bool_]:
        """Whether the column angles of each setting pass as its release."""
        if arm not in self._ideal:
            self._ideal[arm] = self._measured(self._released(self.carrying(self.feel, arm)))
        measures = self._measured(angles)
        return judge_releases(measures, self._ideal[arm], self.plan.test, travel=self.plan.throw.travel_rad).passed

    def carrying(self, feel: NDArray[np.float64], arm: PilotArm | None) -> NDArray[np.float64]:
        """I, B, G (settings, 3) with an arm."""
        return carrying(self.plan.loader, feel, arm)

    def _released(self, feel: NDArray[np.float64]) -> NDArray[np.float64]:
        return ideal_releases(feel, self.plan.release_rad, self.record.step_s, self.record.samples)

    def _measured(self, angles: NDArray[np.float64]) -> ReleaseBatch:
        return measured(self.plan, self.record, angles, self.threads)


def setting_groups(plan: Plan, threads: int) -> Iterator[SettingGroup]:
    """A group for each chunk of settings with the same frequency."""
    feel = plan.settings.feel(plan.loader)
    for which, record in pieces(plan):
        yield SettingGroup(plan, which, feel[which], record, threads)
