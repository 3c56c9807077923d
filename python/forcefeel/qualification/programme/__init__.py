"""Qualification runs: the programme of a rule's tests, made on a simulated loader or on recorded files."""

from forcefeel.qualification.programme.result import Qualification, Result, Section, Standing
from forcefeel.qualification.programme.run import QualificationSetup, qualify_loader

__all__ = ["Qualification", "QualificationSetup", "Result", "Section", "Standing", "qualify_loader"]
