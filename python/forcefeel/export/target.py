"""Targets of an export."""

from enum import StrEnum


class Target(StrEnum):
    """Target of an export."""

    C = "c"
    """C99 of law and feel for one axis, with golden vectors."""
    FIRMWARE = "firmware"
    """Law, feel and supervisor for one axis as a static library for a target, with a C header and golden vectors."""
    FMU = "fmu"
    """Loader, law and machine as FMUs for co-simulation, of FMI 2.0 and 3.0."""
    MATLAB = "matlab"
    """Matrices of law and plant for MATLAB, Octave and Python, with scripts for the closed loop and expected results."""
    OPENFFBOARD = "openffboard"
    """Feel as serial commands of the OpenFFBoard firmware, with what its effects do not render."""
    ST = "st"
    """Structured Text of IEC 61131-3, a function block of law and feel for one axis."""
    TABLE = "table"
    """Drive settings with their CoE objects, parameter sheet and observer of a drive or PLC, as CSV and page."""
