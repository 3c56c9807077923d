"""The commands, their options and their help. Bodies import what they need, so that help answers at once."""

from pathlib import Path
from typing import Annotated

import typer

from forcefeel.cli.compensate_options import (
    CompensateEnvelope,
    CompensateGrid,
    CompensateMethod,
    CompensateOff,
    CompensateOut,
    CompensateReplace,
    CompensateRule,
    CompensateSaveLaw,
    CompensateThreads,
)
from forcefeel.cli.envelope_options import (
    EnvelopeAngle,
    EnvelopeCompare,
    EnvelopeCompensators,
    EnvelopeCorners,
    EnvelopeDraws,
    EnvelopeGrid,
    EnvelopeOff,
    EnvelopeRule,
    EnvelopeSeed,
    EnvelopeThreads,
)
from forcefeel.cli.excite_options import (
    ExciteCurrent,
    ExciteDrive,
    ExciteExperiment,
    ExciteFit,
    ExciteForce,
    ExciteFrom,
    ExciteKind,
    ExciteKindOption,
    ExciteLaw,
    ExciteMeasure,
    ExciteNoise,
    ExciteOut,
    ExciteRate,
    ExciteTime,
    ExciteTo,
    ExciteTravel,
)
from forcefeel.cli.frontier_options import FrontierCompensator, FrontierGrid
from forcefeel.cli.identify_options import (
    AsResponses,
    BenchColumn,
    BenchExperiment,
    BenchFile,
    BenchFiles,
    BenchFrom,
    BenchHold,
    BenchTo,
    BenchUnit,
    IdentifyFit,
    IdentifyLaw,
    IdentifyLoss,
    IdentifyLossOption,
    IdentifyStarts,
    NoPriors,
    ResonanceBand,
    ResonanceChannel,
)
from forcefeel.cli.options import (
    R1,
    R2,
    Converge,
    Horizon,
    Json,
    LoaderFile,
    PilotCoupling,
    PositionWeight,
    Q,
    Step,
    Tolerance,
    Units,
)
from forcefeel.cli.qualify_options import (
    AllLaws,
    AxisOption,
    Changes,
    ControlAxis,
    Laws,
    Operator,
    OutFolder,
    Overdamped,
    OverdampedOption,
    Pdf,
    Pressure,
    QualifyRule,
    RecordColumns,
    Recorded,
    RecordUnits,
    References,
    Simulator,
    Tests,
    ThrowOption,
)
from forcefeel.cli.scenario_options import ScenarioOptions, with_scenario
from forcefeel.cli.schedule_options import ScheduleKnots, ScheduleMethod, ScheduleRefine
from forcefeel.cli.sweep_options import Grid, Redesign, Runs, Scheduler, Threads, Vary
from forcefeel.units import UnitSystem

app = typer.Typer(
    name="forcefeel",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="Design, prove and run the force feel of aircraft simulator controls.\n\n"
    "Exit status: 0 fine, 1 the answer is bad (such as an unstable design), 2 the input is bad, 70 a fault of forcefeel itself: "
    "please report it, with what it prints where FORCEFEEL_TRACEBACK=1 is set.",
)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version  # noqa: PLC0415

        typer.echo(f"forcefeel {version('forcefeel')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Options of the program itself."""


@app.command(epilog="Example: `forcefeel new my.toml --units si`")
def new(
    path: Annotated[Path, typer.Argument(help="Loader file to write.")],
    units: Units = UnitSystem.US,
    json: Json = False,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it is there.")] = False,
    built_in: Annotated[
        str, typer.Option("--built-in", help="Which: elevator, or elevator-2khz with a digital controller.")
    ] = "elevator",
) -> None:
    """Write the built-in elevator loader as a commented loader file."""
    from forcefeel.cli import commands  # noqa: PLC0415

    commands.new(path, built_in, units, as_json=json, force=force)


@app.command(epilog="Example: `forcefeel design my.toml --out report`")
def design(
    loader: LoaderFile = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for report.html, results.json and the responses.")] = Path(
        "forcefeel-report"
    ),
    units: Units = UnitSystem.US,
    json: Json = False,
    horizon: Horizon = None,
    converge: Converge = False,
    step: Step = None,
    tolerance: Tolerance = None,
    position_weight: PositionWeight = None,
    r1: R1 = None,
    r2: R2 = None,
    pilot_coupling: PilotCoupling = None,
    q: Q = None,
) -> None:
    """Analyse a loader, compensate it, and write the report.

    Exit status 1 if the compensated loader is unstable at the programmed setting.
    """
    from forcefeel.cli import commands  # noqa: PLC0415

    chosen = commands.Options(horizon, converge, step, tolerance, position_weight, r1, r2, pilot_coupling, q)
    commands.design(loader, chosen, out, units, as_json=json)


