"""What a law can be exported to."""

from enum import StrEnum


class Target(StrEnum):
    """Where a law goes.

    Example:
        >>> import forcefeel as ff
        >>> [target.value for target in ff.export.Target]
        ['c', 'matlab', 'table']
    """

    C = "c"
    """C99 of law and feel for one axis, with golden vectors."""
    MATLAB = "matlab"
    """Matrices of law and plant for MATLAB, Octave and Python, the loop that they close, and the numbers that must come out."""
    TABLE = "table"
    """What the parameter sheet of a drive or a PLC wants, as CSV."""
