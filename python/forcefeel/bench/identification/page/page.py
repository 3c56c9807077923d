"""The page of an identification: the template filled with plots, tables and words."""

from collections.abc import Sequence

from markupsafe import Markup

from forcefeel.bench.identification.as_json import FitSettings
from forcefeel.bench.identification.digits import title_of
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.bench.identification.misfit import size_text, stated_noise
from forcefeel.bench.identification.page import plots as identification_plots
from forcefeel.bench.identification.page import tables as identification_tables
from forcefeel.bench.identification.result import Fitted, Identification, Status
from forcefeel.bench.responses import Response
from forcefeel.page import machine
from forcefeel.page.picture import Picture
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import number_text, prose_html
from forcefeel.units import UnitSystem


def identification_page(
    found: Identification,
    units: UnitSystem,
    settings: FitSettings | None = None,
    estimated: Sequence[str] = (),
    *,
    command: str = "",
) -> str:
    """The whole page, numbers in ``units``.

    Args:
        found: The identification.
        units: Units of the numbers.
        settings: How it was made; nothing is said of it if not given.
        estimated: Files beside the page that hold responses estimated from records.
        command: The command that asked for it.
    """
    responses = [one for one in found.fitted if isinstance(one.data, Response)]
    return render(
        "bench/identification/page/identification.html.j2",
        command=command,
        loader=found.before,
        found=found,
        conclusions=identification_conclusions(found, units),
        glance=identification_tables.glance(found),
        estimates=identification_tables.estimates(found, units),
        estimates_drawing=_estimates(found),
        inseparable=[
            (one.sentence, identification_tables.inseparable(one) if len(one.keys) > 1 else None)
            for one in found.inseparable
        ],
        advice=identification_tables.advice(found),
        responses=[
            _response(k, one, one.data, units) for k, one in enumerate(responses) if isinstance(one.data, Response)
        ],
        bars=any(stated_noise(one) for one in responses),
        records=[_record(k, one, units) for k, one in enumerate(one for one in found.fitted if one not in responses)],
        several=len(found.estimates) > 1,
        correlations=identification_tables.correlations(found),
        rigid=found.rigid and identification_tables.rigid(found.rigid),
        level=number_text(found.rigid.level) if found.rigid else "",
        data=identification_tables.data(found, units),
        estimated=estimated,
        settings=settings and identification_tables.settings(settings),
        ends=identification_tables.ends(found, units),
        parameters=machine.parameters(found.loader or found.before, units),
    )


def _estimates(found: Identification) -> Markup:
    """The plot of the estimates; nothing where there is none to draw."""
    if all(one.status is Status.UNDETERMINED for one in found.estimates):
        return Markup("")
    return drawing(identification_plots.estimates(found), "estimates-plot")


def _response(k: int, one: Fitted, data: Response, units: UnitSystem) -> Picture:
    drawn = identification_plots.response(one, data, units)
    return Picture.of(f"response-{k}", title_of(one), _meaning(one, units), drawn)


def _record(k: int, one: Fitted, units: UnitSystem) -> Picture:
    drawn = identification_plots.record(one, units)
    return Picture.of(f"record-{k}", title_of(one), _meaning(one, units), drawn)


def _meaning(one: Fitted, units: UnitSystem) -> Markup:
    experiment = str(one.data.experiment).replace("_", " ")
    return prose_html(
        f"Experiment {experiment}; the fit leaves {size_text(one, one.residual_rms, units)} (root mean square)."
    )
