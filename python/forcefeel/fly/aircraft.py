"""An aircraft of JSBSim, moved by one of its controls.

A reversible control moves the surface itself; an irreversible one commands the actuators or the fly-by-wire system, in shares
of their full command. JSBSim counts a surface in shares of its travel too; the share is the command's and the trim's together,
and a share up is another angle than the same share down. The aircraft is trimmed by JSBSim; the control's zero is the trimmed
position, and a tab takes the force off there.

A positive control is pushed, turned to the right, or has its right pedal forward. JSBSim counts an elevator and a left aileron
positive with the trailing edge down, a rudder with the trailing edge left.
"""

import ctypes
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from itertools import count, takewhile
from math import degrees, isfinite
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from forcefeel import _core
from forcefeel.errors import InputError, named_extra
from forcefeel.fly.control_data import control_data
from forcefeel.loader.axes import FlightAxis
from forcefeel.loader.loader import Loader
from forcefeel.simulation.inputs.flight import FLIGHT_UNITS, WITHOUT

FRAME_S = 0.002
"""Time between two states of the aircraft; at 8 ms the short period of a light aircraft is 1 % off."""

_FT, _KT, _PSF = 0.3048, 1852 / 3600, 4.4482216152605 / 0.3048**2
_SHARES = (-1.0, 1.0)
_STILL = 1e-6
_POSITION = {"pitch": "fcs/elevator-pos-rad", "roll": "fcs/left-aileron-pos-rad", "yaw": "fcs/rudder-pos-rad"}
_COMMAND = {"pitch": "fcs/elevator-cmd-norm", "roll": "fcs/aileron-cmd-norm", "yaw": "fcs/rudder-cmd-norm"}
_TRIM = {axis: f"fcs/{axis}-trim-cmd-norm" for axis in _COMMAND}
_SURFACE = {"pitch": "elevator", "roll": "aileron", "yaw": "rudder"}
_COMMAND_SIGN = {"pitch": 1.0, "roll": 1.0, "yaw": -1.0}
"""Of a command per control."""
_SPEED_BRAKES = ("speedbrake", "spoiler")
_THROTTLE = "fcs/throttle-cmd-norm"
_BANK_PER_RAD, _BANK_S = 1.0, 0.5
_TRIMMED = {
    "udot": "thrust and drag",
    "vdot": "side force",
    "wdot": "lift and weight",
    "pdot": "roll",
    "qdot": "pitch",
    "rdot": "yaw",
}
"""What JSBSim balances, by its name of the acceleration."""


