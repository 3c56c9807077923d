"""What two linked loaders share: the step, and the periods of delay between them."""

from dataclasses import replace
from math import inf

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.links import Link, LinkKind
from forcefeel.loader.loader import Loader
from forcefeel.simulation.scenario import Scenario, Steps

MOST_SWING = 0.5
"""Steps times the frequency of both columns on a shaft, whose torque is straight within a step, or of a body at the middle."""

_WHOLE = 1e-6
"""Of a period; a delay that differs by so little is whole periods."""


def common_step(link: Link, loaders: tuple[Loader, Loader], scenario: Scenario) -> float:
    """The step of both loaders in s, for a scenario of the first.

    Raises:
        InputError: If their periods or delays leave none, an electronic link joins loaders without digital controllers, or the
            shaft of a mechanical link is too stiff for it.
    """
    periods = [loader["controller.period"] for loader in loaders]
    if periods[0] != periods[1]:
        shown = " and ".join(f"{1e3 * period:g} ms" for period in periods)
        raise InputError(
            f"controller.period: expected one period for {' and '.join(link.between)}, got {shown}; change one in its file"
        )
    if link.kind is LinkKind.ELECTRONIC and periods[0] == 0:
        raise InputError(
            f"links.{link.name}.kind: an electronic link joins two digital controllers, and these loaders have none; set "
            'controller.period, or write kind = "mechanical"'
        )
    longest = scenario.step_s
    for _ in loaders:
        longest = min(Steps.of(replace(scenario, step_s=longest), loader).step_s for loader in loaders)
    if any(Steps.of(replace(scenario, step_s=longest), loader).step_s != longest for loader in loaders):
        raise InputError("controller.delay: the delays of both loaders leave no common step; give both the same delay")
    if link.kind is LinkKind.MECHANICAL:
        _check_stiffness(link, (loaders[0]["column.inertia"], loaders[1]["column.inertia"]), longest)
    elif link["middle_inertia"]:
        _check_stiffness(link, (inf, inf), periods[0])
    return longest


def _check_stiffness(link: Link, inertias: tuple[float, float], step_s: float) -> None:
    """Refuses a link on which both columns, or the body at its middle, swing too fast for the step."""
    rate = _core.fastest_on_shaft(link.values, inertias)
    if rate * step_s > MOST_SWING:
        what, remedy = ("both columns swing", "a smaller --step, ") if inertias[0] < inf else ("the middle swings", "")
        if link["middle_inertia"]:
            remedy += "more middle_inertia, "
        raise InputError(
            f"links.{link.name}.stiffness: {what} on the link at {rate:.4g} rad/s, too fast for a step of "
            f"{step_s:g} s; expected at most {MOST_SWING / step_s:.4g} rad/s; take {remedy}or less stiffness or damping"
        )


def delay_periods(link: Link, loaders: tuple[Loader, Loader]) -> int | None:
    """Periods of delay of an electronic link; ``None`` of a mechanical one.

    Raises:
        InputError: If they are not whole, or too many.
    """
    if link.kind is LinkKind.MECHANICAL:
        return None
    period = loaders[0]["controller.period"]
    periods = link["delay"] / period or 1.0
    if not (1 <= round(periods) <= _core.MOST_LINK_DELAY and abs(periods - round(periods)) < _WHOLE):
        raise InputError(
            f"links.{link.name}.delay: expected 1 to {_core.MOST_LINK_DELAY} periods of {1e3 * period:g} ms, got "
            f"{1e3 * link['delay']:g} ms"
        )
    return round(periods)
