"""A sampled law with an observer, as data: what a digital controller runs once a period.

``xi`` its state, in coordinates of its own · ``y = [F_c, x_p, theta]`` the sampled load cell force (N), piston displacement (m)
and column angle (rad); of a law for a force sensor at the grip ``y = [F_c, x_p, theta, F_g]``, with its force (N) · ``delta``,
``delta'`` the feel computer's displacement and rate, ``n`` its neutral · ``e`` command in V, of a motor in A · ``T`` torque in N m
that drives the feel computer in the period

    T_k    = torque  [xi; y; delta; delta'] + t_n n
    e_k    = command [xi; y; delta; delta'] + c_n n
    xi_k+1 = transition xi_k + input [y; e_k]        e_k as the amplifier answers it, after limits

and, where it knows the column's dry friction, torque and state as ``crates/model/src/known_friction.rs`` says.
``crates/model/src/observer.rs`` runs it. Observers, regulators and feed-forward are all sets of numbers of this one law.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.units import SECONDS, show

MOST_STATES = 9
"""Most states of a law; the engine runs one with fewer with zeros for the others."""

SAMPLED = 3
"""How many signals are sampled: F_c, x_p, theta."""

SAMPLED_AT_GRIP = SAMPLED + 1
"""How many with the force at the grip, F_g."""

_FEEL = 2
"""delta, delta'."""

OF_FRICTION = 14
"""F_-, F_+, beta, 1 / omega_s, U, v_s, l, of learning g_-, g_+, a, q, c, d, and of rest v_r."""

OF_CONTACT, _THRESHOLD = 11, 5
"""Numbers of the part for contact, and the place of T_min among them from the end."""

_AT_ONE = 1e-11
"""A pole of the law, left to itself, that is nearer to 1 may be one: rounding moves poles by 1e-13."""


