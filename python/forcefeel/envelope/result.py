"""Envelope result: outcome at each setting for each law and case, shares, and the smallest feel."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case, Kind
from forcefeel.envelope.contact import ContactShares
from forcefeel.envelope.forbidden import NOISE, Forbidden, forbidden
from forcefeel.envelope.passivity import Passivity
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.softening import SoftenedShares
from forcefeel.errors import InputError
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import ANGLE, HERTZ, INERTIA, PERCENT, ROTARY_STIFFNESS, UnitSystem, show, to_text
from forcefeel.wilson import wilson_interval

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

PASSES, UNSTABLE, NOT_HELD = "passes", "unstable", "force not held"
"""Outcomes other than the first failing figure. ``NOT_HELD``: the release passes, but the motor cannot hold the force before it."""


class Failure(StrEnum):
    """Why a setting does not pass, in the order of the rule; gives the color on a map."""

    DRIVE = "forbidden by the drive"
    NOISE = "forbidden by the sensors' noise"
    UNSTABLE = "unstable"
    FALL = "fall time"
    FIRST_CROSSING = "first crossing, P0"
    CYCLES = "later cycles, P1 and on"
    OVERSHOOTS = "size of overshoots"
    COUNT = "number of overshoots"
    REST = "rest, or none reached"


EVERY, NOMINAL = "passes in every case", "passes nominally only"

COLORS = {
    EVERY: "#009E73",
    NOMINAL: "#A9E3CC",
    Failure.FIRST_CROSSING: "#0072B2",
    Failure.CYCLES: "#74C1EE",
    Failure.OVERSHOOTS: "#E69F00",
    Failure.COUNT: "#F6E65A",
    Failure.FALL: "#CC79A7",
    Failure.REST: "#9AA3AD",
    Failure.DRIVE: "#8C510A",
    Failure.NOISE: "#DFB98C",
    Failure.UNSTABLE: "#2B2B2B",
}
"""Color of each outcome on every map: Okabe and Ito's hues for color blindness; lightness differs too, for print without color."""


def failure_of(outcome: str) -> Failure | None:
    """Kind of failure of an outcome; ``None`` for a pass."""
    if outcome == PASSES:
        return None
    if outcome in {UNSTABLE, NOT_HELD}:
        return Failure.UNSTABLE if outcome == UNSTABLE else Failure.DRIVE
    if outcome == "P0":
        return Failure.FIRST_CROSSING
    if outcome in {"overshoots", "first overshoot"}:
        return Failure.COUNT
    if outcome in {"fall time", "rise time"}:
        return Failure.FALL
    if outcome[:1] in {"P", "A"} and outcome[1:].isdecimal():
        return Failure.CYCLES if outcome[0] == "P" else Failure.OVERSHOOTS
    return Failure.REST


@dataclass(frozen=True)
class Shares:
    """Shares of all settings for one law.

    Attributes:
        law: Its name.
        stable: Stable with the nominal plant, hands off.
        nominal_share: Passes the release test with the nominal plant, hands off.
        stable_worst: Stable in every case.
        worst_case_share: Passes in every case.
    """

    law: str
    stable: Annotated[float, PERCENT]
    nominal_share: Annotated[float, PERCENT]
    stable_worst: Annotated[float, PERCENT]
    worst_case_share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class DrawnShares:
    """Shares of one law on machines drawn with all tolerances at once.

    Attributes:
        law: Its name.
        machines: Number of machines.
        settings: Share of the settings that pass in at least ``MOST`` of the machines.
        good: Share of the machines that pass at ``MOST`` of the settings or more.
        good_low, good_high: Wilson's interval of this share, confidence 95 %.
        passes: Share of the settings at which a machine passes, mean of all machines.
        least: The same for the worst machine.
    """

    law: str
    machines: int
    settings: Annotated[float, PERCENT]
    good: Annotated[float, PERCENT]
    good_low: Annotated[float, PERCENT]
    good_high: Annotated[float, PERCENT]
    passes: Annotated[float, PERCENT]
    least: Annotated[float, PERCENT]


