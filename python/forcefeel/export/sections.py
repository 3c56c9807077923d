"""Sections of an exported law: what the tracer calls them, their equations, sources, requirements and tests.

The model names the sections where it computes them (``Scalar::section``); the C has a comment at the head of each.
"""

from dataclasses import dataclass, replace

BITS = "The law gives the bits of the simulated controller."
FEEL = "The control has the programmed feel: control feel tests of 14 CFR Part 60, judged by forcefeel qualify."
STABLE = "The drive follows the feel with the parts off by their tolerances: forcefeel envelope."
LIMIT = "The command stays within converter and amplifier."
INPUT = "An input that is no number or out of its range gives the command 0 and leaves the state."
CALLS = "Without initialization, and in settings that do not exist, the command is 0 and the drive has no power."
START = "The law starts in the equilibrium of its sensors."

VECTORS = "{name}_test.c: release, sweep, random input from beyond either stop"
FLIGHTS = "{name}_test.c: random flights"
STATUSES = "tests/export/test_c_safety.py"
SAFE = "The loader is held within its limits, and stopped where a function of the table acts: docs/how-to/safety.md."

STATES = "{name}_test.c: on, sweep, faults of sensors and loop, acknowledgment, emergency stop"
PAIRS = "{name}_test.c: opposed hands, priority button, disconnect"


@dataclass(frozen=True)
class Section:
    """A section of a period.

    Attributes:
        title: Its result.
        equation: What it computes, in the symbols of its source.
        source: File of the model that derives the equation; those that ask for its operations follow from the trace.
        requirement: What it is for.
        test: Golden test that runs it.
        rows: Rows of the loader file whose numbers do not pass as such: constants of time and points of curves.
        rare: Statements that golden vectors may miss, and why.
    """

    title: str
    equation: str
    source: str
    requirement: str
    test: str = VECTORS
    rows: tuple[str, ...] = ()
    rare: str = ""


