"""An aircraft of JSBSim, moved by its elevator.

JSBSim counts the elevator in shares of its travel; the share is the command's and the pitch trim's together, and a share up is
another angle than the same share down. The aircraft is trimmed by JSBSim; the column's zero is the trimmed position, and a tab
takes the force off there.
"""

import ctypes
import os
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from importlib.resources import files
from io import StringIO
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from forcefeel import _core
from forcefeel.errors import InputError, suggestion
from forcefeel.loader.loader import Loader
from forcefeel.simulation.inputs.flight import FLIGHT_UNITS, WITHOUT

FRAME_S = 0.008
"""Time between two states of the aircraft."""

_FT, _KT, _PSF = 0.3048, 1852 / 3600, 4.4482216152605 / 0.3048**2
_SHARES = (-1.0, 1.0)
_STILL = 1e-6
_POSITION, _COMMAND, _TRIM = "fcs/elevator-pos-rad", "fcs/elevator-cmd-norm", "fcs/pitch-trim-cmd-norm"
_TRIMMED = {"udot": "thrust and drag", "wdot": "lift and weight", "qdot": "pitch"}
"""What JSBSim balances, by its name of the acceleration."""


class Aircraft:
    """An aircraft in trimmed flight.

    Args:
        name: One with data of its elevator: ``c172p``.
        speed_m_per_s: Calibrated airspeed.
        altitude_m: Altitude above sea level.
        load_factor: Trimmed in a pull-up with this load factor; 1 for straight and level.

    Raises:
        InputError: If JSBSim is not installed, the aircraft is unknown, or it does not trim.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> round(aircraft.state()["true_airspeed"])
        54
    """

    def __init__(self, name: str, speed_m_per_s: float, altitude_m: float, load_factor: float = 1.0) -> None:
        if name not in known():
            raise InputError(f"aircraft: expected one of {', '.join(known())}, got {name!r}{suggestion(name, known())}")
        self.name = name
        self._travel = {share: self._position_at(share) for share in _SHARES}
        self._model = _loaded(name)
        self._model["ic/vc-kts"] = speed_m_per_s / _KT
        self._model["ic/h-sl-ft"] = altitude_m / _FT
        self._model["ic/gamma-deg"] = 0.0
        if load_factor != 1:
            self._model["ic/targetNlf"] = load_factor
        with _silent() as printed:
            self._model.run_ic()
            self._model["propulsion/set-running"] = -1
            try:
                self._model["simulation/do_simple_trim"] = 1 if load_factor == 1 else 3
            except RuntimeError as error:
                failed = re.findall(r"Sorry, (\w+) doesn't", printed())
                axes = " and ".join(_TRIMMED.get(axis, axis) for axis in failed) or "an axis that JSBSim does not name"
                raise InputError(
                    f"aircraft: {name} does not trim at {speed_m_per_s / _KT:.4g} kt: no balance of {axes}; take another speed "
                    "or altitude"
                ) from error
        self.trimmed_rad: float = self._model[_POSITION]

    def state(self) -> dict[str, float]:
        """The flight state by the names of a host's packet, SI units.

        Raises:
            InputError: If JSBSim gives no number.
        """
        model = self._model
        numbers = {
            "dynamic_pressure": model["aero/qbar-psf"] * _PSF,
            "true_airspeed": model["velocities/vt-fps"] * _FT,
            "angle_of_attack": model["aero/alpha-rad"],
            "sideslip": model["aero/beta-rad"],
            "roll_rate": model["velocities/p-rad_sec"],
            "pitch_rate": model["velocities/q-rad_sec"],
            "yaw_rate": model["velocities/r-rad_sec"],
            "load_factor": model["accelerations/Nz"],
            "mach": model["velocities/mach"],
        }
        for name, number in numbers.items():
            if not abs(number) < _MOST:
                raise InputError(f"aircraft: {self.name} left the range of its model: {name} is {number}")
        return numbers

    def fly(self, elevator_rad: float) -> None:
        """Advance by a frame with the elevator at an angle."""
        low, high = self._travel[-1.0], self._travel[1.0]
        share = elevator_rad / high if elevator_rad > 0 else -elevator_rad / low
        self._model[_COMMAND] = min(1.0, max(-1.0, share)) - self._model[_TRIM]
        with _silent():
            self._model.run()

    def _position_at(self, share: float) -> float:
        """The elevator's angle at a share of its travel, at once.

        Raises:
            InputError: If it is not there at once: an actuator stands between.
        """
        model = _loaded(self.name)
        with _silent():
            model.run_ic()
            model[_COMMAND] = share
            model.run()
            first: float = model[_POSITION]
            model.run()
        if abs(model[_POSITION] - first) > _STILL:
            raise InputError(
                f"aircraft: {self.name} has an actuator between command and elevator; a reversible control moves the surface itself"
            )
        return first


