"""One law at the loader's own setting: poles, margins, noise, demand, and its release with the ideal."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.choice.demand import AnyDemand, largest_demand, unknown
from forcefeel.choice.noise import Noise, noise_at_grip
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import Record, measured, released
from forcefeel.envelope.result import PASSES, UNSTABLE
from forcefeel.laws.law import Law, LawLike
from forcefeel.linear.modes import Mode
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loops.command_loop import command_loops
from forcefeel.loops.margins import LoopMargins, loop_margins
from forcefeel.qualification.batch_verdicts import judge_releases


@dataclass(frozen=True, eq=False)
class Released:
    """Release of the column and of I, B and G alone.

    Attributes:
        time_s: Time, (samples,).
        angle_rad: Column angle; NaN for an unstable loop.
        ideal_rad: Angle of the ideal.
    """

    time_s: NDArray[np.float64] = field(repr=False)
    angle_rad: NDArray[np.float64] = field(repr=False)
    ideal_rad: NDArray[np.float64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class OwnSetting:
    """Results of a law at the loader's own setting, hands off.

    Attributes:
        law: The law.
        stable: Whether its loop is stable.
        outcome: ``passes``, ``unstable``, or the first failing figure of the rule's release test.
        margins: Margins of the loop, broken at the command.
        demand: Demand of the release on the drive; NaN if unstable.
        noise: Effect of the sensor noise on the grip; ``None`` for an analog loader.
        modes: Modes of the closed loop, slowest first.
        release: The release.
    """

    law: Law = field(repr=False)
    stable: bool
    outcome: str
    margins: LoopMargins
    demand: AnyDemand
    noise: Noise | None
    modes: tuple[Mode, ...]
    release: Released = field(repr=False)


def own_setting(plan: Plan, law: LawLike, threads: int) -> OwnSetting:
    """Compute a law at the own setting of the plan's loader, with the plan's rule and angle.

    Raises:
        InputError: If the law cannot be designed.
    """
    loader = plan.loader
    feel = own_feel(loader)
    laws = Law.of(law, loader, feel)
    loop = command_loops(loader, laws, feel)[0]
    stable, outcome, release = _released(plan, laws, feel, threads)
    stable = stable and loop.stable
    single = laws.single(loader, 0)
    return OwnSetting(
        law=single,
        stable=stable,
        outcome=outcome if stable else UNSTABLE,
        margins=loop_margins(loop),
        demand=largest_demand(loader, laws, feel, plan.release_rad) if stable else unknown(loader.drive),
        noise=noise_at_grip(loader, single),
        modes=loop.modes,
        release=release,
    )


def _released(plan: Plan, laws: Law, feel: NDArray[np.float64], threads: int) -> tuple[bool, str, Released]:
    """Stability, outcome of the release test and release, computed as in the envelope."""
    (frequency,), (damping,) = (values.tolist() for values in _core.feel_frequencies(feel))
    record = Record.of(frequency, damping)
    stable, angles = released(plan, plan.cases[:1], feel, laws, record, threads)
    ideal = ideal_releases(feel, plan.release_rad, record.step_s, record.samples)
    measures, reference = (measured(plan, record, history, threads) for history in (angles, ideal))
    verdict = judge_releases(measures, reference, plan.test, travel=plan.throw.travel_rad)
    failing = PASSES if verdict.passed[0] else verdict.names[int(verdict.first_failing[0])]
    return bool(stable[0]), failing, Released(record.time_s, angles[0], ideal[0])
