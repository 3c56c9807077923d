"""Conversion of a loader and its law for the loop."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.law import Law, LawLike
from forcefeel.live.rendered import rendered_feels, within_drive
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import OFF, TABLE
from forcefeel.simulation.scenario import Scenario, Steps

LEAST_PERIOD_S, MOST_PERIOD_S = 1 / 5000, 1 / 250
"""Range of the loop's period: 250 Hz to 5 kHz."""


def live_law(law: LawLike, loader: Loader) -> Law:
    """Law of a live loop; default: that of the loader's drive.

    Raises:
        InputError: If the loader has no digital controller, or the law does not fit it.
    """
    check_loader(loader)
    period = loader["controller.period"]
    if not LEAST_PERIOD_S * (1 - 1e-9) <= period <= MOST_PERIOD_S * (1 + 1e-9):
        stated = f"{1e3 * period:g} ms" if period else "none: its controller is analog"
        raise InputError(
            f"controller.period: a live loop requires {1e3 * LEAST_PERIOD_S:g} to {1e3 * MOST_PERIOD_S:g} ms, got {stated}; "
            'set controller.period in the loader file, such as "0.5 ms"'
        )
    return Law.of(law, loader)


def made_of(
    loader: Loader,
    law: Law,
    *,
    supervised: bool = True,
    scenario: Scenario | None = None,
    host: bool = False,
    soften: bool = False,
    flap_trim: float = 0.0,
) -> tuple[_core.LiveSetup, Steps]:
    """Setup of the loop, and the scenario at the steps of the machine; of one with a host, what it may ask for.

    Raises:
        InputError: As in ``Steps.of`` and ``Law.engine``.
    """
    period = loader["controller.period"]
    steps = Steps.of(scenario or Scenario(duration_s=period, sample_s=period), loader)
    if steps.timing is None:
        raise InputError("controller.period: a live loop requires a digital controller")
    rendered = rendered_feels(loader, law) if host else None
    if soften and rendered is not None:
        rendered = within_drive(rendered, loader)
    setup = _core.LiveSetup(
        loader.si_values,
        steps.step_s,
        steps.timing,
        **law.engine(loader),
        curve=loader.force_curve.arrays if loader.force_curve else None,
        stiffness_factor=loader.stiffness_factor.arrays if loader.stiffness_factor else None,
        cancellation=law.cancellation.numbers if law.cancellation else None,
        supervised=supervised,
        rendered=rendered,
        softens=soften,
        flap_trim=flap_trim,
    )
    return setup, steps


_OF_MACHINE = ("force", "test_signal", "command_signal")
"""Inputs of a scenario that act on the machine instead of the controller."""


def script_of(
    steps: Steps, scenario: Scenario
) -> tuple[dict[str, NDArray[np.float64]], float, tuple[float, int] | None, int]:
    """Inputs of a simulated machine in the engine's form.

    Raises:
        InputError: If the scenario has inputs of the controller, which a running loop gets as requests.
    """
    if others := [name for name in steps.inputs if name not in (*_OF_MACHINE, "fade")]:
        raise InputError(
            f"scenario: {', '.join(others)}: set it on the running loop, such as running.trim_rad; omit it here"
        )
    plant = {name: steps.inputs[name] for name in _OF_MACHINE if name in steps.inputs}
    return plant, steps.start_force_n, steps.held, scenario.seed


def feel_numbers(values: NDArray[np.float64], observer: NDArray[np.float64] | None, cycles: int) -> list[float]:
    """A change of the feel in the loop's form: cycles, values of a loader, numbers of its law with an observer."""
    return [float(cycles), *values.tolist(), *([] if observer is None else observer.tolist())]


def feel_rows(numbers: Sequence[float], loader: Loader) -> dict[str, float | None]:
    """Rows of the feel in which such a change differs from a loader, for ``Loader.replace``."""
    values = {key: value for key, value in zip(TABLE, numbers[1:], strict=False) if key.startswith("feel.")}
    return {key: None if value == OFF.get(key) else value for key, value in values.items() if value != loader[key]}


def checked_feel(rows: Mapping[str, object]) -> None:
    """Check that all rows belong to the feel.

    Raises:
        InputError: For the first other row.
    """
    for key in rows:
        if not key.startswith("feel."):
            raise InputError(f"feel: expected rows of the feel such as feel.stiffness, got {key!r}")
