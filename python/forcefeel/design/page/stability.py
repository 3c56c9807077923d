"""Which curve belongs to which loop of the design, and whether that loop is stable."""

import math

from forcefeel.design.analysis import LoopResult
from forcefeel.design.figure import Figure, Kind
from forcefeel.design.law_loop import LawLoop
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_figures import under
from forcefeel.design.workflow import Design
from forcefeel.page.typography import number_text

AnyDesign = Design | MotorDesign


def loop_of(design: AnyDesign, figure: str, label: str) -> LoopResult | LawLoop | None:
    """The loop that a curve of a time figure shows; ``None`` for the ideal feel."""
    if isinstance(design, MotorDesign) and label == under(design.law):
        return design.programmed
    if figure in {"figure-11a", "figure-11b"}:
        original = design.configuration("rigid" if figure == "figure-11a" else "compliant")
        return {"programmed setting": original.programmed, "low setting": original.low}.get(label)
    return next(
        (configuration.programmed for configuration in design.configurations if configuration.name == label), None
    )


def is_unstable(design: AnyDesign, figure: str, label: str) -> bool:
    """Whether the loop behind a curve is unstable."""
    loop = loop_of(design, figure, label)
    return loop is not None and not loop.assessment.stable


def departs(design: AnyDesign, figure: Figure) -> bool:
    """Whether a curve of a time figure runs away, or one of the figure that it is laid beside."""
    beside = ("figure-11a", "figure-11b") if figure.key in {"figure-11a", "figure-11b"} else (figure.key,)
    return any(is_unstable(design, key, label) for key in beside for label in figure.curves)


def departures(figure: Figure, design: AnyDesign) -> tuple[str, ...]:
    """A sentence for each unstable curve: how it grows, and where the whole of it is."""
    if figure.kind is not Kind.TIME:
        return ()
    sentences = []
    for label in figure.curves:
        loop = loop_of(design, figure.key, label)
        if loop is None or loop.assessment.stable:
            continue
        fastest = max(loop.modes, key=lambda mode: mode.real_per_s)
        swing = f"oscillates at {number_text(fastest.imaginary_per_s / (2 * math.pi), 3)} Hz and "
        how = swing if fastest.imaginary_per_s > 0 else ""
        doubling = number_text(math.log(2) / fastest.real_per_s, 2) if fastest.real_per_s > 0 else "∞"
        sentences.append(
            f"Unstable, {label}: it {how}doubles every {doubling} s. The curve is cut where it leaves the picture;"
            " the table of values has all of it."
        )
    return tuple(sentences)
