"""An excitation as plain data for JSON."""

from typing import Any

from forcefeel.bench.channels import CHANNELS, INPUTS
from forcefeel.bench.excitation.result import Excitation
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import UnitSystem


def excitation_json(excitation: Excitation, units: UnitSystem) -> dict[str, Any]:
    """Everything but the samples; values in the units of ``units``, noise and lines in SI units."""
    drive = INPUTS[excitation.experiment.drive]
    return {
        "loader": excitation.loader.name,
        "experiment": str(excitation.experiment),
        "signal": excitation.words,
        "kind": excitation.plan.signal,
        "time_s": excitation.plan.time_s,
        "rate_hz": excitation.plan.rate_hz,
        "period_s": excitation.period_s,
        "peak": {"value": excitation.peak, "unit": drive},
        "parameters": {
            key: {
                "symbol": TABLE[key].symbol,
                "value": unit(TABLE[key]).from_si(excitation.loader[key], units),
                "unit": unit(TABLE[key]).shown(units),
                "relative_standard_error": error,
            }
            for key, error in excitation.standard_errors.items()
        },
        "limits": {
            use.limit.name: {
                "peak": use.limit.unit.from_si(use.peak, units),
                "limit": use.limit.unit.from_si(use.limit.value, units),
                "unit": use.limit.unit.shown(units),
                "share": use.share,
                "reason": use.limit.reason,
            }
            for use in excitation.uses
        },
        "binding": excitation.binding.limit.name,
        "noise": {name: {"deviation": value, "unit": CHANNELS[name]} for name, value in excitation.noise.items()},
        "efficiency": excitation.efficiency,
        "even_efficiency": excitation.even_efficiency,
        "lines": {
            "frequency_hz": excitation.frequency_hz.tolist(),
            f"power_{drive.lower()}2": excitation.power.tolist(),
        },
        "verdict": excitation.verdict,
        "findings": list(excitation.findings(units)),
    }
