"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.design.analysis import Analysis as Analysis
from forcefeel.design.assessment import Assessment as Assessment
from forcefeel.design.assessment import MotorPeaks as MotorPeaks
from forcefeel.design.assessment import Peaks as Peaks
from forcefeel.design.assessment import assess as assess
from forcefeel.design.assessment import peaks as peaks
from forcefeel.design.figure import Figure as Figure
from forcefeel.design.figure_data import figures as figures
from forcefeel.design.findings import conclusions as conclusions
from forcefeel.design.law_comparison import LawComparison as LawComparison
from forcefeel.design.law_comparison import LawResult as LawResult
from forcefeel.design.motor import MotorAnalysis as MotorAnalysis
from forcefeel.design.motor_design import MotorDesign as MotorDesign
from forcefeel.design.motor_design import design_motor as design_motor
from forcefeel.design.page.page import write_report as write_report
from forcefeel.design.studies import Deviation as Deviation
from forcefeel.design.studies import DroppedPaths as DroppedPaths
from forcefeel.design.studies import drop_paths as drop_paths
from forcefeel.design.studies import sensitivity as sensitivity
from forcefeel.design.workflow import Design as Design
from forcefeel.design.workflow import ServoAnalysis as ServoAnalysis
from forcefeel.design.workflow import analyze as analyze
from forcefeel.design.workflow import design_loader as design_loader
from forcefeel.design.workflow import design_servo as design_servo
