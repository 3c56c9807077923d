"""What two linked loaders share: the step, and the periods of delay between them."""

from dataclasses import replace

import numpy as np

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.links import Link, LinkKind
from forcefeel.loader.loader import Loader
from forcefeel.simulation.scenario import Scenario, Steps

MOST_SWING = 0.5
"""Steps times the frequency of both columns on a mechanical link, whose torque is straight within a step."""

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
        _check_stiffness(link, loaders, longest)
    return longest


def _check_stiffness(link: Link, loaders: tuple[Loader, Loader], step_s: float) -> None:
    """Refuses a shaft on which both columns swing too fast for the step."""
    first, second = (1 / loader["column.inertia"] for loader in loaders)
    per_inertia = first + link["ratio"] ** 2 * second
    steepest = max(link["stiffness"], link["stiffness_after"])
    rate = max(np.sqrt(steepest * per_inertia), link["damping"] * per_inertia)
    if rate * step_s > MOST_SWING:
        raise InputError(
            f"links.{link.name}.stiffness: both columns swing on the link at {rate:.4g} rad/s, too fast for a step of "
            f"{step_s:g} s; expected at most {MOST_SWING / step_s:.4g} rad/s; take a smaller --step, or less stiffness or damping"
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
