"""A loop seen from its command, analog or sampled: what margins and poles are found from.

| loop | from one moment to the next | opened |
|---|---|---|
| sampled | ``x+ = M x + b e_T`` | ``M - b c`` |
| analog, eq. (17) | ``x' = A x + b e_T`` | ``A - b c`` |

``e = c x`` the command, ``e_T`` a test signal on it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import GainLaw
from forcefeel.laws.law import Law
from forcefeel.linear.models import INPUTS, Linkage, loader_model
from forcefeel.linear.modes import Mode, is_stable
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loops.sampled_loop import SampledLoops, sampled_loops

HIGHEST_ANALOG_RAD_PER_S = 2 * pi * 1e4
"""Up to here an analog loop is looked at: far above valve and link."""

_AT_ONCE = 1e-6
"""A sampled pole nearer to zero is gone after a sample or two: a delay, not a motion."""


@dataclass(frozen=True, eq=False)
class CommandLoop:
    """One closed loop.

    Attributes:
        matrix: M or A, (states, states).
        by_command: b, (states,), per V.
        command: c, (states,), V.
        period_s: Sample period; ``None`` for an analog loop.
    """

    matrix: NDArray[np.float64] = field(repr=False)
    by_command: NDArray[np.float64] = field(repr=False)
    command: NDArray[np.float64] = field(repr=False)
    period_s: float | None

    @classmethod
    def sampled(cls, loops: SampledLoops, loop: int = 0) -> "CommandLoop":
        """One of many loops under a digital controller."""
        matrix = loops.matrix[loop]
        return cls(matrix, loops.by_command[loop], matrix[loops.command], loops.period_s)

    @classmethod
    def analog(cls, loader: Loader, law: GainLaw) -> "CommandLoop":
        """The loop of an analog loader."""
        opened = GainLaw([0.0] * len(law.gains), law.load_cell_arm, law.displacement_unit)
        closed = loader_model(loader, law, Linkage.COMPLIANT)
        b = closed.B[:, INPUTS.index("test_signal_v")]
        # The command enters in one place, so that A - A_opened = b c.
        return cls(closed.A, b, b @ (closed.A - loader_model(loader, opened, Linkage.COMPLIANT).A) / (b @ b), None)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles, of z or of s."""
        return np.asarray(np.linalg.eigvals(self.matrix), dtype=np.complex128)

    @property
    def stable(self) -> bool:
        """Whether all poles are where what they stand for dies away."""
        if self.period_s is None:
            return is_stable(float(self.poles.real.max()))
        return bool(np.abs(self.poles).max() < 1)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Its modes, slowest first, a conjugate pair once; of a sampled loop ``s = ln(z) / T``, without what is gone at once."""
        poles = self.poles
        if self.period_s is not None:
            poles = np.asarray(np.log(poles[np.abs(poles) > _AT_ONCE]) / self.period_s, dtype=np.complex128)
        upper = sorted((complex(s) for s in poles if s.imag >= 0), key=abs)
        return tuple(Mode(s.real, s.imag, abs(s), -s.real / abs(s) if s else 0.0) for s in upper)


def command_loops(loader: Loader, laws: Law, feel: NDArray[np.float64]) -> Sequence[CommandLoop]:
    """The loops of a loader at settings I, B, G, a row each.

    Example:
        >>> loader = ff.digital_elevator()
        >>> law = ff.Law.of("robust", loader)
        >>> len(ff.loops.command_loops(loader, law, law.feel))
        1
    """
    if loader["controller.period"]:
        loops = sampled_loops(loader, laws, loader.rows(FEEL_SETTING, feel))
        return [CommandLoop.sampled(loops, loop) for loop in range(len(feel))]
    laws.check(loader)
    at_settings = (loader.replace(dict(zip(FEEL_SETTING, row, strict=True)), si=True) for row in feel.tolist())
    return [CommandLoop.analog(at, laws.numbers.gain_law(loader, k)) for k, at in enumerate(at_settings)]
