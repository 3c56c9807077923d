"""The page of an envelope: the template filled with maps, tables and words."""

from dataclasses import dataclass

from forcefeel.envelope.as_json import releases
from forcefeel.envelope.cockpit import CockpitEnvelope, cockpit_conclusions
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.page import plots as envelope_plots
from forcefeel.envelope.page import tables as envelope_tables
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.envelope.result import COLORS, Envelope
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.setting_maps import SettingMaps, picture, spans
from forcefeel.page.typography import quantity_text
from forcefeel.units import ANGLE, UnitSystem


@dataclass(frozen=True)
class Files:
    """The names of an envelope's files, which its page links.

    Attributes:
        page: The page.
        settings: The settings as a table.
        maps: Outcome and margin of each setting in each case.
        axis: The axis that they are of; empty where there is but one loader.
    """

    page: str
    settings: str
    maps: str
    axis: str = ""

    @classmethod
    def of(cls, axis: str = "") -> "Files":
        """The names of an axis's files; of the only loader's if none is given."""
        end = f"-{axis}" if axis else ""
        return cls(f"envelope{end}.html", f"settings{end}.csv", f"envelope{end}.nc", axis)

    @property
    def names(self) -> tuple[str, str, str]:
        """All three."""
        return self.page, self.settings, self.maps


def envelope_page(found: Envelope, units: UnitSystem, files: Files, *, command: str = "") -> str:
    """The whole page, numbers in ``units``; ``files`` are what it stands among."""
    plan = found.plan
    shares = [(name, found.shares(name)) for name in found.laws]
    nominal, worst = setting_maps(found, worst=False), setting_maps(found, worst=True)
    return render(
        "envelope/page/envelope.html.j2",
        command=command,
        loader=plan.given,
        files=files,
        plan=plan,
        conclusions=envelope_conclusions(found, units),
        laws=shares,
        shares=envelope_tables.shares(found),
        allowed=envelope_tables.allowed(found) if found.forbidden.settings.any() else None,
        angles=envelope_tables.by_angle(found, units) if found.smaller else None,
        angles_plot=drawing(envelope_plots.by_angle(found, units), "angles") if found.smaller else None,
        spans=spans(nominal, units),
        nominal=picture(nominal, units, worst),
        worst=picture(worst, units, nominal),
        failures=envelope_tables.failures(found),
        cases=envelope_tables.cases(found),
        drawn=envelope_tables.drawn(found) if plan.machines else None,
        counted=envelope_tables.counted(found),
        tolerances=tolerances(plan.deviations),
        smallest=envelope_tables.smallest(found, units),
        impedance=drawing(envelope_plots.impedance(found), "impedance"),
        passive=envelope_tables.passive(found),
        grid=envelope_tables.grid(found, units),
        arms=envelope_tables.arms(found),
        angle=quantity_text(plan.release_rad, ANGLE, units, 3),
        releases=f"{releases(found):,}",
        parameters=machine.parameters(plan.given, units),
    )


def setting_maps(envelope: Envelope, *, worst: bool) -> SettingMaps:
    """The outcomes of an envelope over its settings.

    Args:
        envelope: The envelope.
        worst: By the first failure in the first case that fails, in place of the nominal failure.
    """
    settings = envelope.plan.settings
    return SettingMaps(
        stiffness=settings.stiffness,
        frequency=settings.frequency,
        damping=settings.damping,
        colors=COLORS,
        cells={law: envelope.kinds(law, worst=worst) for law in envelope.laws},
        loader=envelope.plan.given,
    )


def cockpit_page(found: CockpitEnvelope, units: UnitSystem, *, command: str = "") -> str:
    """The page over the axes of a cockpit, which links each axis's own."""
    return render(
        "envelope/page/cockpit.html.j2",
        command=command,
        name=found.name,
        axes={axis: (one, envelope_conclusions(one, units), Files.of(axis)) for axis, one in found.axes.items()},
        conclusions=cockpit_conclusions(found),
        table_of_axes=envelope_tables.axes(found, {axis: Files.of(axis).page for axis in found.axes}),
        rules=list(dict.fromkeys(f"{one.plan.rules.title}, {one.plan.rules.edition}" for one in found.axes.values())),
    )
