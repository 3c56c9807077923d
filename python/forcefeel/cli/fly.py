"""``forcefeel fly``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, FolderOptions, LawOption, LoaderFile, LoaderOptions, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.scenario_text import seconds, speed_and_altitude, value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.files import check_output_file, write_whole
from forcefeel.loader.axes import AXIS_OF, FlightAxis, flight_axis, usual_axis
from forcefeel.units import AIRSPEED, ANGLE, ANGULAR_VELOCITY, FORCE, LOAD_FACTOR, Json, Unit, UnitSystem, to_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from forcefeel.fly import FlightCase, FlightReport, Flown, Maneuver

FLIGHT = Group("Flight", sort_key=10)
HAND = Group("Force of a hand", sort_key=20)
MANEUVER = Group("Maneuvers and rules", sort_key=30)
_RAMP_S = 1.0
_POSITIVE = {"pitch": "pushed", "roll": "turned to the right", "yaw": "a right pedal"}
_LONGEST_S = 600.0


@dataclass(frozen=True, kw_only=True)
class FlyOptions(LoaderOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel fly``."""

    aircraft: Annotated[
        str,
        option(
            "Aircraft of JSBSim: 737, T38, c172p, f16, or a TOML file with data of its pitch control.",
            FLIGHT,
            metavar="NAME|FILE",
        ),
    ] = "c172p"
    axis: Annotated[
        FlightAxis | None,
        option(
            "Control of the loader: pitch, roll or yaw.",
            FLIGHT,
            default="axis of the built-in loader, otherwise pitch",
        ),
    ] = None
    speed: Annotated[
        str | None,
        option("Calibrated airspeed of the trimmed flight.", FLIGHT, default="the aircraft's", metavar="SPEED"),
    ] = None
    altitude: Annotated[str | None, option("Altitude.", FLIGHT, default="the aircraft's", metavar="LENGTH")] = None
    force: Annotated[
        str | None,
        option(
            "Force of the hand, reached in a second and held; negative pulls.", HAND, default="-15 N", metavar="FORCE"
        ),
    ] = None
    start: Annotated[str | None, option("Time at which the hand begins.", HAND, default="1 s", metavar="TIME")] = None
    duration: Annotated[
        str | None, option("Length of the flight.", HAND, default="the record's, otherwise 5 s", metavar="TIME")
    ] = None
    record: Annotated[
        Path | None,
        option(
            "Recorded force of the hand: CSV, Parquet or MATLAB with columns 'time (s)' and 'force (lb)'.",
            HAND,
            default="--force",
            metavar="FILE",
        ),
    ] = None
    maneuver: Annotated[
        str | None,
        option(
            "Fly a maneuver, with the loader and on the feel alone. In pitch: pull-up, wind-up-turn, release, phugoid, "
            "short-period, power, flaps, gear, speed-brake or stall; in roll: roll-rate or sideslip; in yaw: yaw-rate or sideslip.",
            MANEUVER,
            metavar="NAME",
        ),
    ] = None
    load_factor: Annotated[
        str | None,
        option("Load factor of pull-up and wind-up turn.", MANEUVER, default="1.4", metavar="NUMBER"),
    ] = None
    off_trim: Annotated[
        str | None,
        option(
            "Speed at which a release begins, in percent of the trim speed.",
            MANEUVER,
            default="90 %",
            metavar="PERCENT",
        ),
    ] = None
    sideslip: Annotated[
        str | None, option("Angle of a steady sideslip.", MANEUVER, default="5 deg", metavar="ANGLE")
    ] = None
    rules: Annotated[
        bool,
        option(
            "Fly the tests of the rules and judge them: Part 60 against the feel alone, and 14 CFR 23, 25 or MIL-F-8785C by "
            "the aircraft's category. Exit status 0 if all are met, otherwise 1.",
            MANEUVER,
        ),
    ] = False
    law: LawOption = None
    out: Annotated[
        Path | None, option("CSV file for the flight, or the maneuver with the loader.", OUTPUT, metavar="FILE")
    ] = None
    out_dir: Annotated[
        Path | None,
        option("Folder for flight.html and results.json of a maneuver or of --rules.", OUTPUT, metavar="FOLDER"),
    ] = None

    def check(self) -> None:
        """Refuses options that do not go together.

        Raises:
            InputError: If so.
        """
        kind = "--rules" if self.rules else "--maneuver" if self.maneuver else ""
        unread = {
            "--maneuver": self.maneuver if self.rules else None,
            "--out": self.out if self.rules else None,
            "--load-factor": self.load_factor if kind != "--maneuver" else None,
            "--sideslip": self.sideslip if kind != "--maneuver" else None,
            "--off-trim": self.off_trim if kind != "--maneuver" else None,
            "--out-dir": self.out_dir if not kind else None,
            "--force": self.force if kind else None,
            "--start": self.start if kind else None,
            "--duration": self.duration if kind else None,
            "--record": self.record if kind else None,
        }
        for name, given in (("--force", self.force), ("--start", self.start)):
            if self.record is not None and given is not None:
                raise InputError(f"{name}: --record is the force of the hand; leave one out")
        for name, text in unread.items():
            if text is not None:
                other = f"{kind} does not use it" if kind else "requires --maneuver"
                raise InputError(f"{name}: {other}; remove {name}{'' if kind else ' or name a maneuver'}")

    def case(self, path: Path | None) -> "FlightCase":
        """Loader, aircraft and trimmed flight.

        Raises:
            InputError: If one is bad.
        """
        from forcefeel.fly import FlightCase

        speed, altitude = speed_and_altitude(self.speed, self.altitude)
        return FlightCase.of(self.loader(path), self.aircraft, speed, altitude, self.law, self.axis)


