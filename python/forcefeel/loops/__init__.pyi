"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.loops.command_loop import CommandLoop as CommandLoop
from forcefeel.loops.command_loop import command_loops as command_loops
from forcefeel.loops.margins import LoopMargins as LoopMargins
from forcefeel.loops.margins import loop_margins as loop_margins
from forcefeel.loops.sampled_loop import SampledLoops as SampledLoops
from forcefeel.loops.sampled_loop import sampled_loops as sampled_loops
