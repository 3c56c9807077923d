"""The third step: the law in the envelope of the identified loader, nominal, in every case and with joint tolerances."""

from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import EnvelopeResult, OutcomeMap
from forcefeel.commission.what_ifs import what_ifs
from forcefeel.envelope.deviations import deviations_of
from forcefeel.envelope.draws import Draws
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.result import Envelope
from forcefeel.envelope.run import Progress, compute
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader

_SEED = 1974

_EXACT = 1e-4
"""Largest deviation of an exactly known parameter, as a share of its value."""


def check_law(
    loader: Loader, name: str, law: Law, plan: CommissionPlan, progress: Progress = lambda done, total: None
) -> tuple[EnvelopeResult, Envelope]:
    """Compute the share of the plan's settings that the law ``name`` renders, designed for the settings of the grid."""
    draws = Draws(plan.draws, seed=_SEED)
    toleranced = {key: deviation for key, deviation in deviations_of(loader).items() if deviation.size > _EXACT}
    envelope_plan = make_plan(loader, {name: law}, plan.grid, rule=plan.rule, changes=toleranced, draws=draws)
    envelope = compute(envelope_plan, threads=plan.threads, progress=progress)
    even = envelope.even_shares(name)
    drawn = (envelope.arrays["drawn_outcome"][0].reshape(plan.draws, -1) == 0) @ envelope_plan.settings.weights
    short = min(even.nominal_share, float(drawn.mean())) < plan.share
    return (
        EnvelopeResult(
            settings=envelope_plan.settings.count,
            passes=even.nominal_share,
            every_case=even.worst_case_share,
            machines=plan.draws,
            drawn=float(drawn.mean()),
            drawn_least=float(drawn.min()),
            findings=envelope_conclusions(envelope, plan.units).findings,
            what_ifs=what_ifs(loader, name, plan, even.nominal_share) if short else (),
            outcomes=_outcomes(envelope, name),
        ),
        envelope,
    )


def _outcomes(envelope: Envelope, law: str) -> OutcomeMap:
    """The map of a law."""
    settings = envelope.plan.settings
    kinds = tuple(tuple(map(tuple, rows)) for rows in envelope.kinds(law, worst=False).tolist())
    return OutcomeMap(tuple(settings.stiffness), tuple(settings.frequency), tuple(settings.damping), kinds)
