"""``forcefeel fly``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, FolderOptions, LawOption, LoaderFile, LoaderOptions, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.scenario_text import seconds, value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.files import check_output_file, write_whole
from forcefeel.units import AIRSPEED, ANGLE, FORCE, LOAD_FACTOR, Json, Unit, UnitSystem, to_text

if TYPE_CHECKING:
    from forcefeel.fly import FlightCase, FlightReport, Flown, Maneuver

FLIGHT = Group("Flight", sort_key=10)
HAND = Group("Force of a hand", sort_key=20)
MANEUVER = Group("Maneuvers and rules", sort_key=30)
_RAMP_S = 1.0
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
    duration: Annotated[str | None, option("Length of the flight.", HAND, default="5 s", metavar="TIME")] = None
    maneuver: Annotated[
        str | None,
        option(
            "Fly a maneuver, with the loader and on the feel alone: pull-up, wind-up-turn, release, phugoid, short-period, "
            "power, flaps or stall.",
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
    rules: Annotated[
        bool,
        option(
            "Fly what the rules need and judge them: Part 60 beside the feel alone, and 14 CFR 23, 25 or MIL-F-8785C by "
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
            "--off-trim": self.off_trim if kind != "--maneuver" else None,
            "--out-dir": self.out_dir if not kind else None,
            "--force": self.force if kind else None,
            "--start": self.start if kind else None,
            "--duration": self.duration if kind else None,
        }
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
        from forcefeel.fly.control_data import control_data

        data = control_data(self.aircraft)
        speed = data.speed_m_per_s if self.speed is None else value("--speed", self.speed, "m/s", "100 kt")
        altitude = data.altitude_m if self.altitude is None else value("--altitude", self.altitude, "m", "3000 ft")
        if not speed > 0:
            raise InputError(f"--speed: expected a speed above 0, got {self.speed}")
        return FlightCase(self.loader(path), self.aircraft, speed, altitude, self.law)


def run(path: LoaderFile = None, /, *, options: FlyOptions = FlyOptions()) -> None:
    """Fly an aircraft of JSBSim by the force of a hand on the loader, a maneuver, or the rules on control forces.

    Hand, loader and aircraft are in lock step. The loader is the supervised live loop on its simulated machine; its feel and
    surface become the aircraft's. The numbers of the aircraft's pitch control are illustrative. Needs JSBSim: pip install
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
    import numpy as np

    from forcefeel.fly import FRAME_S, FlightOptions, fly

    start, lasts = seconds("--start", options.start or "1 s"), seconds("--duration", options.duration or "5 s")
    hand = value("--force", options.force or "-15 N", "N", "-15 N")
    if not 0 < lasts <= _LONGEST_S or not 0 <= start < lasts:
        raise InputError(
            f"--duration: expected at most {_LONGEST_S:g} s, and --start before its end, got {lasts:g} s and {start:g} s"
        )
    time_s = np.arange(0.0, lasts, FRAME_S)
    forces = hand * np.clip((time_s - start) / _RAMP_S, 0, 1)
    flown = fly(case.loader, case.at(), forces, FlightOptions(law=options.law))
    results = _results(flown, case.force_per_g_n)
    if options.out is not None:
        write_whole(options.out, _csv(flown))
    answer(
        {} if options.out is None else {"flight": options.out},
        lambda: results,
        lambda terminal: _show(terminal, results, options, case.loader.name),
        as_json=options.json,
    )


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
        lambda terminal: _show_report(terminal, report, options.units),
        as_json=options.json,
    )
    if not report.fulfilled:
        raise SystemExit(BAD_ANSWER)


def _results(flown: "Flown", slope: float) -> dict[str, Json]:
    speed, load_factor = flown.states["true_airspeed"], flown.states["load_factor"]
    return {
        "force_per_g_n": slope,
        "load_factor_min": float(load_factor.min()),
        "load_factor_max": float(load_factor.max()),
        "true_airspeed_begin_m_per_s": float(speed[0]),
        "true_airspeed_end_m_per_s": float(speed[-1]),
        "column_angle_min_rad": float(flown.angle_rad.min()),
        "column_angle_max_rad": float(flown.angle_rad.max()),
    }


def _csv(flown: "Flown") -> str:
    from forcefeel.fly.run import SUFFIXES
    from forcefeel.tables.csv_table import csv_text

    heads = ["time_s", "force_n", "column_angle_rad", *(f"{name}{SUFFIXES[name]}" for name in flown.states)]
    return csv_text(
        heads, zip(flown.time_s, flown.force_n, flown.angle_rad, *flown.states.values(), strict=True), ".9g"
    )


def _show(terminal: Terminal, results: dict[str, Json], options: FlyOptions, loader: str) -> None:
    table = titled(f"{options.aircraft}, {options.force or '-15 N'} at the grip", "measure", numbers=("value",))

    def row(name: str, key: str, unit: Unit, sign: float = 1.0) -> None:
        number = results[key]
        assert isinstance(number, float)
        table.add_row(name, _text(sign * number, unit, options.units))

    row("pull per g, from trimmed pull-ups of 1.2 and 1.4 g", "force_per_g_n", FORCE, -1.0)
    row("smallest load factor", "load_factor_min", LOAD_FACTOR)
    row("largest load factor", "load_factor_max", LOAD_FACTOR)
    row("true airspeed at the start", "true_airspeed_begin_m_per_s", AIRSPEED)
    row("true airspeed at the end", "true_airspeed_end_m_per_s", AIRSPEED)
    row("smallest column angle", "column_angle_min_rad", ANGLE)
    row("largest column angle", "column_angle_max_rad", ANGLE)
    terminal.show(table)
    _print_control(terminal, loader)


def _print_control(terminal: Terminal, loader: str) -> None:
    from forcefeel.loader.axes import rule_axis, usual_axis

    axis = rule_axis(usual_axis(loader))
    built_for = "" if axis == "pitch" else f", though it is built for {axis}"
    terminal.print(
        f"{loader} is flown as the pitch control{built_for}. The aircraft's numbers of this control are illustrative."
    )


def _text(number: float, unit: Unit, units: UnitSystem) -> str:
    return f"{to_text(round(unit.from_si(number, units), 4), 4)} {unit.shown(units)}".rstrip()


def _show_report(terminal: Terminal, report: "FlightReport", units: UnitSystem) -> None:
    from forcefeel.fly.report import flight_conclusions

    if not report.verdicts:
        for maneuver in report.maneuvers:
            _show_maneuver(terminal, report.case.aircraft, maneuver, units)
        _print_control(terminal, report.case.loader.name)
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
    _print_control(terminal, report.case.loader.name)
    terminal.conclude(flight_conclusions(report))


def _show_maneuver(terminal: Terminal, aircraft: str, maneuver: "Maneuver", units: UnitSystem) -> None:
    table = titled(f"{aircraft}: {maneuver.label}", "measure", numbers=("with the loader", "feel alone"))
    for measure in maneuver.measures:
        table.add_row(
            measure.name, _text(measure.with_loader, measure.unit, units), _text(measure.alone, measure.unit, units)
        )
    terminal.show(table)