class Aircraft:
    """An aircraft in trimmed flight.

    Args:
        name: One with data of its controls: ``737``, ``T38``, ``c172p``, ``f16``; or the path of such a file.
        speed_m_per_s: Calibrated airspeed.
        altitude_m: Altitude above sea level.
        load_factor: Trimmed in a pull-up with this load factor; 1 for straight and level.
        axis: ``pitch``, ``roll`` or ``yaw``: the control that moves it; the others stay where they are.
        sideslip_rad: Trimmed in a steady sideslip, straight flight with crossed controls.
        tab_rad: Angle of the surface's tab from that of the trimmed flight: the aircraft is out of trim.

    Raises:
        InputError: If JSBSim is not installed, the aircraft is unknown, or it does not trim.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> round(aircraft.state()["true_airspeed"])
        54
    """

    def __init__(
        self,
        name: str,
        speed_m_per_s: float,
        altitude_m: float,
        load_factor: float = 1.0,
        *,
        axis: FlightAxis = "pitch",
        sideslip_rad: float = 0.0,
        tab_rad: float = 0.0,
    ) -> None:
        self.data = control_data(name, axis)
        self.name, self.axis, self.tab_rad = name, axis, tab_rad
        numbers = {"speed": speed_m_per_s, "altitude": altitude_m, "load factor": load_factor, "sideslip": sideslip_rad}
        for what, number in numbers.items():
            if not isfinite(number):
                raise InputError(f"{what}: expected a finite number, got {number}")
        full_travel = self.data.full_travel_rad
        reversible = full_travel is None
        # Only a surface has angles that are not JSBSim's shares.
        self._travel = {share: self._position_at(share) for share in _SHARES} if reversible else {-1.0: -1.0, 1.0: 1.0}
        self.per_angle: float = (
            self.data.surface["gearing"] if full_travel is None else _COMMAND_SIGN[axis] / full_travel
        )
        self.speed_m_per_s, self.altitude_m = speed_m_per_s, altitude_m
        self._model = _loaded(self.data.model)
        self._model["ic/vc-kts"] = speed_m_per_s / _KT
        self._model["ic/h-sl-ft"] = altitude_m / _FT
        self._model["ic/gamma-deg"] = 0.0
        if load_factor != 1:
            self._model["ic/targetNlf"] = load_factor
        if sideslip_rad:
            self._model["ic/beta-deg"] = degrees(sideslip_rad)
        # Modes and forces of one weight: no fuel is burnt.
        self._model["propulsion/fuel_freeze"] = 1
        with silent() as printed:
            self._model.run_ic()
            self._model["propulsion/set-running"] = -1
            try:
                self._model["simulation/do_simple_trim"] = 1 if load_factor == 1 else 3
            except RuntimeError as error:
                failed = re.findall(r"Sorry, (\w+) doesn't", printed())
                axes = " and ".join(_TRIMMED.get(axis, axis) for axis in failed) or "an axis that JSBSim does not name"
                pulls = "" if load_factor == 1 else f" and {load_factor:.3g} g"
                pulls += f" and {degrees(sideslip_rad):.3g} deg of sideslip" if sideslip_rad else ""
                raise InputError(
                    f"aircraft: {name} does not trim at {speed_m_per_s / _KT:.4g} kt{pulls}: no balance of {axes}; take "
                    f"another speed, altitude or {'sideslip' if sideslip_rad else 'load factor'}"
                ) from error
        self.commands = {each: self._model[_TRIM[each]] + self._model[_COMMAND[each]] for each in _COMMAND}
        """Trimmed commands of all axes, shares."""
        self.trimmed: float = self._model[_POSITION[axis]] if reversible else self.commands[axis]

    @property
    def travel_rad(self) -> float:
        """Angle of the control at its full positive travel."""
        return self._travel[float(np.sign(self.per_angle))] / self.per_angle

    def angle_from(self, trim: "Aircraft") -> float:
        """Angle of the control in this trimmed flight, rad, from its position in another."""
        return (self.trimmed - trim.trimmed) / self.per_angle

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
            "tab": self.tab_rad,
        }
        for name, number in numbers.items():
            if not abs(number) < _MOST:
                raise InputError(f"aircraft: {self.name} left the range of its model: {name} is {number}")
        return numbers

    def attitude(self) -> dict[str, float]:
        """What the pilot sees: pitch attitude, bank and climb angle, rad, calibrated airspeed, m/s, altitude, m."""
        model = self._model
        return {
            "pitch_attitude": model["attitude/theta-rad"],
            "bank": model["attitude/phi-rad"],
            "climb_angle": model["flight-path/gamma-rad"],
            "calibrated_airspeed": model["velocities/vc-kts"] * _KT,
            "altitude": model["position/h-sl-ft"] * _FT,
        }

    @property
    def throttle(self) -> float:
        """Setting of the first throttle, a share."""
        setting: float = self._model[_THROTTLE]
        return setting

    def set_throttle(self, share: float) -> None:
        """Set all throttles."""
        for engine in range(self._model.get_propulsion().get_num_engines()):
            self._model[f"{_THROTTLE}[{engine}]" if engine else _THROTTLE] = share

    def set_flaps(self, share: float) -> None:
        """Move the flap lever."""
        self._model["fcs/flap-cmd-norm"] = share

    def set_gear(self, share: float) -> None:
        """Move the lever of the landing gear; 1 is down, as JSBSim trims it."""
        self._model["gear/gear-cmd-norm"] = share

    def set_speed_brake(self, share: float) -> None:
        """Move the lever of speed brake and spoilers."""
        for name in _SPEED_BRAKES:
            self._model[f"fcs/{name}-cmd-norm"] = share

    def moved_by_levers(self) -> dict[str, bool]:
        """Whether the levers move flaps, gear and speed brake: they are pulled, and the aircraft flown for a second."""
        self.set_flaps(1.0)
        self.set_gear(0.0)
        self.set_speed_brake(1.0)
        with silent():
            for _ in range(round(1 / FRAME_S)):
                self.fly(self.trimmed)

        def moved(*names: str) -> bool:
            return any(self._model[f"fcs/{name}-pos-{unit}"] for name in names for unit in ("norm", "deg", "rad"))

        gear = self._model["gear/gear-pos-norm"] < 1
        return {"flaps": moved("flap"), "gear": gear, "speed-brake": moved(*_SPEED_BRAKES)}

    def set_bank(self, bank_rad: float) -> None:
        """Roll towards a bank by the ailerons, with an autopilot's damping."""
        model = self._model
        command = _BANK_PER_RAD * (bank_rad - model["attitude/phi-rad"]) - _BANK_S * model["velocities/p-rad_sec"]
        self._command("roll", self.commands["roll"] + min(1.0, max(-1.0, command)))

    def lead(self, begin: "Aircraft", end: "Aircraft", share: float) -> None:
        """Set throttle and the other controls a share of the way between two trimmed flights, and roll towards its bank."""
        self.set_throttle(begin.throttle + share * (end.throttle - begin.throttle))
        self.commands = {
            each: begin.commands[each] + share * (end.commands[each] - begin.commands[each]) for each in _COMMAND
        }
        for each in _COMMAND.keys() - {self.axis, "roll"}:
            self._command(each, self.commands[each])
        if self.axis != "roll":
            banks = [trim.attitude()["bank"] for trim in (begin, end)]
            self.set_bank(banks[0] + share * (banks[1] - banks[0]))

    def fly(self, position: float) -> None:
        """Advance by a frame with the surface at an angle, or the command at a share."""
        low, high = self._travel[-1.0], self._travel[1.0]
        share = position / high if position > 0 else -position / low
        self._command(self.axis, min(1.0, max(-1.0, share)))
        self._model.run()

    def _command(self, axis: str, share: float) -> None:
        self._model[_COMMAND[axis]] = share - self._model[_TRIM[axis]]

    def _position_at(self, share: float) -> float:
        """The surface's angle at a share of its travel, at once.

        Raises:
            InputError: If it is not there at once: an actuator stands between.
        """
        model = _loaded(self.data.model)
        with silent():
            model.run_ic()
            model[_COMMAND[self.axis]] = share
            model.run()
            first: float = model[_POSITION[self.axis]]
            model.run()
        if abs(model[_POSITION[self.axis]] - first) > _STILL:
            raise InputError(
                f"aircraft: {self.name} has an actuator between command and {_SURFACE[self.axis]}; a reversible control moves the "
                "surface itself; take control.moves = command"
            )
        return first


