"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.sizing.cockpit import CockpitSizing as CockpitSizing
from forcefeel.sizing.cockpit import size_cockpit as size_cockpit
from forcefeel.sizing.findings import sizing_conclusions as sizing_conclusions
from forcefeel.sizing.page.page import write_sizing as write_sizing
from forcefeel.sizing.plan import SizingPlan as SizingPlan
from forcefeel.sizing.result import Sizing as Sizing
from forcefeel.sizing.run import size_drive as size_drive
