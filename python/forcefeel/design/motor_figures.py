"""The data behind the figures of an electric loader's design: labeled curves, without a picture.

Angles stand beside those of the programmed spring, forces beside the motor's own, so that 0 dB means the same on every loader.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from forcefeel.design.assessment import programmed_angle_rad
from forcefeel.design.figure import FREQUENCIES_HZ, Figure, Kind
from forcefeel.design.law_loop import law_response, law_step
from forcefeel.design.motor_design import MotorDesign
from forcefeel.linear.electric import ElectricPlant
from forcefeel.linear.frequency import frequency_arrays
from forcefeel.linear.models import LinearModel, Linkage, feel_model, loader_model, open_loop_model, plant_model
from forcefeel.linear.step import DURATION_S, step_outputs
from forcefeel.loader.loader import Loader
from forcefeel.tables.labeled_arrays import LabeledArrays

_UP_TO_CURRENT_LOOP_HZ = np.geomspace(0.1, 1000.0, 1601)
"""Frequencies of the drive's own responses, 400 a decade."""

_BELOW_NYQUIST = 0.9
"""Share of half the sampling rate up to which a sampled response is told."""

STEP, HAND, FORCE, POSITION, LOOP = "step", "hand", "command-to-force", "command-to-position", "loop"
"""Keys of the figures."""


def motor_figures(design: MotorDesign) -> tuple[Figure, ...]:
    """Every figure of an electric loader's design.

    Example:
        >>> design = ff.design_loader(ff.loader.electric("sidestick-roll"))
        >>> [figure.key for figure in ff.design.figures(design)]
        ['step', 'hand', 'command-to-force', 'command-to-position', 'loop']
    """
    return _step(design), _hand(design), _force(design.loader), _position(design.loader), _loop(design.loader)


def under(law: str) -> str:
    """Label of a curve under a law."""
    return f"under {law}"


def _step(design: MotorDesign) -> Figure:
    loader = design.loader
    law = law_step(loader, design.law)
    samples = len(law.time_s)
    curves = {str(linkage): _response(loader_model(loader, None, linkage), loader, samples) for linkage in Linkage}
    curves[under(design.law)] = _curve(law.time_s, law.column_angle_rad, motor_current_a=(law.command, "A"))
    curves["ideal feel"] = _response(feel_model(loader), loader, samples)
    return Figure(STEP, "Step of pilot force", Kind.TIME, curves)


def _response(model: LinearModel, loader: Loader, samples: int) -> LabeledArrays:
    time, outputs = step_outputs(model, loader["pilot.force"], DURATION_S, samples)
    signals = dict(zip(model.output_labels, outputs, strict=True))
    units = {"motor_current_a": "A", "motor_voltage_v": "V"}
    return _curve(
        time,
        signals["column_angle_rad"],
        **{name: (signals[name], unit) for name, unit in units.items() if name in signals},
    )


def _curve(
    time: NDArray[np.float64], angle: NDArray[np.float64], **others: tuple[NDArray[np.float64], str]
) -> LabeledArrays:
    data = {"column_angle_rad": (angle, "rad"), **others}
    return LabeledArrays(
        {name: ("time_s", values, {"units": unit}) for name, (values, unit) in data.items()},
        {"time_s": ("time_s", time, {"units": "s"})},
    )


def _hand(design: MotorDesign) -> Figure:
    """From the pilot's force to the column's angle, over the programmed deflection at rest."""
    loader = design.loader
    per_force = programmed_angle_rad(loader) / loader["pilot.force"]
    models = {
        "no current": plant_model(loader, Linkage.COMPLIANT),
        "compliant": loader_model(loader, None, Linkage.COMPLIANT),
        "ideal feel": feel_model(loader),
    }
    at = FREQUENCIES_HZ[_BELOW_NYQUIST / (2 * loader["controller.period"]) > FREQUENCIES_HZ]
    curves = {name: _frequency(model, 0, "column_angle_rad", 1 / per_force, at) for name, model in models.items()}
    curves[under(design.law)] = _spectrum(at, law_response(loader, design.law, at) / per_force)
    return Figure(HAND, "Compliance at the grip: column's angle per pilot force", Kind.FREQUENCY, curves)


def _force(loader: Loader) -> Figure:
    """From the command of the current to the load cell's force, over the motor's own at the drive's end."""
    plant = ElectricPlant.of(loader)
    held = plant.column_held()
    compliant = plant_model(loader, Linkage.COMPLIANT)
    models = {
        "rigid link": plant_model(loader, Linkage.RIGID),
        "compliant link": compliant,
        "column held": replace(
            compliant, A=held.a, B=held.b, C=held.c, D=held.d, state_labels=compliant.state_labels[: len(held.a)]
        ),
    }
    scale = 1 / plant.force_per_ampere
    curves = {name: _frequency(model, 1, "load_cell_force_n", scale) for name, model in models.items()}
    return Figure(FORCE, "From the command to the load cell's force", Kind.FREQUENCY, curves)


def _position(loader: Loader) -> Figure:
    """From the command of the current to the angle of column and motor, over what the programmed spring gives its torque."""
    plant = ElectricPlant.of(loader)
    scale = loader["feel.stiffness"] / (plant.force_per_ampere * plant.lever)
    rigid, compliant = (plant_model(loader, linkage) for linkage in Linkage)
    curves = {
        "rigid link": _frequency(rigid, 1, "column_angle_rad", scale),
        "compliant link, column": _frequency(compliant, 1, "column_angle_rad", scale),
        "compliant link, motor": _frequency(compliant, 1, "drive_position_m", scale / plant.lever),
    }
    return Figure(POSITION, "From the command to the angles of column and motor", Kind.FREQUENCY, curves)


def _loop(loader: Loader) -> Figure:
    models = {f"{linkage} link": open_loop_model(loader, linkage) for linkage in Linkage}
    curves = {name: frequency_arrays(model, _UP_TO_CURRENT_LOOP_HZ) for name, model in models.items()}
    return Figure(LOOP, "Loop of the feel by current alone, opened at the command", Kind.FREQUENCY, curves)


def _frequency(
    model: LinearModel,
    entry: int,
    output: str,
    scale: float,
    frequency_hz: NDArray[np.float64] = _UP_TO_CURRENT_LOOP_HZ,
) -> LabeledArrays:
    """Gain and phase of one input to one output, times ``scale``."""
    row = list(model.output_labels).index(output)
    single = model.to_output(row)
    column = slice(entry, entry + 1)
    return frequency_arrays(
        replace(
            single,
            B=single.B[:, column],
            C=scale * single.C,
            D=scale * single.D[:, column],
            input_labels=single.input_labels[column],
        ),
        frequency_hz,
    )


def _spectrum(frequency_hz: NDArray[np.float64], values: NDArray[np.complex128]) -> LabeledArrays:
    phase = np.degrees(np.unwrap(np.angle(values)))
    return LabeledArrays(
        {
            "gain_db": ("frequency_hz", 20 * np.log10(np.abs(values)), {"units": "dB"}),
            "phase_deg": ("frequency_hz", phase, {"units": "deg"}),
        },
        {"frequency_hz": ("frequency_hz", frequency_hz, {"units": "Hz"})},
    )
