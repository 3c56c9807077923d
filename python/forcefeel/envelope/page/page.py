"""Page of an envelope, the template filled with maps, tables and text, and its folder."""

from dataclasses import dataclass
from pathlib import Path

from forcefeel.envelope.as_json import releases, settings_csv
from forcefeel.envelope.cockpit.as_json import result_json
from forcefeel.envelope.cockpit.cockpit import CockpitEnvelope, cockpit_conclusions
from forcefeel.envelope.cockpit.pair import COLORS_LINKED, PairEnvelope
from forcefeel.envelope.contact import PUSH_N, QUIET_N, TAP_N
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.page import plots as envelope_plots
from forcefeel.envelope.page import tables as envelope_tables
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.envelope.result import COLORS, Envelope
from forcefeel.envelope.strike import RATE_RAD_PER_S, THROWN_BACK
from forcefeel.json_values import json_text
from forcefeel.loader.axes import PROJECT_AXES
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.setting_maps import SettingMaps, picture, spans
from forcefeel.page.typography import quantity_text
from forcefeel.units import ANGLE, ANGULAR_VELOCITY, FORCE, UnitSystem


@dataclass(frozen=True)
class Files:
    """File names of an envelope, which its page links.

    Attributes:
        page: The page.
        settings: The settings as a table.
        maps: Outcome and margin of each setting in each case.
        axis: Axis of the files; empty for a single loader.
    """

    page: str
    settings: str
    maps: str
    axis: str = ""

    @classmethod
    def of(cls, axis: str = "") -> "Files":
        """File names of an axis, or of a single loader if ``axis`` is empty."""
        end = f"-{axis}" if axis else ""
        return cls(f"envelope{end}.html", f"settings{end}.csv", f"envelope{end}.nc", axis)

    @property
    def names(self) -> tuple[str, str, str]:
        """All three."""
        return self.page, self.settings, self.maps


PAGE, RESULTS = "envelope.html", "results.json"
"""File names in addition to those of ``Files``."""

FOLDER = OutputFolder(
    "the envelope",
    (PAGE, RESULTS, *(name for axis in ("", *PROJECT_AXES) for name in Files.of(axis).names)),
)
"""A loader's folder and a cockpit's replace each other."""


def envelope_page(envelope: Envelope, units: UnitSystem, files: Files, *, command: str = "") -> str:
    """The page, with numbers in ``units`` and links to ``files``."""
    plan = envelope.plan
    shares = [(name, envelope.shares(name)) for name in envelope.laws]
    nominal, worst = setting_maps(envelope, worst=False), setting_maps(envelope, worst=True)
    return render(
        "envelope/page/envelope.html.j2",
        command=command,
        loader=plan.given,
        files=files,
        plan=plan,
        conclusions=envelope_conclusions(envelope, units),
        laws=shares,
        shares=envelope_tables.shares(envelope),
        allowed=envelope_tables.allowed(envelope) if envelope.forbidden.settings.any() else None,
        angles=envelope_tables.by_angle(envelope, units) if envelope.smaller else None,
        angles_plot=drawing(envelope_plots.by_angle(envelope, units), "angles") if envelope.smaller else None,
        contacts=envelope_tables.contacts(envelope) if plan.contacts else None,
        **{
            name: quantity_text(force, FORCE, units, 2)
            for name, force in (("tap", TAP_N), ("push", PUSH_N), ("quiet", QUIET_N))
        },
        strike=quantity_text(RATE_RAD_PER_S, ANGULAR_VELOCITY, units, 2),
        thrown=f"{THROWN_BACK:g}",
        spans=spans(nominal, units),
        nominal=picture(nominal, units, worst),
        worst=picture(worst, units, nominal),
        failures=envelope_tables.failures(envelope),
        cases=envelope_tables.cases(envelope),
        drawn=envelope_tables.drawn(envelope) if plan.machines else None,
        counted=envelope_tables.counted(envelope),
        tolerances=tolerances(plan.deviations),
        smallest=envelope_tables.smallest(envelope, units),
        impedance=drawing(envelope_plots.impedance(envelope), "impedance"),
        passive=envelope_tables.passive(envelope),
        grid=envelope_tables.grid(envelope, units),
        arms=envelope_tables.arms(envelope),
        angle=quantity_text(plan.release_rad, ANGLE, units, 3),
        releases=f"{releases(envelope):,}",
        contacts_inferred=f"{envelope.contacts_inferred:,}" if envelope.contacts_inferred else "",
        envelope_inferred=f"{envelope.inferred:,} of {releases(envelope) + envelope.inferred:,}"
        if envelope.inferred
        else "",
        parameters=machine.parameters(plan.given, units),
    )


