"""Records that were handed over as files: which test each is of, and what is wrong with two that do not go together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from forcefeel.errors import InputError
from forcefeel.files import Kind, input_files, input_kind
from forcefeel.qualification import Record, Rules, measure_release, read_record
from forcefeel.qualification.plan.plan import SIGNS, SMALL, STATIC, RuleTestCase
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.release_part import release_part
from forcefeel.qualification.throw import Throw
from forcefeel.tables.between import ALL, Times
from forcefeel.tables.column_names import ColumnNames
from forcefeel.tables.table_file import ENDINGS

_BOTH_SIDES = 0.3
"""Of its range a record goes to either side of where it began at least, if it is a sweep."""


@dataclass(frozen=True, eq=False)
class Given:
    """A record that was handed over.

    Attributes:
        record: What is in it.
        path: Where it was read; ``None`` of one that was in memory.
    """

    record: Record
    path: Path | None = None

    @property
    def sha256(self) -> str:
        """Hash of the file, in hexadecimal; empty if it was in memory."""
        return self.record.data_hash


def given_files(option: str, words: Sequence[str], planned: Sequence[RuleTestCase]) -> list[tuple[str, Path]]:
    """The files that an option names, each with its test, empty where that is not said.

    Args:
        option: What a message names.
        words: ``NAME=FILE``; a file by itself, whose test is that of its name or else seen from what is in it; or a folder,
            all of whose files are named after tests.
        planned: The tests there are.

    Raises:
        InputError: If a test is unknown or a folder has no such file.
    """
    keys = [trial.key for trial in planned]
    return [pair for word in words for pair in _paths(option, word, keys)]


@dataclass(frozen=True)
class Recognition:
    """What tells which test a record is of.

    Attributes:
        planned: The tests there are.
        rules: How long sweeps last.
        throw: Where the control ends, for a release that is told by its share of it.
    """

    planned: Sequence[RuleTestCase]
    rules: Rules
    throw: Throw

    def read(
        self, option: str, files: Sequence[tuple[str, Path]], names: ColumnNames, times: Mapping[str, Times]
    ) -> dict[str, Given]:
        """The records by the test they are of.

        Args:
            option: What a message names.
            files: As of ``given_files``.
            names: What the files call their columns.
            times: Between which times they are read, by stem.

        Raises:
            InputError: If a file cannot be read or measured, is of no test, or two are of one.
        """
        records: dict[str, Given] = {}
        for stated, path in files:
            record = read_record(path, between_s=times.get(path.stem, ALL), **names.arguments(path.stem))
            key = stated or self._test_of(record)
            if any(trial.key == key and trial.test.kind == "release" for trial in self.planned):
                record = release_part(record)
            if key in records:
                raise InputError(
                    f"{option}: {path} and {records[key].path} are both for the test {key}; expected one; "
                    f"name each with NAME=FILE, where NAME is one of {', '.join(trial.key for trial in self.planned)}"
                )
            records[key] = Given(record, path)
        return records

    def _test_of(self, record: Record) -> str:
        """The test that a record is of: a sweep goes to both sides with a force, a release to one."""
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
            raise InputError(
                f"{record.name}: is a {SIGNS[sign]} release, of which {self.rules.id} has none for this axis"
            )
        return releases[min(same_side, key=lambda candidate: abs(candidate - share))].key


def check_cover(first: tuple[Record, ReleaseFeatures], other: tuple[Record, ReleaseFeatures]) -> None:
    """Refuses two releases of which one ends while the other still moves.

    Raises:
        InputError: With the one that is too short, and the time at which it ends.
    """
    for (short, features), (long, their) in ((first, other), (other, first)):
        lasts = float(short.time_s[-1]) - features.release_s.value
        needed = their.settled_s - their.release_s.value
        if lasts < needed:
            raise InputError(
                f"{short.name}: ends at {short.time_s[-1]:.6g} s, {lasts:.4g} s after its release; {long.name} comes to rest "
                f"{needed:.4g} s after its own; expected records of one length; record {short.name} for longer"
            )


def _paths(option: str, word: str, keys: Sequence[str]) -> list[tuple[str, Path]]:
    """The files of a word, each with its test, empty where it is not said."""
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
            f"{option}: {path}: has no file that is named after a test; expected some of {', '.join(keys)}, each with "
            f"{', '.join(ENDINGS)}"
        )
    return [(file.stem, file) for file in files]