_MOST = 1e6


def known() -> list[str]:
    """The aircraft with data of their elevator."""
    folder = files("forcefeel") / "data" / "aircraft"
    return sorted(path.name.removesuffix(".toml") for path in folder.iterdir() if path.name.endswith(".toml"))


def with_elevator(loader: Loader, aircraft: Aircraft) -> Loader:
    """The loader with the aircraft's surface and feel, its force zero where the aircraft is trimmed.

    Example:
        >>> ff.fly.with_elevator(ff.digital_elevator(), ff.fly.Aircraft("c172p", 51.4, 900.0))["surface.per_deflection"]
        -0.3
    """
    path = files("forcefeel") / "data" / "aircraft" / f"{aircraft.name}.toml"
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    rows = {f"surface.{key}": value for key, value in data["surface"].items()}
    changed = loader.replace({**rows, "feel.stiffness": data["feel"]["stiffness"]})
    frequency, _ = _core.feel_frequency(changed.si_values)
    _, damping = _core.feel_from_frequency(frequency, data["feel"]["damping_ratio"], changed["feel.stiffness"])
    # The tab's share of the coefficient: the moment is linear in it.
    state = aircraft.state()
    with_none, with_one = (
        hinge_moment(changed.replace({"surface.at_zero": c}, si=True), state, 0.0)[0] for c in (0.0, 1.0)
    )
    at_zero = -with_none / (with_one - with_none)
    return changed.replace({"feel.damping": damping, "surface.at_zero": at_zero}, si=True)


def hinge_moment(loader: Loader, state: Mapping[str, float], angle_rad: float) -> tuple[float, float, float]:
    """Force at the grip, N, spring, N m/rad, and damping, N m s/rad, of the loader's surface in a flight state."""
    row = [state.get(name, WITHOUT.get(name, 0.0)) for name in FLIGHT_UNITS]
    ((force, stiffness, damping),) = _core.hinge_moment(loader.si_values, np.array([[*row, angle_rad]])).tolist()
    return force, stiffness, damping


def _loaded(name: str) -> Any:
    try:
        import jsbsim  # noqa: PLC0415  an extra
    except ImportError as error:
        raise InputError("JSBSim is not installed; install it with: pip install forcefeel[fly]") from error
    with _silent():
        model = jsbsim.FGFDMExec(None)
        model.set_debug_level(0)
        model.load_model(name)
        model.set_dt(FRAME_S)
    return model


@contextmanager
def _silent() -> Iterator[Callable[[], str]]:
    """Keep what JSBSim prints from standard output, the process's and Python's; the yielded function returns it."""
    flush, by_python = ctypes.CDLL(None).fflush, StringIO()
    flush(None)
    with TemporaryFile() as printed, redirect_stdout(by_python):
        kept = os.dup(1)
        os.dup2(printed.fileno(), 1)

        def text() -> str:
            flush(None)
            printed.seek(0)
            return printed.read().decode(errors="replace") + by_python.getvalue()

        try:
            yield text
        finally:
            flush(None)
            os.dup2(kept, 1)
            os.close(kept)
