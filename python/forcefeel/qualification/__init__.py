"""Qualification of control feel: rules as data, measuring on records, verdicts."""

from forcefeel.qualification.batch_verdicts import BatchVerdicts, judge_releases
from forcefeel.qualification.figures import Figure
from forcefeel.qualification.judge_release import judge_release
from forcefeel.qualification.judge_sweep import judge_dynamic_sweep, judge_small_inputs, judge_sweep
from forcefeel.qualification.record_file import read_record
from forcefeel.qualification.records import Record
from forcefeel.qualification.release import ReleaseFeatures, measure_release
from forcefeel.qualification.release_batch import ReleaseBatch, measure_releases
from forcefeel.qualification.rules import DEFAULT_EDITION, Rules, Test, editions, load_rules
from forcefeel.qualification.sweep import SweepFeatures, measure_sweep
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.qualification.verdicts import Outcome, Verdict, overall

__all__ = [
    "DEFAULT_EDITION",
    "BatchVerdicts",
    "Figure",
    "Outcome",
    "Record",
    "ReleaseBatch",
    "ReleaseFeatures",
    "Rules",
    "SweepFeatures",
    "Test",
    "Tolerance",
    "Verdict",
    "editions",
    "judge_dynamic_sweep",
    "judge_release",
    "judge_releases",
    "judge_small_inputs",
    "judge_sweep",
    "load_rules",
    "measure_release",
    "measure_releases",
    "measure_sweep",
    "overall",
    "read_record",
]
