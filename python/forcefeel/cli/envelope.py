"""``forcefeel envelope``."""

from dataclasses import dataclass
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group
from rich.table import Table

from forcefeel.cli.law_option import DEFAULT_LAW, LAW_METAVAR, LAW_NAMES, law_option_named
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderOrProject, OutputOptions, ThreadOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.release_options import ASKED, AngleOptions, ReleaseOptions
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.conclusions import share_text
from forcefeel.errors import InputError
from forcefeel.units import FORCE, UnitSystem, to_text

if TYPE_CHECKING:
    from forcefeel.envelope import CockpitEnvelope, Envelope
    from forcefeel.envelope.plan import Plan
    from forcefeel.loader.loader import Loader

DRAWN = Group("All tolerances at once", sort_key=20)


@dataclass(frozen=True, kw_only=True)
class EnvelopeOptions(ReleaseOptions, AngleOptions, FolderOptions, ThreadOptions, OutputOptions):
    """The options of ``forcefeel envelope``."""

    grid: Annotated[
        tuple[str, ...],
        option(
            "Values along an axis. Defaults: 'stiffness=1..100 %:25:log' (of G_max), 'frequency=0.5..4 Hz:16:log', "
            "'damping=0.1, 0.2, 0.4, 0.7, 1, 1.5'. Repeatable.",
            ASKED,
            metavar="AXIS=VALUES",
        ),
    ] = ()
    law: Annotated[
        tuple[str, ...],
        option(
            f"Law, designed for each setting: {LAW_NAMES}; or a law file. Repeatable.",
            ASKED,
            default=DEFAULT_LAW,
            metavar=LAW_METAVAR,
        ),
    ] = ()
    compare: Annotated[bool, option("Compare all laws.", ASKED)] = False
    draws: Annotated[int, option("Number of machines drawn from all tolerances; 0 for none.", DRAWN)] = 40
    seed: Annotated[int, option("Seed of the draws.", DRAWN)] = 0
    corners: Annotated[
        bool,
        option("Draw each tolerance at one of its limits instead of between them.", DRAWN),
    ] = False
    contact: Annotated[
        bool,
        option(
            "Also test clamps and stops of 1e3 to 1e6 N/m at the grip. Disable with --no-contact.",
            ASKED,
            negative="--no-contact",
        ),
    ] = True
    soften: Annotated[
        bool,
        option("Soften settings that the drive forbids to the nearest that it renders, and release these too.", ASKED),
    ] = False
    full: Annotated[bool, option("Run every setting in every case; infer none from its neighbors.", ASKED)] = False
    out: Annotated[Path, option("Folder for envelope.html, settings.csv and results.json.", OUTPUT)] = Path(
        "forcefeel-envelope"
    )

    def plan(self, loader: "Loader") -> "Plan":
        """What is to be computed of a loader.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        from forcefeel.envelope.draws import Draws
        from forcefeel.envelope.plan import make_plan
        from forcefeel.laws.law import default_law, names_for
        from forcefeel.sweep import text

        if self.compare and self.law:
            raise InputError("--compare and --law: given both, and --compare takes all laws; leave one out")
        names = names_for(loader) if self.compare else self.law or (default_law(loader),)
        plan = make_plan(
            loader,
            names,
            text.assignments("--grid", self.grid, "stiffness=1..100 %:25:log"),
            rule=self.rule,
            angle_rad=self.angle_rad,
            changes=self.deviations(loader),
            draws=Draws(self.draws, self.seed, self.corners),
            full=self.full,
            soften=self.soften,
        )
        return (plan.with_contacts() if self.contact else plan).with_smaller_releases()


def run(path: LoaderOrProject = None, /, *, options: EnvelopeOptions = EnvelopeOptions()) -> None:
    """Map the programmed feels that the loader renders: stable, and a release within the tolerances of a rule.

    Tests the nominal plant, each plant parameter at both limits of its tolerance, each pilot's arm at the grip, and machines with
    all tolerances at once. Without a tolerance in the file: lengths 1 % (a ruler's), valve gain 30 %, others 20 %; change them
    with --deviation.

    For a project file with a table [axes], writes a page for each axis and a summary of them. Each link is tested with each pilot's
    arm on both sides, at up to 120 settings that both sides render alone.

    Example: forcefeel envelope my.toml --compare --out envelope
    """
    from forcefeel.envelope.cockpit.as_json import result_json
    from forcefeel.envelope.cockpit.cockpit import find_cockpit
    from forcefeel.envelope.page.page import FOLDER, write_envelope
    from forcefeel.envelope.run import compute
    from forcefeel.loader.project import Project

    with law_option_named():
        subject = options.project(path) or options.plan(options.loader(path))
        FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
        with all_or_nothing("envelope", "releases", silent=options.json) as bar:
            envelope: Envelope | CockpitEnvelope = (
                find_cockpit(subject, options.plan, threads=options.threads, progress=bar.show)
                if isinstance(subject, Project)
                else compute(subject, threads=options.threads, progress=bar.show)
            )
            bar.describe("report")
            command = options.command_line(path)
            page = write_envelope(envelope, options.out, options.units, replace=options.replace, command=command)
    answer(
        {"page": page},
        lambda: result_json(envelope, options.units),
        lambda terminal: _show(terminal, envelope, options.units),
        as_json=options.json,
    )


def _show_axes(console: Terminal, cockpit: "CockpitEnvelope") -> None:
    from forcefeel.envelope.cockpit.cockpit import SHARES, cockpit_conclusions
    from forcefeel.envelope.findings import angle_text

    title = f"{cockpit.name}: shares of the settings"
    table = titled(title, "axis", "loader", "drive", "law", "from", numbers=SHARES)
    table.add_column("largest loss from")
    for row in cockpit.rows:
        table.add_row(
            row.axis,
            row.loader,
            row.drive,
            row.law,
            angle_text(row.release_rad, UnitSystem.SI),
            *row.shares,
            row.worst_text,
        )
    console.show(table, ["drive", "loader"])
    if cockpit.pairs:
        numbers = ("settings", "rendered alone", "of these, linked")
        links = titled("Both hands on", "link", "law", "fewest with", numbers=numbers)
        for pair in cockpit.pairs:
            worst = min(pair.rows, key=lambda row: row.passes, default=None)
            links.add_row(
                pair.link.name,
                pair.law,
                f"{worst.first}, {worst.second}: {share_text(worst.passes)}" if worst else "–",
                f"{pair.settings.count:,}",
                f"{pair.rendered.sum():,}",
                share_text(pair.linked_share) if worst else "–",
            )
        console.show(links)
    console.conclude(cockpit_conclusions(cockpit), alarming=False)


def _show(console: Terminal, envelope: "Envelope | CockpitEnvelope", units: UnitSystem) -> None:
    from forcefeel.envelope.cockpit.cockpit import CockpitEnvelope
    from forcefeel.envelope.findings import angle_text, envelope_conclusions

    if isinstance(envelope, CockpitEnvelope):
        _show_axes(console, envelope)
        return
    title = f"Shares of the settings, released from {angle_text(envelope.plan.release_rad, units)}"
    table = titled(title, "law", numbers=("stable", "passes", "stable in every case", "passes in every case"))
    for name in envelope.laws:
        shares = envelope.shares(name)
        table.add_row(
            name, *map(share_text, (shares.stable, shares.nominal_share, shares.stable_worst, shares.worst_case_share))
        )
    console.show(table)
    if envelope.softened:
        console.show(_softened(envelope))
    if envelope.plan.contacts:
        console.show(_in_contact(envelope, units))
    if envelope.smaller:
        console.show(_by_angle(envelope, units))
    if envelope.plan.machines:
        console.show(_drawn(envelope))
    console.conclude(envelope_conclusions(envelope, units), alarming=False)


def _softened(envelope: "Envelope") -> Table:
    table = titled("Settings with the nominal plant", "law", numbers=("as programmed", "softened", "not at all"))
    for shares in envelope.softened:
        table.add_row(shares.law, *map(share_text, (shares.as_programmed, shares.softened, shares.not_rendered)))
    return table


def _in_contact(envelope: "Envelope", units: UnitSystem) -> Table:
    """Quiet settings; the largest force is that of a contact at the grip, the fastest return that from a stop."""
    from forcefeel.page.typography import NONE, quantity_text

    numbers = ("quiet in every contact", "least share in a contact", "thrown back", "fastest return", "largest force")
    table = titled(f"Settings in {len(envelope.plan.contacts)} contacts, clamps and stops", "law", numbers=numbers)
    for name in envelope.laws:
        shares = envelope.contact_shares(name)
        least, fastest = min(shares.by_contact.values()), shares.fastest_return
        row = (
            *map(share_text, (shares.quiet, least, shares.thrown_back)),
            NONE if isnan(fastest) else f"{to_text(fastest, 2)} times",
        )
        table.add_row(name, *row, quantity_text(shares.largest_force_n, FORCE, units, 3))
    return table


def _by_angle(envelope: "Envelope", units: UnitSystem) -> Table:
    from forcefeel.envelope.findings import angle_text

    angles = [angle_text(angle_shares.release_rad, units) for angle_shares in envelope.by_angle]
    table = titled("Passes with the nominal plant, released from", "law", numbers=angles)
    for name in envelope.laws:
        table.add_row(name, *(share_text(angle_shares.passes[name]) for angle_shares in envelope.by_angle))
    return table


def _drawn(envelope: "Envelope") -> Table:
    from forcefeel.envelope.result import MOST

    machines = (
        f"{len(envelope.plan.machines):,} machines {'at the corners' if envelope.plan.draws.corners else 'at random'}"
    )
    most = share_text(MOST)
    numbers = (f"settings, in {most} of machines", f"machines, at {most} of settings", "a machine, on average")
    table = titled(f"All tolerances at once, {machines}", "law", numbers=numbers)
    for name in envelope.laws:
        drawn = envelope.drawn_shares(name)
        table.add_row(name, *map(share_text, (drawn.settings, drawn.good, drawn.passes)))
    return table
