"""The report's law beside the best one, a row each."""

from markupsafe import Markup

from forcefeel.conclusions import capital
from forcefeel.design.law_comparison import LawComparison, LawResult
from forcefeel.page.table import Cell, Table, words


def beside(tried: LawComparison) -> Table:
    """What each law is, what its tests came to, and what it renders."""
    head = ("Law", "Description", f"By {tried.rule} it", f"Over {tried.settings} settings it")
    return Table(tuple(map(Cell, head)), tuple(_row(tried, law) for law in tried.laws))


def _row(tried: LawComparison, law: LawResult) -> tuple[Cell, ...]:
    rank = " ".join(
        text for text, holds in (("the best", law == tried.best), ("the report's", law == tried.report)) if holds
    )
    name = Markup("<b>{}</b><br><small>{}</small>").format(law.name, rank)
    return (
        Cell(name),
        words(capital(law.summary)),
        words(law.qualified_text, bad=not law.qualifies),
        words(law.rendered_text),
    )
