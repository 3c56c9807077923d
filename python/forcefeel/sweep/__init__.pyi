"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.sweep.linked_plan import LinkedSweep as LinkedSweep
from forcefeel.sweep.linked_result import LinkedSweepResult as LinkedSweepResult
from forcefeel.sweep.linked_result import run_linked_sweep as run_linked_sweep
from forcefeel.sweep.page.linked_page import write_linked_sweep as write_linked_sweep
from forcefeel.sweep.page.page import write_sweep as write_sweep
from forcefeel.sweep.plan import Sweep as Sweep
from forcefeel.sweep.result import SweepResult as SweepResult
from forcefeel.sweep.run import run_sweep as run_sweep
from forcefeel.sweep.stability import stability_batch as stability_batch
from forcefeel.sweep.summary import Summary as Summary
from forcefeel.sweep.summary import summarize as summarize
