"""Eqs. (15), (17), (19), (21): comparison of the model's Jacobians with the printed matrices."""

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.laws.analog.recursion import DesignSettings
from forcefeel.linear.models import DESIGN_STATES
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.reproduction import printed_matrices as printed
from forcefeel.reproduction.table import Reason, Row, Section, Verdict, number
from forcefeel.units import factor

ROUNDING = 1e-14
"""Relative difference of entries that are the same formula in another order of multiplication."""

_SIGN = "with the printed sign the load cell moves the column against the pilot, eq. (6)"


def matrices(loader: Loader) -> Section:
    """Every entry of the printed matrices."""
    letters = printed.letters(loader)
    as_printed = loader.si_values.copy()
    as_printed[INDEX["load_cell.gain"]] *= -1
    rigid = _core.rigid(as_printed, GainLaw.original(as_printed))
    compliant = _core.compliant(as_printed, GainLaw.original(as_printed))
    plant = _core.design_plant(loader.si_values, letters.Gmax)
    return Section(
        "State equations",
        (
            _matrix("eq. (15), rigid model, with the printed sign", "eq. (15)", printed.rigid(letters), rigid),
            _matrix(
                "eq. (17), compliant model, with the printed sign", "eq. (17)", printed.compliant(letters), compliant
            ),
            _matrix("eq. (19), design plant, with G_max / I", "eq. (19)", printed.design_plant(letters), plant),
            _sign(loader),
            _pilot_force(loader),
            _weight(loader),
        ),
    )


def largest_difference(printed_matrix: NDArray[np.float64], computed: NDArray[np.float64]) -> float:
    """Largest relative difference of entries; infinite where one is zero and the other is not."""
    if not np.array_equal(printed_matrix == 0, computed == 0):
        return np.inf
    filled = printed_matrix != 0
    return float(np.max(np.abs(computed[filled] / printed_matrix[filled] - 1)))


def _matrix(
    item: str,
    where: str,
    witness: tuple[NDArray[np.float64], NDArray[np.float64]],
    model: tuple[NDArray[np.float64], ...],
) -> Row:
    a, b = witness
    entries = np.hstack([a, b[:, None]])
    difference = largest_difference(entries, np.hstack([model[0], model[1][:, :1]]))
    verdict = Verdict.AGREES if difference <= ROUNDING else Verdict.OPEN
    count = f"{np.count_nonzero(entries)} entries"
    return Row(item, where, count, _difference(difference), difference, "", verdict)


def _difference(largest: float) -> str:
    return "same to rounding" if largest <= ROUNDING else f"largest relative difference {largest:.0e}"


def _sign(loader: Loader) -> Row:
    model = _core.compliant(loader.si_values, GainLaw.original(loader.si_values))[0]
    entry = model[5, 1] / printed.compliant(printed.letters(loader))[0][5, 1]
    # With the sign turned round, as the reason says, the entry is the printed one.
    return number(
        "sign of K_1 G_max A / I", "eqs. (12), (15), (17)", "1", float(entry), "", Reason(_SIGN, -float(entry))
    )


def _pilot_force(loader: Loader) -> Row:
    plant = _core.design_plant(loader.si_values, loader["column.grip_arm"])[0]
    text = (
        "G_max in place of a lever arm: wrong unit and size. forcefeel uses R_p / I, from the torque at rest; the report"
        " computed c_7 with -alpha R_b / I"
    )
    value = plant[3, 6] * factor("1/(N s^2)", "1/(lb s^2)")
    return number(
        "coefficient of F_p in the computer's row", "eq. (19)", "480", value, "1/(lb s^2)", Reason(text, 28800 / 60)
    )


def _weight(loader: Loader) -> Row:
    base = DESIGN_STATES.index("base_position_m")
    scale = np.ones(len(DESIGN_STATES))
    scale[base] = loader["column.base_arm"] / 10  # the printed [Q] is on x_b in inches, R_b = 10 in.
    expected = np.zeros((7, 7))
    expected[2, 2], expected[base, base] = 100.0, 1.0
    expected[2, base] = expected[base, 2] = -10.0
    difference = largest_difference(expected, DesignSettings().weight(loader) * np.outer(scale, scale))
    verdict = Verdict.AGREES if difference <= ROUNDING else Verdict.OPEN
    text = _difference(difference)
    return Row("[Q] with 100, -10, 1 from R_1 = 0", "eq. (21), appendix", "4 entries", text, difference, "", verdict)
