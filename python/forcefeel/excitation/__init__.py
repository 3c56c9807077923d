"""The excitation that best determines chosen parameters of a loader within the limits of the bench."""

from forcefeel.excitation.bench_file import write_excitation
from forcefeel.excitation.excite import excite
from forcefeel.excitation.information import NotSeparableError
from forcefeel.excitation.plan import ExcitationPlan
from forcefeel.excitation.result import Excitation, LimitUse

__all__ = ["Excitation", "ExcitationPlan", "LimitUse", "NotSeparableError", "excite", "write_excitation"]