def run(path: LoaderFile = None, /, *, options: FlyOptions = FlyOptions()) -> None:
    """Fly an aircraft of JSBSim by the force of a hand on the loader, a maneuver, or the rules on control forces.

    Hand, loader and aircraft are in lock step. The loader is the supervised live loop on its simulated machine; its feel and
    surface become the aircraft's. The numbers of the aircraft's controls are illustrative. Needs JSBSim: pip install
    forcefeel[fly].

    Example: forcefeel fly elevator-2khz --aircraft c172p --speed '100 kt' --rules --out-dir report
    """
    options.check()
    if options.out is not None:
        check_output_file(options.out)
    case = options.case(path)
    if options.rules or options.maneuver:
        _report(path, case, options)
    else:
        _by_hand(case, options)


def _by_hand(case: "FlightCase", options: FlyOptions) -> None:
    from forcefeel.fly import FlightOptions, fly

    flown = fly(case.loader, case.at(), _forces(options), FlightOptions(law=options.law))
    results = _results(flown, case)
    if options.out is not None:
        write_whole(options.out, _csv(flown))
    answer(
        {} if options.out is None else {"flight": options.out},
        lambda: results,
        lambda terminal: _show(terminal, results, options, case),
        as_json=options.json,
    )


def _forces(options: FlyOptions) -> "NDArray[np.float64]":
    """Force of the hand in each frame: recorded, or a ramp that is held.

    Raises:
        InputError: If the record is bad, or the flight is too long.
    """
    import numpy as np

    from forcefeel.fly import FRAME_S
    from forcefeel.simulation.inputs import read_recorded

    record = None if options.record is None else read_recorded(options.record).from_zero()
    ends_s = 5.0 if record is None else float(record.time_s[-1])
    lasts = ends_s if options.duration is None else seconds("--duration", options.duration)
    start = seconds("--start", options.start or "1 s")
    if not 0 < lasts <= _LONGEST_S or (record is None and not 0 <= start < lasts):
        raise InputError(
            f"--duration: expected at most {_LONGEST_S:g} s, and --start before its end, got {lasts:g} s and {start:g} s"
        )
    time_s = np.arange(0.0, lasts, FRAME_S)
    if record is not None:
        forces: NDArray[np.float64] = np.interp(time_s, record.time_s, record.force_n)
        return forces
    return value("--force", options.force or "-15 N", "N", "-15 N") * np.clip((time_s - start) / _RAMP_S, 0, 1)


def _report(path: Path | None, case: "FlightCase", options: FlyOptions) -> None:
    """A maneuver, or the rules.

    Raises:
        SystemExit: If a rule is not met.
    """
    from forcefeel.fly import FlightReport, ManeuverRequest, fly_maneuver, fly_rules, write_flight
    from forcefeel.fly.as_json import report_json
    from forcefeel.fly.page.page import FOLDER

    if options.out_dir is not None:
        FOLDER.check(options.out_dir, replace=options.replace)
    if options.maneuver:
        request = ManeuverRequest(
            value("--load-factor", options.load_factor or "1.4", "", "1.4"),
            value("--off-trim", options.off_trim or "90 %", "", "90 %"),
            value("--sideslip", options.sideslip or "5 deg", "rad", "5 deg"),
        )
        maneuver = fly_maneuver(case, options.maneuver, request)
        report = FlightReport(case, (), (), (maneuver,), {}, ())
        if options.out is not None:
            write_whole(options.out, _csv(maneuver.flown))
    else:
        with all_or_nothing("fly", silent=options.json) as bar:
            report = fly_rules(case, bar.describe)
    page = None
    if options.out_dir is not None:
        command = options.command_line(path)
        page = write_flight(report, options.out_dir, options.units, replace=options.replace, command=command)
    answer(
        {"flight": options.out, "page": page},
        lambda: report_json(report, options.units),
        lambda terminal: show_report(terminal, report, options.units),
        as_json=options.json,
    )
    if not report.fulfilled:
        raise SystemExit(BAD_ANSWER)