_MOST = 1e6


def with_surface(loader: Loader, aircraft: Aircraft) -> Loader:
    """The loader with the aircraft's surface and feel, its force zero where the aircraft is trimmed.

    Example:
        >>> ff.fly.with_surface(ff.digital_elevator(), ff.fly.Aircraft("c172p", 51.4, 900.0))["surface.per_deflection"]
        -0.3
    """
    data = aircraft.data
    rows = {f"surface.{key}": value for key, value in data.surface.items()}
    changed = loader.replace({**rows, "feel.stiffness": data.stiffness})
    frequency, _ = _core.feel_frequency(changed.si_values)
    _, damping = _core.feel_from_frequency(frequency, data.damping_ratio, changed["feel.stiffness"])
    # The tab's share of the coefficient: the moment is linear in it.
    state = aircraft.state()
    with_none, with_one = (
        hinge_moment(changed.replace({"surface.at_zero": c}, si=True), state, 0.0)[0] for c in (0.0, 1.0)
    )
    at_zero = -with_none / (with_one - with_none)
    return changed.replace({"feel.damping": damping, "surface.at_zero": at_zero}, si=True)


def flight_row(state: Mapping[str, float]) -> list[float]:
    """A flight state as the engine takes it, in the order of ``FLIGHT_UNITS``."""
    return [state.get(name, WITHOUT.get(name, 0.0)) for name in FLIGHT_UNITS]


def hinge_moment(loader: Loader, state: Mapping[str, float], angle_rad: float) -> tuple[float, float, float]:
    """Force at the grip, N, spring, N m/rad, and damping, N m s/rad, of the loader's surface in a flight state."""
    row = np.array([[*flight_row(state), angle_rad]])
    ((force, stiffness, damping),) = _core.hinge_moment(loader.si_values, row).tolist()
    return force, stiffness, damping


def _loaded(name: str) -> Any:
    with named_extra():
        import jsbsim  # noqa: PLC0415  an extra
    with silent():
        model = jsbsim.FGFDMExec(None)
        model.set_debug_level(0)
        try:
            there = model.load_model(name)
        except RuntimeError:
            there = False
        # Some aircraft write tables of their own to where one stands.
        for output in takewhile(model.get_output_filename, count()):
            model.set_output_filename(output, os.devnull)
        model.set_dt(FRAME_S)
    if not there:
        raise InputError(f"aircraft: JSBSim has no aircraft {name!r}; name one of its folder aircraft as model")
    return model


@contextmanager
def silent() -> Iterator[Callable[[], str]]:
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
