"""forcefeel designs, proves and runs the force feel of aircraft simulator controls.

Everything public is listed here, by the module that holds it. A name is fetched when first used, so that
``forcefeel --help`` does not wait for the numerical libraries; ``__init__.pyi`` has the same list for type checkers.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

_PUBLIC = {
    "_core": ("Compensator",),
    "linear.boundary": ("StabilityBoundary", "smallest_stable_stiffness"),
    "linear.frequency": ("Margins", "Peak", "frequency_response", "margins", "resonance"),
    "linear.modes": ("Mode", "modes"),
    "linear.step": ("step_response",),
    "design.assessment": ("Assessment", "Peaks", "assess", "peaks"),
    "choice": ("Choice", "Score", "Scored", "choose", "score_methods"),
    "choice.page.folder": ("write_choice",),
    "loader.curves": ("Curve",),
    "laws.analog.recursion": ("Compensation", "DesignSettings", "compensate", "published_settings"),
    "conclusions": ("Conclusions",),
    "design.findings": ("conclusions",),
    "flight_schedule": (
        "FlightSchedule",
        "ScheduleAxis",
        "ScheduleCheck",
        "check_schedule",
        "design_schedule",
        "read_knots",
        "second_order_feel",
    ),
    "flight_schedule.page.folder": ("write_schedule",),
    "simulation.findings": ("run_conclusions",),
    "envelope": ("Draws", "Envelope", "envelope"),
    "envelope.page.folder": ("write_envelope",),
    "frontier": ("Frontier", "find_frontier"),
    "frontier.page.folder": ("write_frontier",),
    "design.workflow": ("Analysis", "Design", "analyze", "design"),
    "errors": ("InputError",),
    "design.figure_data": ("Figure", "figures"),
    "simulation.inputs": (
        "Chirp",
        "Doublet",
        "HandsOff",
        "Multisine",
        "Pulse",
        "Recorded",
        "Release",
        "Schedule",
        "Step",
        "StopToStop",
        "read_recorded",
    ),
    "bench.excitation.bench_file": ("write_excitation",),
    "bench.excitation.excite": ("excite",),
    "bench.excitation.plan": ("ExcitationPlan",),
    "bench.excitation.result": ("Excitation",),
    "bench.data_file": ("read_bench_data",),
    "bench.records": ("BenchRecord",),
    "bench.estimate": ("estimate_response",),
    "bench.experiments": ("Drive", "Experiment", "Loop"),
    "bench.identification.fit": ("identify",),
    "bench.identification.linear": ("model_response",),
    "bench.record_file": ("read_bench_record",),
    "bench.resonance": ("Resonance", "link_from_resonance", "read_resonance"),
    "bench.response_file": ("read_response",),
    "bench.responses": ("Response",),
    "bench.identification.result": ("Estimate", "Identification"),
    "bench.identification.page.folder": ("write_identification",),
    "loops.command_loop": ("CommandLoop", "command_loops"),
    "laws.sampled.methods": ("Method", "method", "tuned"),
    "laws.law": ("Law",),
    "laws.sampled.tuning": ("Power", "Tuning"),
    "envelope.tune": ("Tuned", "tune"),
    "loops.margins": ("LoopMargins", "loop_margins"),
    "laws.sampled.sampled_compensator": ("SampledCompensator",),
    "loops.sampled_loop": ("SampledLoops", "sampled_loops"),
    "loader.built_in": ("digital_elevator", "elevator"),
    "loader.loader": ("Loader", "load"),
    "linear.models": (
        "Linkage",
        "compliant_model",
        "design_plant",
        "ideal_feel",
        "overall_open_loop",
        "rigid_model",
        "servo",
        "state_feedback",
    ),
    "design.page": ("write_report",),
    "qualification.programme": ("Qualification", "QualificationSetup", "qualify_loader"),
    "qualification.page.folder": ("write_qualification",),
    "reproduction": ("reproduce",),
    "simulation.page.folder": ("write_simulation",),
    "simulation.limits": ("Limits", "limits"),
    "laws.analog.gain_schedule": ("GainSchedule", "schedule_gains"),
    "simulation": ("FeelChange", "Measures", "Run", "RunStatus", "Scenario", "simulate", "simulate_batch"),
    "simulation.linear": ("simulate_linear_batch",),
    "sweep": ("Sweep", "SweepResult", "run_sweep"),
    "sweep.stability": ("stability_batch",),
    "sweep.summary": ("Summary", "summarize"),
    "sweep.page.folder": ("write_sweep",),
    "loader.tolerances": ("Distribution", "Tolerance"),
    "design.studies": ("Deviation", "DroppedPaths", "drop_paths", "sensitivity"),
    "units": ("UnitSystem",),
}
_HOME = {name: module for module, names in _PUBLIC.items() for name in names}

__all__ = list(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'forcefeel' has no attribute {name!r}")
    return getattr(import_module(f"forcefeel.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)


class _Package(ModuleType):
    """The package, in which a public name stays what it is where a folder has the same one.

    The import of ``forcefeel.envelope.result`` would set ``forcefeel.envelope`` to the folder, and hide the function.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