@dataclass(frozen=True)
class AllowedShares:
    """Shares of one law among the settings that drive and sensors allow; NaN if they allow none.

    Attributes:
        law: Its name.
        settings: Number of allowed settings.
        nominal_share: Passes with the nominal plant, hands off.
        worst_case_share: Passes in every case.
    """

    law: str
    settings: int
    nominal_share: Annotated[float, PERCENT]
    worst_case_share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class AngleShares:
    """Shares at one release angle with the nominal plant, hands off; noise counts more at smaller angles.

    Attributes:
        release_rad: Release angle.
        allowed: Share of the settings that drive and sensors allow at this angle.
        passes: Share of all settings that pass, by law.
    """

    release_rad: Annotated[float, ANGLE]
    allowed: Annotated[float, PERCENT]
    passes: Mapping[str, float]


MOST = 0.95
"""Share of machines or settings that counts as most of them."""


@dataclass(frozen=True)
class EvenShares:
    """Shares of one law with logarithmic weights along stiffness, frequency and damping ratio.

    Attributes:
        law: Its name.
        nominal_share: Passes with the nominal plant, hands off.
        worst_case_share: Passes in every case.
    """

    law: str
    nominal_share: Annotated[float, PERCENT]
    worst_case_share: Annotated[float, PERCENT]


@dataclass(frozen=True)
class CaseShares:
    """Shares of one case.

    Attributes:
        case: Its name.
        stable, passes: Shares of all settings.
        lost: Share of the nominal passes that fail in this case; NaN without nominal passes.
        verified: Whether the case's numbers were verified against a source.
        inferred: Number of settings whose outcome is inferred from their neighbors.
    """

    case: str
    stable: Annotated[float, PERCENT]
    passes: Annotated[float, PERCENT]
    lost: Annotated[float, PERCENT]
    verified: bool
    inferred: int


@dataclass(frozen=True)
class Smallest:
    """Smallest inertia and smallest stiffness that a law renders on the grid.

    Attributes:
        law: Its name.
        worst: Of the passes in every case instead of the nominal passes.
        inertia_n_m_s2_per_rad: Smallest I; NaN if no setting passes.
        stiffness_n_m_per_rad: Smallest G.
        inertia_share: The smallest I as a share of the column's own inertia J.
        stiffness_share: The smallest G as a share of G_max.
        frequency_rad_per_s: Highest natural frequency that passes.
    """

    law: str
    worst: bool
    inertia_n_m_s2_per_rad: Annotated[float, INERTIA]
    stiffness_n_m_per_rad: Annotated[float, ROTARY_STIFFNESS]
    inertia_share: Annotated[float, PERCENT]
    stiffness_share: Annotated[float, PERCENT]
    frequency_rad_per_s: Annotated[float, HERTZ]


