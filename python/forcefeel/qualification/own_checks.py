"""Checks by forcefeel itself, of what no qualification rule tests."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isinf, isnan

from forcefeel.units import Unit, UnitSystem, to_text


@dataclass(frozen=True)
class OwnCheck:
    """One check.

    Attributes:
        name: What is checked.
        value: The measured value, SI; NaN where the link did not give way, infinite where the run diverged.
        low: Least value; NaN without limits.
        high: Largest value.
        unit: Its unit.

    Example:
        >>> breakout = ff.qualification.OwnCheck("breakout, up", 140.0, 135.0, 149.0, ff.units.FORCE)
        >>> breakout.outcome, breakout.texts(ff.UnitSystem.SI)
        ('passed', ('140 N', '135 to 149 N'))
    """

    name: str
    value: float
    low: float
    high: float
    unit: Unit

    @property
    def passed(self) -> bool:
        """Whether it is within its limits, or has none and is finite."""
        return (isnan(self.high) and not isinf(self.value)) or self.low <= self.value <= self.high

    @property
    def outcome(self) -> str:
        """``passed``, ``failed`` or ``measured``."""
        return "failed" if not self.passed else "measured" if isnan(self.high) else "passed"

    def texts(self, units: UnitSystem) -> tuple[str, str]:
        """The value, and its limits."""
        shown = self.unit.shown(units)

        def text(value: float) -> str:
            return to_text(self.unit.from_si(value, units), 4)

        value = "did not give way" if isnan(self.value) else f"{text(self.value)} {shown}".rstrip()
        value = "diverged" if isinf(self.value) else value
        between = f"at most {text(self.high)}" if self.low == 0 else f"{text(self.low)} to {text(self.high)}"
        return value, "none" if isnan(self.high) else f"{between} {shown}".rstrip()


LinkChecks = Mapping[str, tuple[OwnCheck, ...]]
"""The checks of each link, by its name."""


def link_findings(links: LinkChecks, units: UnitSystem) -> tuple[str, ...]:
    """What the checks of each link came to, a sentence for each link."""
    return tuple(_finding(name, checks, units) for name, checks in links.items())


def _finding(name: str, checks: tuple[OwnCheck, ...], units: UnitSystem) -> str:
    failed = [check for check in checks if not check.passed]
    if not failed:
        return f"Link {name}: all checks passed. They are forcefeel's own; no rule has a test of a link."
    each = "; ".join("{}: {}, expected {}".format(check.name, *check.texts(units)) for check in failed)
    return f"Link {name}, forcefeel's own checks: failed {each}."
