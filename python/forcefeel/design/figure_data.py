"""The data behind the figures of a design: for a valve the report's 2, 8 to 11 and 14, for a motor those of ``motor_figures``."""

from dataclasses import replace

import numpy as np

from forcefeel import _core
from forcefeel.design.analysis import Configuration
from forcefeel.design.figure import FREQUENCIES_HZ, Figure, Kind
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_figures import motor_figures
from forcefeel.design.workflow import Design
from forcefeel.linear.frequency import frequency_arrays
from forcefeel.linear.models import LinearModel, Linkage, feel_model, loader_model, open_loop_model, servo_model
from forcefeel.linear.step import step_arrays
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ALTERNATIVES
from forcefeel.tables.labeled_arrays import LabeledArrays


def figures(design: Design | MotorDesign) -> tuple[Figure, ...]:
    """Every figure of the report that has a curve, computed for ``design``; those of a motor for a motor.

    Example:
        >>> len(ff.design.figures(ff.design_loader(ff.elevator()))) > 5
        True
    """
    if isinstance(design, MotorDesign):
        return motor_figures(design)
    return (
        _valve(design.loader),
        _servo("figure-08", "Servo, position loop open", design.loader, closed=False),
        _servo("figure-09", "Servo, position loop closed", design.loader, closed=True),
        _overall(design),
        _original("figure-11a", "Step of pilot force, rigid model", design, Linkage.RIGID),
        _original("figure-11b", "Step of pilot force, compliant model", design, Linkage.COMPLIANT),
        _compensated(design),
    )


def _valve(loader: Loader) -> Figure:
    """Eq. (1) for five currents, and its tangent at the report's operating point, which is what eq. (2) means."""
    rated, supply = loader["valve.rated_current"], loader["valve.supply_pressure"]
    pressure = np.linspace(0.0, supply, 201)
    curves = {}
    for share in (0.2, 0.4, 0.6, 0.8, 1.0):
        flow = _core.orifice_flow(loader.si_values, np.full_like(pressure, share * rated), pressure)
        curves[f"{100 * share:.0f} % of rated current"] = _valve_curve(pressure, flow)
    i_share, p_share = (ALTERNATIVES[f"valve.operating_{name}"].default_us for name in ("current", "pressure"))
    current, at = np.array([i_share * rated]), np.array([p_share * supply])
    _, slope = _core.valve_gains(loader.si_values, i_share, p_share)
    tangent = _core.orifice_flow(loader.si_values, current, at) - slope * (pressure - at)
    curves[f"tangent at {100 * i_share:.0f} %, eq. (2)"] = _valve_curve(pressure, tangent)
    return Figure("figure-02", "Control valve: flow against load pressure", Kind.VALVE, curves)


def _valve_curve(pressure: np.ndarray, flow: np.ndarray) -> LabeledArrays:
    return LabeledArrays(
        {"flow_m3_per_s": ("load_pressure_pa", flow, {"units": "m^3/s"})},
        {"load_pressure_pa": ("load_pressure_pa", pressure, {"units": "Pa"})},
    )


def _servo(key: str, title: str, loader: Loader, *, closed: bool) -> Figure:
    rigid = servo_model(loader, Linkage.RIGID, closed=closed)
    compliant = servo_model(loader, Linkage.COMPLIANT, closed=closed)
    # The column's angle as the voltage that the potentiometer would give if the link did not stretch.
    volts_per_rad = rigid.C[0, 0] / rigid.C[1, 0]
    column = compliant.to_output(1)
    column = replace(column, C=volts_per_rad * column.C)
    return Figure(
        key,
        title,
        Kind.FREQUENCY,
        {
            "rigid link": frequency_arrays(rigid.to_output(0), FREQUENCIES_HZ),
            "compliant link, piston": frequency_arrays(compliant.to_output(0), FREQUENCIES_HZ),
            "compliant link, column": frequency_arrays(column, FREQUENCIES_HZ),
        },
    )


def _overall(design: Design) -> Figure:
    curves = {
        configuration.name: frequency_arrays(
            open_loop_model(design.low_loader, configuration.linkage, configuration.law), FREQUENCIES_HZ
        )
        for configuration in design.configurations
    }
    return Figure("figure-10", "Overall open loop at the low setting", Kind.FREQUENCY, curves)


def _original(key: str, title: str, design: Design, linkage: Linkage) -> Figure:
    settings = {"programmed setting": design.loader, "low setting": design.low_loader}
    curves = {name: _response(loader_model(loader, None, linkage), loader) for name, loader in settings.items()}
    # Both settings have the same ideal: frequency, damping ratio and programmed deflection are kept.
    curves["ideal feel"] = _response(feel_model(design.loader), design.loader)
    return Figure(key, title, Kind.TIME, curves)


def _compensated(design: Design) -> Figure:
    curves = {
        configuration.name: _configuration(configuration, design.loader) for configuration in design.configurations
    }
    curves["ideal feel"] = _response(feel_model(design.loader), design.loader)
    return Figure("figure-14", "Step of pilot force, compensated beside the original", Kind.TIME, curves)


def _configuration(configuration: Configuration, loader: Loader) -> LabeledArrays:
    return _response(loader_model(loader, configuration.law, configuration.linkage), loader)


def _response(model: LinearModel, loader: Loader) -> LabeledArrays:
    return step_arrays(model, loader["pilot.force"])
