"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel._core import Compensator as Compensator
from forcefeel.laws.analog.gain_schedule import GainSchedule as GainSchedule
from forcefeel.laws.analog.gain_schedule import schedule_gains as schedule_gains
from forcefeel.laws.analog.recursion import Compensation as Compensation
from forcefeel.laws.analog.recursion import DesignSettings as DesignSettings
from forcefeel.laws.analog.recursion import compensate as compensate
from forcefeel.laws.analog.recursion import published_settings as published_settings
from forcefeel.laws.law import Law as Law
from forcefeel.laws.sampled.methods import Method as Method
from forcefeel.laws.sampled.methods import method as method
from forcefeel.laws.sampled.methods import tuned as tuned
from forcefeel.laws.sampled.sampled_compensator import SampledCompensator as SampledCompensator
from forcefeel.laws.sampled.tuning import Power as Power
from forcefeel.laws.sampled.tuning import Tuning as Tuning
