"""Records of a motor's bench from the tests' independent witness: files that are wrong, what drives them, what sensors show."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np

from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from tests import electric_witness as witness

SMOOTH = (
    "motor.torque_constant",
    "motor.inertia",
    "linkage.stiffness",
    "linkage.damping",
    "column.inertia",
)
"""What a multisine sees."""

ROUGH = MappingProxyType(
    {
        "motor.coulomb_friction": 0.01,
        "motor.viscous_friction": 0.001,
        "motor.cogging_torque": 0.008,
        "motor.cogging_phase": 0.6,
        "column.coulomb_friction": 0.02,
    }
)
"""What a slow sweep sees besides, in shares of the motor's largest torque or of the feel's force at 10 degrees; a phase in rad."""

OFF, PHASE_OFF = 0.25, 0.5
"""Most by which the truth differs from the file: as a logarithm, and in rad."""

LINES_HZ = np.array([0.5, 1, 1.5, 2.5, 3.5, 5, 7, 10, 14, 18, 25, 35, 50, 70, 100])
RAMP_S = 0.5
SETTLE_S = 1.5
"""Before a record begins: under dry friction and cogging the witness first finds its rest."""


def file_of(loader, rough=False, backlash_m=0.0):
    """The loader's file: linear feel, as the witness has it, no tolerances; with friction and cogging if they are asked for."""
    found = loader.with_tolerances(dict.fromkeys(loader.tolerances)).replace({"feel.breakout": 0.0})
    torque = found["motor.torque_constant"] * found["current_loop.current_limit"]
    force = found["feel.stiffness"] * np.radians(10) / found["column.grip_arm"]
    sizes = {key: share * (force if key.startswith("column") else torque) for key, share in ROUGH.items()}
    sizes |= {"motor.cogging_phase": ROUGH["motor.cogging_phase"], "motor.cogging_periods": 12.0}
    found = found.replace(sizes, si=True) if rough else found
    return found.replace({"linkage.backlash": backlash_m}, si=True) if backlash_m else found


def truth_of(file, keys, random):
    """A machine whose parameters are not what its file says."""
    off = random.uniform(-1, 1, len(keys))
    values = {
        key: file[key] + PHASE_OFF * it if key.endswith("phase") else file[key] * np.exp(OFF * it)
        for key, it in zip(keys, off, strict=True)
    }
    return file.replace(values, si=True)


def multisine(share, file, duration_s, random, lines_hz=LINES_HZ):
    """A current in A with an r.m.s. of a share of the largest one, over time."""
    phases = random.uniform(0, 2 * np.pi, len(lines_hz))
    height = share * file["current_loop.current_limit"] * np.sqrt(2 / len(lines_hz))

    def current(t):
        rise = np.clip(min(t, duration_s - t) / RAMP_S, 0.0, 1.0)
        shape = 0.5 - 0.5 * np.cos(np.pi * rise)
        return float(shape * height * np.sum(np.cos(2 * np.pi * lines_hz * t + phases)))

    return current


def slow(file, angle_rad=0.12):
    """A pilot's force in N that moves the column slowly through its travel, both ways."""
    height = file["feel.stiffness"] * angle_rad / file["column.grip_arm"]
    return lambda t: height * np.sin(2 * np.pi * 0.4 * t) * (0.7 + 0.3 * np.cos(2 * np.pi * 0.17 * t)) if t > 0 else 0.0


NOISE = 0.01
"""White noise, as a share of each channel's deviation."""


def record(truth, law, experiment, signal, duration_s, *, random, settle_s=0.0):
    """What a bench records of ``truth`` under a law or none, noise on it."""
    asked, period = Experiment.read(experiment), truth["controller.period"]
    late = lambda t: signal(t - settle_s) if t >= settle_s else 0.0  # noqa: E731
    sampled = np.array([signal(k * period) for k in range(round(duration_s / period) + 1)])
    drives = {"command": late} if asked.drive == "command_current" else {}
    if asked.drive == "test_current":  # a straight line between the samples, as the record is read
        drives = {"test": lambda t: float(np.interp(t - settle_s, np.arange(len(sampled)) * period, sampled))}
    pilot = late if asked.drive == "pilot_force" else (lambda t: 0.0)
    numbers = None if law is None else law.sampled
    run = witness.simulate(truth, numbers, pilot, duration_s + settle_s, rtol=1e-8, **drives)  # far below the noise
    seen = {name: values[round(settle_s / period) :] for name, values in run.items()}
    channels = sensed(truth, seen)
    channels = {name: it + NOISE * it.std() * random.standard_normal(len(it)) for name, it in channels.items()}
    channels[str(asked.drive)] = sampled
    hold = "staircase" if asked.drive == "command_current" else "straight"
    return BenchRecord(experiment, asked, np.arange(len(sampled)) * period, channels, hold)


def sensed(truth, seen):
    """The channels of a motor's bench."""
    plant = witness.Plant(truth)
    travel, speed, angle = seen["drive_position_m"], seen["motor_speed"], seen["column_angle_rad"]
    states = zip(travel, speed, angle * plant.arm, seen["column_rate"], strict=True)
    return {
        "column_angle": angle,
        "drive_position": travel,
        "load_cell_force": np.array([plant.force(*it) for it in states]),
        "motor_current": seen["motor_current_a"],
        "motor_angle": travel / plant.r,
    }


def measured(found, *channels):
    """The record with these channels alone, and its drive."""
    return replace(found, channels={name: found.channels[name] for name in (*channels, str(found.experiment.drive))})
