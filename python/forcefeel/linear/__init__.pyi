"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.linear.boundary import StabilityBoundary as StabilityBoundary
from forcefeel.linear.boundary import largest_stable_stiffness as largest_stable_stiffness
from forcefeel.linear.boundary import smallest_stable_stiffness as smallest_stable_stiffness
from forcefeel.linear.electric_modes import NamedMode as NamedMode
from forcefeel.linear.electric_modes import motor_modes as motor_modes
from forcefeel.linear.frequency import Margins as Margins
from forcefeel.linear.frequency import Peak as Peak
from forcefeel.linear.frequency import frequency_response as frequency_response
from forcefeel.linear.frequency import margins as margins
from forcefeel.linear.frequency import resonance as resonance
from forcefeel.linear.models import Linkage as Linkage
from forcefeel.linear.models import state_feedback as state_feedback
from forcefeel.linear.modes import Mode as Mode
from forcefeel.linear.state_space import compliant_model as compliant_model
from forcefeel.linear.state_space import design_plant as design_plant
from forcefeel.linear.state_space import ideal_feel as ideal_feel
from forcefeel.linear.state_space import overall_open_loop as overall_open_loop
from forcefeel.linear.state_space import plant as plant
from forcefeel.linear.state_space import rigid_model as rigid_model
from forcefeel.linear.state_space import servo as servo
from forcefeel.linear.step import step_response as step_response
