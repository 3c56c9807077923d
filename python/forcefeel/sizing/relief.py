"""Demand of a simulated release on a drive: at the release the drive relieves the stretch of the link.

The programmed feel requires this relief instantly, because the hand's force vanishes instantly. Its duration depends on the law:
`robust`, or without a digital controller the report's position loop. The noise of the sensors is omitted.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX, TABLE
from forcefeel.loader.timing import controller_steps
from forcefeel.sizing.motor import Motor, MotorNeeds
from forcefeel.sizing.valve import Valve, ValveNeeds

_STEP_S = 2.5e-4
_NOISE = [INDEX[key] for key in TABLE if key.endswith(".noise")]


@dataclass(frozen=True, eq=False)
class Relief:
    """Demand of a simulated release over time.

    Attributes:
        law: Name of the law.
        force_n, speed_m_per_s: Force and speed of the drive at the grip.
        share: Used share of the drive's peak limit.
        needs: Largest demand on the drive.
    """

    law: str
    force_n: NDArray[np.float64] = field(repr=False)
    speed_m_per_s: NDArray[np.float64] = field(repr=False)
    share: NDArray[np.float64] = field(repr=False)
    needs: MotorNeeds | ValveNeeds

    @property
    def of_peak(self) -> float:
        """Largest share, at most 1: a drive cannot exceed its limit."""
        return min(float(self.share.max()), 1.0)


def relief(drive: Motor | Valve, angle_rad: float, duration_s: float) -> Relief | None:
    """The simulated release, evaluated over ``duration_s``; ``None`` if no law can be designed, or the run diverges."""
    loader = drive.loader
    try:
        law = Law.of(None, loader)
    except InputError:
        return None
    outputs = [name for name, _ in _core.simulation_outputs(loader.drive)]
    kept = ("motor_current", "motor_speed") if isinstance(drive, Motor) else ("load_pressure", "actuator_flow")
    histories = _run(loader, law, (angle_rad, duration_s), [outputs.index(name) for name in kept])
    if not np.isfinite(histories).all():
        return None
    if isinstance(drive, Motor):
        return _of_motor(drive, law.name, *histories)
    return _of_valve(drive, law.name, *histories)


def _run(loader: Loader, law: Law, release: tuple[float, float], outputs: list[int]) -> NDArray[np.float64]:
    """Histories (outputs, samples) of a release, without the sensors' noise."""
    angle, duration = release
    step, timing = controller_steps(loader, _STEP_S) if loader["controller.period"] else (_STEP_S, None)
    none = np.zeros((int(np.ceil(duration / step)), 2))
    values = loader.si_values.copy()
    values[_NOISE] = 0.0
    engine = _core.Simulation(
        {"force": none},
        step,
        outputs=outputs,
        held=(angle, 0),
        timing=timing,
        curve=loader.force_curve.arrays if loader.force_curve else None,
        cancellation=law.cancellation.numbers if law.cancellation else None,
    )
    _, histories = engine.run(values[np.newaxis], **law.engine(loader))
    return np.asarray(histories[0])


def _of_motor(motor: Motor, law: str, current: NDArray[np.float64], turns: NDArray[np.float64]) -> Relief:
    speed = turns / motor.statics.gear
    volts = motor.voltage(current, speed)
    most = float(np.abs(current).max())
    needs = MotorNeeds(motor.statics.torque(most), most, float(np.abs(volts).max()), np.nan, np.nan)
    force = motor.statics.torque(1.0) * current * motor.statics.gear
    return Relief(law, force, speed, motor.share_of(current, volts), needs)


def _of_valve(valve: Valve, law: str, pressure: NDArray[np.float64], flow: NDArray[np.float64]) -> Relief:
    spool = valve.statics.needed(flow, pressure)
    needs = ValveNeeds(float(np.abs(pressure).max()), float(spool.max()))
    per_pressure = valve.force_per_pressure
    return Relief(law, per_pressure * pressure, flow / per_pressure, valve.share_of(pressure, spool), needs)
