"""Conclusions from a simulation, in sentences."""

from math import isfinite, isnan, pi, sqrt
from types import MappingProxyType

import numpy as np

from forcefeel._core import feel_frequency
from forcefeel.conclusions import Conclusions, of_result
from forcefeel.loader.arms import UNVERIFIED, arm_of
from forcefeel.loader.beyond_linear import beyond_linear
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC, INDEX
from forcefeel.simulation import Run, RunStatus
from forcefeel.simulation.demanded import demanded
from forcefeel.simulation.hangs import Hang, hang
from forcefeel.simulation.inputs import (
    Chirp,
    Doublet,
    Force,
    HandsOff,
    Multisine,
    Pulse,
    Recorded,
    Release,
    Step,
    StopToStop,
)
from forcefeel.simulation.limits_met import (
    LimitTimes,
    below_noise,
    goes_to_a_place,
    keeps_moving,
    limit_times,
    why_no_overshoot,
)
from forcefeel.simulation.outcome import feel_position
from forcefeel.simulation.programmed_feel import has_arm, programmed, spring_is_g
from forcefeel.units import ANGLE, CURRENT, FORCE, MOTOR_CURRENT, Unit, UnitSystem, to_text

_LITTLE = 1e-3
"""Share of the time that is not worth a word."""

_WARMER = 1.0
"""Degrees that are not worth a word."""


_CURRENT_LIMIT = MappingProxyType(
    {
        HYDRAULIC: ("amplifier.current_limit", CURRENT),
        ELECTRIC: ("current_loop.current_limit", MOTOR_CURRENT),
    }
)
"""By drive: row of the largest current, and what it is shown in."""


@of_result
def run_conclusions(run: Run, units: UnitSystem) -> Conclusions:
    """The conclusions of a run, with numbers in ``units``.

    Example:
        >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0)))
        >>> ff.simulation.run_conclusions(run, ff.UnitSystem.SI).verdict
        'Settled at 1.24 s, overshoot 45.3 %, 1.68 Hz.'
    """
    limits = limit_times(run)
    sentences = (
        run.softened.sentence(units) if run.softened else "",
        _at_rest(run, units),
        _period(run),
        _demand(run, units),
        _heat(run),
        _saturation(run, limits, units),
        _stops(run, limits),
        _friction(run, limits),
        _arm(run),
        _design(run),
        run.law_remark,
    )
    return Conclusions(
        run.status is not RunStatus.DIVERGED, _verdict(run, units), tuple(text for text in sentences if text)
    )


def input_text(force: Force, units: UnitSystem) -> str:
    """What the pilot does: ``a step of 96 lb at 0.1 s``."""
    if isinstance(force, HandsOff):
        return "hands off"
    if isinstance(force, Release):
        when = f" at {force.start_s:g} s" if force.start_s else ""
        return f"a release from {_quantity(force.angle_rad, ANGLE, units)}{when}"
    if isinstance(force, Recorded):
        low, high = (_force(float(bound), units) for bound in (force.force_n.min(), force.force_n.max()))
        return f"the recording {force.name}, {low} to {high}"
    return _formula_text(force, _force(force.force_n, units))


def _formula_text(force: Step | Pulse | Doublet | StopToStop | Chirp | Multisine, peak: str) -> str:
    match force:
        case Step():
            return f"a step of {peak} at {force.start_s:g} s"
        case Pulse():
            return f"a pulse of {peak} from {force.start_s:g} s on, {force.width_s:g} s long"
        case Doublet():
            return f"a doublet of ±{peak} from {force.start_s:g} s on, {force.width_s:g} s each way"
        case StopToStop():
            return f"a stop-to-stop sweep to {peak} either way and back, {force.duration_s:g} s long"
        case Chirp():
            band = f"from {force.from_hz:g} to {force.to_hz:g} Hz"
            return f"a {force.spacing} chirp of ±{peak} {band}, {force.duration_s:g} s long"
        case Multisine():
            lines = f"{len(force.lines_hz)} lines from {force.lines_hz[0]:g} to {force.lines_hz[-1]:g} Hz"
            return f"a multisine of ±{peak}, {lines}, period {force.duration_s:g} s"


