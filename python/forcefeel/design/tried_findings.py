"""Conclusions from a comparison of laws, in sentences: the best by the rule, and the report's if the loader can use it."""

from forcefeel.design.law_comparison import LawComparison


def verdict(tried: LawComparison) -> str:
    """Which law is the best and whether it qualifies."""
    if tried.impossible:
        return f"The laws cannot be compared on this loader: {tried.impossible}."
    best, report = tried.best, tried.report
    if report is None:
        if best is None:
            return "No law is eligible for this loader."
        return f"By {tried.rule} law {best.name} {best.qualified_text}."
    if best is None:
        return f"No law is eligible for this loader. By {tried.rule} the report's law {report.qualified_text}."
    if best == report:
        return f"The report's law is the best for this loader. By {tried.rule} it {report.qualified_text}."
    return f"By {tried.rule} law {best.name} {best.qualified_text}. The report's law {report.qualified_text}."


def lines(tried: LawComparison) -> list[str]:
    """What the laws render, why the best is chosen, why the report's does not qualify, and what looks closer."""
    if tried.impossible:
        return []
    settings = f"{tried.settings} settings of stiffness, frequency and damping ratio"
    texts = [f"Laws compared at {settings}. {tried.remarks[0]}"] if tried.best else [*tried.remarks]
    report, best = tried.report, tried.best
    if report is not None and best != report:
        texts.append(f"The report's law, {report.name}, {report.rendered_text}.")
    if report is None and best is not None and best.qualified and best.qualified.reasons:
        texts.append(f"With {best.name}: {best.qualified.reasons[0]}")
    if report is not None and report.qualified and report.qualified.reasons:
        texts.append(f"With the report's law: {report.qualified.reasons[0]}")
    return [*texts, "The settings are few, so shares are rough: the page lists the commands for more."]
