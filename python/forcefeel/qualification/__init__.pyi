"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.qualification.batch_verdicts import judge_releases as judge_releases
from forcefeel.qualification.force_points import ForcePoints as ForcePoints
from forcefeel.qualification.force_points import read_force_points as read_force_points
from forcefeel.qualification.own_checks import OwnCheck as OwnCheck
from forcefeel.qualification.page.page import write_qualification as write_qualification
from forcefeel.qualification.plan.cockpit import CockpitQualification as CockpitQualification
from forcefeel.qualification.plan.cockpit import qualify_cockpit as qualify_cockpit
from forcefeel.qualification.plan.result import Qualification as Qualification
from forcefeel.qualification.plan.run import QualificationSetup as QualificationSetup
from forcefeel.qualification.plan.run import qualify_loader as qualify_loader
from forcefeel.qualification.record_file import read_record as read_record
from forcefeel.qualification.records import Record as Record
from forcefeel.qualification.release import measure_release as measure_release
from forcefeel.qualification.release_batch import measure_releases as measure_releases
from forcefeel.qualification.release_verdicts import judge_release as judge_release
from forcefeel.qualification.rules import DEFAULT_EDITION as DEFAULT_EDITION
from forcefeel.qualification.rules import Rules as Rules
from forcefeel.qualification.rules import editions as editions
from forcefeel.qualification.rules import load_rules as load_rules
from forcefeel.qualification.sweep import measure_sweep as measure_sweep
from forcefeel.qualification.sweep_verdicts import judge_sweep as judge_sweep
from forcefeel.qualification.verdicts import Outcome as Outcome
from forcefeel.qualification.verdicts import Verdict as Verdict
