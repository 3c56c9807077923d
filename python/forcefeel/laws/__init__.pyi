"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel._core import GainLaw as GainLaw
from forcefeel.laws.analog.gain_schedule import GainSchedule as GainSchedule
from forcefeel.laws.analog.gain_schedule import schedule_gains as schedule_gains
from forcefeel.laws.analog.recursion import DesignSettings as DesignSettings
from forcefeel.laws.analog.recursion import GainDesign as GainDesign
from forcefeel.laws.analog.recursion import design_gains as design_gains
from forcefeel.laws.analog.recursion import published_settings as published_settings
from forcefeel.laws.law import Law as Law
from forcefeel.laws.law import default_law as default_law
from forcefeel.laws.sampled.law_designs import LawDesign as LawDesign
from forcefeel.laws.sampled.law_designs import law_design as law_design
from forcefeel.laws.sampled.law_designs import tuned as tuned
from forcefeel.laws.sampled.sampled_law import SampledLaw as SampledLaw
from forcefeel.laws.sampled.tuning import Power as Power
from forcefeel.laws.sampled.tuning import Tuning as Tuning