def _verdict(run: Run, units: UnitSystem) -> str:
    if run.status is RunStatus.DIVERGED:
        return f"{run.note[0].upper()}{run.note[1:]}."
    measures = run.measures
    if measures.maximum_angle_rad == measures.minimum_angle_rad:
        return "The column did not move."
    if below_noise(run):
        noise = _quantity(run.angle_noise_rad, ANGLE, units, 2)
        return f"The column moved only within the sensors' noise, {noise} r.m.s."
    if not goes_to_a_place(run.scenario.force):
        return _range(run, units)
    why = why_no_overshoot(run)
    overshoot = f"no overshoot to measure: {why}" if why else f"overshoot {_percent(measures.overshoot)}"
    swing = ", ".join(filter(None, (_frequency(run), overshoot) if why else (overshoot, _frequency(run))))
    if hanging := hang(run):
        return f"The column {_hangs(run, hanging, units)}; {swing}."
    if run.status is RunStatus.SETTLED:
        return f"Settled at {to_text(measures.settling_time_s, 3)} s, {swing}."
    by = _quantity(measures.last_swing_rad, ANGLE, units, 2)
    return f"Still moving after {to_text(run.scenario.duration_s)} s, by {by} over the last tenth; {swing}."


def _range(run: Run, units: UnitSystem) -> str:
    """Of a run whose force leads to no place of its own."""
    measures = run.measures
    low, high = (
        to_text(ANGLE.from_si(angle, units), 3) for angle in (measures.minimum_angle_rad, measures.maximum_angle_rad)
    )
    motion = f"The column moved between {low} and {high} {ANGLE.shown(units)}"
    if keeps_moving(run.scenario.force):
        return f"{motion}."
    if hanging := hang(run):
        return f"{motion} and {_hangs(run, hanging, units)}."
    settled = run.status is RunStatus.SETTLED
    end = (
        f"settled at {to_text(measures.settling_time_s, 3)} s"
        if settled
        else f"was still moving after {to_text(run.scenario.duration_s)} s"
    )
    return f"{motion} and {end}."


def _hangs(run: Run, hanging: Hang, units: UnitSystem) -> str:
    at, feel = (_quantity(angle, ANGLE, units, 3) for angle in (hanging.angle_rad, hanging.feel_rad))
    where = f"hangs at {at}{hanging.held_by and f' {hanging.held_by}'} while its feel is at {feel}"
    return f"{where}, with the current at its limit of {_current_limit(run, units)}" if hanging.current else where


def _at_rest(run: Run, units: UnitSystem) -> str:
    """Where a settled column rests, beside where the programmed feel alone would."""
    force, loader = run.scenario.force, run.loader
    if run.status is not RunStatus.SETTLED or not isinstance(force, Step):
        return ""
    rests = f"It rests at {_quantity(run.measures.final_angle_rad, ANGLE, units, 3)}"
    stiffness = float(programmed(loader)[INDEX["feel.stiffness"]])
    angle = loader["column.grip_arm"] * force.force_n / stiffness
    if angle == 0 or not spring_is_g(run):
        return f"{rests}."
    share = _percent(run.measures.final_angle_rad / angle)
    spring = "the springs of G and the arm" if has_arm(loader) else "the spring G alone"
    return (
        f"{rests}, {share} of {_quantity(angle, ANGLE, units, 3)}, where {spring} balance{'' if has_arm(loader) else 's'} "
        "this force."
    )


def _period(run: Run) -> str:
    """How it swings, beside how the programmed feel alone would: ``w sqrt(1 - zeta^2)``, and ``w`` itself by its name."""
    if run.status is RunStatus.DIVERGED or not (frequency := _frequency(run)):
        return ""
    periods = int(run.measures.periods)
    swings = f"It oscillates at {frequency} ({'one period' if periods == 1 else f'mean of {periods} periods'})"
    if not spring_is_g(run):
        return f"{swings}."
    alone = "I, B and G with the arm" if has_arm(run.loader) else "I, B and G alone"
    natural, damping = feel_frequency(programmed(run.loader))
    if damping >= 1:
        return f"{swings}; {alone} do not oscillate."
    damped, undamped = (to_text(rad_per_s / (2 * pi), 3) for rad_per_s in (natural * sqrt(1 - damping**2), natural))
    return f"{swings}; {alone} give {damped} Hz damped, {undamped} Hz undamped."


def _frequency(run: Run) -> str:
    """From the mean period; empty where the column did not swing."""
    measures = run.measures
    if not goes_to_a_place(run.scenario.force) or isnan(measures.period_s):
        return ""
    return f"{to_text(1 / measures.period_s, 3)} Hz"


