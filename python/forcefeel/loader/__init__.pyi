"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.loader.built_in import digital_elevator as digital_elevator
from forcefeel.loader.built_in import electric as electric
from forcefeel.loader.built_in import elevator as elevator
from forcefeel.loader.bus import Bus as Bus
from forcefeel.loader.curves import Curve as Curve
from forcefeel.loader.loader import Loader as Loader
from forcefeel.loader.loader import load as load
from forcefeel.loader.project import Project as Project
from forcefeel.loader.project import read_project as read_project
from forcefeel.loader.tolerances import Distribution as Distribution
from forcefeel.loader.tolerances import Tolerance as Tolerance
