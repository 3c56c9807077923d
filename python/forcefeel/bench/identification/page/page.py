"""The page of an identification: the template with plots, tables and text."""

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
    identification: Identification,
    units: UnitSystem,
    settings: FitSettings | None = None,
    estimated: Sequence[str] = (),
    *,
    command: str = "",
) -> str:
    """The whole page, numbers in ``units``.

    Args:
        identification: The identification.
        units: Units of the numbers.
        settings: Settings of the fit.
        estimated: Files with responses estimated from records.
        command: The command.
    """
    responses = [fitted for fitted in identification.fitted if isinstance(fitted.data, Response)]
    return render(
        "bench/identification/page/identification.html.j2",
        command=command,
        loader=identification.before,
        identification=identification,
        conclusions=identification_conclusions(identification, units),
        glance=identification_tables.glance(identification),
        estimates=identification_tables.estimates(identification, units),
        estimates_drawing=_estimates(identification),
        inseparable=[
            (group.sentence, identification_tables.inseparable(group) if len(group.keys) > 1 else None)
            for group in identification.inseparable
        ],
        advice=identification_tables.advice(identification),
        responses=[
            _response(k, fitted, fitted.data, units)
            for k, fitted in enumerate(responses)
            if isinstance(fitted.data, Response)
        ],
        bars=any(stated_noise(fitted) for fitted in responses),
        records=[
            _record(k, fitted, units)
            for k, fitted in enumerate(fitted for fitted in identification.fitted if fitted not in responses)
        ],
        several=len(identification.estimates) > 1,
        correlations=identification_tables.correlations(identification),
        rigid=identification.rigid and identification_tables.rigid(identification.rigid),
        level=number_text(identification.rigid.level) if identification.rigid else "",
        data=identification_tables.data(identification, units),
        estimated=estimated,
        settings=settings and identification_tables.settings(settings),
        ends=identification_tables.ends(identification, units),
        parameters=machine.parameters(identification.loader or identification.before, units),
    )


def _estimates(identification: Identification) -> Markup:
    """The plot of the estimates; empty without determined ones."""
    if all(estimate.status is Status.UNDETERMINED for estimate in identification.estimates):
        return Markup("")
    return drawing(identification_plots.estimates(identification), "estimates-plot")


def _response(k: int, fitted: Fitted, data: Response, units: UnitSystem) -> Picture:
    drawn = identification_plots.response(fitted, data, units)
    return Picture.of(f"response-{k}", title_of(fitted), _meaning(fitted, units), drawn)


def _record(k: int, fitted: Fitted, units: UnitSystem) -> Picture:
    drawn = identification_plots.record(fitted, units)
    return Picture.of(f"record-{k}", title_of(fitted), _meaning(fitted, units), drawn)


def _meaning(fitted: Fitted, units: UnitSystem) -> Markup:
    experiment = str(fitted.data.experiment).replace("_", " ")
    return prose_html(
        f"Experiment {experiment}; the fit leaves {size_text(fitted, fitted.residual_rms, units)} (root mean square)."
    )
