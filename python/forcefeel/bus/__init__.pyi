"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.bus.bench_record import PLAYED as PLAYED
from forcefeel.bus.bench_record import play as play
from forcefeel.bus.bench_record import record as record
from forcefeel.bus.check import check_bus as check_bus
from forcefeel.bus.cockpit import CockpitBusCheck as CockpitBusCheck
from forcefeel.bus.cockpit import check_cockpit as check_cockpit
from forcefeel.bus.host import check_host as check_host
from forcefeel.bus.load import bus_load as bus_load
from forcefeel.bus.result import BusCheck as BusCheck
from forcefeel.bus.result import BusDelay as BusDelay
from forcefeel.bus.result import BusFrame as BusFrame
from forcefeel.bus.result import BusLoad as BusLoad
from forcefeel.bus.result import BusNode as BusNode
from forcefeel.bus.result import Finding as Finding
