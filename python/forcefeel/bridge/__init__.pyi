"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.bridge.run import BridgeReport as BridgeReport
from forcefeel.bridge.run import BridgeSettings as BridgeSettings
from forcefeel.bridge.run import bridge as bridge
from forcefeel.bridge.simulator import Axis as Axis
from forcefeel.bridge.simulator import Simulator as Simulator
from forcefeel.bridge.simulator import SimulatorState as SimulatorState
from forcefeel.bridge.text import Text as Text
from forcefeel.bridge.x_plane import XPlane as XPlane