@app.command(epilog="Example: `forcefeel analyze my.toml --json > analysis.json`")
def analyze(loader: LoaderFile = None, units: Units = UnitSystem.US, json: Json = False) -> None:
    """Analyse the original system: modes, margins, stability, response.

    Exit status 1 if it is unstable at the programmed setting (compliant link).
    """
    from forcefeel.cli import commands  # noqa: PLC0415

    commands.analyze(loader, units, as_json=json)


@app.command(epilog="Example: `forcefeel compensate elevator-2khz --method auto --out methods`")
def compensate(
    loader: LoaderFile = None,
    units: Units = UnitSystem.US,
    json: Json = False,
    method: CompensateMethod = None,
    envelope: CompensateEnvelope = False,
    grid: CompensateGrid = None,
    rule: CompensateRule = None,
    off: CompensateOff = None,
    set_: Changes = None,
    out: CompensateOut = None,
    replace: CompensateReplace = False,
    threads: CompensateThreads = None,
    save_law: CompensateSaveLaw = None,
    horizon: Horizon = None,
    converge: Converge = False,
    step: Step = None,
    tolerance: Tolerance = None,
    position_weight: PositionWeight = None,
    r1: R1 = None,
    r2: R2 = None,
    pilot_coupling: PilotCoupling = None,
    q: Q = None,
) -> None:
    """Compute the feedback gains by recursion (22) and close the loop with them; or try methods and choose one.

    With `--method auto` every method is scored over the envelope, on the valve, on noise and on margins, and one is chosen.

    Exit status 1 if the compensated loader is unstable at the programmed setting, or no method is eligible.
    """
    from forcefeel.cli import commands, compensate_command  # noqa: PLC0415
    from forcefeel.cli.given_loader import given_loader  # noqa: PLC0415

    recursion = commands.Options(horizon, converge, step, tolerance, position_weight, r1, r2, pilot_coupling, q)
    chosen = compensate_command.MethodOptions(method, envelope, grid, rule, off, out, replace, threads)
    compensate_command.run_compensate(
        given_loader(loader, set_), recursion, chosen, units, save_law=save_law, as_json=json
    )


@app.command(epilog="Example: `forcefeel simulate my.toml --input release --angle '10 deg' --out run`")
@with_scenario
def simulate(
    loader: LoaderFile = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for simulation.html, history.csv and results.json.")
    ] = None,
    units: Units = UnitSystem.US,
    json: Json = False,
    *,
    scenario: ScenarioOptions,
) -> None:
    """Run the loader in time: nonlinear where its file says so.

    Values are text with a unit, such as '20 lb'; times may go without, in seconds. Exit status 1 if the run diverged.
    """
    from forcefeel.cli import simulate_command  # noqa: PLC0415

    simulate_command.run_simulate(loader, scenario, out, units, as_json=json)


@app.command(epilog="Example: `forcefeel sweep my.toml --runs 100000 --out sweep`")
@with_scenario
def sweep(
    loader: LoaderFile = None,
    runs: Runs = None,
    vary: Vary = None,
    grid: Grid = None,
    redesign: Redesign = False,
    out: Annotated[Path, typer.Option("--out", help="Folder for sweep.html, summary.json and runs.nc.")] = Path(
        "forcefeel-sweep"
    ),
    resume: Annotated[bool, typer.Option("--resume", help="Go on with what is finished in the folder.")] = False,
    replace: Annotated[bool, typer.Option("--replace", help="Replace a sweep that is in the folder.")] = False,
    threads: Threads = None,
    scheduler: Scheduler = None,
    units: Units = UnitSystem.US,
    json: Json = False,
    *,
    scenario: ScenarioOptions,
) -> None:
    """Run many loaders: drawn from the tolerances of the loader file, or over a grid of settings.

    The same seed gives the same numbers, whatever the threads or workers. Ctrl-C keeps what is finished and says how to go on
    (exit status 130). Exit status 1 if a loader within the tolerances diverged.
    """
    from forcefeel.cli import sweep_command  # noqa: PLC0415

    chosen = sweep_command.SweepOptions(runs, vary, grid, redesign, out, resume, replace, scheduler, threads)
    sweep_command.run_sweep_command(loader, chosen, scenario, units, as_json=json)


