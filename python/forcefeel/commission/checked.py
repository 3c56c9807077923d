"""The third step: the law in the envelope of the identified loader, nominal, in every case and with all tolerances at once."""

from collections.abc import Iterator

import numpy as np

from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import Checked, WhatIf
from forcefeel.commission.seen import BREAKAWAY, DRY
from forcefeel.envelope.deviations import deviations_of
from forcefeel.envelope.draws import Draws
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.result import Envelope
from forcefeel.envelope.run import Progress, compute
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import OFF
from forcefeel.loader.sensors import SENSORS

_GAIN = 0.01
"""Share from which on a change is worth a word."""

_SEED = 1974

_EXACT = 1e-4
"""Deviation, as a share of the value, up to which a parameter is as the file has it."""


def check_law(
    loader: Loader, name: str, law: Law, plan: CommissionPlan, progress: Progress = lambda done, total: None
) -> tuple[Checked, Envelope]:
    """What a law renders.

    Args:
        loader: The identified loader.
        name: The law's name.
        law: The law, with the settings of the grid.
        plan: What is asked.
        progress: Called with the releases that are done and all there are.
    """
    draws = Draws(plan.draws, seed=_SEED)
    known = {key: one for key, one in deviations_of(loader).items() if one.size > _EXACT}
    asked = make_plan(loader, {name: law}, plan.grid, rule=plan.rule, changes=known, draws=draws)
    found = compute(asked, threads=plan.threads, progress=progress)
    even = found.even_shares(name)
    drawn = (found.data["drawn_outcome"].values[0].reshape(plan.draws, -1) == 0) @ asked.settings.weights
    short = min(even.passes, float(drawn.mean())) < plan.share
    return (
        Checked(
            settings=asked.settings.count,
            passes=even.passes,
            every_case=even.passes_worst,
            machines=plan.draws,
            drawn=float(drawn.mean()),
            drawn_least=float(drawn.min()),
            findings=envelope_conclusions(found, plan.units).findings,
            what_ifs=_what_ifs(loader, name, plan, even.passes) if short else (),
        ),
        found,
    )


def _what_ifs(loader: Loader, name: str, plan: CommissionPlan, now: float) -> tuple[WhatIf, ...]:
    """What other machines would render with a law of the same design, those that render more."""
    found = []
    for change, other in _others(loader):
        try:
            asked = make_plan(other, [name], plan.grid, rule=plan.rule, changes={}, arms=())
            found.append(WhatIf(change, compute(asked, threads=plan.threads).even_shares(name).passes))
        except InputError:  # no law of this design for such a machine
            continue
    better = [one for one in found if one.passes >= now + _GAIN]
    return tuple(sorted(better, key=lambda one: -one.passes))


def _others(loader: Loader) -> Iterator[tuple[str, Loader]]:
    """Machines that differ in one thing that hardware can change."""
    bare = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    if bare[DRY]:
        for share, words in (
            (0.5, "half the dry friction"),
            (0.0, "no dry friction (bearings, or a force sensor at the grip)"),
        ):
            breakaway = bare[BREAKAWAY]
            rows = {DRY: share * bare[DRY], BREAKAWAY: share * breakaway if breakaway != OFF[BREAKAWAY] else None}
            yield words, bare.replace(rows if share else {DRY: None, BREAKAWAY: None})
    lags = {key: None for sensor in SENSORS if np.isfinite(bare[key := f"{sensor}.bandwidth"])}
    if lags:
        yield "sensors without lag", bare.replace(lags)
    noise = {
        key: bare[key] / 10 for sensor in SENSORS for part in ("noise", "resolution") if bare[key := f"{sensor}.{part}"]
    }
    if noise:
        yield "a tenth of the sensors' noise", bare.replace(noise)
    period = bare["controller.period"]
    if period:
        yield (
            "half the controller's period and delay",
            bare.replace({"controller.period": period / 2, "controller.delay": bare["controller.delay"] / 2}),
        )
    limits = {"amplifier.current_limit", "valve.flow_limit", "current_loop.current_limit", "current_loop.voltage_limit"}
    wider = {key: 2 * bare[key] for key in sorted(limits) if key in bare.given and np.isfinite(bare[key])}
    if wider:
        yield "twice the drive's limits", bare.replace(wider)
