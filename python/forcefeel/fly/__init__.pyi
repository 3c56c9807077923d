"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.fly.aircraft import FRAME_S as FRAME_S
from forcefeel.fly.aircraft import Aircraft as Aircraft
from forcefeel.fly.aircraft import with_elevator as with_elevator
from forcefeel.fly.case import FlightCase as FlightCase
from forcefeel.fly.case import HeldFlight as HeldFlight
from forcefeel.fly.modes import free_modes as free_modes
from forcefeel.fly.pilot import CrossoverPilot as CrossoverPilot
from forcefeel.fly.run import Flown as Flown
from forcefeel.fly.run import Way as Way
from forcefeel.fly.run import fly as fly
from forcefeel.fly.trims import force_per_g as force_per_g
from forcefeel.fly.trims import held_force as held_force
from forcefeel.fly.trims import trimmed_force as trimmed_force
