"""Contact: whether a setting is quiet while the grip is clamped or the column is pushed into a stop.

A clamp holds the grip by a spring and a damper and is tapped; into a stop the grip is pushed without end. A setting swings on if
the force of the contact varies by ``QUIET_N`` or more over the last part of the run, and by no less than ``DECAYED`` of that over
the part before: a spring without damping rings for long, and that is no fault of the loop. One that does is run twice as long.

The load cell's force at the grip is judged likewise, since a column may hold still while its motor buzzes. It has to vary by twice
what the sensors' noise makes of it while nothing touches the column, and by what compensating the column's dry friction takes.
A column that friction or a firm feel holds short of the stop is in no contact, whatever its load cell shows.

A setting is quiet if it does not swing on, and if no stop throws the column back that a hand pushes into it (``strike``).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from math import pi, radians, sqrt
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.strike import strikes
from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.simulation import Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Pulse, Step
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import FORCE, MASS, PERCENT, RATIO, Unit

_STIFFNESS = Unit("N/m", "N/m", "lb/in")

QUIET_N = 8.9
"""2 lb."""

DECAYED = 0.9

TAP_N, TAP_S, PUSH_N = 13.3, 0.05, 8.0
"""3 lb for 50 ms on a clamp, 1.8 lb into a stop."""

STOP_RAD = radians(5.0)
"""Where the stop stands, away from the neutral."""

_CLAMP_S, _STOP_S = 2.0, 4.0
"""Durations. Of their quarters, the last two are compared; then the same of runs twice as long."""

_FREE_S = 3.0
"""Duration of the run without a contact that shows the noise."""

STOPS = [f"{stop}_{side}" for stop in ("column.stop", "feel.soft_stop", "feel.hard_stop") for side in ("low", "high")]
"""Rows of the loader's own stops, which that run omits."""

_OF_NOISE = 2.0
"""Least swing of the load cell's force that is not noise, of the noise's own."""

CONTACT_TIME = 0.9
"""Usual time of a setting in contact, as a share of a release, for progress: on ``elevator-2khz`` and ``elevator-electric``."""

_BATCH = 512
"""Settings whose histories are in memory at once."""


@dataclass(frozen=True)
class Contact:
    """Something stiff at the grip.

    Attributes:
        stop: Whether it is a stop on one side; else a clamp.
        stiffness_n_per_m: Its stiffness at the grip.
        damping_ratio: Its damping, with the column's own inertia and the mass.
        mass_kg: Mass that a clamp adds to the grip.

    Example:
        >>> ff.envelope.Contact(False, 1e4, 0.02, 3.0).name
        'clamp 10,000 N/m, damping 0.02, 3 kg'
    """

    stop: bool
    stiffness_n_per_m: Annotated[float, _STIFFNESS]
    damping_ratio: Annotated[float, RATIO]
    mass_kg: Annotated[float, MASS] = 0.0

    @property
    def name(self) -> str:
        """Its name, such as ``clamp 10,000 N/m, damping 0.02, 3 kg``."""
        mass = f", {self.mass_kg:g} kg" if self.mass_kg else ""
        return f"{self.kind} {self.stiffness_n_per_m:,.0f} N/m, damping {self.damping_ratio:g}{mass}"

    @property
    def kind(self) -> str:
        """``clamp`` or ``stop``."""
        return "stop" if self.stop else "clamp"

    def on(self, loader: Loader) -> Loader:
        """The loader in this contact."""
        arm = loader["column.grip_arm"]
        own = loader["column.inertia"] / arm**2
        damping = 2 * self.damping_ratio * sqrt(self.stiffness_n_per_m * (own + self.mass_kg))
        rows = (
            {
                "column.stop_high": STOP_RAD,
                "column.stop_stiffness": self.stiffness_n_per_m * arm**2,
                "column.stop_damping": damping * arm**2,
                # The feel does not stop before a thing that it does not know of.
                "feel.hard_stop_high": pi,
            }
            if self.stop
            else {
                "pilot.arm_mass": self.mass_kg,
                "pilot.arm_stiffness": self.stiffness_n_per_m,
                "pilot.arm_damping": damping,
            }
        )
        return loader.replace(rows, si=True)


STIFFNESSES = (1e3, 1e4, 3e4, 1e5, 1e6)
"""N/m at the grip: from a firm arm's to a steel stop's."""

SOFT_STOP = 3e3
"""N/m at the grip of a stop against which the most light feels swing on: it pushes the column for as long as a hand would."""

_LITTLE, _SOME, _MUCH = 0.02, 0.1, 0.5
"""Damping ratios: of steel, of a hand, of rubber."""

_DAMPED = (
    Contact(False, 1e4, _SOME),
    Contact(False, 1e6, _SOME),
    Contact(False, 1e4, _SOME, 3.0),
    Contact(False, 1e5, _SOME, 3.0),
    Contact(False, 3e4, _MUCH),
    Contact(True, 3e4, _SOME),
    Contact(True, 1e3, _SOME),
    Contact(True, 1e3, _MUCH),
    Contact(True, 1e6, _MUCH),
)
"""Those in which settings swing on that do so in none with little damping."""

