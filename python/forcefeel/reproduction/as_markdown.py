"""The comparison as Markdown, and in a sentence."""

from forcefeel.reproduction.table import Row, Section, Verdict


def markdown(sections: tuple[Section, ...]) -> str:
    """The comparison as Markdown: per section a table of what differs or has a remark, then the numbers that agree.

    Example:
        >>> row = ff.reproduction.Row("k", "Table I", "6108", "6108", 6108.0, "lb/in", ff.reproduction.Verdict.AGREES)
        >>> "Linkage" in ff.reproduction.markdown((ff.reproduction.Section("Linkage", (row,)),))
        True
    """
    lines = [summary(sections), ""]
    for section in sections:
        agree = [row for row in section.rows if row.verdict is Verdict.AGREES and not row.reason]
        lines += [f"## {section.title}", "", *_table([row for row in section.rows if row not in agree])]
        if agree:
            numbers = "; ".join(f"{row.item}: {row.printed} {row.unit}".rstrip() for row in agree)
            lines += [f"Agree: {numbers}.", ""]
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


def _table(rows: list[Row]) -> list[str]:
    """The rows as a table, a reason that several share at the first of them."""
    lines = ["| item | where | printed | computed | verdict |", "|---|---|---|---|---|"]
    first: dict[str, str] = {}
    for row in rows:
        same = first.setdefault(row.reason, row.item)
        verdict = f"{row.verdict}: {row.reason if same == row.item else f'as {same}'}"
        cells = (row.item, row.where, row.printed, f"{row.computed} {row.unit}".rstrip(), verdict)
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return [*lines, ""] if rows else []
