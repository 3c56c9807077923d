"""An identification for machines: everything that its page says as plain data, and frequency responses as tables."""

import csv
import io
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.identification.digits import NOT_DETERMINED, gain_unit
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.bench.identification.misfit import stated_noise
from forcefeel.bench.identification.result import Ended, Estimate, Fitted, Identification, Status, data_of
from forcefeel.bench.responses import Response
from forcefeel.json_values import Json, json_value, quantity
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import SECONDS, UnitSystem

_DIGITS = ".9g"


@dataclass(frozen=True)
class FitSettings:
    """How a fit was made.

    Attributes:
        loss: What large residuals cost.
        starts: How many places the search began at.
        priors: Whether normal tolerances of the loader file were priors.
        as_responses: Whether records were turned into frequency responses first.
        law: Name of the law of the whole loader.
    """

    loss: str = "huber"
    starts: int = 5
    priors: bool = True
    as_responses: bool = False
    law: str = "original"


def identification_json(
    found: Identification, units: UnitSystem, settings: FitSettings | None = None
) -> dict[str, Json]:
    """What the identification says, and of what."""
    after = None if found.loader is None else found.loader.as_json(units)
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": found.before.name,
        "conclusions": json_value(identification_conclusions(found, units), units),
        "determined": found.determined,
        "settings": json_value(settings, units),
        "parameters": [_estimate(one, units) for one in found.estimates],
        "correlation": [[_finite(value) for value in row] for row in found.correlation.tolist()],
        "inseparable": [
            {"parameters": list(one.keys), "weights": list(map(_finite, one.weights)), "sentence": one.sentence}
            for one in found.inseparable
        ],
        "advice": [
            {"sentence": one.sentence, "half_intervals": {key: _finite(share) for key, share in one.shares.items()}}
            for one in found.advice
        ],
        "rigid_link": json_value(found.rigid, units),
        "notes": list(found.notes),
        "starts": [_ended(found, one, units) for one in found.ends],
        "data": [_data(found, one, units) for one in data_of(found.fitted)],
        "before": found.before.as_json(units),
        "after": after,
    }


def response_csv(response: Response, units: UnitSystem) -> str:
    """A response as a table that ``read_response`` reads: what it is in lines with ``#``, then frequency, gain, phase and more."""
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
    text = io.StringIO()
    text.write(f"# experiment: {response.experiment}\n")
    text.write(f"# from: {response.input} ({source})\n# to: {response.output} ({target})\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([format(value, _DIGITS) for value in row] for row in zip(*columns.values(), strict=True))
    return text.getvalue()


def _estimate(one: Estimate, units: UnitSystem) -> dict[str, Json]:
    """One parameter; of one that is not determined nothing that could be taken for its value."""
    unknown, measured_in = one.unknown, unit(TABLE[one.unknown.key])
    known = one.status is not Status.UNDETERMINED
    found: dict[str, Json] = {
        "parameter": unknown.key,
        "symbol": unknown.symbol,
        "status": str(one.status),
        "file": quantity(unknown.nominal, measured_in, units),
        "bounds": [quantity(bound, measured_in, units) for bound in (unknown.low, unknown.high)],
        "prior": None,
        "half_interval_without_prior": _finite(one.share),
    }
    if unknown.prior is not None:
        mean, deviation = (quantity(value, measured_in, units) for value in unknown.prior)
        found["prior"] = {"mean": mean, "deviation": deviation}
    shown = {
        "estimate": one.value,
        "standard_error": one.deviation,
        "low": one.low,
        "high": one.high,
    }
    return found | {
        name: quantity(value, measured_in, units) if known else NOT_DETERMINED for name, value in shown.items()
    }


def _ended(found: Identification, end: Ended, units: UnitSystem) -> dict[str, Json]:
    values: dict[str, Json] = {}
    for one, value in zip(found.estimates, end.end.tolist(), strict=True):
        known = one.status is not Status.UNDETERMINED
        measured_in = unit(TABLE[one.unknown.key])
        values[one.unknown.key] = quantity(value, measured_in, units) if known else NOT_DETERMINED
    began: dict[str, Json] = {
        key: quantity(value, unit(TABLE[key]), units) for key, value in zip(found.keys, end.start.tolist(), strict=True)
    }
    return {"start": began, "end": values, "cost": _finite(end.cost), "same_place": end.same}


def _data(found: Identification, data: object, units: UnitSystem) -> dict[str, Json]:
    """One file, and what is left of each of its channels."""
    parts = [one for one in found.fitted if one.data is data]
    given = parts[0].data
    common: dict[str, Json] = {
        "name": given.name,
        "kind": "frequency response" if isinstance(given, Response) else "record",
        "experiment": str(given.experiment),
        "sha256": given.data_hash,
    }
    if isinstance(given, Response):
        common |= {"input": given.input, "output": given.output}
    else:
        common |= {"hold": given.hold}
    return common | {"channels": [_part(one, units) for one in parts]}


def _part(one: Fitted, units: UnitSystem) -> dict[str, Json]:
    response = isinstance(one.data, Response)
    ends: dict[str, Json] = {"points": len(one.at)}
    if response:
        ends["band"] = {"value": [float(one.at[0]), float(one.at[-1])], "unit": "Hz"}
        stated = stated_noise(one)
        sizes: dict[str, Json] = {
            "residual_rms": _finite(one.residual_rms),
            "noise": _finite(one.noise),
            "stated_noise": None if stated is None else _finite(stated),
        }
    else:
        ends["length"] = quantity(float(one.at[-1] - one.at[0]), SECONDS, units)
        measured_in = channel_unit(one.channel)
        sizes = {
            "residual_rms": quantity(one.residual_rms, measured_in, units),
            "noise": quantity(one.noise, measured_in, units),
        }
    return {"channel": one.channel, **ends, **sizes}


def _finite(value: float) -> Json:
    """A number that JSON has; text for the others."""
    return json_value(float(value), UnitSystem.SI)
