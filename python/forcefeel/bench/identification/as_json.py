"""An identification as plain data for JSON, and frequency responses as tables."""

from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.identification.digits import NOT_DETERMINED, gain_unit
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.bench.identification.misfit import stated_noise
from forcefeel.bench.identification.result import Ended, Estimate, Fitted, Identification, Status, data_of
from forcefeel.bench.responses import Response
from forcefeel.json_values import json_value
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import SECONDS, Json, UnitSystem, quantity

_DIGITS = ".9g"


@dataclass(frozen=True)
class FitSettings:
    """Settings of a fit.

    Attributes:
        loss: Loss of large residuals.
        starts: Number of starts of the search.
        priors: Whether normal tolerances of the loader file were priors.
        as_responses: Whether records were converted into frequency responses first.
        law: Name of the law of the whole loader.
    """

    loss: str = "huber"
    starts: int = 5
    priors: bool = True
    as_responses: bool = False
    law: str = "original"


def identification_json(
    identification: Identification, units: UnitSystem, settings: FitSettings | None = None
) -> dict[str, Json]:
    """Results and inputs of an identification."""
    fitted_json = None if identification.loader is None else identification.loader.as_json(units)
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": identification.before.name,
        "conclusions": json_value(identification_conclusions(identification, units), units),
        "determined": identification.determined,
        "settings": json_value(settings, units),
        "parameters": [_estimate(estimate, units) for estimate in identification.estimates],
        "correlation": [[_finite(value) for value in row] for row in identification.correlation.tolist()],
        "inseparable": [
            {"parameters": list(group.keys), "weights": list(map(_finite, group.weights)), "sentence": group.sentence}
            for group in identification.inseparable
        ],
        "advice": [
            {
                "sentence": advice.sentence,
                "half_intervals": {key: _finite(share) for key, share in advice.shares.items()},
            }
            for advice in identification.advice
        ],
        "rigid_link": json_value(identification.rigid, units),
        "notes": list(identification.notes),
        "starts": [_ended(identification, end, units) for end in identification.ends],
        "data": [_data(identification, measurement, units) for measurement in data_of(identification.fitted)],
        "before": identification.before.as_json(units),
        "after": fitted_json,
    }


def response_csv(response: Response, units: UnitSystem) -> str:
    """A response as CSV for ``read_response``: properties in lines with ``#``, then frequency, gain, phase and more."""
    source, target = (channel_unit(name).shown(units) for name in (response.input, response.output))
    _, scale = gain_unit(response, units)
    columns = {
        "frequency (Hz)": response.frequency_hz,
        "gain (dB)": 20 * np.log10(scale * np.abs(response.value)),
        "phase (deg)": np.degrees(np.angle(response.value)),
    }
    if response.coherence is not None:
        columns["coherence"] = response.coherence
    if response.deviation is not None:
        columns["deviation"] = response.deviation
    return (
        f"# experiment: {response.experiment}\n"
        f"# from: {response.input} ({source})\n# to: {response.output} ({target})\n"
        f"{csv_text(columns, zip(*columns.values(), strict=True), _DIGITS)}"
    )


def _estimate(estimate: Estimate, units: UnitSystem) -> dict[str, Json]:
    """One parameter; without a value if undetermined."""
    unknown, measured_in = estimate.unknown, unit(TABLE[estimate.unknown.key])
    determined = estimate.status is not Status.UNDETERMINED
    document: dict[str, Json] = {
        "parameter": unknown.key,
        "symbol": unknown.symbol,
        "status": str(estimate.status),
        "file": quantity(unknown.nominal, measured_in, units),
        "bounds": [quantity(bound, measured_in, units) for bound in (unknown.low, unknown.high)],
        "prior": None,
        "half_interval_without_prior": _finite(estimate.share),
    }
    if unknown.prior is not None:
        mean, deviation = (quantity(value, measured_in, units) for value in unknown.prior)
        document["prior"] = {"mean": mean, "deviation": deviation}
    texts = {
        "estimate": estimate.value,
        "standard_error": estimate.deviation,
        "low": estimate.low,
        "high": estimate.high,
    }
    return document | {
        name: quantity(value, measured_in, units) if determined else NOT_DETERMINED for name, value in texts.items()
    }


def _ended(identification: Identification, end: Ended, units: UnitSystem) -> dict[str, Json]:
    values: dict[str, Json] = {}
    for estimate, value in zip(identification.estimates, end.end.tolist(), strict=True):
        determined = estimate.status is not Status.UNDETERMINED
        measured_in = unit(TABLE[estimate.unknown.key])
        values[estimate.unknown.key] = quantity(value, measured_in, units) if determined else NOT_DETERMINED
    began: dict[str, Json] = {
        key: quantity(value, unit(TABLE[key]), units)
        for key, value in zip(identification.keys, end.start.tolist(), strict=True)
    }
    return {"start": began, "end": values, "cost": _finite(end.cost), "same_place": end.same}


def _data(identification: Identification, data: object, units: UnitSystem) -> dict[str, Json]:
    """One data file, and the residual of each of its channels."""
    parts = [fitted for fitted in identification.fitted if fitted.data is data]
    measurement = parts[0].data
    common: dict[str, Json] = {
        "name": measurement.name,
        "kind": "frequency response" if isinstance(measurement, Response) else "record",
        "experiment": str(measurement.experiment),
        "sha256": measurement.data_hash,
    }
    if isinstance(measurement, Response):
        common |= {"input": measurement.input, "output": measurement.output}
    else:
        common |= {"hold": measurement.hold}
    return common | {"channels": [_part(part, units) for part in parts]}


def _part(fitted: Fitted, units: UnitSystem) -> dict[str, Json]:
    response = isinstance(fitted.data, Response)
    ends: dict[str, Json] = {"points": len(fitted.at)}
    if response:
        ends["band"] = {"value": [float(fitted.at[0]), float(fitted.at[-1])], "unit": "Hz"}
        stated = stated_noise(fitted)
        sizes: dict[str, Json] = {
            "residual_rms": _finite(fitted.residual_rms),
            "noise": _finite(fitted.noise),
            "stated_noise": None if stated is None else _finite(stated),
        }
    else:
        ends["length"] = quantity(float(fitted.at[-1] - fitted.at[0]), SECONDS, units)
        measured_in = channel_unit(fitted.channel)
        sizes = {
            "residual_rms": quantity(fitted.residual_rms, measured_in, units),
            "noise": quantity(fitted.noise, measured_in, units),
        }
    return {"channel": fitted.channel, **ends, **sizes}


def _finite(value: float) -> Json:
    """A finite number, or text for the others."""
    return json_value(float(value), UnitSystem.SI)
