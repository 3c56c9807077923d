"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.fly.aircraft import FRAME_S as FRAME_S
from forcefeel.fly.aircraft import Aircraft as Aircraft
from forcefeel.fly.aircraft import with_surface as with_surface
from forcefeel.fly.case import FlightCase as FlightCase
from forcefeel.fly.case import HeldFlight as HeldFlight
from forcefeel.fly.live import LiveFlight as LiveFlight
from forcefeel.fly.live import fly_live as fly_live
from forcefeel.fly.maneuvers import Maneuver as Maneuver
from forcefeel.fly.maneuvers import ManeuverRequest as ManeuverRequest
from forcefeel.fly.maneuvers import fly_maneuver as fly_maneuver
from forcefeel.fly.modes import free_modes as free_modes
from forcefeel.fly.page.page import write_flight as write_flight
from forcefeel.fly.pilot import CrossoverPilot as CrossoverPilot
from forcefeel.fly.report import FlightReport as FlightReport
from forcefeel.fly.report import fly_rules as fly_rules
from forcefeel.fly.run import FlightOptions as FlightOptions
from forcefeel.fly.run import Flown as Flown
from forcefeel.fly.run import fly as fly
from forcefeel.fly.trims import force_per_g as force_per_g
from forcefeel.fly.trims import held_force as held_force
from forcefeel.fly.trims import trimmed_force as trimmed_force
