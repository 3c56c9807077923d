"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.choice.page.page import write_choice as write_choice
from forcefeel.choice.quick_choice import best_law as best_law
from forcefeel.choice.rule import Choice as Choice
from forcefeel.choice.rule import choose as choose
from forcefeel.choice.score import LawScores as LawScores
from forcefeel.choice.score import Score as Score
from forcefeel.choice.score import score_laws as score_laws
