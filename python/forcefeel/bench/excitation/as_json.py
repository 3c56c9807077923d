"""An excitation as plain data for JSON."""

from typing import Any

from forcefeel.bench.channels import CHANNELS, INPUTS
from forcefeel.bench.excitation.result import Excitation
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import UnitSystem


def excitation_json(found: Excitation, units: UnitSystem) -> dict[str, Any]:
    """Everything but the samples; values in the units of ``units``, noise and lines in SI units."""
    drive = INPUTS[found.experiment.drive]
    return {
        "loader": found.loader.name,
        "experiment": str(found.experiment),
        "signal": found.words,
        "kind": found.plan.signal,
        "time_s": found.plan.time_s,
        "rate_hz": found.plan.rate_hz,
        "period_s": found.period_s,
        "peak": {"value": found.peak, "unit": drive},
        "parameters": {
            key: {
                "symbol": TABLE[key].symbol,
                "value": unit(TABLE[key]).from_si(found.loader[key], units),
                "unit": unit(TABLE[key]).shown(units),
                "relative_standard_error": error,
            }
            for key, error in found.standard_errors.items()
        },
        "limits": {
            use.limit.name: {
                "peak": use.limit.unit.from_si(use.peak, units),
                "limit": use.limit.unit.from_si(use.limit.value, units),
                "unit": use.limit.unit.shown(units),
                "share": use.share,
                "reason": use.limit.reason,
            }
            for use in found.uses
        },
        "binding": found.binding.limit.name,
        "noise": {name: {"deviation": value, "unit": CHANNELS[name]} for name, value in found.noise.items()},
        "efficiency": found.efficiency,
        "even_efficiency": found.even_efficiency,
        "lines": {"frequency_hz": found.frequency_hz.tolist(), f"power_{drive.lower()}2": found.power.tolist()},
        "verdict": found.verdict,
        "findings": list(found.findings(units)),
    }
