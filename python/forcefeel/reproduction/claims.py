"""Comparison of the report's claims with the models."""

import numpy as np

from forcefeel import _core
from forcefeel.design.assessment import Peaks, assess
from forcefeel.design.sentences import SMALL_ERROR
from forcefeel.design.studies import CHANGES, droppable, worst
from forcefeel.design.workflow import Design
from forcefeel.laws.analog.recursion import GAIN_UNITS, DesignSettings, design_gains
from forcefeel.linear.models import DESIGN_FEEL, DESIGN_PLANT, Linkage, design_model, state_feedback
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.reproduction.appendix import printed
from forcefeel.reproduction.table import Row, Section, Verdict, claim
from forcefeel.units import ROTARY_STIFFNESS, UnitSystem, to_text


def claims(design: Design) -> Section:
    """A row or more per claim."""
    return Section(
        "Claims",
        (
            *_sign(design),
            _printed_digits(design),
            *_scale(design.loader),
            _overdamped(design),
            _compliance(design),
            _structural_damping(design),
            *_only_delta(design),
            _low_stiffness(design),
            _valve_dynamics(design),
            _feasible(design),
            _insensitive(design),
            _dropped(design),
            _stabilizable(design.loader),
            _converged_at_rest(design),
        ),
    )


def _sign(design: Design) -> list[Row]:
    rows = []
    for linkage, build in ((Linkage.RIGID, _core.rigid), (Linkage.COMPLIANT, _core.compliant)):
        values = design.low_loader.si_values.copy()
        values[INDEX["load_cell.gain"]] *= -1
        poles = np.linalg.eigvals(build(values, _core.GainLaw.original(values))[0])
        fastest = poles[np.argmax(poles.real)]
        rows.append(
            claim(
                f"{linkage} model is stable at the low setting, printed sign of eq. (12)",
                "eq. (12)",
                float(fastest.real),
                "1/s",
                holds=bool(fastest.real < 0),
                reason="a real pole runs away",
            )
        )
    return rows


def _printed_digits(design: Design) -> Row:
    """The report's own simulation: its printed digits, six states fed back."""
    digits = [float(text) for text in printed()["gains"]["us"]]
    gains = np.array([digit / unit.from_si(1.0, UnitSystem.US) for digit, unit in zip(digits, GAIN_UNITS, strict=True)])
    assessment = assess(design.loader, state_feedback(design.loader, gains[:6]))
    return claim(
        "the printed digits settle the column right",
        "page of fig. 14",
        assessment.static_angle_rad,
        "rad",
        holds=abs(assessment.static_error) <= SMALL_ERROR,
        reason=f"steady angle with the printed c_1 .. c_6, {100 * assessment.static_error:+.2f} % off",
    )


def _scale(loader: Loader) -> list[Row]:
    """Rendering of the programmed deflection by the original system."""
    assessment = assess(loader, None, linkage=Linkage.RIGID)
    k_1 = loader["potentiometer.gain"] * (loader["linkage.ratio"] * loader["column.base_arm"]) ** 2
    k_1 /= loader["feel.maximum_stiffness"]
    right = assess(loader.replace({"load_cell.gain": k_1}, si=True), None, linkage=Linkage.RIGID)
    return [
        claim(
            "the original system renders the deflection R_p F_p / G (rigid link)",
            "eqs. (12), (13)",
            1 + assessment.static_error,
            "",
            holds=abs(assessment.static_error) <= SMALL_ERROR,
            reason="reached share; K_1 = 0.005 V/lb is too small",
        ),
        claim(
            "it does with K_1 = K_3 (alpha R_b)^2 / G_max",
            "eqs. (12), (13)",
            1 + right.static_error,
            "",
            holds=abs(right.static_error) <= SMALL_ERROR,
            reason="reached share; at rest p drives oil through C_p",
        ),
    ]


def _overdamped(design: Design) -> Row:
    rigid = design.servo(Linkage.RIGID)
    slowest = rigid.closed_modes[0]
    return claim(
        "the inner loop is somewhat overdamped",
        "page of fig. 1",
        slowest.frequency_rad_per_s / (2 * np.pi),
        "Hz",
        holds=slowest.imaginary_per_s == 0,
        reason="its slowest pole is real",
    )


def _compliance(design: Design) -> Row:
    rigid, compliant = (design.configuration(name).boundary for name in ("rigid", "compliant"))
    holds = compliant.stiffness_n_m_per_rad > rigid.stiffness_n_m_per_rad
    reason = f"smallest stable G; of the rigid model {_us(rigid.stiffness_n_m_per_rad)}"
    return claim(
        "compliance makes low G unstable",
        "page of fig. 10",
        _number(compliant.stiffness_n_m_per_rad),
        _UNIT,
        holds=holds,
        reason=reason,
    )


def _structural_damping(design: Design) -> Row:
    before, after = (
        design.configuration(name).programmed.assessment.least_damping_ratio for name in ("compliant", "compensated")
    )
    reason = f"damping ratio of the structural mode; {to_text(before, 2)} in the original system"
    return claim(
        "the structural oscillation is reduced", "introduction", after, "", holds=after > before, reason=reason
    )


