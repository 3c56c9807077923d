"""The comparison as Markdown, and in a sentence."""

from forcefeel.reproduction.table import Section, Verdict


def markdown(sections: tuple[Section, ...]) -> str:
    """The comparison as Markdown: a table per section, a reason that several of its rows share at the first of them.

    Example:
        >>> row = ff.reproduction.Row("k", "Table I", "6108", "6108", 6108.0, "lb/in", ff.reproduction.Verdict.AGREES)
        >>> "Linkage" in ff.reproduction.markdown((ff.reproduction.Section("Linkage", (row,)),))
        True
    """
    lines = [summary(sections), ""]
    for section in sections:
        places = {row.where for row in section.rows}
        title = f"{section.title} ({places.pop()})" if len(places) == 1 else section.title
        head = ["item", *(["where"] if places else []), "printed", "computed", "verdict"]
        lines += [f"## {title}", "", _line(head), "|---" * len(head) + "|"]
        first: dict[str, str] = {}
        for row in section.rows:
            same = first.setdefault(row.reason, row.item)
            reason = row.reason if same == row.item else f"as {same}"
            where = [row.where] if places else []
            verdict = f"{row.verdict}: {reason}" if row.reason else str(row.verdict)
            lines.append(_line([row.item, *where, row.printed, f"{row.computed} {row.unit}".rstrip(), verdict]))
        lines.append("")
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


def _line(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
