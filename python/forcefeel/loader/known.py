"""How well a loader is known: by what share its machine may differ from the linear plant that a law is designed for."""

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, MOTOR_PARAMETERS, OFF, PLANT_PARAMETERS
from forcefeel.loader.tolerances import ASSUMED, assumed

ORIFICE = {"valve.current_gain": "valve.rated_flow", "valve.pressure_gain": "valve.supply_pressure"}
"""What stands for the gains C_i, C_p where the flow follows the orifice, eq. (1)."""

LEFT_OUT = (
    "motor.viscous_friction",
    "motor.coulomb_friction",
    "motor.static_friction",
    "motor.cogging_torque",
    "motor.cogging_torque_2",
    "transmission.backlash",
    "transmission.efficiency",
    "transmission.backdriving_efficiency",
    "linkage.backlash",
    "actuator.seal_friction",
    "column.coulomb_friction",
    "column.static_friction",
    "column.gravity_torque",
    "load_cell.offset",
    "load_cell.bandwidth",
    "potentiometer.offset",
    "potentiometer.bandwidth",
    "column_sensor.offset",
    "column_sensor.bandwidth",
    "controller.input_bits",
    "controller.output_bits",
)
"""Optional rows that move machine or samples and that no linear plant has."""


def machine_rows(loader: Loader) -> tuple[str, ...]:
    """The parameters of the machine that its linear plant depends on, those that the loader has.

    Example:
        >>> from forcefeel.loader.known import machine_rows
        >>> "valve.rated_flow" in machine_rows(ff.digital_elevator())
        True
    """
    electric, orifice = loader.drive == ELECTRIC, bool(loader["valve.orifice"])
    keys = (
        MOTOR_PARAMETERS if electric else tuple(ORIFICE.get(key, key) if orifice else key for key in PLANT_PARAMETERS)
    )
    return tuple(key for key in keys if loader[key] not in {0.0, OFF.get(key)})


def off_by(loader: Loader) -> float:
    """The largest share by which a parameter of the machine may be off.

    It is that of its tolerance, and ``tolerances.assumed`` for one that has none. The whole loader counts as known no better than
    ``ASSUMED`` where it has any row of ``LEFT_OUT``.

    Example:
        >>> from forcefeel.loader.known import machine_rows, off_by
        >>> loader = ff.loader.electric("sidestick-pitch")
        >>> off_by(loader), off_by(loader.with_tolerances(dict.fromkeys(machine_rows(loader), "1 %")))
        (0.2, 0.01)
    """
    shares = [_share(loader, key) for key in machine_rows(loader)]
    if any(loader[key] != OFF[key] for key in LEFT_OUT):
        shares.append(ASSUMED)
    return max(shares)


def _share(loader: Loader, key: str) -> float:
    if key not in loader.tolerances:
        return assumed(key)
    value = loader[key]
    return max(abs(end - value) for end in loader.tolerances[key].ends) / abs(value)