@dataclass(frozen=True, eq=False)
class Envelope:
    """A computed envelope.

    Attributes:
        plan: Its plan.
        arrays: ``outcome`` (law, case, damping, frequency, stiffness), an index into ``outcomes``, and ``margin``, the smallest
            margin as a share of its tolerance: 1 exact, 0 at the limit, NaN if not measurable. With drawn machines also
            ``drawn_outcome`` and ``drawn_margin`` (.., machine, ..), and ``off`` (machine, parameter), the deviation of each
            parameter as a share of its value. With contacts also, over (law,
            contact, ..), ``swings_on``, ``thrown_back`` and ``contact_inferred``, and NaN where inferred: ``largest_force_n`` and
            ``returns``, the rate away from a stop over the rate at which the column strikes it, NaN in a clamp too.
            ``data`` is the same as a data set of xarray.
        outcomes: ``passes``, ``unstable``, then the figures that can fail first, by the rule's names.
        passivity: Passivity of the grip, by law.
        smaller: Shares at the angles of ``Plan.smaller_rad``.
        law_remarks: Remarks on laws designed for another loader: ``Law.made_for_another``.
        softened: Shares as programmed, softened and not at all, by law; empty without ``Plan.soften``.

    Example:
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> ff.find_envelope(ff.elevator(), ["original"], grid).laws
        ('original',)
    """

    plan: Plan
    arrays: LabeledArrays
    outcomes: tuple[str, ...]
    passivity: Mapping[str, Passivity]
    smaller: tuple[AngleShares, ...] = ()
    law_remarks: tuple[str, ...] = ()
    softened: tuple[SoftenedShares, ...] = ()

    @property
    def data(self) -> "xr.Dataset":
        """The arrays as a data set of xarray, an extra."""
        return self.arrays.dataset

    def __repr__(self) -> str:
        all_shares = map(self.shares, self.laws)
        each = "; ".join(
            f"{shares.law} passes at {shares.nominal_share:.1%}, in every case at {shares.worst_case_share:.1%}"
            for shares in all_shares
        )
        return f"<Envelope of {self.plan.given.name!r}, {self.plan.settings.count:,} settings: {each}>"

    def plot(
        self,
        law: str | None = None,
        *,
        damping: float | None = None,
        worst: bool = True,
        units: UnitSystem = UnitSystem.SI,
        ax: "Axes | None" = None,
    ) -> "Axes":
        """Draw the map of passes and first failures over stiffness and natural frequency.

        Args:
            law: Name of the law; default: the last.
            damping: Damping ratio of the map; the nearest value of the grid is taken. Default: that of the loader.
            worst: Color by the failure in the first failing case instead of the nominal failure.
            units: Units of the labels.
            ax: Matplotlib axes; default: a new figure.

        Returns:
            The axes.

        Raises:
            InputError: If the envelope does not contain the law.

        Example:
            >>> grid = {"stiffness": "5..100 %:4:log", "frequency": "1..4 Hz:3", "damping": "0.3, 0.7"}
            >>> envelope = ff.find_envelope(ff.elevator(), ["converged"], grid)
            >>> envelope.plot(damping=0.7).get_ylabel()
            'Natural frequency, Hz'
        """
        from forcefeel.plots.draw import cells  # noqa: PLC0415  loads Matplotlib only for plots

        name = self.laws[-1] if law is None else law
        if name not in self.laws:
            raise InputError(f"law: expected one of {', '.join(self.laws)}, got {show(name)}")
        settings, loader = self.plan.settings, self.plan.given
        inertia, friction, stiffness = (loader[key] for key in FEEL_SETTING)
        frequency = (stiffness / inertia) ** 0.5
        nearest_to = friction / (2 * inertia * frequency) if damping is None else damping
        row = int(np.argmin(np.abs(np.array(settings.damping) - nearest_to)))
        return cells(
            self.kinds(name, worst=worst)[row],
            COLORS,
            100 * np.array(settings.stiffness),
            HERTZ.from_si(1.0, units) * np.array(settings.frequency),
            labels=(
                "Stiffness, % of $G_{max}$",
                f"Natural frequency, {HERTZ.shown(units)}",
                f"{loader.name}, {name}: damping ratio {to_text(settings.damping[row], 3)}, {'every case' if worst else 'nominal'}",
            ),
            own=(100 * stiffness / loader["feel.maximum_stiffness"], HERTZ.from_si(frequency, units)),
            ax=ax,
        )

    @cached_property
    def _codes(self) -> NDArray[np.int8]:
        """Outcomes (law, case, settings)."""
        values = self.arrays["outcome"]
        return np.asarray(values.reshape(*values.shape[:2], -1))

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(self.plan.laws)

    def codes(self, law: str) -> NDArray[np.int8]:
        """Outcomes (case, settings) of a law."""
        return np.asarray(self._codes[self.laws.index(law)])

    def passes(self, law: str) -> NDArray[np.bool_]:
        """Which settings pass (case, settings)."""
        return np.asarray(self.codes(law) == 0)

    def stable(self, law: str) -> NDArray[np.bool_]:
        """Which settings are stable (case, settings)."""
        return np.asarray(self.codes(law) != self.outcomes.index(UNSTABLE))

    def contact_shares(self, law: str) -> ContactShares:
        """Settings that are quiet in contact.

        Raises:
            InputError: If the plan has no contacts.
        """
        if not self.plan.contacts:
            raise InputError(
                "contacts: the envelope was made without; give find_envelope some, such as Contact(True, 1e6, 0.02)"
            )
        row = self.laws.index(law)
        swings, thrown = (
            self.arrays[name][row].reshape(len(self.plan.contacts), -1) for name in ("swings_on", "thrown_back")
        )
        quiet = ~(swings | thrown)
        names = [contact.name for contact in self.plan.contacts]
        by_contact = dict(zip(names, quiet.mean(axis=1).tolist(), strict=True))
        force = float(np.nanmax(self.arrays["largest_force_n"][row]))
        fastest = float(np.fmax.reduce(self.arrays["returns"][row], axis=None))
        return ContactShares(
            law, float(quiet.all(axis=0).mean()), float(thrown.any(axis=0).mean()), fastest, force, by_contact
        )

    def shares(self, law: str) -> Shares:
        """Shares of all settings for a law."""
        stable, passes = self.stable(law), self.passes(law)
        masks = (stable[0], passes[0], stable.all(axis=0), passes.all(axis=0))
        return Shares(law, *(float(which.mean()) for which in masks))

    def allowed_shares(self, law: str) -> AllowedShares:
        """Shares of a law among the settings that are not forbidden to every law."""
        allowed, passes = ~self.forbidden.settings, self.passes(law)
        both = np.stack([passes[0], passes.all(axis=0)])[:, allowed]
        shares = both.mean(axis=1).tolist() if allowed.any() else [np.nan, np.nan]
        return AllowedShares(law, int(allowed.sum()), *shares)

    @property
    def inferred(self) -> int:
        """Number of outcomes, of cases and drawn machines, that are inferred from neighboring settings."""
        names = ("inferred", "drawn_inferred")
        return sum(int(self.arrays[name].sum()) for name in names if name in self.arrays)

    @property
    def contacts_inferred(self) -> int:
        """Number of outcomes in contact that are inferred likewise."""
        return int(self.arrays["contact_inferred"].sum()) if self.plan.contacts else 0

    @property
    def by_angle(self) -> tuple[AngleShares, ...]:
        """Nominal shares over the release angle: the plan's own angle first, then its smaller ones."""
        passes = {name: float(self.passes(name)[0].mean()) for name in self.laws}
        own = AngleShares(self.plan.release_rad, 1 - float(self.forbidden.settings.mean()), passes)
        return (own, *self.smaller)

    def even_shares(self, law: str) -> EvenShares:
        """Shares with logarithmic weights of the settings: ``Settings.weights``."""
        passes, weights = self.passes(law), self.plan.settings.weights
        return EvenShares(law, float(weights[passes[0]].sum()), float(weights[passes.all(axis=0)].sum()))

    def drawn_shares(self, law: str) -> DrawnShares:
        """Shares of a law on the drawn machines.

        Raises:
            InputError: If the envelope has no drawn machines.
        """
        if not self.plan.machines:
            raise InputError("draws: expected drawn machines, got none; compute the envelope with draws")
        index, machines = self.laws.index(law), len(self.plan.machines)
        passes = self.arrays["drawn_outcome"][index].reshape(machines, -1) == 0
        share = passes.mean(axis=1)
        good = int((share >= MOST).sum())
        return DrawnShares(
            law,
            machines,
            float((passes.mean(axis=0) >= MOST).mean()),
            good / machines,
            *wilson_interval(good, machines),
            float(share.mean()),
            float(share.min()),
        )

    def case_shares(self, law: str) -> tuple[CaseShares, ...]:
        """Shares of a law in each case."""
        stable, passes = self.stable(law), self.passes(law)
        lost = passes[0] & ~passes
        nominal = int(passes[0].sum())
        inferred = self.arrays["inferred"][self.laws.index(law)].reshape(len(self.plan.cases), -1).sum(axis=1)
        return tuple(
            CaseShares(
                case.name,
                float(stable[k].mean()),
                float(passes[k].mean()),
                float(lost[k].sum()) / nominal if nominal else np.nan,
                case.verified,
                int(inferred[k]),
            )
            for k, case in enumerate(self.plan.cases)
        )

    def failures(self, law: str, *, worst: bool = False) -> NDArray[np.int8]:
        """Why each setting fails (damping, frequency, stiffness): index in ``Failure``, -1 for a pass.

        Args:
            law: Its name.
            worst: Of the first failing case instead of the nominal one; instability in any case comes first.
        """
        order = list(Failure)
        kinds = [failure_of(outcome) for outcome in self.outcomes]
        table = np.array([-1 if kind is None else order.index(kind) for kind in kinds], dtype=np.int8)
        failing_kinds = table[self.codes(law)]
        if worst:
            first = np.argmax(failing_kinds >= 0, axis=0)
            failing = np.take_along_axis(failing_kinds, first[np.newaxis], axis=0)[0]
            kinds_at = np.where(
                (failing_kinds == order.index(Failure.UNSTABLE)).any(axis=0), order.index(Failure.UNSTABLE), failing
            )
        else:
            kinds_at = failing_kinds[0]
        for which, kind in ((self.forbidden.settings, Failure.DRIVE), (self.forbidden.of(NOISE), Failure.NOISE)):
            kinds_at = np.where((kinds_at >= 0) & which, order.index(kind), kinds_at)
        return np.asarray(kinds_at.astype(np.int8).reshape(self.plan.settings.shape))

    def kinds(self, law: str, *, worst: bool) -> NDArray[np.int8]:
        """Outcome of each setting (damping, frequency, stiffness): index in ``COLORS``."""
        order = list(COLORS)
        table = np.array([order.index(kind) for kind in Failure], dtype=np.int8)
        failing = self.failures(law, worst=worst)
        every = self.passes(law).all(axis=0).reshape(failing.shape)
        passing = np.where(every, order.index(EVERY), order.index(NOMINAL)).astype(np.int8)
        return np.asarray(np.where(failing < 0, passing, table[failing]))

    @cached_property
    def forbidden(self) -> Forbidden:
        """Settings that no law renders, released from the plan's angle."""
        return forbidden(self.plan)

    def failure_shares(self, law: str) -> dict[Failure, float]:
        """Share of all settings for each reason of nominal failure."""
        failures = self.failures(law)
        return {kind: float((failures == index).mean()) for index, kind in enumerate(Failure)}

    def smallest(self, law: str, *, worst: bool = False) -> Smallest:
        """Smallest inertia and stiffness that a law renders."""
        passes = self.passes(law)
        which = passes.all(axis=0) if worst else passes[0]
        loader = self.plan.loader
        if not which.any():
            return Smallest(law, worst, *[np.nan] * 5)
        inertia, _, stiffness = self.plan.settings.feel(loader)[which].T
        return Smallest(
            law,
            worst,
            float(inertia.min()),
            float(stiffness.min()),
            float(inertia.min() / loader["column.inertia"]),
            float(stiffness.min() / loader["feel.maximum_stiffness"]),
            float(self.plan.settings.rows[which, 1].max()),
        )

    def case(self, name: str) -> Case:
        """The case with this name."""
        return next(case for case in self.plan.cases if case.name == name)

    def worst_case(self, law: str, kind: Kind) -> CaseShares | None:
        """The case of a kind with the largest loss; ``None`` without a loss."""
        rows = [
            row
            for row, case in zip(self.case_shares(law), self.plan.cases, strict=True)
            if case.kind is kind and row.lost > 0
        ]
        return max(rows, key=lambda row: row.lost, default=None)
