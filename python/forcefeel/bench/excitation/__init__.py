"""The excitation that best determines chosen parameters of a loader within the limits of the bench."""

from forcefeel.bench.excitation.bench_file import write_excitation
from forcefeel.bench.excitation.excite import excite
from forcefeel.bench.excitation.information import NotSeparableError
from forcefeel.bench.excitation.plan import ExcitationPlan
from forcefeel.bench.excitation.result import Excitation, LimitUse

__all__ = ["Excitation", "ExcitationPlan", "LimitUse", "NotSeparableError", "excite", "write_excitation"]