@app.command(epilog="Example: `forcefeel envelope my.toml --compare --out envelope`")
def envelope(
    loader: LoaderFile = None,
    grid: EnvelopeGrid = None,
    compensator: EnvelopeCompensators = None,
    compare: EnvelopeCompare = False,
    rule: EnvelopeRule = None,
    angle: EnvelopeAngle = None,
    off: EnvelopeOff = None,
    draws: EnvelopeDraws = 40,
    seed: EnvelopeSeed = 0,
    corners: EnvelopeCorners = False,
    set_: Changes = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for envelope.html, settings.csv and results.json.")] = Path(
        "forcefeel-envelope"
    ),
    replace: Annotated[bool, typer.Option("--replace", help="Replace an envelope that is in the folder.")] = False,
    threads: EnvelopeThreads = None,
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Map which programmed feels the loader renders: stable, and its release within the tolerances of a rule.

    With the nominal plant, with each plant parameter at either end of its tolerance (the loader file's; where it gives none, 20 %
    are assumed, of the valve's gain 30 %; --off) and with each pilot's arm at the grip; then with all tolerances at once.
    """
    from forcefeel.cli import envelope_command  # noqa: PLC0415
    from forcefeel.envelope.draws import Draws  # noqa: PLC0415

    drawn = Draws(draws, seed, corners)
    chosen = envelope_command.EnvelopeOptions(
        grid, compensator, compare, rule, angle, off, drawn, set_, out, replace, threads
    )
    envelope_command.run_envelope(loader, chosen, units, as_json=json)


@app.command(epilog="Example: `forcefeel frontier elevator-2khz --out frontier`")
def frontier(
    loader: LoaderFile = None,
    grid: FrontierGrid = None,
    compensator: FrontierCompensator = None,
    rule: EnvelopeRule = None,
    angle: EnvelopeAngle = None,
    off: EnvelopeOff = None,
    set_: Changes = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for frontier.html and results.json.")] = Path(
        "forcefeel-frontier"
    ),
    replace: Annotated[bool, typer.Option("--replace", help="Replace a frontier that is in the folder.")] = False,
    threads: EnvelopeThreads = None,
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Find what cannot be rendered on this hardware and why, and what tighter tolerances or other parts would buy.

    Takes a few minutes with the default grid.
    """
    from forcefeel.cli import frontier_command  # noqa: PLC0415

    chosen = frontier_command.FrontierOptions(grid, compensator, rule, angle, off, set_, out, replace, threads)
    frontier_command.run_frontier(loader, chosen, units, as_json=json)


@app.command(epilog="Example: `forcefeel schedule elevator-2khz --knots knots.csv --out schedule`")
def schedule(
    knots: ScheduleKnots,
    loader: LoaderFile = None,
    method: ScheduleMethod = "robust",
    refine: ScheduleRefine = 10,
    rule: EnvelopeRule = None,
    off: EnvelopeOff = None,
    set_: Changes = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for schedule.html, gains.csv and results.json.")] = Path(
        "forcefeel-schedule"
    ),
    replace: Annotated[bool, typer.Option("--replace", help="Replace a schedule that is in the folder.")] = False,
    threads: EnvelopeThreads = None,
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Design laws over the settings an aircraft runs through, and check them at, between and on the way between the knots.

    Exit status 1 unless every loop that was checked is stable.
    """
    from forcefeel.cli import schedule_command  # noqa: PLC0415

    chosen = schedule_command.ScheduleCommandOptions(knots, method, refine, rule, off, set_, out, replace, threads)
    schedule_command.run_schedule(loader, chosen, units, as_json=json)


@app.command(epilog="Example: `forcefeel qualify my.toml --compare --pdf`")
def qualify(
    loader: LoaderFile = None,
    rule: QualifyRule = None,
    test: Tests = None,
    axis: AxisOption = ControlAxis.PITCH,
    throw: ThrowOption = None,
    overdamped: OverdampedOption = Overdamped.FALL_TIME,
    dynamic_pressure: Pressure = None,
    reference: References = None,
    record: Recorded = None,
    column: RecordColumns = None,
    unit: RecordUnits = None,
    compensator: Laws = None,
    compare: AllLaws = False,
    set_: Changes = None,
    out: OutFolder = Path("forcefeel-qualification"),
    pdf: Pdf = False,
    simulator: Simulator = "",
    operator: Operator = "",
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Make the control feel tests of a qualification rule on a loader, or on records of a simulator.

    The reference is the programmed feel, or a recorded aircraft. What is tested qualifies, does not qualify, or is incomplete.
    Exit status 0 if it qualifies, or passed all that `--test` asked for; else 1.
    """
    from forcefeel.cli import qualify_command  # noqa: PLC0415

    chosen = qualify_command.QualifyOptions(
        rule,
        test,
        axis,
        throw,
        overdamped,
        dynamic_pressure,
        reference,
        record,
        column,
        unit,
        compensator,
        compare,
        set_,
        out,
        pdf,
        simulator,
        operator,
    )
    qualify_command.run_qualify(loader, chosen, units, as_json=json)


@app.command(
    epilog="Example: `forcefeel identify my.toml --data closed.csv --data release.mat --fit k,c,J,C_i --out identified`"
)
def identify(
    data: BenchFiles,
    fit: IdentifyFit,
    loader: LoaderFile = None,
    experiment: BenchExperiment = None,
    from_: BenchFrom = None,
    to: BenchTo = None,
    column: BenchColumn = None,
    unit: BenchUnit = None,
    hold: BenchHold = None,
    starts: IdentifyStarts = 5,
    loss: IdentifyLossOption = IdentifyLoss.HUBER,
    no_priors: NoPriors = False,
    responses: AsResponses = False,
    compensator: IdentifyLaw = None,
    set_: Changes = None,
    out: Annotated[
        Path, typer.Option("--out", help="Folder for the new loader.toml, identification.html and results.json.")
    ] = Path("forcefeel-identified"),
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace an identification that is in the folder.")
    ] = False,
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Find parameters of a loader from what was measured on the bench, with how sure they are.

    LOADER is never changed. Exit status 1 if the data do not determine a parameter: then no loader file is written, and the page
    says what cannot be told apart and which experiment would.
    """
    from forcefeel.cli import bench_data, identify_command  # noqa: PLC0415

    bench = bench_data.BenchData(data, experiment, from_, to, column, unit, hold)
    chosen = identify_command.IdentifyOptions(
        bench, fit, starts, loss, no_priors, responses, compensator, set_, out, replace
    )
    identify_command.run_identify(loader, chosen, units, as_json=json)


@app.command(epilog="Example: `forcefeel resonance my.toml --data closed.csv --band '8..16 Hz'`")
def resonance(
    data: BenchFile,
    loader: LoaderFile = None,
    band: ResonanceBand = None,
    channel: ResonanceChannel = None,
    experiment: BenchExperiment = None,
    from_: BenchFrom = None,
    to: BenchTo = None,
    column: BenchColumn = None,
    unit: BenchUnit = None,
    hold: BenchHold = None,
    set_: Changes = None,
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Read a resonance off a measured response, and the link's k and c from it, as the 1974 report did.

    Exit status 1 if no resonance can be read.
    """
    from forcefeel.cli import bench_data, resonance_command  # noqa: PLC0415

    bench = bench_data.BenchData([data], experiment, from_, to, column, unit, hold)
    resonance_command.run_resonance(loader, bench, channel, band, set_, units, as_json=json)


@app.command(epilog="Example: `forcefeel excite elevator --fit k,c,J,C_i --time 60 --rate 1000 --out excite.csv`")
def excite(
    fit: ExciteFit,
    loader: LoaderFile = None,
    experiment: ExciteExperiment = "servo-closed",
    measure: ExciteMeasure = None,
    noise: ExciteNoise = None,
    kind: ExciteKindOption = ExciteKind.MULTISINE,
    time: ExciteTime = 60.0,
    rate: ExciteRate = 1000.0,
    from_: ExciteFrom = None,
    to: ExciteTo = None,
    limit_current: ExciteCurrent = None,
    limit_travel: ExciteTravel = None,
    limit_force: ExciteForce = None,
    limit_drive: ExciteDrive = None,
    compensator: ExciteLaw = None,
    set_: Changes = None,
    out: ExciteOut = Path("forcefeel-excite.csv"),
    replace: Annotated[bool, typer.Option("--replace", help="Replace a file that is there.")] = False,
    units: Units = UnitSystem.US,
    json: Json = False,
) -> None:
    """Design the signal for the bench that determines chosen parameters best within the limits of the loader.

    The file, with measured columns added, is what `forcefeel identify` reads. Exit status 1 if this experiment cannot tell the
    parameters apart, and then nothing is written, or does not determine one.
    """
    from forcefeel.cli import excite_command  # noqa: PLC0415

    limits = {"current": limit_current, "travel": limit_travel, "force": limit_force, "drive": limit_drive}
    chosen = excite_command.ExciteOptions(
        fit, experiment, measure, noise, kind, (time, rate), (from_, to), limits, compensator, set_, out, replace
    )
    excite_command.run_excite(loader, chosen, units, as_json=json)


@app.command(epilog="Example: `forcefeel reproduce`")
def reproduce(
    units: Units = UnitSystem.US,
    json: Json = False,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print the table as Markdown.")] = False,
) -> None:
    """Set every number and claim of the 1974 report beside what the models give.

    Exit status 1 if a number differs without a known reason.
    """
    from forcefeel.cli import commands  # noqa: PLC0415

    commands.reproduce(units, as_json=json, as_markdown=markdown)
