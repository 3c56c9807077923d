"""The loop under a digital controller, from one period to the next, its delay included.

``x+ = M x + b_e e_T + b_F F_p``: what plant, sensors, controller and the commands under way carry from sample to sample, from
the very step that runs them (``crates/model/src/machine/period.rs``). ``e_T`` is a test signal on the command.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.law import Law, LawLike
from forcefeel.linear.unit_circle import inside_unit_circle, sampled_poles
from forcefeel.loader.loader import Loader
from forcefeel.loader.timing import controller_steps
from forcefeel.threads import threads_or_cores


@dataclass(frozen=True, eq=False)
class SampledLoops:
    """Loops under a digital controller.

    Attributes:
        period_s: Sample period.
        matrix: M, (loops, states, states).
        by_command: b_e, (loops, states), per V.
        by_force: b_F, (loops, states), per N.
        base: Place of the column's base, in m, among the states.
        command: Place of the youngest command, in V.
        threads: How many find the poles.
    """

    period_s: float
    matrix: NDArray[np.float64] = field(repr=False)
    by_command: NDArray[np.float64] = field(repr=False)
    by_force: NDArray[np.float64] = field(repr=False)
    base: int
    command: int
    threads: int = 1

    @cached_property
    def poles(self) -> NDArray[np.complex128]:
        """Poles of each loop, (loops, states); not numbers where the matrix is not made of numbers."""
        return sampled_poles(self.matrix, self.threads)

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """Whether all poles of each loop are inside the unit circle."""
        return inside_unit_circle(self.matrix, self.threads)


def sampled_loops(
    loader: Loader, law: LawLike, values: NDArray[np.float64] | None = None, *, threads: int | None = None
) -> SampledLoops:
    """The loops of a loader, or of many that share its controller, under a law.

    What holds, touches or rounds (dry friction, play, stops, the feel's spring but for G, the steps of sensors and converters)
    is left out: it has no slope at rest.

    Args:
        loader: The loader, with ``controller.period``.
        law: As ``simulate_batch`` takes it.
        values: SI values, a row for each loop in the order of ``parameters.TABLE``; the loader's own if not given.
        threads: How many; all cores if not given.

    Raises:
        InputError: If the loader has no period, or a sampled law was made for another.

    Example:
        >>> ff.loops.sampled_loops(ff.digital_elevator(), "robust").matrix.ndim
        3
    """
    if loader["controller.period"] == 0:
        raise InputError("controller.period: expected a sample period, got none; give one, for example 0.5 ms")
    step_s, timing = controller_steps(loader, _LONGEST_STEP_S)
    rows = loader.si_values[np.newaxis] if values is None else np.ascontiguousarray(values, dtype=np.float64)
    threads = threads_or_cores(threads)
    states, matrices = _core.sampled_loops(rows, step_s, timing, **Law.of(law, loader).engine(loader), threads=threads)
    n = len(states)
    return SampledLoops(
        loader["controller.period"],
        matrices[:, :, :n],
        matrices[:, :, n],
        matrices[:, :, n + 1],
        states.index(_core.PERIOD_BASE),
        states.index(_core.PERIOD_COMMAND),
        threads,
    )


_LONGEST_STEP_S = 1e-4
"""So fine that the fast poles of a tight loop are those of the exact plant to some 1e-3."""
