"""Conclusions from a run of two linked loaders, in sentences."""

from math import inf

from forcefeel.conclusions import Conclusions, capital, of_result
from forcefeel.laws.sampled.sampled_law import SAMPLED_AT_GRIP
from forcefeel.linked.result import LinkedRun
from forcefeel.loader.links import AfterBreakout, LinkKind
from forcefeel.simulation.findings import input_text
from forcefeel.units import ANGLE, FORCE, Unit, UnitSystem, to_text


@of_result
def linked_conclusions(run: LinkedRun, units: UnitSystem) -> Conclusions:
    """The conclusions of a run, with numbers in ``units``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> pushed = ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb")))
        >>> run = ff.linked.simulate_linked(project, "pitch", pushed, "robust")
        >>> ff.linked.linked_conclusions(run, ff.UnitSystem.US).verdict
        'The link held: peak link force 27.1 lb at the grip, largest position difference 2.48 deg.'
    """
    force = _quantity(run.measures.peak_link_force_n, FORCE, units)
    apart = _quantity(run.measures.largest_difference_rad, ANGLE, units)
    numbers = "" if run.diverged else f": peak link force {force} at the grip, largest position difference {apart}"
    verdict = f"{capital(run.note)}{numbers}."
    findings = tuple(
        filter(None, (_fight(run, units), _priority(run), _dual(run), _after(run), _own_feel(run), _grip_law(run)))
    )
    return Conclusions(not run.diverged, verdict, findings)


def hands_text(run: LinkedRun, units: UnitSystem) -> str:
    """What both pilots do, and what happens to the link."""
    first, second = run.link.between
    scenario = run.scenario
    text = f"{first}: {input_text(scenario.first.force, units)}; {second}: {input_text(scenario.second_force, units)}"
    if scenario.jam is not None:
        text += f"; {scenario.jam.axis} jams at {scenario.jam.at_s:g} s"
    if scenario.button is not None:
        text += f"; {scenario.button.axis} takes priority by button at {scenario.button.at_s:g} s"
    if scenario.disconnect_s is not None:
        text += f"; the link is opened at {scenario.disconnect_s:g} s"
    return text


def _fight(run: LinkedRun, units: UnitSystem) -> str:
    fight = run.measures.peak_force_fight_n
    return (
        f"Force fight: the hands push against each other with up to {_quantity(fight, FORCE, units)}." if fight else ""
    )


def _priority(run: LinkedRun) -> str:
    """How long each pilot has priority."""
    lasts = run.measures.first_priority_s, run.measures.second_priority_s
    each = [f"{axis} for {time:.3g} s" for axis, time in zip(run.link.between, lasts, strict=True) if time]
    return f"Priority: {', '.join(each)}. The other control follows." if each else ""


def _dual(run: LinkedRun) -> str:
    time = run.measures.dual_input_s
    return f"Dual input: both hands push for {time:.3g} s." if time else ""


def _after(run: LinkedRun) -> str:
    if run.measures.gave_way_at_s >= (run.scenario.disconnect_s or inf):
        return ""
    if run.link.after_breakout is AfterBreakout.UNCOUPLE:
        return "The link uncoupled and stays open. Its stored energy is lost to both columns."
    return "The override takes hold again, without a step, as the columns come back together."


def _own_feel(run: LinkedRun) -> str:
    kind = "columns" if run.link.kind is LinkKind.MECHANICAL else "feel computers"
    moved = (
        "the sum of both feels and of the body at the middle" if run.link["middle_inertia"] else "the sum of both feels"
    )
    return f"Each side keeps its own feel, and the link acts on both {kind}: one pilot alone moves {moved}."


def _grip_law(run: LinkedRun) -> str:
    laws = [law.sampled for law in run.laws]
    if run.link.kind is LinkKind.ELECTRONIC or not any(law and law.sampled == SAMPLED_AT_GRIP for law in laws):
        return ""
    text = "A law for the force sensor at the grip feels the hand alone: its drive holds the column against the shaft."
    return f"{text} Use an electronic link."


def _quantity(value: float, measured_in: Unit, units: UnitSystem) -> str:
    return f"{to_text(measured_in.from_si(value, units), 3)} {measured_in.shown(units)}"