@dataclass(frozen=True, eq=False)
class SampledLaw:
    """A sampled law for one setting or for many.

    Attributes:
        period_s: Sample period of the plant it was made for.
        delay_s: Time from the sample to its command, likewise; at most a period.
        transition: (settings, n, n); n at most ``MOST_STATES``.
        input: (settings, n, 4), columns F_c, x_p, theta, e; with the grip's sensor (settings, n, 5), F_g before e, and so below.
        command: (settings, n + 5), in V, of a motor in A, on xi, F_c, x_p, theta, delta, delta'.
        torque: (settings, n + 5), in N m on the same.
        friction: (settings, 2 n + 19), the dry friction that it knows: r, the column's rate in rad/s on the same as command; b, by
            which xi moves per N m of friction; ``F_-``, ``F_+`` in N m, beta, 1 / ``omega_s`` in s/rad, U in N m, v_s in rad/s, l;
            how it learns: ``g_-``, ``g_+``, a in 1/(N m), q in N m, c, d; and v_r in rad/s. Zeros where it is not given: it knows
            of none.
        neutral: (settings, 2), c_n in V or A and t_n in N m per radian of the feel's neutral: see ``laws.sampled.neutral``. Zeros
            where it is not given.
        contact: (settings, 11), what it does in contact: alpha R_b in m, k_x, k_v, B_c in N m s/rad, v_m in rad/s, T_r and T_min in
            N m, K_e in N m/rad, t_q in s, theta_n and theta_t in rad; see ``laws.sampled.contact_law``. Zeros where it is not
            given: it knows of none.
        settled: (settings, n, 4), the state at rest per F_c, x_p, theta, delta; see ``_settled``.

    Arrays are read-only.

    Raises:
        InputError: If shapes do not go together, a number is not finite, the delay is negative or longer than the period, or
            the state at rest is not determined: a law that integrates without end has any.

    Example:
        >>> law = ff.Law.of("robust", ff.digital_elevator()).sampled
        >>> law.period_s, law.delay_s
        (0.0005, 0.0005)
    """

    period_s: Annotated[float, SECONDS]
    delay_s: Annotated[float, SECONDS]
    transition: NDArray[np.float64] = field(repr=False)
    input: NDArray[np.float64] = field(repr=False)
    command: NDArray[np.float64] = field(repr=False)
    torque: NDArray[np.float64] = field(repr=False)
    friction: NDArray[np.float64] = field(default_factory=lambda: np.empty(0), repr=False)
    neutral: NDArray[np.float64] = field(default_factory=lambda: np.empty(0), repr=False)
    contact: NDArray[np.float64] = field(default_factory=lambda: np.empty(0), repr=False)
    settled: NDArray[np.float64] = field(init=False, repr=False)
    kind: ClassVar[str] = "sampled"
    by_machine: ClassVar[bool] = False
    displacement_unit: ClassVar[str] = "rad"

    def __post_init__(self) -> None:
        if not (np.isfinite(self.period_s) and self.period_s > 0):
            raise InputError(f"period_s: expected a time above 0, got {show(self.period_s)}")
        if not 0 <= self.delay_s <= self.period_s:
            raise InputError(f"delay_s: expected 0 to the period of {self.period_s:g} s, got {show(self.delay_s)}")
        for name, array in _arrays(self).items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        settled = _settled(self)
        settled.setflags(write=False)
        object.__setattr__(self, "settled", settled)

    @property
    def settings(self) -> int:
        """How many settings it has a law for."""
        return len(self.transition)

    @property
    def knows_friction(self) -> bool:
        """Whether it gives dry friction back."""
        return bool(self.friction[:, -OF_FRICTION].any())

    @property
    def knows_contact(self) -> bool:
        """Whether it has a part for contact."""
        return bool(self.contact[:, OF_CONTACT - _THRESHOLD].any())

    @property
    def sampled(self) -> int:
        """How many signals it samples: ``SAMPLED`` or ``SAMPLED_AT_GRIP``."""
        return int(self.input.shape[2]) - 1

    @property
    def states(self) -> int:
        """How many states each law has."""
        return int(self.transition.shape[1])

    @property
    def digital(self) -> "SampledLaw":
        """The law itself, as ``LawNumbers`` has it."""
        return self

    def engine(self) -> dict[str, Any]:
        """The numbers as keywords of the engine."""
        return {"observers": self.rows()}

    def as_json(self) -> dict[str, Any]:
        """The numbers in SI units; without those of friction and contact if it knows of none."""
        known = {FRICTION: self.knows_friction, CONTACT: self.knows_contact}
        return {name: getattr(self, name).tolist() for name in NUMBERS if known.get(name, True)}

    def gain_law(self, loader: Loader, setting: int = 0) -> GainLaw:
        """Raises ``InputError``: a sampled law is not gains alone."""
        raise InputError(f"law: expected gains on {loader.name} for setting {setting + 1}, got a sampled law")

    def some(self, which: int | slice | Sequence[int] | NDArray[np.integer | np.bool_]) -> "SampledLaw":
        """The laws of some settings: one index, or a slice, indices or a mask."""
        chosen = np.atleast_1d(np.arange(self.settings)[which])
        law = copy(self)  # nothing to check or to settle again
        for name in (*NUMBERS, "settled"):
            part = getattr(self, name)[chosen]
            part.setflags(write=False)
            object.__setattr__(law, name, part)
        return law

    def between(self, other: "SampledLaw", share: float) -> "SampledLaw":
        """The law whose every number is ``(1 - share) a + share b``: it says what lies between what the two say.

        Args:
            other: The law that it goes to; both are for one setting, of one plant, in the same coordinates.
            share: How far it goes, 0 to 1.

        Raises:
            InputError: If period, delay or number of states differ, there is more than one setting, or the share is beyond.
        """
        for name in ("period_s", "delay_s", "states", "sampled"):
            own, two = getattr(self, name), getattr(other, name)
            if own != two:
                raise InputError(f"other: expected a law with the {name} {own:g} of this one, got {two:g}")
        if (self.settings, other.settings) != (1, 1):
            raise InputError(
                f"other: expected two single laws, got {self.settings} and {other.settings} settings; pick with some(...)"
            )
        if not 0 <= share <= 1:
            raise InputError(f"share: expected a number from 0 to 1, got {show(share)}")
        numbers = ((1 - share) * getattr(self, name) + share * getattr(other, name) for name in NUMBERS)
        return SampledLaw(self.period_s, self.delay_s, *numbers)

    def rows(self) -> NDArray[np.float64]:
        """A row of ``_core.OBSERVER_NUMBERS`` numbers for each setting, as the engine takes them.

        transition (9 by 9), input (9 by 5), command (15), torque (15), settled (9 by 5), neutral (2), friction (34) and
        contact (11), row by row, with zeros for the states, and for the force at the grip, that the law has not.
        """
        n, spare = self.states, MOST_STATES - self.states
        grip = [SAMPLED] * (SAMPLED_AT_GRIP - self.sampled)
        absent = [n] * spare + [n + place for place in grip]

        def wide(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.insert(np.pad(numbers, ((0, 0), (0, spare), (0, 0))), grip, 0.0, axis=2)

        parts = (
            np.pad(self.transition, ((0, 0), (0, spare), (0, spare))),
            wide(self.input),
            np.insert(self.command, absent, 0.0, axis=1),
            np.insert(self.torque, absent, 0.0, axis=1),
            wide(self.settled),
            self.neutral,
            np.insert(self.friction, absent + [2 * n + self.sampled + _FEEL] * spare, 0.0, axis=1),
            self.contact,
        )
        return np.ascontiguousarray(np.hstack([part.reshape(self.settings, -1) for part in parts]))


FRICTION, CONTACT = "friction", "contact"
NUMBERS = ("transition", "input", "command", "torque", FRICTION, "neutral", CONTACT)
"""The arrays that a law is made of, in the order in which it takes them."""


def _arrays(law: SampledLaw) -> dict[str, NDArray[np.float64]]:
    """The law's numbers as arrays that go together."""
    arrays = {name: _array(name, getattr(law, name)) for name in NUMBERS}
    shape = arrays["transition"].shape
    if len(shape) != 3 or shape[0] < 1 or shape[1] != shape[2] or not 1 <= shape[1] <= MOST_STATES:
        raise InputError(
            f"transition: expected the shape (settings, n, n) with 1 to {MOST_STATES} states n, got {shape}"
        )
    settings, n, _ = shape
    at_grip = arrays["input"].shape == (settings, n, SAMPLED_AT_GRIP + 1)
    sampled = SAMPLED_AT_GRIP if at_grip else SAMPLED
    output_shape = (settings, n + sampled + _FEEL)
    known = (settings, 2 * n + sampled + _FEEL + OF_FRICTION)
    if not arrays[FRICTION].size:
        arrays[FRICTION] = np.zeros(known)
    if not arrays["neutral"].size:
        arrays["neutral"] = np.zeros((settings, 2))
    if not arrays[CONTACT].size:
        arrays[CONTACT] = np.zeros((settings, OF_CONTACT))
    shapes = {
        "input": (settings, n, sampled + 1),
        "command": output_shape,
        "torque": output_shape,
        FRICTION: known,
        "neutral": (settings, 2),
        CONTACT: (settings, OF_CONTACT),
    }
    for name, expected in shapes.items():
        if arrays[name].shape != expected:
            raise InputError(f"{name}: expected the shape {expected}, got {arrays[name].shape}")
    for name, array in arrays.items():
        good = np.isfinite(array).reshape(settings, -1).all(axis=1)
        if not good.all():
            raise InputError(f"{name}: expected finite numbers, got one that is not in setting {int(np.argmin(good))}")
    return arrays


def _array(name: str, given: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: expected an array of numbers ({error})") from error


def _settled(law: SampledLaw) -> NDArray[np.float64]:
    """The state at rest per F_c, x_p, theta, F_g where it is sampled, delta, with ``e`` the law's own command.

    ``(I - A - b_e c_xi) xi = (B_y + b_e c_y) y + b_e c_delta delta``
    """
    n, sampled = law.states, law.sampled
    by_signal, by_command = law.input[..., :sampled], law.input[..., sampled:]
    alone = law.transition + by_command @ law.command[:, None, :n]
    # Free of the units of xi, as the condition of the matrix is not.
    nearest = np.abs(np.linalg.eigvals(alone) - 1).min(axis=1)
    if (nearest < _AT_ONE).any():
        raise InputError(
            f"transition: expected a state at rest that is determined, got a pole at 1 in setting {int(np.argmin(nearest))}, "
            "the command of the law itself included; let what integrates there leak"
        )
    moved = by_command @ law.command[:, None, n : n + sampled + 1]
    moved[..., :sampled] += by_signal
    return np.asarray(np.linalg.solve(np.eye(n) - alone, moved), dtype=np.float64)