def _results(flown: "Flown", case: "FlightCase") -> dict[str, Json]:
    speed = flown.states["true_airspeed"]
    ranges = {key: flown.states[name] for _, name, key, _ in _RANGES[case.axis]} | {
        "column_angle_*_rad": flown.angle_rad
    }
    return {
        **({"force_per_g_n": case.force_per_g_n} if case.axis == "pitch" else {}),
        "true_airspeed_begin_m_per_s": float(speed[0]),
        "true_airspeed_end_m_per_s": float(speed[-1]),
        **{key.replace("*", "min"): float(row.min()) for key, row in ranges.items()},
        **{key.replace("*", "max"): float(row.max()) for key, row in ranges.items()},
    }


def _csv(flown: "Flown") -> str:
    from forcefeel.fly.run import SUFFIXES
    from forcefeel.tables.csv_table import csv_text

    heads = ["time_s", "force_n", "column_angle_rad", *(f"{name}{SUFFIXES[name]}" for name in flown.states)]
    return csv_text(
        heads, zip(flown.time_s, flown.force_n, flown.angle_rad, *flown.states.values(), strict=True), ".9g"
    )


def _show(terminal: Terminal, results: dict[str, Json], options: FlyOptions, case: "FlightCase") -> None:
    hand = options.force or "-15 N" if options.record is None else str(options.record)
    table = titled(f"{options.aircraft}, {hand} at the grip", "measure", numbers=("value",))

    def row(name: str, key: str, unit: Unit, sign: float = 1.0) -> None:
        number = results[key]
        assert isinstance(number, float)
        table.add_row(name, _text(sign * number, unit, options.units))

    if case.axis == "pitch":
        row("pull per g, from trimmed pull-ups of 1.2 and 1.4 g", "force_per_g_n", FORCE, -1.0)
    row("true airspeed at the start", "true_airspeed_begin_m_per_s", AIRSPEED)
    row("true airspeed at the end", "true_airspeed_end_m_per_s", AIRSPEED)
    for name, _, key, unit in (*_RANGES[case.axis], ("column angle", "", "column_angle_*_rad", ANGLE)):
        row(f"smallest {name}", key.replace("*", "min"), unit)
        row(f"largest {name}", key.replace("*", "max"), unit)
    terminal.show(table)
    _print_control(terminal, case)


_RANGES = {
    "pitch": (("load factor", "load_factor", "load_factor_*", LOAD_FACTOR),),
    "roll": (
        ("roll rate", "roll_rate", "roll_rate_*_rad_per_s", ANGULAR_VELOCITY),
        ("bank", "bank", "bank_*_rad", ANGLE),
    ),
    "yaw": (
        ("yaw rate", "yaw_rate", "yaw_rate_*_rad_per_s", ANGULAR_VELOCITY),
        ("sideslip", "sideslip", "sideslip_*_rad", ANGLE),
    ),
}
"""Name, state, key of the ranges that an axis prints."""


def _print_control(terminal: Terminal, case: "FlightCase") -> None:
    built_for = flight_axis(usual_axis(case.loader.name))
    though = (
        "" if built_for == case.axis or case.loader.name not in AXIS_OF else f", though it is built for {built_for}"
    )
    terminal.print(
        f"{case.loader.name} is flown as the {case.axis} control{though}; a positive control is {_POSITIVE[case.axis]}. "
        "The aircraft's numbers of this control are illustrative."
    )


def _text(number: float, unit: Unit, units: UnitSystem) -> str:
    return f"{to_text(round(unit.from_si(number, units), 4), 4)} {unit.shown(units)}".rstrip()


def show_report(terminal: Terminal, report: "FlightReport", units: UnitSystem) -> None:
    """Prints the verdicts of the rules, or the measures of the maneuvers."""
    from forcefeel.fly.report import flight_conclusions

    if not report.verdicts:
        for maneuver in report.maneuvers:
            _show_maneuver(terminal, report.case.aircraft, maneuver, units)
        _print_control(terminal, report.case)
        return
    table = titled(
        f"{report.case.loader.name} with {report.case.aircraft}",
        *("rule", "quantity", "outcome"),
        numbers=("with the loader", "feel alone", "limit"),
    )
    for verdict in report.verdicts:
        unit = verdict.unit
        numbers = (verdict.with_loader, verdict.feel, verdict.limit)
        texts = ["", "", ""] if unit is None else [_text(number, unit, units) for number in numbers]
        table.add_row(
            verdict.rule.marked_label,
            verdict.quantity,
            str(verdict.outcome),
            *texts[:2],
            f"{verdict.bound} {texts[2]}".rstrip(),
        )
    terminal.show(table)
    _print_control(terminal, report.case)
    terminal.conclude(flight_conclusions(report))


def _show_maneuver(terminal: Terminal, aircraft: str, maneuver: "Maneuver", units: UnitSystem) -> None:
    table = titled(f"{aircraft}: {maneuver.label}", "measure", numbers=("with the loader", "feel alone"))
    for measure in maneuver.measures:
        table.add_row(
            measure.name, _text(measure.with_loader, measure.unit, units), _text(measure.alone, measure.unit, units)
        )
    terminal.show(table)
