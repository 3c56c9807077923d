"""Input records from files: recognition of their tests, and checks of pairs that are compared."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from forcefeel.errors import InputError
from forcefeel.files import Kind, input_files, input_kind
from forcefeel.qualification import ForcePoints, Record, Rules, measure_release, read_record
from forcefeel.qualification.plan.plan import SIGNS, SMALL, STATIC, RuleTestCase
from forcefeel.qualification.record_file import read_reference
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.release_part import release_part
from forcefeel.qualification.throw import Throw
from forcefeel.tables.between import ALL, Times
from forcefeel.tables.column_names import ColumnNames
from forcefeel.tables.table_file import ENDINGS

_BOTH_SIDES = 0.3
"""Least excursion of a sweep to either side of its start, as a share of its range."""


@dataclass(frozen=True, eq=False)
class InputRecord:
    """An input record, or points of a static test.

    Attributes:
        record: The record, or points of force over position.
        path: Its file; ``None`` for a record in memory.
    """

    record: Record | ForcePoints
    path: Path | None = None

    @property
    def sha256(self) -> str:
        """Hash of the file, in hexadecimal; empty if it was in memory."""
        return self.record.data_hash


def record_files(option: str, words: Sequence[str], planned: Sequence[RuleTestCase]) -> list[tuple[str, Path]]:
    """The files of an option, each with the name of its test, which is empty if not stated.

    Args:
        option: Name of the option for messages.
        words: ``NAME=FILE``; a file, whose test follows from its name or else from its contents; or a folder of files
            that are named after tests.
        planned: The tests.

    Raises:
        InputError: If a test is unknown, or a folder has no file that is named after a test.
    """
    keys = [trial.key for trial in planned]
    return [pair for word in words for pair in _paths(option, word, keys)]


@dataclass(frozen=True)
class Recognition:
    """Recognition of the test of a record.

    Attributes:
        planned: The tests.
        rules: The rule, with the durations of its sweeps.
        throw: Travel of the control; a release is recognized by its share of it.
        conditions: Flight condition of points, as of ``ForcePoints.of_condition``.
    """

    planned: Sequence[RuleTestCase]
    rules: Rules
    throw: Throw
    conditions: tuple[str, ...] = ()

    def read(
        self, option: str, files: Sequence[tuple[str, Path]], names: ColumnNames, times: Mapping[str, Times]
    ) -> dict[str, InputRecord]:
        """The records by test.

        Args:
            option: Name of the option for messages.
            files: Files as of ``record_files``.
            names: Column names of the files.
            times: First and last time to read, by stem.

        Raises:
            InputError: If a file cannot be read or measured, belongs to no test, or two belong to the same test.
        """
        records: dict[str, InputRecord] = {}
        for stated, path in files:
            between = times.get(path.stem, ALL)
            record = (
                read_reference(path, between_s=between, conditions=self.conditions, **names.arguments(path.stem))
                if option == "--reference"
                else read_record(path, between_s=between, **names.arguments(path.stem))
            )
            key = stated or (STATIC if isinstance(record, ForcePoints) else self._test_of(record))
            if isinstance(record, ForcePoints):
                check_static(record, key)
            elif any(trial.key == key and trial.test.kind == "release" for trial in self.planned):
                record = release_part(record)
            if key in records:
                raise InputError(
                    f"{option}: {path} and {records[key].path} are both for the test {key}; expected one; "
                    f"name each with NAME=FILE, where NAME is one of {', '.join(trial.key for trial in self.planned)}"
                )
            records[key] = InputRecord(record, path)
        return records

    def _test_of(self, record: Record) -> str:
        """The test of a record: a sweep has a force and goes to both sides, a release goes to one."""
        keys = {trial.key for trial in self.planned}
        away = record.position - record.position[0]
        span = float(np.ptp(away))
        if record.body_rate_rad_per_s is not None and SMALL in keys and record.force_n is None:
            return SMALL
        if record.force_n is not None and min(-float(away.min()), float(away.max())) > _BOTH_SIDES * span:
            middles = {sweep.name: sum(sweep.duration_s) / 2 for sweep in self.rules.sweeps}
            nearest = min(middles, key=lambda name: abs(np.log(record.duration_s / middles[name])))
            return STATIC if nearest == "slow" else nearest
        features = measure_release(record, rules=self.rules.release, settle_check=False)
        displaced = features.displacement.value
        sign = 1 if displaced > 0 else -1
        releases: Mapping[float, RuleTestCase] = {
            trial.share: trial for trial in self.planned if trial.test.kind == "release"
        }
        share = (
            displaced / abs(self.throw.end(sign))
            if record.position_unit == "rad"
            else sign * self.rules.release.deflection[1]
        )
        same_side = [share for share in releases if share * sign > 0]
        if not same_side:
            raise InputError(f"{record.name}: is a {SIGNS[sign]} release; {self.rules.id} has none for this axis")
        return releases[min(same_side, key=lambda candidate: abs(candidate - share))].key


def check_static(points: ForcePoints, key: str) -> None:
    """Refuses points for a test other than the static one.

    Raises:
        InputError: If so.
    """
    if key != STATIC:
        raise InputError(
            f"{points.name}: has no column 'time', and {key} is a motion; expected a record over time; points are for {STATIC}"
        )


def check_cover(first: tuple[Record, ReleaseFeatures], other: tuple[Record, ReleaseFeatures]) -> None:
    """Refuses two releases if one record ends while the other still moves.

    Raises:
        InputError: With the shorter record and its end.
    """
    for (short, features), (long, their) in ((first, other), (other, first)):
        lasts = float(short.time_s[-1]) - features.release_s.value
        needed = their.settled_s - their.release_s.value
        if lasts < needed:
            raise InputError(
                f"{short.name}: ends at {short.time_s[-1]:.6g} s, {lasts:.4g} s after its release; {long.name} comes to rest "
                f"{needed:.4g} s after its own; expected records of equal length; record {short.name} for longer"
            )


def _paths(option: str, word: str, keys: Sequence[str]) -> list[tuple[str, Path]]:
    """The files of an argument, each with the name of its test, which is empty if not stated."""
    name, equals, rest = word.partition("=")
    if equals and name in keys:
        return [(name, Path(rest))]
    path = Path(word)
    kind = input_kind(path)
    if equals and kind is None:
        raise InputError(f"{option}: unknown test {name!r}; expected NAME=FILE with NAME one of {', '.join(keys)}")
    if kind is not Kind.FOLDER:
        return [(path.stem if path.stem in keys else "", path)]
    files = [file for file in input_files(path) if file.suffix.lower() in ENDINGS and file.stem in keys]
    if not files:
        raise InputError(
            f"{option}: {path}: no file is named after a test; expected some of {', '.join(keys)}, each with "
            f"{', '.join(ENDINGS)}"
        )
    return [(file.stem, file) for file in files]
