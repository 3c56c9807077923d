"""Choosing for the engineer: every method tried on a loader, scored, and one chosen by a rule that is written down."""

from forcefeel.choice.rule import Choice, choose
from forcefeel.choice.score import Score, Scored, score_methods

__all__ = ["Choice", "Score", "Scored", "choose", "score_methods"]
