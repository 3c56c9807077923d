"""forcefeel designs, proves and runs the force feel of aircraft simulator controls.

Everything public is listed here, by the module that holds it. A name is fetched when first used, so that
``forcefeel --help`` does not wait for the numerical libraries; ``__init__.pyi`` has the same list for type checkers.
"""

from importlib import import_module
from typing import Any

_PUBLIC = {
    "_core": ("Compensator",),
    "analysis.boundary": ("StabilityBoundary", "smallest_stable_stiffness"),
    "analysis.frequency": ("Margins", "Peak", "frequency_response", "margins", "resonance"),
    "analysis.modes": ("Mode", "modes"),
    "analysis.time": ("step_response",),
    "assessment": ("Assessment", "Peaks", "assess", "peaks"),
    "choice": ("Choice", "Score", "Scored", "choose", "score_methods"),
    "report.choice_folder": ("write_choice",),
    "curves": ("Curve",),
    "compensation": ("Compensation", "DesignSettings", "compensate", "published_settings"),
    "findings": ("Conclusions", "conclusions"),
    "flight_schedules": (
        "FlightSchedule",
        "ScheduleAxis",
        "ScheduleCheck",
        "check_schedule",
        "design_schedule",
        "read_knots",
        "second_order_feel",
    ),
    "report.schedule_folder": ("write_schedule",),
    "run_findings": ("run_conclusions",),
    "envelopes": ("Draws", "Envelope", "envelope"),
    "report.envelope_folder": ("write_envelope",),
    "frontier": ("Frontier", "find_frontier"),
    "report.frontier_folder": ("write_frontier",),
    "workflow": ("Analysis", "Design", "analyze", "design"),
    "errors": ("InputError",),
    "figure_data": ("Figure", "figures"),
    "inputs": (
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
    "excitation.bench_file": ("write_excitation",),
    "excitation.excite": ("excite",),
    "excitation.plan": ("ExcitationPlan",),
    "excitation.result": ("Excitation",),
    "bench.data_file": ("read_bench_data",),
    "bench.records": ("BenchRecord",),
    "bench.estimate": ("estimate_response",),
    "bench.experiments": ("Drive", "Experiment", "Loop"),
    "identification.fit": ("identify",),
    "identification.linear": ("model_response",),
    "bench.record_file": ("read_bench_record",),
    "bench.resonance": ("Resonance", "link_from_resonance", "read_resonance"),
    "bench.response_file": ("read_response",),
    "bench.responses": ("Response",),
    "identification.result": ("Estimate", "Identification"),
    "report.identification_folder": ("write_identification",),
    "command_loop": ("CommandLoop", "command_loops"),
    "designs.methods": ("Method", "method", "tuned"),
    "designs.setting_laws": ("own_law",),
    "designs.tuning": ("Power", "Tuning"),
    "envelopes.tune": ("Tuned", "tune"),
    "command_margins": ("LoopMargins", "loop_margins"),
    "sampled_compensator": ("SampledCompensator",),
    "sampled_loop": ("SampledLoops", "sampled_loops"),
    "loader": ("Loader", "digital_elevator", "elevator", "load"),
    "models": (
        "Linkage",
        "compliant_model",
        "design_plant",
        "ideal_feel",
        "overall_open_loop",
        "rigid_model",
        "servo",
        "state_feedback",
    ),
    "report": ("write_report",),
    "qualify": ("Qualification", "QualificationSetup", "qualify_loader"),
    "report.qualification_folder": ("write_qualification",),
    "reproduction": ("reproduce",),
    "report.simulation_folder": ("write_simulation",),
    "run_limits": ("Limits", "limits"),
    "schedule": ("GainSchedule", "schedule_gains"),
    "simulation": ("FeelChange", "Measures", "Run", "RunStatus", "Scenario", "simulate", "simulate_batch"),
    "simulation.linear": ("simulate_linear_batch",),
    "sweep": ("Sweep", "SweepResult", "run_sweep"),
    "sweep.stability": ("stability_batch",),
    "sweep.summary": ("Summary", "summarize"),
    "report.sweep_folder": ("write_sweep",),
    "tolerances": ("Distribution", "Tolerance"),
    "studies": ("Deviation", "DroppedPaths", "drop_paths", "sensitivity"),
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