def _only_delta(design: Design) -> list[Row]:
    own_gains, other_gains = (
        design_gains(loader, DesignSettings()).gains for loader in (design.loader, _other_setting(design.loader))
    )
    change = np.abs(other_gains / own_gains - 1)
    others, own = float(np.max(change[DESIGN_PLANT])), float(np.min(change[DESIGN_FEEL]))
    return [
        claim(
            "gains of the plant's states do not depend on the computer setting",
            "page of fig. 14",
            others,
            "",
            holds=others < 1e-9,  # the recursion's own tolerance is 1e-10
            reason="largest relative change of c_1, c_2, c_5, c_6 from 2 Hz, 0.2 to 1 Hz, 0.7",
        ),
        claim(
            "gains of delta and its rate do",
            "page of fig. 14",
            own,
            "",
            holds=own > 0.01,
            reason="smallest relative change of c_3, c_4 over the same",
        ),
    ]


def _other_setting(loader: Loader) -> Loader:
    inertia, damping = _core.feel_from_frequency(2 * np.pi, 0.7, loader["feel.stiffness"])
    return loader.replace({"feel.inertia": inertia, "feel.damping": damping}, si=True)


def _low_stiffness(design: Design) -> Row:
    before, after = (design.configuration(name).boundary for name in ("compliant", "compensated"))
    reason = f"smallest stable G; {_us(before.stiffness_n_m_per_rad)} in the original system. Eq. (19) omits the load-cell loop"
    value = _number(after.stiffness_n_m_per_rad)
    return claim(
        "the instability at low G is eliminated", "page of fig. 14", value, _UNIT, holds=value == 0, reason=reason
    )


def _valve_dynamics(design: Design) -> Row:
    law = design.compensation.law(design.loader)
    fast = design.loader.replace({"valve.natural_frequency": "37700 rad/s"})
    with_valve, without = (assess(loader, law).frequency_rad_per_s for loader in (design.loader, fast))
    change = with_valve / without - 1
    reason = "change of the feel's frequency with a valve a hundred times faster"
    return claim(
        "the valve's dynamics may be neglected in the design",
        "page of eq. (19)",
        100 * change,
        "%",
        holds=abs(change) < 0.01,
        reason=reason,
    )


def _feasible(design: Design) -> Row:
    peaks = design.configuration("compensated").programmed.peaks
    share = 100 * max(peaks.current_share, peaks.flow_share) if isinstance(peaks, Peaks) else np.inf
    reason = "largest share of a rating"
    return claim(
        "current and flow stay within the valve's limits",
        "page of eq. (22)",
        share,
        "%",
        holds=share <= 100,
        reason=reason,
    )


def _insensitive(design: Design) -> Row:
    row = worst(design.deviations)
    assessment, nominal = row.assessment, design.configuration("compensated").programmed.assessment.tracking_error
    if assessment is None or not assessment.stable:
        return claim(
            "the scheme is insensitive to plant parameters",
            "page of fig. 14",
            np.nan,
            "",
            holds=False,
            reason=f"{row.quantity} at {row.change:+.0%} makes it unstable",
        )
    reason = (
        f"tracking error at {row.quantity} {row.change:+.0%}, {nominal:.1%} nominal. All deviations up to {max(CHANGES):.0%}"
        " are stable, but the column settles right only if the gains of x_p and delta match the linkage's geometry"
    )
    return claim(
        "the scheme is insensitive to plant parameters",
        "page of fig. 14",
        100 * assessment.tracking_error,
        "%",
        holds=assessment.tracking_error - nominal <= SMALL_ERROR,
        reason=reason,
    )


def _dropped(design: Design) -> Row:
    full = design.configuration("compensated").programmed.assessment.tracking_error
    compensated = design.configuration("compensated")
    most = droppable(design.dropped, compensated.programmed.assessment, compensated.boundary)
    if most is None:
        return claim(
            "feedback paths can be eliminated", "introduction", 0.0, "paths", holds=False, reason="none without loss"
        )
    reason = f"{', '.join(most.paths)}: tracking error {most.assessment.tracking_error:.1%} instead of {full:.1%}"
    return claim(
        "feedback paths can be eliminated", "introduction", float(len(most.paths)), "paths", holds=True, reason=reason
    )


def _stabilizable(loader: Loader) -> Row:
    plant = design_model(loader)
    unmoved = len(plant.A) - int(np.linalg.matrix_rank(np.hstack([plant.A, plant.B])))
    reason = "F_p is constant and e does not move it: a Riccati solver refuses the plant, recursion (22) does not"
    verdict = Verdict.EXPLAINED if unmoved == 1 else Verdict.OPEN  # F_p and nothing else
    item = "the plant of eq. (19) is stabilizable"
    return Row(item, "eq. (19)", "assumed", str(unmoved), float(unmoved), "states", verdict, reason)


def _converged_at_rest(design: Design) -> Row:
    loader, gains = design.loader, design.converged.gains
    with_force = assess(loader, state_feedback(loader, gains)).static_error
    without = assess(loader, state_feedback(loader, gains[:6])).static_error
    reason = (
        f"static error with c_7; without it {100 * without:.3g} %. The published horizon needs no c_7, by its length"
    )
    return claim(
        "converged gains settle the column right",
        "eq. (20)",
        100 * with_force,
        "%",
        holds=abs(with_force) < 1e-6,
        reason=reason,
    )


_UNIT = ROTARY_STIFFNESS.us


def _number(stiffness: float) -> float:
    return ROTARY_STIFFNESS.from_si(stiffness, UnitSystem.US)


def _us(stiffness: float) -> str:
    return f"{to_text(_number(stiffness))} {_UNIT}"
