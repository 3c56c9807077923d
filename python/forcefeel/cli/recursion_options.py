"""The options of recursion (22)."""

import io
import warnings
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.options import option
from forcefeel.errors import InputError, shortened
from forcefeel.files import MOST_TEXT_BYTES, read_input

if TYPE_CHECKING:
    from forcefeel.laws.analog.recursion import DesignSettings
    from forcefeel.loader.loader import Loader

RECURSION = Group("Recursion (22)", sort_key=30)


class Coupling(StrEnum):
    """How the pilot's force enters the feel computer's row of eq. (19)."""

    REPORT = "report"
    COLUMN = "column"


@dataclass(frozen=True, kw_only=True)
class RecursionOptions:
    """The options as given; ``None`` is not given."""

    horizon_s: Annotated[
        float | None, option("Length of the horizon, s.", RECURSION, "--horizon", default="0.05, the published one")
    ] = None
    converge: Annotated[bool, option("Iterate until the gains converge.", RECURSION)] = False
    step_s: Annotated[float | None, option("Sampling step, s.", RECURSION, "--step", default="1e-4")] = None
    tolerance: Annotated[
        float | None, option("With --converge: largest change of a gain at the end.", RECURSION, default="1e-10")
    ] = None
    position_weight: Annotated[float | None, option("Weight of (delta - theta)^2.", RECURSION, default="100")] = None
    r1: Annotated[float | None, option("Weight R_1 of the squared velocity error.", RECURSION, default="0")] = None
    r2: Annotated[float | None, option("Weight R_2 of e^2.", RECURSION, default="0.1")] = None
    pilot_coupling: Annotated[
        Coupling | None,
        option(
            "Entry of F_p in the row of the feel computer, for c_7: as in the report (-alpha R_b) or as on the column "
            "(R_p).",
            RECURSION,
            default="report; column with --converge",
        ),
    ] = None
    q: Annotated[
        Path | None,
        option(
            "Full matrix [Q]: CSV, 7 rows of 7, SI units, order x_p p delta delta' x_b x_b' F_p.",
            RECURSION,
            metavar="FILE",
        ),
    ] = None

    def settings(self, loader: "Loader") -> "DesignSettings":
        """The settings for ``loader``: the published ones, changed as asked.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        from forcefeel.laws.analog.recursion import (
            PUBLISHED_HORIZON_S,
            DesignSettings,
            published_settings,
        )

        self._check()
        coupling = self.pilot_coupling or (Coupling.COLUMN if self.converge else Coupling.REPORT)
        base = (
            published_settings(loader) if coupling is Coupling.REPORT else DesignSettings(horizon_s=PUBLISHED_HORIZON_S)
        )
        names = {field.name for field in fields(base)} & {field.name for field in fields(RecursionOptions)}
        given = {name: value for name in names if (value := getattr(self, name)) is not None}
        if self.converge:
            given["horizon_s"] = None
        return replace(base, **{**given, "q": _read_q(self.q)})

    def check_none(self, loader: "Loader") -> None:
        """That no option of recursion (22) is given for a loader with a motor, which has none.

        Raises:
            InputError: If an option of it is given.
        """
        from forcefeel.loader.loader import check_hydraulic

        if any(getattr(self, field.name) not in {None, False} for field in fields(RecursionOptions)):
            check_hydraulic(
                loader,
                "recursion (22)",
                "leave its options out: design takes the best of the laws that a motor can run",
            )

    def _check(self) -> None:
        if self.converge and self.horizon_s is not None:
            raise InputError("--converge and --horizon: given both; an endless horizon has no length, leave one out")
        if self.tolerance is not None and not self.converge:
            raise InputError("--tolerance: is for --converge; a horizon ends by its length")
        if self.q is not None and (self.position_weight is not None or self.r1 is not None):
            raise InputError("--q: gives [Q] whole; leave out --position-weight and --r1")


def _read_q(path: Path | None) -> tuple[tuple[float, ...], ...] | None:
    if path is None:
        return None
    import numpy as np

    data = read_input(path, MOST_TEXT_BYTES, "[Q] as CSV, 7 rows of 7 numbers")
    try:
        with warnings.catch_warnings(action="error"):  # NumPy only warns of an empty file
            return tuple(tuple(row) for row in np.loadtxt(io.BytesIO(data), delimiter=",", ndmin=2).tolist())
    except (ValueError, UserWarning) as error:
        raise InputError(f"{path}: expected [Q] as CSV, 7 rows of 7 numbers: {shortened(str(error), 120)}") from error
