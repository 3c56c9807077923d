"""Runs the tests of a rule on one law or one recorded simulator: measurements, references and verdicts."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.qualification import ForcePoints, Outcome, Record, Rules, Verdict, measure_release
from forcefeel.qualification.figures import Figure
from forcefeel.qualification.plan.feel_alone import FeelAlone
from forcefeel.qualification.plan.input_records import check_cover
from forcefeel.qualification.plan.motions import SHORT, LoopError, Motions, Moved, first_force, release_duration_s
from forcefeel.qualification.plan.plan import STATIC, SURFACE, RuleTestCase, SweepName, duration_s
from forcefeel.qualification.plan.result import Result, Side
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.release_verdicts import Overdamped, judge_release
from forcefeel.qualification.static_points import measure_points
from forcefeel.qualification.sweep import SweepFeatures, measure_sweep
from forcefeel.qualification.sweep_verdicts import judge_dynamic_sweep, judge_small_inputs, judge_sweep
from forcefeel.qualification.throw import Throw
from forcefeel.qualification.verdicts import overall
from forcefeel.simulation.inputs import Recorded
from forcefeel.units import UnitSystem

PROGRAMMED = "programmed feel"
"""Name of the records of the programmed feel."""

_REACH = 0.99 * SHORT
"""Share of the throw at which the farthest points of a reference lie at most, so that a sweep covers them."""

_LONGER = 4.0
"""Factor by which a simulated release is extended, once, if it has not come to rest."""

_ROOM = 0.02
"""Deviation from the rule's shares of the throw that a recorded release may have without a remark."""


_Features = TypeVar("_Features", ReleaseFeatures, SweepFeatures)


class MissingError(Exception):
    """A required input of a test is missing."""


class BrokenError(Exception):
    """A simulated loader fails a test because it cannot be measured."""


@dataclass(frozen=True, eq=False)
class Task:
    """Inputs common to all sections.

    Attributes:
        loader: The loader, hands off.
        feel: Its programmed feel alone.
        motions: Simulates records.
        rules: The rule.
        throw: Travel of the control.
        references: Recorded references by test; empty where the programmed feel is the reference.
        system: Unit system that selects the rule's rounding of forces.
        overdamped: Quantity compared where a response has no overshoot.
        points: Points that are the reference of the static test; ``None`` without.
        programmed: Records of the programmed feel by input, shared by all laws.
    """

    loader: Loader
    feel: FeelAlone
    motions: Motions
    rules: Rules
    throw: Throw
    references: Mapping[str, Record]
    system: UnitSystem
    overdamped: Overdamped
    points: ForcePoints | None = None
    programmed: dict[object, Record] = field(default_factory=dict)

    def once(self, what: object, make: Callable[[], Record]) -> Record:
        """A record of the programmed feel, simulated once.

        Raises:
            MissingError: If it cannot be simulated.
        """
        if what not in self.programmed:
            try:
                self.programmed[what] = make()
            except InputError as error:
                raise MissingError(f"no reference: {error}") from error
        return self.programmed[what]


