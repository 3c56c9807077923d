"""Compensation: feedback gains that make the column follow the programmed feel, eqs. (20)-(22).

The gains minimize the sum over the horizon of ``x' [Q] x + R_2 e^2`` for the design plant of eq. (19), sampled at the step
of the design. ``x`` holds ``DESIGN_STATES``; the pilot force is a constant state, which no feedback can move, so only the
first six states are stabilizable.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError, expect
from forcefeel.json_values import fields_json
from forcefeel.laws.analog.gains import FixedGains
from forcefeel.linear.models import DESIGN_STATES, design_model, state_feedback
from forcefeel.loader.loader import Loader, check_hydraulic
from forcefeel.units import LENGTH, RATIO, SECONDS, Json, Unit, UnitSystem, quantity

GAIN_UNITS = (
    Unit("V/m", "V/cm", "V/in"),
    Unit("V/Pa", "V cm^2/N", "V in^2/lb"),
    Unit("V/rad", "V/rad", "V/rad"),
    Unit("V s/rad", "V s/rad", "V s/rad"),
    Unit("V/m", "V/cm", "V/in"),
    Unit("V s/m", "V s/cm", "V s/in"),
    Unit("V/N", "V/N", "V/lb"),
)
"""Units of the gains c_1 .. c_7 on ``DESIGN_STATES``."""

GAIN_SYMBOLS = ("c_1", "c_2", "c_3", "c_4", "c_5", "c_6", "c_7")
"""The report's letters for the gains on ``DESIGN_STATES``."""

MOST_STEPS = _core.MOST_RECURSION_STEPS
"""Longest recursion: some two seconds of computing, and 200 s of horizon at the report's step."""

PUBLISHED_HORIZON_S = 0.05
"""Horizon that gives the published gains; see ``docs/reference/validation.md``."""

_MOTIONS = tuple(
    (DESIGN_STATES.index(f"{of}_position_{unit}"), DESIGN_STATES.index(f"{of}_velocity_{unit}_per_s"))
    for of, unit in (("feel", "rad"), ("base", "m"))
)
"""Places of delta and delta', of x_b and x_b'."""


@dataclass(frozen=True)
class DesignSettings:
    """What recursion (22) is run with.

    Attributes:
        step_s: Sampling step of the design.
        horizon_s: Length of the horizon; ``None`` runs until the gains stand still.
        tolerance: Without a horizon: stop when no gain has changed over the second half of the steps by more than this
            share of the largest, the states scaled to the order of one.
        position_weight: Weight of ``(delta - theta)^2``, eq. (21), in 1/rad^2.
        r1: Weight R_1 of ``(delta' - theta')^2``, eq. (21), in s^2/rad^2.
        r2: Weight R_2 of ``e^2``, eq. (20), in 1/V^2.
        q: [Q] whole, 7 by 7 on ``DESIGN_STATES`` in SI units, in place of the two weights of eq. (21).
        pilot_arm_m: Torque that the feel computer sees per newton of pilot force; the grip's arm R_p if not given.

    Raises:
        InputError: If a value is not finite or has the wrong sign, or [Q] is not symmetric and positive semidefinite.
    """

    step_s: Annotated[float, SECONDS] = 1e-4
    horizon_s: Annotated[float, SECONDS] | None = None
    tolerance: Annotated[float, RATIO] = 1e-10
    position_weight: Annotated[float, Unit("1/rad^2", "1/rad^2", "1/rad^2")] = 100.0
    r1: Annotated[float, Unit("s^2/rad^2", "s^2/rad^2", "s^2/rad^2")] = 0.0
    r2: Annotated[float, Unit("1/V^2", "1/V^2", "1/V^2")] = 0.1
    q: tuple[tuple[float, ...], ...] | None = None
    pilot_arm_m: Annotated[float, LENGTH] | None = None

    def __post_init__(self) -> None:
        for name, smallest in (("step_s", 1e-7), ("tolerance", 1e-15), ("r2", 1e-12)):
            _check(name, getattr(self, name), smallest)
        for name in ("position_weight", "r1"):
            _check(name, getattr(self, name), 0.0)
        if self.horizon_s is not None:
            _check("horizon_s", self.horizon_s, self.step_s)
            steps = self.horizon_s / self.step_s
            if steps > MOST_STEPS:
                longest = MOST_STEPS * self.step_s
                raise InputError(
                    f"horizon_s: expected at most {longest:g} s at a step of {self.step_s:g} s, got {self.horizon_s:g}"
                )
            if abs(steps - round(steps)) > 1e-6 * steps:  # rounding of a quotient that is whole
                raise InputError(
                    f"horizon_s: expected a whole number of steps of {self.step_s:g} s, got {self.horizon_s:g} s"
                )
        if self.q is not None:
            _check_weight(self.q)
        if self.pilot_arm_m is not None and not np.isfinite(self.pilot_arm_m):
            raise InputError(f"pilot_arm_m: expected a finite number, got {self.pilot_arm_m:g}")

    def weight(self, loader: Loader) -> NDArray[np.float64]:
        """[Q] on ``DESIGN_STATES`` in SI units, eq. (21)."""
        if self.q is not None:
            return np.array(self.q, dtype=np.float64)
        # The error delta - theta is the design plant's output, its rate the same row on the velocities.
        row = np.asarray(design_model(loader).C)[0]
        rate = np.zeros_like(row)
        for position, velocity in _MOTIONS:
            rate[velocity] = row[position]
        return self.position_weight * np.outer(row, row) + self.r1 * np.outer(rate, rate)


