"""The built-in loaders, by name."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from importlib.resources import as_file, files
from pathlib import Path
from types import MappingProxyType

import numpy as np

from forcefeel.errors import InputError, suggestion
from forcefeel.files import Kind, input_kind
from forcefeel.loader.axes import ELECTRIC_AXES
from forcefeel.loader.loader import Loader, load
from forcefeel.loader.parameters import HYDRAULIC, OFF, TABLE, absent, has
from forcefeel.units import show

_REPORT = (
    "NASA Langley, Analysis and Compensation of an Aircraft Simulator Control Loading System, October 1974; "
    "the tolerances are assumed"
)

_ASSUMED = dict.fromkeys(
    (
        "amplifier.admittance",
        "valve.current_gain",
        "valve.pressure_gain",
        "valve.natural_frequency",
        "valve.rated_flow",
        "valve.supply_pressure",
        "actuator.oil_volume",
        "actuator.bulk_modulus",
        "linkage.stiffness",
        "linkage.damping",
        "column.inertia",
        "load_cell.gain",
        "potentiometer.gain",
    ),
    "20 %",
) | {"valve.current_gain": "30 %", "valve.rated_flow": "30 %"}
"""The elevator's tolerances: the report gives none, but its sensitivity study deviates parameters by 20 %. A valve's gain is known
less well than the rest."""


def elevator() -> Loader:
    """The elevator loader of the 1974 report, from the appendix's U.S. customary column; its tolerances are assumed.

    Example:
        >>> ff.elevator()
        <Loader 'elevator-1974': feel G = 9600 lb in/rad, 2.01 Hz, damping ratio 0.2; analog; 13 tolerances>
    """
    values = np.array(
        [OFF.get(key, row.default_si) if has(HYDRAULIC, row) else absent(row) for key, row in TABLE.items()]
    )
    return Loader("elevator-1974", _REPORT, values).with_tolerances(_ASSUMED)


def digital_elevator() -> Loader:
    """The same loader as it would be run today: under a digital controller at 2 kHz with one sample of delay.

    The flow follows the orifice, eq. (1), limited by the appendix's rated current and flow. The sensors are of a usual kind, no one
    product: a load cell with 0.1 lb of noise, an encoder of 23 bits a turn at the column, a potentiometer at the piston. Flow
    and valve have no sensor.

    Example:
        >>> ff.digital_elevator()["controller.period"]
        0.0005
    """
    changes: dict[str, str | float | bool | None] = {
        "controller.period": "0.5 ms",
        "controller.delay": "0.5 ms",
        "valve.orifice": True,
        "valve.flow_limit": "100 in^3/s",
        "amplifier.current_limit": "15 mA",
        "load_cell.noise": "0.1 lb",
        "load_cell.resolution": "0.05 lb",
        "potentiometer.noise": "0.0005 in",
        "potentiometer.resolution": "0.0005 in",
        "column_sensor.noise": "4e-5 deg",
        "column_sensor.resolution": "4.29e-5 deg",
    }
    return replace(
        elevator().replace(changes), name="elevator-2khz", source=f"{_REPORT}; controller and sensors assumed"
    )


def electric(name: str) -> Loader:
    """A built-in electric loader; its source says which of its numbers are illustrative.

    Raises:
        InputError: If the name is unknown.

    Example:
        >>> ff.loader.electric("sidestick-pitch").drive
        'electric'
    """
    if name not in ELECTRIC_AXES:
        raise InputError(f"name: expected {', '.join(ELECTRIC_AXES)}, got {show(name)}")
    with as_file(files("forcefeel") / "data" / "loaders" / f"{name}.toml") as path:
        return load(path)


BUILT_IN: Mapping[str, Callable[[], Loader]] = MappingProxyType(
    {
        "elevator-2khz": digital_elevator,
        "elevator-1974": elevator,
        **{name: partial(electric, name) for name in ELECTRIC_AXES},
    }
)
"""Loaders by name."""


def is_built_in(given: str | Path, folder: Path = Path()) -> bool:
    """Whether a name is a built-in loader's, and no file in the folder has it; a folder of results may."""
    return str(given) in BUILT_IN and input_kind(folder / given) in (None, Kind.FOLDER)


def open_loader(given: str | Path | None) -> Loader:
    """The loader of a file, or a built-in one by its name; ``elevator-2khz`` if not given.

    Raises:
        InputError: As ``load``.
    """
    if given is None:
        return digital_elevator()
    name = str(given)
    if is_built_in(given):
        return BUILT_IN[name]()
    if not input_kind(Path(given)) and (close := suggestion(name, BUILT_IN)):
        raise InputError(f"{name}: expected a loader file or a built-in loader, found no such file{close}")
    return load(given)