CONTACTS = (
    *(Contact(False, k, _LITTLE, mass) for mass, k in product((0.0, 3.0), STIFFNESSES)),
    *(Contact(True, k, _LITTLE) for k in (1e3, SOFT_STOP, 1e4, 1e5, 1e6)),
    *_DAMPED,
)
"""Contacts of an envelope. Of 3 settings that swing on in one of the 48 of ``benchmarks/contact.py``, 2 do so in one of these;
with 1 lb of dry friction, 41 of 55."""

FEW_CONTACTS = Contact(False, 1e4, _LITTLE), Contact(False, 1e5, _LITTLE), Contact(True, 1e6, _LITTLE)
"""Those by which laws are compared."""


@dataclass(frozen=True)
class ContactShares:
    """Settings of one law that are quiet in contact.

    Attributes:
        law: Its name.
        quiet: Share of the settings that swing on in no contact, and that no stop throws back.
        thrown_back: Share of the settings that a stop throws back.
        fastest_return: Largest rate away from a stop over the rate at which it is struck; NaN if none is.
        largest_force_n: Largest force of any contact with any setting.
        by_contact: Share of the settings that are quiet, by the name of the contact.

    Example:
        >>> grid = {"stiffness": "10, 100 %", "frequency": "1, 2 Hz", "damping": "0.3, 0.7"}
        >>> contacts = (ff.envelope.Contact(False, 1e5, 0.02),)
        >>> few = ff.find_envelope(ff.digital_elevator(), ["robust"], grid, contacts=contacts, changes={}, arms=())
        >>> few.contact_shares("robust").quiet
        1.0
    """

    law: str
    quiet: Annotated[float, PERCENT]
    thrown_back: Annotated[float, PERCENT]
    fastest_return: Annotated[float, RATIO]
    largest_force_n: Annotated[float, FORCE]
    by_contact: Mapping[str, float]


