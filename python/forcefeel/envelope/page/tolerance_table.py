"""Table of the parameters' tolerances and their sources, shared by all pages with cases."""

from collections.abc import Mapping

from forcefeel.envelope.deviations import Deviation, Origin
from forcefeel.envelope.tolerance_sentences import ends_text
from forcefeel.loader.tolerances import ENDS_AT, Distribution
from forcefeel.page.table import Cell, Table, words
from forcefeel.page.typography import parameter_name

_MINUS = "\N{MINUS SIGN}"

_SPREAD = {
    Distribution.UNIFORM: "uniform",
    Distribution.TRIANGULAR: "triangular",
    Distribution.NORMAL: f"normal; its cases at {ENDS_AT:.0f} standard deviations",
}


def tolerances(deviations: Mapping[str, Deviation]) -> Table:
    """A row for each parameter; assumed tolerances are highlighted."""
    rows = tuple(
        (
            words(parameter_name(key)),
            Cell(ends_text(deviation).replace("-", _MINUS), "number"),
            words(_SPREAD[deviation.spread.distribution]),
            words(str(deviation.origin), bad=deviation.origin is Origin.ASSUMED),
        )
        for key, deviation in deviations.items()
    )
    return Table((Cell("Parameter"), Cell("Off by", "number"), Cell("Distribution"), Cell("Stated by")), rows)