def setting_maps(envelope: Envelope, *, worst: bool) -> SettingMaps:
    """The outcomes of an envelope over its settings: the nominal failure, or if ``worst`` that in the first failing case."""
    settings = envelope.plan.settings
    return SettingMaps(
        stiffness=settings.stiffness,
        frequency=settings.frequency,
        damping=settings.damping,
        colors=COLORS,
        cells={law: envelope.kinds(law, worst=worst) for law in envelope.laws},
        loader=envelope.plan.given,
    )


def pair_maps(cockpit: CockpitEnvelope, pair: PairEnvelope) -> SettingMaps:
    """What each side renders alone, and the pair with both hands on."""
    alone = {f"{axis} alone": pair.alone_kinds(side) for side, axis in enumerate(pair.link.between)}
    return SettingMaps(
        stiffness=pair.settings.stiffness,
        frequency=pair.settings.frequency,
        damping=pair.settings.damping,
        colors=COLORS_LINKED,
        cells={**alone, "linked": pair.kinds},
        loader=cockpit.axes[pair.link.between[0]].plan.given,
    )


def cockpit_page(cockpit: CockpitEnvelope, units: UnitSystem, *, command: str = "") -> str:
    """The page of a cockpit, with links to the page of each axis."""
    return render(
        "envelope/page/cockpit.html.j2",
        pairs=[
            (pair, picture(pair_maps(cockpit, pair), units), envelope_tables.arms_of_pair(pair))
            for pair in cockpit.pairs
        ],
        command=command,
        name=cockpit.name,
        axes={
            axis: (envelope, envelope_conclusions(envelope, units), Files.of(axis))
            for axis, envelope in cockpit.axes.items()
        },
        conclusions=cockpit_conclusions(cockpit),
        table_of_axes=envelope_tables.axes(cockpit, {axis: Files.of(axis).page for axis in cockpit.axes}),
        rules=list(
            dict.fromkeys(
                f"{envelope.plan.rules.title}, {envelope.plan.rules.edition}" for envelope in cockpit.axes.values()
            )
        ),
    )


def write_envelope(
    envelope: Envelope | CockpitEnvelope, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``envelope.nc``, ``settings.csv``, ``results.json`` and ``envelope.html``, the page last.

    Of a cockpit the page and the two files of each axis, such as ``envelope-roll.html``, then those of all axes.
    Existing files stay until the new ones are complete; other files in the folder are not touched.

    Args:
        envelope: The envelope of a loader, or of each axis of a cockpit.
        out: The folder; created if missing.
        units: Units of all numbers except those of ``envelope.nc``, which are SI.
        replace: Whether existing files may be replaced.
        command: Command line to show on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains such files and ``replace`` is false, or cannot be written.

    Example:
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> envelope = ff.find_envelope(ff.elevator(), ["original"], grid)
        >>> ff.envelope.write_envelope(envelope, Path("envelope"), ff.UnitSystem.SI).parent.name
        'envelope'
    """
    FOLDER.check(out, replace=replace)
    contents: dict[str, str | bytes] = {}
    for axis, axis_envelope in envelope.axes.items() if isinstance(envelope, CockpitEnvelope) else [("", envelope)]:
        files = Files.of(axis)
        contents[files.maps] = bytes(axis_envelope.data.to_netcdf(engine="scipy"))
        contents[files.settings] = settings_csv(axis_envelope, units)
        contents[files.page] = envelope_page(axis_envelope, units, files, command=command)
    if isinstance(envelope, CockpitEnvelope):
        contents[PAGE] = cockpit_page(envelope, units, command=command)
    contents = {RESULTS: json_text(result_json(envelope, units)), **contents}
    FOLDER.write(out, contents)
    return out / PAGE