class TestBench:
    """One simulated loader, or one recorded simulator.

    Args:
        task: Inputs common to all sections.
        name: Name of its records.
        moved: The simulated loader; ``None`` for a recorded simulator.
        records: Records of the simulator by test.
    """

    __test__ = False  # not a test for pytest to collect

    def __init__(self, task: Task, name: str, moved: Moved | None, records: Mapping[str, Record]) -> None:
        self.task, self.name, self.moved, self.records = task, name, moved, records
        self._slow_sweeps: dict[str, tuple[Side, Side]] = {}

    def result(self, trial: RuleTestCase) -> Result:
        """The result of a test.

        Raises:
            InputError: If a record is invalid.
        """
        made: dict[str, Callable[[RuleTestCase], Result]] = {
            "static": self._static,
            "freeplay": self._freeplay,
            "release": self._release,
            "dynamic sweep": self._dynamic,
            "small inputs": self._small,
        }
        try:
            return made[trial.test.kind](trial)
        except MissingError as missing:
            return Result(trial, Outcome.NOT_EVALUATED, reason=str(missing))
        except BrokenError as broken:
            return Result(trial, Outcome.FAILED, reason=str(broken))

    # Releases.

    def _release(self, trial: RuleTestCase) -> Result:
        task, record, recorded_reference = self.task, self._record(trial.key), self._reference(trial.key)
        angle = trial.share * abs(task.throw.end(1 if trial.share > 0 else -1))
        measured = reference = None
        if recorded_reference is not None:
            reference = recorded_reference, measure_release(recorded_reference, rules=task.rules.release)
            angle = reference[1].displacement.value
        if record is not None:
            measured = record, measure_release(record, rules=task.rules.release)
            angle = measured[1].displacement.value
        reference = reference or self._programmed_release(angle, record)
        measured = measured or self._loader_release(angle)
        if record is not None and recorded_reference is not None:
            check_cover(measured, reference)
        in_angle = measured[0].position_unit == "rad"
        verdicts = judge_release(
            measured[1],
            reference[1],
            trial.test,
            travel=task.throw.travel_rad if in_angle else None,
            overdamped=task.overdamped,
            system=task.system,
        )
        remark = self._off_the_rule(angle) if in_angle else ""
        return _judged(trial, verdicts, Side(*measured), Side(*reference), (remark,) if remark else ())

    def _programmed_release(self, angle: float, beside: Record | None) -> tuple[Record, ReleaseFeatures]:
        _angles_only(beside)
        task, lasts = self.task, release_duration_s(self.task.loader)
        record = task.once(("release", angle), lambda: task.motions.release(task.feel, angle, lasts, PROGRAMMED))
        return record, _reference_of(lambda: measure_release(record, rules=task.rules.release))

    def _loader_release(self, angle: float) -> tuple[Record, ReleaseFeatures]:
        duration, task = release_duration_s(self.task.loader), self.task
        for lasts in (duration, _LONGER * duration):
            record = self._simulated(partial(task.motions.release, angle_rad=angle, duration_s=lasts, name=self.name))
            features = _measured(partial(measure_release, record, rules=task.rules.release, settle_check=False))
            if features.settled:
                return record, features
        raise BrokenError(f"{self.name}: does not come to rest within {lasts:.3g} s after the release")

    def _off_the_rule(self, angle: float) -> str:
        least, most = self.task.rules.release.deflection
        share = abs(angle / self.task.throw.end(1 if angle > 0 else -1))
        if least - _ROOM <= share <= most + _ROOM:
            return ""
        return (
            f"Released from {100 * share:.3g} % of the throw; the rule requires {100 * least:g} to {100 * most:g} % of it, or "
            "of the allowed deflection."
        )

    # Sweeps.

    def _static(self, trial: RuleTestCase) -> Result:
        measured, reference = self._slow(STATIC)
        points = self.task.points
        if points is not None:
            reference = Side(points, measure_points(_in_unit(points, measured, self.task.loader["column.grip_arm"])))
        verdicts = judge_sweep(_swept(measured), _swept(reference), trial.test, system=self.task.system)
        kept = tuple(verdict for verdict in verdicts if (verdict.rule.quantity == "surface") is (trial.key == SURFACE))
        if trial.key == SURFACE and all(verdict.outcome is Outcome.NOT_EVALUATED for verdict in kept):
            raise MissingError("both static sweeps require a column 'surface (deg)'")
        return _judged(trial, kept, measured, reference)

    def _freeplay(self, trial: RuleTestCase) -> Result:
        """The rule's freeplay is a length at the grip: ``R_p theta`` for an angle."""
        measured, reference = self._slow(trial.key)
        arm = self.task.loader["column.grip_arm"]
        measured_at_grip, reference_at_grip = (_at_grip(_swept(side), arm) for side in (measured, reference))
        return _judged(
            trial,
            judge_sweep(measured_at_grip, reference_at_grip, trial.test, system=self.task.system),
            measured,
            reference,
        )

    def _slow(self, key: str) -> tuple[Side, Side]:
        """The slow sweeps of loader and reference, run once; recorded sweeps belong to one test each."""
        key = key if self.records or self.task.references else STATIC
        if key not in self._slow_sweeps:
            self._slow_sweeps[key] = self._swept_slowly(key)
        return self._slow_sweeps[key]

    def _swept_slowly(self, key: str) -> tuple[Side, Side]:
        points = self.task.points if key == STATIC else None
        record, recorded_reference = self._record(key), None if points else self._reference(key)
        measured = None if record is None else _side(record)
        reference = None if recorded_reference is None else _side(recorded_reference)
        like = measured if measured is not None else reference
        throw, lasts = self.task.throw, duration_s(self.task.rules, "slow")
        if like is not None and (measured is None or reference is None):
            _angles_only(like.signals)
            swept = _swept(like)
            throw = Throw(swept.stops[0] - swept.neutral, swept.stops[1] - swept.neutral, swept.name)
            lasts = swept.duration_s
        elif points is not None:
            low, high = (
                end(_in_unit(points, None, self.task.loader["column.grip_arm"]).position) for end in (min, max)
            )
            stops = self.task.loader["column.stop_low"], self.task.loader["column.stop_high"]
            low, high = min(throw.low_rad, low / _REACH), max(throw.high_rad, high / _REACH)
            throw = Throw(max(low, stops[0]), min(high, stops[1]), throw.source)
        with ThreadPoolExecutor(1) as beside:  # the engine lets go of the interpreter
            programmed = beside.submit(lambda: reference or self._programmed_slow(throw, lasts))
            return measured or self._loader_slow(throw, lasts), programmed.result()

    def _loader_slow(self, throw: Throw, lasts: float) -> Side:
        first = first_force(self.task.loader, throw)
        record = self._simulated(lambda moved: self.task.motions.swept(moved, throw, first, lasts, self.name))
        return Side(record, _measured(lambda: measure_sweep(record)))

    def _programmed_slow(self, throw: Throw, lasts: float) -> Side:
        task, first = self.task, first_force(self.task.loader, throw)
        record = task.once((throw, lasts), lambda: task.motions.swept(task.feel, throw, first, lasts, PROGRAMMED))
        return Side(record, _reference_of(lambda: measure_sweep(record)))

    def _dynamic(self, trial: RuleTestCase) -> Result:
        name: SweepName = trial.sweep or "slow"
        record, recorded_reference = self._record(trial.key), self._reference(trial.key)
        for what, those in (("record", self.records), ("reference", self.task.references)):
            if those and STATIC not in those:
                raise MissingError(f"requires the slow sweep too: add a {what} for the test {STATIC}")
        slow, slow_reference = self._slow(STATIC)
        measured = _side(record) if record is not None else None
        reference = _side(recorded_reference) if recorded_reference is not None else None
        if measured is None:
            measured = self._loader_fast(slow, recorded_reference, name)
        if reference is None:
            reference = self._programmed_fast(slow_reference, record, name)
        sides = (
            Side(measured.record, measured.features, _swept(slow)),
            Side(reference.record, reference.features, _swept(slow_reference)),
        )
        verdicts = judge_dynamic_sweep(
            _swept(measured),
            _swept(slow),
            _swept(reference),
            _swept(slow_reference),
            trial.test,
            system=self.task.system,
        )
        return _judged(trial, verdicts, *sides)

    def _loader_fast(self, slow: Side, recorded_reference: Record | None, name: SweepName) -> Side:
        """The loader under the recorded reference's force, or under that of its slow sweep in less time."""
        force = _force_of(recorded_reference) if recorded_reference is not None else self._quicker(slow, name)
        record = self._simulated(lambda moved: self.task.motions.forced(moved, force, self.name))
        return Side(record, _measured(lambda: measure_sweep(record)))

    def _programmed_fast(self, slow: Side, recorded: Record | None, name: SweepName) -> Side:
        _angles_only(recorded)
        task, force = self.task, _force_of(recorded) if recorded is not None else self._quicker(slow, name)
        record = task.once((name, id(slow.record)), lambda: task.motions.forced(task.feel, force, PROGRAMMED))
        return Side(record, _reference_of(lambda: measure_sweep(record)))

    def _quicker(self, slow: Side, name: SweepName) -> Recorded:
        """The force of a slow sweep, compressed to the duration of another."""
        record, lasts = slow.signals, duration_s(self.task.rules, name)
        time = (record.time_s - record.time_s[0]) * (lasts / record.duration_s)
        assert record.force_n is not None  # it was swept
        return Recorded(time, record.force_n, name)

    # Small inputs, and helpers of all tests.

    def _small(self, trial: RuleTestCase) -> Result:
        record, recorded_reference = self._record(trial.key), self._reference(trial.key)
        if record is None or recorded_reference is None:
            raise MissingError("requires a record and a reference, each with a column 'body rate (deg/s)'")
        return _judged(
            trial, judge_small_inputs(record, recorded_reference, trial.test), Side(record), Side(recorded_reference)
        )

    def _record(self, key: str) -> Record | None:
        """The record of a test; ``None`` where the loader is simulated."""
        if self.moved is not None:
            return None
        if key not in self.records:
            raise MissingError("no record")
        return self.records[key]

    def _reference(self, key: str) -> Record | None:
        """The recorded reference of a test; ``None`` where the programmed feel is the reference."""
        if not self.task.references:
            return None
        if key not in self.task.references:
            raise MissingError("no reference")
        return self.task.references[key]

    def _simulated(self, make: Callable[[Moved], Record]) -> Record:
        assert self.moved is not None  # records are checked first
        try:
            return make(self.moved)
        except LoopError as error:
            raise BrokenError(f"{self.name}: {error}") from error


