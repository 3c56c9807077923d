"""The comparison as Markdown, and in a sentence."""

from forcefeel.reproduction.table import Row, Section, Verdict


def markdown(sections: tuple[Section, ...]) -> str:
    """The comparison as Markdown.

    Example:
        >>> row = ff.reproduction.Row("k", "Table I", "6108", "6108", 6108.0, "lb/in", ff.reproduction.Verdict.AGREES)
        >>> "Linkage" in ff.reproduction.markdown((ff.reproduction.Section("Linkage", (row,)),))
        True
    """
    lines = [summary(sections), ""]
    for section in sections:
        lines += [
            f"## {section.title}",
            "",
            "| item | where | printed | computed | unit | verdict | reason |",
            "|---" * 7 + "|",
        ]
        lines += [_markdown_row(row) for row in section.rows] + [""]
    return "\n".join(lines)


def summary(sections: tuple[Section, ...]) -> str:
    """Number of rows by verdict.

    Example:
        >>> row = ff.reproduction.Row("k", "Table I", "6108", "6108", 6108.0, "lb/in", ff.reproduction.Verdict.AGREES)
        >>> len(ff.reproduction.summary((ff.reproduction.Section("Linkage", (row,)),))) > 0
        True
    """
    verdicts = [row.verdict for section in sections for row in section.rows]
    agree, explained, refuted, unexplained = (verdicts.count(verdict) for verdict in Verdict)
    return (
        f"{len(verdicts)} numbers and claims: {agree} agree, {explained} differ for a known reason, {refuted} do not hold,"
        f" {unexplained} differ for no known reason."
    )


def _markdown_row(row: Row) -> str:
    cells = (row.item, row.where, row.printed, row.computed, row.unit, str(row.verdict), row.reason)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