class Status(StrEnum):
    """How recursion (22) ended."""

    CONVERGED = "converged"
    HORIZON = "horizon"
    MOVING = "moving"
    SINGULAR = "singular"


@dataclass(frozen=True, eq=False)
class GainDesign:
    """Gains and how well they are proved.

    Attributes:
        settings: What the recursion was run with.
        gains: SI gains c_1 .. c_7 on ``DESIGN_STATES``.
        steps: Steps of the recursion.
        status: How the recursion ended.
        change: Change of the gains over the second half of the steps, as a share of the largest, the states scaled.
        riccati_residual: How far the gains are from the best for an endless horizon; see ``SampledProblem.residual``.
    """

    settings: DesignSettings
    gains: NDArray[np.float64]
    steps: int
    status: Status
    change: Annotated[float, RATIO]
    riccati_residual: Annotated[float, RATIO]

    def as_json(self, system: UnitSystem) -> dict[str, Json]:
        """The fields, and each gain with the state that it acts on."""
        rows = zip(GAIN_SYMBOLS, DESIGN_STATES, self.gains, GAIN_UNITS, strict=False)
        gains = [
            {"symbol": symbol, "state": state, **quantity(float(value), measured_in, system)}
            for symbol, state, value, measured_in in rows
        ]
        return fields_json(self, system) | {"gains": gains}

    @property
    def reached(self) -> bool:
        """Whether the recursion ended as it was asked to: at its horizon, or with gains that stand still."""
        return self.status in {Status.HORIZON, Status.CONVERGED}

    @property
    def note(self) -> str:
        """How the recursion ended, in words."""
        after = f"after {self.steps} steps of {self.settings.step_s:g} s"
        match self.status:
            case Status.CONVERGED:
                return f"converged {after}"
            case Status.HORIZON:
                return f"horizon of {self.settings.horizon_s:g} s, {self.steps} steps of {self.settings.step_s:g} s"
            case Status.MOVING:
                advice = f"expected {self.settings.tolerance:g}: change r2, the step or the tolerance"
                return f"not converged {after}: the gains still change by {self.change:.1e}; {advice}"
            case Status.SINGULAR:
                return f"stopped {after}: R + H' E H could not be inverted in double precision; change r2 or the step"

    def law(self, loader: Loader) -> GainLaw:
        """The law on the six measured states.

        The pilot force is not measured, so its gain is left out. Gains over an endless horizon count on it: without it the
        column settles short of the programmed deflection.
        """
        return state_feedback(loader, self.gains[:6])