def _judged(
    trial: RuleTestCase, verdicts: tuple[Verdict, ...], measured: Side, reference: Side, remarks: tuple[str, ...] = ()
) -> Result:
    return Result(trial, overall(verdicts), verdicts, measured, reference, remarks=remarks)


def _measured(measure: Callable[[], _Features]) -> _Features:
    """Features of a simulated loader; its record is complete, so a failed measurement is a failure of the loader."""
    try:
        return measure()
    except InputError as error:
        raise BrokenError(str(error)) from error


def _reference_of(measure: Callable[[], _Features]) -> _Features:
    """Features of the programmed feel; if they cannot be measured, there is no reference."""
    try:
        return measure()
    except InputError as error:
        raise MissingError(f"no reference: {error}") from error


def _side(record: Record) -> Side:
    return Side(record, measure_sweep(record))


def _swept(side: Side) -> SweepFeatures:
    assert isinstance(side.features, SweepFeatures)  # a sweep's result
    return side.features


def _in_unit(points: ForcePoints, measured: Side | None, grip_arm_m: float) -> ForcePoints:
    """Points in the position's unit of the sweep that is judged; of a simulated loader, rad."""
    unit = "rad" if measured is None else measured.record.position_unit
    if points.position_unit == unit:
        return points
    scale = grip_arm_m if unit == "m" else 1 / grip_arm_m
    return replace(points, position=points.position * scale, position_unit=unit)


def _at_grip(swept: SweepFeatures, grip_arm_m: float) -> SweepFeatures:
    """The features with freeplay as a length at the grip; other figures are unchanged."""
    if swept.position_unit == "m":
        return swept
    play = swept.freeplay
    at_grip = Figure(grip_arm_m * play.value, grip_arm_m * play.uncertainty, "m")
    return replace(swept, freeplay=at_grip, position_unit="m")


def _force_of(record: Record) -> Recorded:
    assert record.force_n is not None  # it was measured as a sweep
    return Recorded(record.time_s, record.force_n, record.name).from_zero()


def _angles_only(record: Record | None) -> None:
    if record is not None and record.position_unit != "rad":
        raise MissingError(
            f"{record.name}: position: expected an angle, as of the programmed feel, got a length; add a recorded reference"
        )
