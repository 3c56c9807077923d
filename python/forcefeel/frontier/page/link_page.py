"""Page of the limits of a project's links, and its folder."""

from importlib.metadata import version
from math import isfinite
from pathlib import Path

import plotly.graph_objects as go

from forcefeel.conclusions import capital
from forcefeel.frontier.link_limits import CockpitFrontier, LinkFrontier, link_conclusions, stiffness_text
from forcefeel.frontier.page.page import FOLDER, PAGE, RESULTS
from forcefeel.json_values import json_text, json_value
from forcefeel.loader.links import LINK_TABLE
from forcefeel.loader.parameters import unit
from forcefeel.page.canvas import add_curve, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.picture import Picture
from forcefeel.page.render import render
from forcefeel.page.table import Table, heads, number
from forcefeel.units import ROTARY_DAMPING, Json, UnitSystem, to_text

_LOOKS = (LineStyle(COMPLIANT, "solid"), LineStyle(COMPENSATED, "dash"), LineStyle(RIGID, "dot"))


def limit_rows(frontier: LinkFrontier, units: UnitSystem) -> tuple[tuple[str, ...], ...]:
    """Delay, then the largest stable stiffness for each injected damping, as text."""
    by_delay: dict[float, list[str]] = {}
    for limit in frontier.limits:
        by_delay.setdefault(limit.delay_s, []).append(stiffness_text(limit, units))
    return tuple((f"{1e3 * delay:g} ms", *texts) for delay, texts in by_delay.items())


def limit_heads(frontier: LinkFrontier, units: UnitSystem) -> tuple[str, ...]:
    """Heads of ``limit_rows``."""
    return ("one-way delay", *(f"{_damping(value, units)} injected" for value in _dampings(frontier)))


def links_json(frontier: CockpitFrontier, units: UnitSystem) -> dict[str, Json]:
    """The limits of each link, every number with its unit."""
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "project": frontier.name,
        "conclusions": json_value(link_conclusions(frontier, units), units),
        "links": {
            name: {
                "between": list(of.link.between),
                "kind": str(of.link.kind),
                "law": of.law,
                "own": json_value(of.own, units),
                "used": of.used if isfinite(of.used) else None,
                "limits": [json_value(limit, units) for limit in of.limits],
            }
            for name, of in frontier.links.items()
        },
    }


def write_links(
    frontier: CockpitFrontier, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``results.json`` and ``frontier.html``, the page last; arguments as for ``write_frontier``.

    Raises:
        InputError: As ``write_frontier``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
        >>> frontier = ff.frontier.link_frontier(project, "robust", delays=[1])
        >>> ff.frontier.write_links(frontier, Path("links"), ff.UnitSystem.US).name
        'frontier.html'
    """
    FOLDER.check(out, replace=replace)
    page = render(
        "frontier/page/links.html.j2",
        command=command,
        name=frontier.name,
        conclusions=link_conclusions(frontier, units),
        links=[
            (of, Picture.of(f"link-{k}", "", "", _curves(of, units)), _table(of, units))
            for k, of in enumerate(frontier.links.values())
        ],
    )
    FOLDER.write(out, {RESULTS: json_text(links_json(frontier, units)), PAGE: page})
    return out / PAGE


def _dampings(frontier: LinkFrontier) -> list[float]:
    return list(dict.fromkeys(limit.injected_damping_n_m_s_per_rad for limit in frontier.limits))


def _damping(value: float, units: UnitSystem) -> str:
    return (
        f"{to_text(ROTARY_DAMPING.from_si(value, units), 3)} {ROTARY_DAMPING.shown(units)}" if value else "no damping"
    )


def _table(frontier: LinkFrontier, units: UnitSystem) -> Table:
    head = heads(*map(capital, limit_heads(frontier, units)))
    return Table(head, tuple(tuple(map(number, row)) for row in limit_rows(frontier, units)))


def _curves(frontier: LinkFrontier, units: UnitSystem) -> go.Figure:
    """Largest stable stiffness over the delay, a curve for each injected damping, and the link itself."""
    picture, of = go.Figure(), unit(LINK_TABLE["stiffness"])
    for damping, look in zip(_dampings(frontier), _LOOKS, strict=True):
        limits = [limit for limit in frontier.limits if limit.injected_damping_n_m_s_per_rad == damping]
        delays = [1e3 * limit.delay_s for limit in limits]
        stiffness = [of.from_si(limit.stiffness_n_m_per_rad, units) for limit in limits]
        add_curve(
            picture,
            delays,
            stiffness,
            f"{_damping(damping, units)} injected",
            look,
            f"%{{y:.3~g}} {of.shown(units)}",
        )
    if frontier.own is not None:
        picture.add_scatter(
            x=[1e3 * frontier.own.delay_s],
            y=[of.from_si(frontier.link["stiffness"], units)],
            mode="markers",
            name="the link",
            marker={"size": 11, "color": IDEAL},
            hovertemplate=f"%{{y:.3~g}} {of.shown(units)}",
        )
    frame(picture, 420)
    picture.update_xaxes(
        type="log", title_text="One-way delay, ms", tickvals=[0.5, 1, 2, 5, 10, 20, 50], hoverformat=".3~g"
    )
    picture.update_yaxes(
        type="log", dtick="D2", tickformat=",~r", title_text=f"Largest stable stiffness, {of.shown(units)}"
    )
    return picture
