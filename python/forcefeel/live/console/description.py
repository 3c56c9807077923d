"""Description of a loop for a page: loader, channels, sliders and their limits."""

from dataclasses import dataclass
from math import inf, isfinite

from forcefeel.live.console.telemetry import RATE_HZ, Channel
from forcefeel.live.flight_controls import READINGS, FlightControls
from forcefeel.live.live_session import OF_A_SENSOR, Fault, LiveSession, Sensor
from forcefeel.loader.links import Link
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import TABLE, limits_si, unit
from forcefeel.page.typography import split_symbol, unit_text
from forcefeel.units import ANGLE, FORCE, Json, UnitSystem

_TO_EITHER_SIDE = 4.0
"""Range of the sliders of I, B, G: initial value divided and multiplied by this factor."""

_SLIDERS: dict[str, tuple[str, float, float]] = {
    "feel.stiffness": ("stiffness", 0, 0),
    "feel.damping": ("damping", 0, 0),
    "feel.inertia": ("inertia", 0, 0),
    "feel.breakout": ("breakout", 0, 60.0),
    "feel.coulomb_friction": ("dry friction", 0, 60.0),
    "feel.quadratic_damping": ("quadratic damping", 0, 50.0),
    "feel.hysteresis": ("hysteresis", 0, 40.0),
    "feel.deadband": ("deadband", 0, 0.07),
    "feel.detent_force": ("detent", 0, 60.0),
    "feel.detent_angle": ("detent position", -0.17, 0.17),
    "feel.preload": ("preload", -60.0, 60.0),
}
"""Rows with a slider: name, lowest and highest value in SI units; the range of I, B, G follows from the loader."""

FAULTS: dict[Fault, str] = {
    "no_samples": "no samples",
    "stuck": "a sensor is stuck",
    "not_a_number": "a sensor returns NaN",
    "jump": "a sensor jumps",
    "spike": "a sensor jumps for one sample",
    "reversed": "a sensor has its sign reversed",
    "ignores_command": "commands are lost",
}
"""Text of the faults of a simulated machine that need no number of their own."""

SENSORS: dict[Sensor, tuple[str, float]] = {
    "load_cell": ("load cell", 500.0),
    "drive": ("drive's end", 0.01),
    "column": ("column", 0.05),
}
"""Sensors with faults, and their jump: N, m, rad."""


@dataclass(frozen=True)
class Slider:
    """A row of the feel that can be changed while the loop runs.

    Attributes:
        key: The row.
        name: Displayed name.
        low, high: Range in SI units.
        even: Whether the slider is logarithmic.
    """

    key: str
    name: str
    low: float
    high: float
    even: bool

    def as_json(self, system: UnitSystem) -> Json:
        """The slider for the page: values in SI units, ``scale`` converts them to the displayed unit."""
        row = TABLE[self.key]
        base, index, dashes = split_symbol(row.symbol)
        return {
            "key": self.key,
            "name": self.name,
            "meaning": row.meaning,
            "symbol": [base, index, dashes],
            "unit": unit_text(unit(row).shown(system)),
            "scale": unit(row).from_si(1.0, system),
            "low": self.low,
            "high": self.high,
            "even": self.even,
        }


def sliders(loader: Loader) -> tuple[Slider, ...]:
    """Sliders of a loader's feel."""
    rows = []
    for key, (name, least, most) in _SLIDERS.items():
        smallest, largest = limits_si(TABLE[key])
        even = key in FEEL_SETTING and loader[key] > 0
        low, high = _around(loader, key) if even else (least, most or 1.0)
        rows.append(Slider(key, name, max(low, smallest), min(high, largest), even))
    return tuple(rows)


def _around(loader: Loader, key: str) -> tuple[float, float]:
    """Range of a slider of I, B, G; the stiffness is limited by the scale of its channel."""
    most = max(loader["feel.maximum_stiffness"], loader[key]) if key == "feel.stiffness" else inf
    return loader[key] / _TO_EITHER_SIDE, min(_TO_EITHER_SIDE * loader[key], most)


def description(
    running: LiveSession, displayed: tuple[Channel, ...], throw_rad: tuple[float, float], system: UnitSystem
) -> dict[str, Json]:
    """The description, without fields of a single client."""
    loader = running.loader
    angle, force = ANGLE.from_si(1.0, system), FORCE.from_si(1.0, system)
    return {
        "loader": loader.name,
        "law": running.law.name,
        "link": None if running.settings.link is None else link_json(running.settings.link),
        "period_ms": 1e3 * running.period_s,
        "frames_hz": RATE_HZ,
        "channels": [
            {"column": channel.column, "label": channel.label, "unit": unit_text(channel.unit.shown(system))}
            for channel in displayed
        ],
        "sliders": [slider.as_json(system) for slider in sliders(loader)],
        "angle": {
            "unit": ANGLE.shown(system),
            "scale": angle,
            "low": throw_rad[0] * angle,
            "high": throw_rad[1] * angle,
        },
        "force": {"unit": FORCE.shown(system), "scale": force},
        "flight": None if running.flight is None else flight_json(running.flight, system),
        "faults": [{"name": name, "text": text, "of": name in OF_A_SENSOR} for name, text in FAULTS.items()],
        "sensors": [{"name": name, "text": text, "jump": by} for name, (text, by) in SENSORS.items()],
    }


def flight_json(flight: FlightControls, system: UnitSystem) -> Json:
    """Readings and levers of a flight for the page."""
    return {
        "readings": [
            {"name": name, "label": label, "unit": unit_text(unit.shown(system)), "scale": unit.from_si(1.0, system)}
            for name, (label, unit) in READINGS.items()
        ],
        "levers": [
            {
                "key": name,
                "name": lever.label,
                "symbol": ["", "", ""],
                "unit": unit_text(lever.unit.shown(system)),
                "scale": lever.unit.from_si(1.0, system),
                "low": lever.low,
                "high": lever.high,
                "even": False,
            }
            for name, lever in flight.levers.items()
        ],
    }


def link_json(link: Link) -> Json:
    """A link for the page."""
    dual_input = link["dual_input_force"]
    return {
        "name": link.name,
        "between": list(link.between),
        "kind": link.kind.value,
        "dual_input_n": dual_input if isfinite(dual_input) else None,
    }


def feel_json(running: LiveSession) -> dict[str, Json]:
    """Values of the rows with a slider, in SI units; ``None`` if infinite."""
    loader = running.loader
    values = {key: loader[key] for key in _SLIDERS}
    return {key: value if isfinite(value) else None for key, value in values.items()}


def host_json(running: LiveSession) -> Json:
    """State of the aircraft simulator for the page; ``None`` without a host port."""
    host = running.host
    if host is None:
        return None
    status = "none yet" if host.silent_s is None else "silent" if host.silent_s > _SILENT_S else "sends"
    return {
        "listens": host.listens,
        "status": status,
        "share": round(host.share, 2),
        "refused": host.refused,
        "softened": host.softened,
        "waiting": host.waiting,
    }


_SILENT_S = 0.2
"""A host without packets for this long is silent; a host at 30 Hz sends more often."""
