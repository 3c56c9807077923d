"""Qualification runs: the tests of a rule on a simulated loader or on recorded files."""

from forcefeel.qualification.plan.result import Qualification, QualificationStatus, Result, Section
from forcefeel.qualification.plan.run import QualificationSetup, qualify_loader

__all__ = ["Qualification", "QualificationSetup", "QualificationStatus", "Result", "Section", "qualify_loader"]