def published_settings(loader: Loader) -> DesignSettings:
    """The settings that give the gains printed in the appendix.

    The recursion is stopped after 0.05 s, and the pilot force enters the computer's row as though it were the load cell's
    force, with the arm ``-alpha R_b``.

    Example:
        >>> ff.laws.published_settings(ff.elevator()).horizon_s
        0.05
    """
    check_hydraulic(loader, "recursion (22)")
    law = state_feedback(loader, np.zeros(6))
    return DesignSettings(horizon_s=PUBLISHED_HORIZON_S, pilot_arm_m=-law.load_cell_arm)


NAMED_DESIGNS: Mapping[str, Callable[[Loader], DesignSettings | FixedGains]] = MappingProxyType(
    {
        "original": lambda _: FixedGains(),
        "published": published_settings,
        "converged": lambda _: DesignSettings(),
    }
)
"""How the gains of each law are designed, by the law's name."""


def design_gains(loader: Loader, settings: DesignSettings | None = None) -> GainDesign:
    """Runs recursion (22) for ``loader``.

    Args:
        loader: The loader; its valve dynamics are left out of the design plant.
        settings: Weights, step and horizon; ``published_settings`` if not given. ``DesignSettings()`` runs the report's
            weights to convergence.

    Returns:
        The gains, and in ``status`` and ``note`` how the recursion ended; gains that have not ``reached`` what was asked
        are those of its last step.

    Example:
        >>> found = ff.design_gains(ff.elevator())
        >>> len(found.gains), found.note
        (7, 'horizon of 0.05 s, 500 steps of 0.0001 s')
    """
    check_hydraulic(loader, "recursion (22)")
    if settings is not None:
        expect("settings", settings, DesignSettings, "DesignSettings, such as DesignSettings(r2=0.05)")
    settings = settings or published_settings(loader)
    problem = SampledProblem.of(loader, settings)
    most_steps = MOST_STEPS if settings.horizon_s is None else round(settings.horizon_s / settings.step_s)
    tolerance = settings.tolerance if settings.horizon_s is None else None
    solution = _core.recursion(problem.phi, problem.h, problem.q, problem.r, most_steps, tolerance)
    gains = solution.gains[0] / problem.scale
    gains.setflags(write=False)
    return GainDesign(
        settings=settings,
        gains=gains,
        steps=solution.steps,
        status=Status(solution.status),
        change=solution.change,
        riccati_residual=problem.residual(gains),
    )


@dataclass(frozen=True)
class SampledProblem:
    """The design plant over one step, its states scaled to the order of one.

    Attributes:
        phi: Transition matrix [Phi].
        h: Input matrix [H].
        q: Weight [Q].
        r: Weight R_2, 1 by 1.
        scale: SI value of one unit of each scaled state.
    """

    phi: NDArray[np.float64]
    h: NDArray[np.float64]
    q: NDArray[np.float64]
    r: NDArray[np.float64]
    scale: NDArray[np.float64]

    @classmethod
    def of(cls, loader: Loader, settings: DesignSettings) -> "SampledProblem":
        """The problem that ``settings`` pose for ``loader``."""
        plant = design_model(loader, settings.pilot_arm_m)
        scale = state_scale(loader)
        phi, h = _core.discretize(plant.A * scale / scale[:, None], plant.B / scale[:, None], settings.step_s)
        q = settings.weight(loader) * np.outer(scale, scale)
        return cls(phi, h, q, np.array([[float(settings.r2)]]), scale)

    def residual(self, gains: NDArray[np.float64]) -> float:
        """How far ``gains`` (SI) are from optimal: the residual of eqs. (22) at their fixed point.

        ``E`` of ``E = M' E M + Q + c' R c``, ``M = Phi + H c``, eq. (22b), is the cost of constant gains. They
        are optimal if and only if eq. (22a) then returns them. The residual is the largest difference on the six
        stabilizable states, as a share of the largest gain. It is not a number if a state does not decay, as of an
        undamped feel: the cost then has no bound, or exceeds the range of double precision.
        """
        phi, h, q = self.phi[:6, :6], self.h[:6], self.q[:6, :6]
        c = (gains[:6] * self.scale[:6])[None, :]
        closed = phi + h @ c
        if (
            not np.all(np.isfinite(closed)) or np.max(np.abs(np.linalg.eigvals(closed))) >= 1.0 - 1e-12
        ):  # rounding of one
            return np.nan
        with np.errstate(over="ignore", invalid="ignore"):
            cost = _cost_of_constant_gains(closed, q + c.T @ self.r @ c)
            better = -np.linalg.solve(self.r + h.T @ cost @ h, h.T @ cost @ phi)
            return float(np.max(np.abs(better - c)) / np.max(np.abs(c)))


