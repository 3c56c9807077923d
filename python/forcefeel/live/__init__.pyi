"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.live.bus import BusEmulator as BusEmulator
from forcefeel.live.cockpit import LiveCockpit as LiveCockpit
from forcefeel.live.cockpit import start_cockpit as start_cockpit
from forcefeel.live.console.server import Console as Console
from forcefeel.live.endpoint import Simulated as Simulated
from forcefeel.live.endpoint import Udp as Udp
from forcefeel.live.live_session import FAULTS as FAULTS
from forcefeel.live.live_session import SENSORS as SENSORS
from forcefeel.live.live_session import LiveSession as LiveSession
from forcefeel.live.machine import Machine as Machine
from forcefeel.live.record import LiveRecord as LiveRecord
from forcefeel.live.record import Replayed as Replayed
from forcefeel.live.record import read_live_record as read_live_record
from forcefeel.live.record import replay as replay
from forcefeel.live.starting import start as start
from forcefeel.live.state import COLUMNS as COLUMNS
from forcefeel.live.state import STATES as STATES
from forcefeel.live.state import Histogram as Histogram
from forcefeel.live.state import HostState as HostState
from forcefeel.live.state import State as State
from forcefeel.live.state import Timing as Timing
from forcefeel.live.state import Trip as Trip
