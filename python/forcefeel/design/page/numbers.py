"""``results.json``: every number of the design with its unit, and what stands in which table of values."""

from collections.abc import Mapping
from importlib.metadata import version

from forcefeel.design.figure import Figure
from forcefeel.design.findings import conclusions
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.page.captions import MEANINGS
from forcefeel.design.page.responses import column_names
from forcefeel.design.workflow import Design
from forcefeel.json_values import json_text, json_value
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import UnitSystem


def results_json(
    design: Design | MotorDesign,
    drawn: tuple[Figure, ...],
    tables: Mapping[str, LabeledArrays],
    units: UnitSystem,
    tried: LawComparison | None,
) -> str:
    """The results as JSON text; ``tables`` are the figures' values by file name, in the order of ``drawn``."""
    curves = [
        {
            "figure": figure.key,
            "title": figure.title,
            "meaning": MEANINGS[figure.key],
            "file": name,
            "columns": column_names(data),
        }
        for figure, (name, data) in zip(drawn, tables.items(), strict=True)
    ]
    document = {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "conclusions": json_value(conclusions(design, units, tried), units),
        "design": json_value(design, units),
        "laws": json_value(tried, units),
        "figures": curves,
    }
    return json_text(document)
