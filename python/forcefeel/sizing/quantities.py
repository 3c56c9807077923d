"""Units of what a drive is sized by."""

from forcefeel.units import Unit

SPEED = Unit("m/s", "cm/s", "in/s", "m_per_s")
TORQUE = Unit("N m", "N m", "lb in", "n_m")
MOTOR_CURRENT = Unit("A", "A", "A", "a")
VOLTAGE = Unit("V", "V", "V", "v")
TEMPERATURE = Unit("degC", "degC", "degC", "degc")
MASS = Unit("kg", "kg", "lbm", "kg")
AREA = Unit("m^2", "cm^2", "in^2", "m2")
