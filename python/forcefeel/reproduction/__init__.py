"""Every number and claim of the 1974 report, beside what the models give.

The report's matrices and digits are typed in here as an independent witness; nothing else in the package reads them.
"""

from forcefeel.reproduction.markdown import markdown, summary
from forcefeel.reproduction.run import reproduce
from forcefeel.reproduction.table import Row, Section, Verdict

__all__ = ["Row", "Section", "Verdict", "markdown", "reproduce", "summary"]
