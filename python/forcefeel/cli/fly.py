"""``forcefeel fly``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.options import OUTPUT, LawOption, LoaderFile, LoaderOptions, OutputOptions, option
from forcefeel.cli.scenario_text import seconds, value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.files import check_output_file, write_whole
from forcefeel.units import ANGLE, FORCE, Json, Unit

if TYPE_CHECKING:
    from forcefeel.fly import Flown

FLIGHT = Group("Flight", sort_key=10)
_RAMP_S = 1.0
_LONGEST_S = 600.0
_SPEED = Unit("m/s", "m/s", "kt")


@dataclass(frozen=True, kw_only=True)
class FlyOptions(LoaderOptions, OutputOptions):
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
        str, option("Force of the hand, reached in a second and held; negative pulls.", FLIGHT, metavar="FORCE")
    ] = "-15 N"
    start: Annotated[str, option("Time at which the hand begins.", FLIGHT, metavar="TIME")] = "1 s"
    duration: Annotated[str, option("Length of the flight.", FLIGHT, metavar="TIME")] = "5 s"
    law: LawOption = None
    out: Annotated[Path | None, option("CSV file for the flight.", OUTPUT, metavar="FILE")] = None


def run(path: LoaderFile = None, /, *, options: FlyOptions = FlyOptions()) -> None:
    """Fly an aircraft of JSBSim by the force of a hand on the loader: load factor, speed, stick force per g.

    Hand, loader and aircraft are in lock step. The loader is the supervised live loop on its simulated machine; its feel and
    surface become the aircraft's. The numbers of the aircraft's pitch control are illustrative. Needs JSBSim: pip install
    forcefeel[fly].

    Example: forcefeel fly elevator-2khz --aircraft c172p --speed '100 kt' --force '-15 N'
    """
    import numpy as np

    from forcefeel.fly import FRAME_S, Aircraft, Way, fly, force_per_g
    from forcefeel.fly.control_data import control_data

    data = control_data(options.aircraft)
    speed = data.speed_m_per_s if options.speed is None else value("--speed", options.speed, "m/s", "100 kt")
    altitude = data.altitude_m if options.altitude is None else value("--altitude", options.altitude, "m", "3000 ft")
    start, lasts = seconds("--start", options.start), seconds("--duration", options.duration)
    hand = value("--force", options.force, "N", "-15 N")
    if not speed > 0:
        raise InputError(f"--speed: expected a speed above 0, got {options.speed}")
    if not 0 < lasts <= _LONGEST_S or not 0 <= start < lasts:
        raise InputError(
            f"--duration: expected at most {_LONGEST_S:g} s, and --start before its end, got {lasts:g} s and {start:g} s"
        )
    if options.out is not None:
        check_output_file(options.out)
    loader = options.loader(path)
    aircraft = Aircraft(options.aircraft, speed, altitude)
    time_s = np.arange(0.0, lasts, FRAME_S)
    flown = fly(loader, aircraft, hand * np.clip((time_s - start) / _RAMP_S, 0, 1), Way(law=options.law))
    slope = force_per_g(loader, options.aircraft, speed, altitude)
    if options.out is not None:
        write_whole(options.out, _csv(flown))
    results = _results(flown, slope)
    answer(
        {} if options.out is None else {"flight": options.out},
        lambda: results,
        lambda terminal: _show(terminal, results, options),
        as_json=options.json,
    )


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


def _show(terminal: Terminal, results: dict[str, Json], options: FlyOptions) -> None:
    table = titled(f"{options.aircraft}, {options.force} at the grip", "measure", numbers=("value",))

    def row(name: str, key: str, unit: Unit | None = None) -> None:
        number = results[key]
        assert isinstance(number, float)
        system = options.units
        text = f"{number:.3f}" if unit is None else f"{unit.from_si(number, system):.4g} {unit.shown(system)}"
        table.add_row(name, text)

    row("stick force per g, from trimmed pull-ups of 1.2 and 1.4 g", "force_per_g_n", FORCE)
    row("smallest load factor", "load_factor_min")
    row("largest load factor", "load_factor_max")
    row("true airspeed at the start", "true_airspeed_begin_m_per_s", _SPEED)
    row("true airspeed at the end", "true_airspeed_end_m_per_s", _SPEED)
    row("smallest column angle", "column_angle_min_rad", ANGLE)
    row("largest column angle", "column_angle_max_rad", ANGLE)
    terminal.show(table)
    terminal.print("The numbers of the aircraft's pitch control are illustrative.")