def swings_on(
    loader: Loader, law: Law, feel: NDArray[np.float64], contact: Contact, *, threads: int | None = None
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Whether each setting swings on in a contact, and the contact's largest force in N.

    Args:
        loader: The loader, free.
        law: Law of each setting.
        feel: I, B, G of the settings in SI units, (settings, 3).
        contact: What it touches.
        threads: Number of threads; default: all cores.

    Example:
        >>> loader, feel = ff.digital_elevator(), np.array([[0.5, 1.4, 45.0]])
        >>> law, clamp = ff.Law.of("robust", loader, feel), ff.envelope.Contact(False, 1e5, 0.5)
        >>> [bool(ff.envelope.swings_on(loader, one, feel, clamp)[0][0]) for one in (law, law.without_contact())]
        [False, True]
    """
    touched = _touch(loader, law, feel, contact, threads)
    return touched.swings_on, touched.largest_force_n


@dataclass(frozen=True)
class Touched:
    """Settings in one contact.

    Attributes:
        swings_on: Whether each swings on.
        largest_force_n: Largest force of the contact.
        margin: How far the swing in the end, or the rate away from a stop, is below its limit, as a share of that.
        thrown_back: Whether a stop throws each back.
        returns: Rate away from a stop over the rate at which each strikes it; NaN where none is struck.
    """

    swings_on: NDArray[np.bool_]
    largest_force_n: NDArray[np.float64]
    margin: NDArray[np.float64]
    thrown_back: NDArray[np.bool_]
    returns: NDArray[np.float64]

    @property
    def quiet(self) -> NDArray[np.bool_]:
        """Whether each is quiet."""
        return np.asarray(~(self.swings_on | self.thrown_back))


def touch(loader: Loader, law: Law, feel: NDArray[np.float64], contact: Contact, threads: int | None) -> Touched:
    """What ``swings_on`` tells, by how much, and how fast a stop throws each back; the same arguments."""
    touched = _touch(loader, law, feel, contact, threads)
    if not contact.stop:
        return touched
    struck = strikes(contact.on(loader), law, feel, threads=threads)
    margin = np.fmin(touched.margin, 1 - struck.of_limit)
    return replace(touched, margin=margin, thrown_back=struck.thrown_back, returns=struck.back / struck.came)


def _touch(loader: Loader, law: Law, feel: NDArray[np.float64], contact: Contact, threads: int | None) -> Touched:
    """The same without a strike."""
    duration = _STOP_S if contact.stop else _CLAMP_S
    touched = _run(loader, law, feel, contact, np.zeros(len(feel)), duration, threads)
    # A damped column may come to its stop as late as in the last quarter, and strike it once. What swings may be noise.
    still = np.flatnonzero(touched.swings_on)
    if still.size:
        again = law.some(still), feel[still]
        later = _run(loader, *again, contact, _noise_n(loader, *again, threads), 2 * duration, threads)
        touched.swings_on[still], touched.margin[still] = later.swings_on, later.margin
        touched.largest_force_n[still] = np.maximum(touched.largest_force_n[still], later.largest_force_n)
    return touched


def _noise_n(loader: Loader, law: Law, feel: NDArray[np.float64], threads: int | None) -> NDArray[np.float64]:
    """Swing of the load cell's force at the grip in N by the sensors' noise, of each setting, while nothing touches the column."""
    scenario = Scenario(Step(PUSH_N, start_s=_FREE_S / 3), duration_s=_FREE_S)
    noise = np.zeros(len(feel))
    # A light feel gives way farther than to the loader's own stops.
    endless = loader.replace(dict.fromkeys(STOPS))
    for which, runs in _batches(endless, law, feel, scenario, threads):
        # Sixths of it: the second, before the push, and the last.
        sixth = np.ceil(6 * runs["time_s"] / _FREE_S)
        swings = [np.ptp(runs["load_cell_force_n"][:, sixth == k], axis=1) for k in (2, 6)]
        noise[which] = np.nan_to_num(np.maximum(*swings), nan=np.inf) * _at_grip(loader)
    return noise


def _batches(
    loader: Loader, law: Law, feel: NDArray[np.float64], scenario: Scenario, threads: int | None
) -> Iterator[tuple[NDArray[np.intp], LabeledArrays]]:
    """Histories of some settings after the other."""
    rows = loader.rows(FEEL_SETTING, feel)
    keep = ["column_angle_rad", "load_cell_force_n"]
    for first in range(0, len(feel), _BATCH):
        which = np.arange(first, min(first + _BATCH, len(feel)))
        law_of = law.some(which)
        yield which, batch_outputs(loader, scenario, rows[which], law_of, keep=keep, first_run=None, threads=threads)


def _run(
    loader: Loader,
    law: Law,
    feel: NDArray[np.float64],
    contact: Contact,
    noise: NDArray[np.float64],
    duration_s: float,
    threads: int | None,
) -> Touched:
    """``touch`` by runs of one duration."""
    force = Step(PUSH_N) if contact.stop else Pulse(TAP_N, start_s=0.05, width_s=TAP_S)
    scenario = Scenario(force, duration_s=duration_s)
    swings, forces, margins = np.zeros(len(feel), dtype=bool), np.zeros(len(feel)), np.zeros(len(feel))
    for which, runs in _batches(contact.on(loader), law, feel, scenario, threads):
        angle, cell = runs["column_angle_rad"], runs["load_cell_force_n"] * _at_grip(loader)
        diverged = ~np.isfinite(angle[:, -1])
        angle[diverged] = np.nan_to_num(angle[diverged], nan=np.pi, posinf=np.pi, neginf=-np.pi)
        # Quarters from the end, which is 0.
        quarter = np.ceil(4 * (scenario.duration_s - runs["time_s"]) / scenario.duration_s)
        lowest, highest = _limits(angle, quarter)
        # The force rises with the angle: its limits are those of the angle.
        lowest, highest = _force(contact, loader, lowest), _force(contact, loader, highest)
        forces[which] = np.maximum(np.abs(lowest), np.abs(highest)).max(axis=0)
        cell_lowest, cell_highest = _limits(cell, quarter)
        cell_limit = np.maximum(QUIET_N, _OF_NOISE * noise[which]) + 2 * _friction_n(loader)
        if contact.stop:
            cell_limit[highest[3] <= 0] = np.inf
        swings[which], margins[which] = diverged, 1.0
        for swing, most in ((highest - lowest, QUIET_N), (cell_highest - cell_lowest, cell_limit)):
            before, after = swing[2:4]
            swings[which] |= (after >= most) & (after > DECAYED * before)
            margins[which] = np.minimum(margins[which], 1 - after / most)
    return Touched(swings, forces, margins, np.zeros_like(swings), np.full_like(forces, np.nan))


def _limits(history: NDArray[np.float64], quarter: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Least and largest values of each quarter and at the end, (5, settings) each."""
    parts = [history[:, quarter == k] for k in (4, 3, 2, 1, 0)]
    return tuple(np.stack([limit(part, axis=1) for part in parts]) for limit in (np.min, np.max))


def _friction_n(loader: Loader) -> float:
    """Dry friction of the column: a law that compensates it moves the load cell's force by twice that as the column turns round."""
    return float(max(loader["column.coulomb_friction"], loader["column.static_friction"]))


def _at_grip(loader: Loader) -> float:
    """Force at the grip that the load cell's balances, ``alpha R_b / R_p``."""
    return float(loader["linkage.ratio"] * loader["column.base_arm"] / loader["column.grip_arm"])


def _force(contact: Contact, loader: Loader, angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Force of a contact at column angles."""
    depth = np.maximum(angle - STOP_RAD, 0.0) if contact.stop else angle
    return np.asarray(depth * contact.stiffness_n_per_m * loader["column.grip_arm"])


def quiet_in_few(
    loader: Loader, law: Law, feel: NDArray[np.float64], *, threads: int | None = None
) -> NDArray[np.bool_]:
    """Whether each setting is quiet in all of ``FEW_CONTACTS``; arguments as in ``swings_on``."""
    return np.asarray(np.all([touch(loader, law, feel, contact, threads).quiet for contact in FEW_CONTACTS], axis=0))