SECTIONS = {
    "inputs": Section("Inputs", "y of this sample", "control.rs", BITS),
    "tuning": Section(
        "Coefficients of the feel from the rows that are tuned",
        "torque mu R_p F, slope F / phi, friction mu R_p F / I",
        "feel.rs",
        FEEL,
    ),
    "sampling": Section(
        "Sampled sensors",
        "y = [F_c, x_p, theta, F_g]; b' = (b - b_last) / T",
        "control.rs",
        BITS,
        rows=("controller.period", "controller.input_bits"),
    ),
    "cancellation": Section(
        "Current against cogging and friction of the motor",
        "e_c = T_c / K_t delta' / sqrt(delta'^2 + w_s^2) - sum of T_k / K_t sin(N_k (x + v t) / r + phi_k)",
        "cancellation.rs",
        STABLE,
        rows=("motor.cogging_torque",),
    ),
    "observer": Section(
        "Command and torque of the law",
        "e = c [xi; y; delta; delta'], T_o = t [xi; y; delta; delta']",
        "observer.rs",
        STABLE,
    ),
    "friction": Section(
        "Torque of the hand without the column's dry friction",
        "w = v / sqrt(v^2 + v_s^2), f = (F + g) w; T+ = T', within T_o - f + (F + g) [s-, s+] + U [-1, 1]",
        "known_friction.rs",
        STABLE,
    ),
    "neutral": Section("Command and torque at the trimmed neutral", "e + c_n n, T + t_n n", "observer.rs", FEEL),
    "contact": Section(
        "Command and torque against something stiff",
        "e = e_o + m (e_c - e_o), T = T_o + m (T_c - T_o), delta'+ = delta' / (1 + m B_c h / I)",
        "contact_law.rs",
        STABLE,
        rare="A push that goes slowly from one side to the other and is soft: of some laws with known friction.",
    ),
    "limits": Section("Command within its limits", "|e| <= e_max", "controller.rs", LIMIT),
    "observer_state": Section("Observer at the next sample", "xi+ = A xi + B [y; e] + b f", "observer.rs", STABLE),
    "trim": Section(
        "Neutral, moved to the trim", "|n'| <= n'_max", "feel.rs", FEEL, rows=("feel.trim_rate", "controller.period")
    ),
    "feel": Section(
        "Programmed feel over a period, one Runge-Kutta step of order 4",
        "I delta'' + B delta' + mu b_2 phi' |phi'| + S + mu R_p (F_preload + parts) + stops + friction = T + mu T_s "
        "(report, eqs. 11-12)",
        "feel.rs",
        FEEL,
        rows=("controller.period", "force_curve"),
        rare="A soft stop that the feel leaves within a step.",
    ),
    "feel_friction": Section(
        "Dry friction of the feel",
        "v = 0 while |a| <= f_s; else |a_f| = f (1 + s a_F)",
        "dry_friction.rs",
        FEEL,
        rare="No friction between two settings that have friction: only rounding could make it.",
    ),
    "feel_stops": Section(
        "Hard stops, velocity limit and soft stops of the feel",
        "low <= delta <= high, |delta'| <= v_max; k d + c d' beyond a soft stop",
        "feel.rs",
        FEEL,
        rare="A touch of a soft stop in the very step in which the velocity turns.",
    ),
    "give_way": Section(
        "Feel gives way where the drive is at its limit",
        "delta' = ... - 2 a_w x, delta'' = ... - a_w^2 x, x = (e - e_cut) / c_3",
        "control.rs",
        STABLE,
        rare="A command that does not depend on delta: of no law, but perhaps between two.",
    ),
    "conversion": Section(
        "Command as the converter gives it",
        "e = q round(e / q)",
        "controller.rs",
        LIMIT,
        rows=("controller.output_bits",),
    ),
    "surface": Section(
        "Hinge moment and bobweight in a flight",
        "T = s_h k eta_h q S_h c_h (C_0 + C_alpha alpha_s + C_delta delta + C_tau tau + C_rate delta' c_h / 2 V)",
        "surface.rs",
        FEEL,
        FLIGHTS,
        rare="A segment beyond the last angle or Mach number of a table, which is at infinity.",
    ),
    "rest": Section("Start at rest", "xi = R [y; delta]", "observer.rs", START),
    "link": Section(
        "Electronic link",
        "T = S(phi) + c phi', S = k (phi - clamp(phi, -p/2, p/2)) up to M_b",
        "link.rs",
        FEEL,
        PAIRS,
    ),
    "modifiers": Section(
        "Trim, factor on the spring and stick shaker, led to the requested values",
        "x+ = x + sat(w - x) within r T; swing = a sin(2 pi turns)",
        "modifiers.rs",
        FEEL,
        STATES,
        rows=("feel.trim_rate", "feel.shaker_frequency", "controller.period"),
    ),
    "plausibility": Section(
        "Observer of drive, link and column: readings as sampled, or as predicted",
        "J v' = alpha R_b F + tau; u' = a e - b F - d u, x' = u - g F; F = k (s -+ b) + c s' + F_b",
        "supervisor/plausibility.rs",
        SAFE,
        STATES,
        rows=("safety.bridge_time", "safety.silence_time", "safety.delay_tolerance"),
    ),
    "safety": Section(
        "Safety functions that need no sensor",
        "emergency stop, drive fault, late cycles, numbers, readings that are bridged for too long",
        "supervisor.rs",
        SAFE,
        STATES,
        rows=("safety.overrun_time", "safety.bridge_time"),
    ),
    "sensors": Section(
        "Sensors: silent, late, no number, out of range, stuck, in disagreement",
        "r = s + (c / k) s' - F / k, |r| <= b + d_theta alpha R_b",
        "supervisor/sensors.rs",
        SAFE,
        STATES,
        rows=("safety.stuck_time", "safety.agreement_time", "safety.silence_time"),
    ),
    "grip": Section(
        "Force, speed, travel and energy at the grip, runaway, swing",
        "tau = w_o (J v - int (alpha R_b F + tau) dt); P = (alpha R_b F - f) v; E' = P_g - max(0, -tau v_f) - E / 1 s",
        "supervisor/grip.rs",
        SAFE,
        STATES,
        rows=("safety.force_time", "safety.runaway_time"),
    ),
    "grip_zero": Section(
        "Zero of the force sensor at the grip",
        "F_0 goes to the mean of F_g while no hand is on the grip",
        "supervisor/grip_zero.rs",
        SAFE,
        STATES,
        rows=("safety.grip_zero_time",),
    ),
    "grip_reading": Section(
        "Force sensor at the grip against the hand's estimated torque",
        "|F_g - F_0| within the noise: |tau - tau_0| <= tau_max + delta |D - D_0|",
        "supervisor/grip_reading.rs",
        SAFE,
        STATES,
        rows=("safety.stuck_time", "grip_sensor.noise", "grip_sensor.resolution", "safety.hand_force"),
    ),
    "sequence": Section(
        "State: off, initializing, passive, active, fading, tripped; power of the drive; search of the travel",
        "off -> initializing -> passive <-> fading <-> active; any -> tripped -> off",
        "supervisor/sequence.rs",
        SAFE,
        STATES,
        rows=("safety.stuck_time", "safety.power_time", "safety.travel_search"),
    ),
    "command": Section(
        "Command within its limits, or led to zero",
        "|e| <= (s_0 + (1 - s_0) s) e_max, |e - e_last| <= e'_max T",
        "supervisor/command.rs",
        SAFE,
        STATES,
        rows=("safety.saturation_time",),
    ),
    "outputs": Section(
        "Programmed angle and rate; functions as bits", "theta = delta / (delta per angle)", "axis.rs", BITS, STATES
    ),
    "result": Section("Outputs and feel, if all are numbers", "-", "control.rs", BITS),
    "numbers": Section("Operations on numbers", "smaller, larger, within, with_sign, nearest, bits", "scalar.rs", BITS),
    "status": Section("Order of calls, range checks, status", "-", "law_inputs.rs", INPUT, STATUSES),
}

SUPERVISED = {
    key: replace(section, test=STATES) if section.test == VECTORS else section for key, section in SECTIONS.items()
} | {
    "inputs": Section(
        "Inputs and state",
        "sensors, requests and counts of this sample; law, feel and supervisor",
        "axis.rs",
        BITS,
        STATES,
    ),
    "rest": Section(
        "Law that has seen these sensors for long",
        "(1 - A) xi = B [y; 0]",
        "supervised_law.rs",
        START,
        STATES,
    ),
    "result": Section("Outputs", "-", "axis.rs", BITS, STATES),
    "off": Section("State of an axis that is off", "-", "axis.rs", SAFE, STATES),
    "status": Section("Order of calls, settings that exist, status", "-", "axis.rs", CALLS, STATES),
}
"""Those of a supervised law: it keeps its state whatever the numbers are, and starts by itself."""