def _demand(run: Run, units: UnitSystem) -> str:
    if run.status is RunStatus.DIVERGED:
        return ""
    loader, measures = run.loader, run.measures
    if measures.maximum_angle_rad == measures.minimum_angle_rad:
        return ""
    used = [
        f"{_percent(getattr(measures, row.peak) / loader[row.whole])} of {row.whole_name}"
        for row in demanded(loader)
        if row.peak
    ]
    return f"Peak demand: {', '.join(used[:-1])} and {used[-1]}." if len(used) > 1 else ""


def _heat(run: Run) -> str:
    """How warm the motor becomes, where that is known."""
    if run.loader.drive != ELECTRIC or not isfinite(run.loader["thermal.winding_capacity"]):
        return ""
    temperature = run.outputs["winding_temperature_degc"]
    warm = temperature[np.isfinite(temperature)]
    if not len(warm) or warm.max() - warm.min() < _WARMER:
        return ""
    limit = run.loader["thermal.winding_limit"]
    return f"The winding warms from {warm[0]:.0f} to {warm.max():.0f} degC; at {limit:.0f} degC the motor shuts off."


def _saturation(run: Run, limits: LimitTimes, units: UnitSystem) -> str:
    sentences = []
    of_motor = run.loader.drive == ELECTRIC
    limit = run.loader[_CURRENT_LIMIT[run.loader.drive][0]]
    if isfinite(limit):
        at = f"the amplifier's limit of {_current_limit(run, units)}"
        spent = f"was at {at} for {_percent(limits.current)} of the time" if limits.current else f"never reached {at}"
        sentences.append(f"The current {spent}.")
        if limits.voltage:
            sentences.append(f"The voltage was at its limit for {_percent(limits.voltage)} of the time.")
        if of_motor and limits.current > _LITTLE:
            sentences.append("To check holding force, run forcefeel size.")
    beyond = (
        (limits.over_current, "the current was above its rating"),
        (limits.over_flow, "the flow was above its rating"),
        (limits.over_pressure, "the load pressure was above the supply's"),
    )
    if over := [f"{what} for {_percent(share)} of the time" for share, what in beyond if share > _LITTLE]:
        unlimited = "" if isfinite(limit) else " The loader file sets no amplifier.current_limit."
        text = ", ".join(over)
        sentences.append(f"{text[0].upper()}{text[1:]}.{unlimited}")
    return " ".join(sentences)


def _current_limit(run: Run, units: UnitSystem) -> str:
    row, measured_in = _CURRENT_LIMIT[run.loader.drive]
    return _quantity(run.loader[row], measured_in, units, 3)


def _stops(run: Run, limits: LimitTimes) -> str:
    loader = run.loader
    sides = (
        (loader["column.stop_low"], limits.stop_low_s, "the lower end stop"),
        (loader["column.stop_high"], limits.stop_high_s, "the upper end stop"),
        (loader["feel.hard_stop_low"], limits.feel_low_s, "the programmed lower stop"),
        (loader["feel.hard_stop_high"], limits.feel_high_s, "the programmed upper stop"),
    )
    stops = [(spent, name) for bound, spent, name in sides if isfinite(bound)]
    hit = [f"at {name} for {to_text(spent, 3)} s" for spent, name in stops if spent]
    if hit:
        return f"It was {' and '.join(hit)}."
    if not stops:
        return ""
    return "It reached no stop" + (": the force is too small." if isinstance(run.scenario.force, StopToStop) else ".")


def _friction(run: Run, limits: LimitTimes) -> str:
    if not (run.loader["column.coulomb_friction"] or run.loader["column.static_friction"]):
        return ""
    if not limits.stuck_s:
        return "Dry friction never held the column once it moved."
    end = ", in the end too" if limits.stuck_at_end else ""
    return f"Dry friction held the column for {to_text(limits.stuck_s, 3)} s in all{end}."


def _arm(run: Run) -> str:
    arm = arm_of(run.loader)
    return f"The pilot's arm is the {arm} one, whose numbers are unverified." if arm in UNVERIFIED else ""


def _design(run: Run) -> str:
    """Of a law that feeds back states: what its design cannot have known."""
    rows = beyond_linear(run.loader)
    if not rows or not feel_position(run).endswith("_rad"):
        return ""
    return f"The gains are designed on the linear models, which neglect {rows}; this simulation includes them."


def _force(value: float, units: UnitSystem) -> str:
    return _quantity(value, FORCE, units)


def _quantity(value: float, measured_in: Unit, units: UnitSystem, digits: int = 4) -> str:
    return f"{to_text(measured_in.from_si(value, units), digits)} {measured_in.shown(units)}"


def _percent(share: float) -> str:
    return f"{to_text(100 * share, 3)} %"