def _cost_of_constant_gains(closed: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """``E = W + M' W M + M'^2 W M^2 + ...`` of a stable ``M``, the steps doubled.

    Nothing is inverted, so that a pole close to the circle costs no more digits than it has to.

    Source: R. A. Smith, Matrix equation XA + BX = C, SIAM Journal on Applied Mathematics 16 (1968).
    """
    total, power = weight, closed
    for _ in range(_DOUBLINGS):
        total = total + power.T @ total @ power
        power = power @ power
    return total


_DOUBLINGS = 50
"""Of a pole ``1 - 1e-12`` nothing is left after so many: ``exp(-2^50 1e-12)``."""


def gains_in(system: UnitSystem, gains: NDArray[np.float64]) -> NDArray[np.float64]:
    """SI gains as numbers of the units that people read under ``system``."""
    return np.array([unit.from_si(float(c), system) for unit, c in zip(GAIN_UNITS, gains, strict=False)])


def state_scale(loader: Loader) -> NDArray[np.float64]:
    """Size of each of ``DESIGN_STATES``, SI: the column at one radian, moving at the feel's frequency, at supply pressure."""
    frequency, _ = _core.feel_frequency(loader.si_values)
    base = loader["column.base_arm"]
    piston = loader["linkage.ratio"] * base
    force = loader["feel.stiffness"] / loader["column.grip_arm"]
    pressure = loader["valve.supply_pressure"]
    return np.array([piston, pressure, 1.0, frequency, base, base * frequency, force])


_LARGEST = 1e12
"""No setting is larger: weights beyond it drown the others in rounding."""


def _check(name: str, value: float, smallest: float) -> None:
    if not smallest <= value <= _LARGEST:
        raise InputError(f"{name}: expected a number from {smallest:g} to {_LARGEST:g}, got {value:g}")


def _check_weight(given: tuple[tuple[float, ...], ...]) -> None:
    n = len(DESIGN_STATES)
    try:
        q = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"q: expected {n} rows of {n} numbers ({error})") from error
    if q.shape != (n, n):
        raise InputError(f"q: expected {n} rows of {n} numbers, got shape {q.shape}")
    if not np.all(np.isfinite(q)) or not np.allclose(q, q.T, rtol=1e-12, atol=0.0):
        raise InputError("q: expected a symmetric matrix of finite numbers")
    diagonal = np.diag(q)
    weighted = diagonal > 0
    # A state without a weight of its own can have none together with another; the rest is judged free of its units.
    scale = np.sqrt(diagonal[weighted])
    lowest = float(np.min(np.linalg.eigvalsh(q[np.ix_(weighted, weighted)] / np.outer(scale, scale)), initial=0.0))
    if np.any(q[~weighted] != 0) or lowest < -1e-9:  # rounding of an eigenvalue that is zero
        raise InputError("q: expected a positive semidefinite matrix, got one that makes some deviation pay")
