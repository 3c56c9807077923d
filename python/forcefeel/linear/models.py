"""The models of the report as python-control state-space objects.

Their matrices are exact Jacobians of the Rust model; nothing here repeats an equation. Signals are named in words with
their SI unit at the end. The feel computer's displacement is a voltage in the original system (``feel_position_v``) and
an angle under state feedback (``feel_position_rad``).
"""

from collections.abc import Sequence
from enum import StrEnum

import control
import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import Compensator
from forcefeel.errors import InputError, expect
from forcefeel.loader.loader import Loader, check_loader

INPUTS = ("pilot_force_n", "test_signal_v")
"""Inputs of the loader models: pilot force F_p, test signal e_T at the amplifier."""

OUTPUTS = (
    "column_angle_rad",
    "feel_position",
    "piston_position_m",
    "load_cell_force_n",
    "potentiometer_v",
    "valve_current_a",
    "actuator_flow_m3_per_s",
)
"""Outputs of the loader models; a model adds the unit to ``feel_position``, ``_v`` or ``_rad``."""

SERVO_OUTPUTS = ("potentiometer_v", "column_angle_rad")
"""Outputs of the servo alone: what its loop feeds back, and what the pilot feels of it."""

DESIGN_STATES = (
    "piston_position_m",
    "load_pressure_pa",
    "feel_position_rad",
    "feel_velocity_rad_per_s",
    "base_position_m",
    "base_velocity_m_per_s",
    "pilot_force_n",
)
"""States of the design plant, eq. (19); the compensator's gains are on these."""

DESIGN_PLANT, DESIGN_FEEL = (
    [DESIGN_STATES.index(name) for name in names]
    for names in (
        ("piston_position_m", "load_pressure_pa", "base_position_m", "base_velocity_m_per_s"),
        ("feel_position_rad", "feel_velocity_rad_per_s"),
    )
)
"""Places of the plant's own states, which do not see the feel, and of the feel computer's among ``DESIGN_STATES``."""

_SERVO_STATES = ("load_pressure_pa", "commanded_flow_m3_per_s", "commanded_flow_rate_m3_per_s2")


class Linkage(StrEnum):
    """How the link between piston and column is modelled.

    Example:
        >>> import forcefeel as ff
        >>> [linkage.value for linkage in ff.linear.Linkage]
        ['rigid', 'compliant']
    """

    RIGID = "rigid"
    COMPLIANT = "compliant"


def rigid_model(loader: Loader, compensator: Compensator | None = None) -> control.StateSpace:
    """Loader with a rigid link, eq. (15): states x_p, x_p', p, q_i, q_i', delta, delta'.

    Args:
        loader: The loader.
        compensator: The law that drives the amplifier; the original position loop, eq. (13), if not given.

    Returns:
        Continuous-time model with inputs ``INPUTS`` and outputs ``OUTPUTS``, SI units.

    Example:
        >>> import forcefeel as ff
        >>> ff.linear.rigid_model(ff.elevator()).nstates
        7
    """
    return loader_model(loader, compensator, Linkage.RIGID)


def compliant_model(loader: Loader, compensator: Compensator | None = None) -> control.StateSpace:
    """Loader with a compliant link, eq. (17): states x_p, p, q_i, q_i', delta, delta', x_b, x_b'.

    Arguments and result are those of ``rigid_model``.

    Example:
        >>> import forcefeel as ff
        >>> model = ff.compliant_model(ff.elevator())
        >>> model.nstates, model.input_labels
        (8, ['pilot_force_n', 'test_signal_v'])
    """
    return loader_model(loader, compensator, Linkage.COMPLIANT)


def loader_model(loader: Loader, compensator: Compensator | None, linkage: Linkage) -> control.StateSpace:
    """``rigid_model`` or ``compliant_model``, as ``linkage`` says."""
    check_loader(loader)
    if compensator is not None:
        expect(
            "compensator", compensator, Compensator, "an analog law, as compensate(loader).compensator(loader) gives it"
        )
    law = compensator or Compensator.original(loader.values)
    unit = law.displacement_unit.lower()
    feel = [f"feel_position_{unit}", f"feel_velocity_{unit}_per_s"]
    if linkage is Linkage.RIGID:
        matrices = _core.rigid(loader.values, law)
        states = ["piston_position_m", "piston_velocity_m_per_s", *_SERVO_STATES, *feel]
    else:
        matrices = _core.compliant(loader.values, law)
        states = ["piston_position_m", *_SERVO_STATES, *feel, "base_position_m", "base_velocity_m_per_s"]
    outputs = [feel[0] if name == "feel_position" else name for name in OUTPUTS]
    return _state_space(f"{loader.name} {linkage}", matrices, states, INPUTS, outputs)


def servo(loader: Loader, linkage: Linkage, *, closed: bool) -> control.StateSpace:
    """The hydraulic servo alone, from the amplifier's input e_T to ``SERVO_OUTPUTS`` (figs. 8, 9).

    Args:
        loader: The loader; its column hangs on the servo, the feel computer is off.
        linkage: Rigid or compliant link.
        closed: With the position loop of eq. (13) closed, or open.

    Example:
        >>> import forcefeel as ff
        >>> ff.linear.servo(ff.elevator(), ff.linear.Linkage.COMPLIANT, closed=True).input_labels
        ['test_signal_v']
    """
    law = Compensator.position_loop(loader.values) if closed else Compensator.none(loader.values)
    model = loader_model(loader, law, linkage)
    kept = [k for k, name in enumerate(model.state_labels) if not name.startswith("feel_")]
    # The deaf feel computer neither moves nor is heard, so leaving its states out is exact.
    matrices = (
        model.A[np.ix_(kept, kept)],
        model.B[np.ix_(kept, [1])],
        model.C[np.ix_([OUTPUTS.index(name) for name in SERVO_OUTPUTS], kept)],
        np.zeros((len(SERVO_OUTPUTS), 1)),
    )
    name = f"{loader.name} servo {linkage} {'closed' if closed else 'open'}"
    return _state_space(name, matrices, [model.state_labels[k] for k in kept], INPUTS[1:], SERVO_OUTPUTS)


def overall_open_loop(loader: Loader, linkage: Linkage, compensator: Compensator | None = None) -> control.StateSpace:
    """The overall loop, opened at the torque that the feel computer sees (fig. 10).

    L from that torque through feel computer, servo and load cell back to it, with the sign for which the closed loop's
    characteristic equation is 1 + L = 0. The torque enters the model in one place, so the closed loop's state matrix is
    ``A - b c``, where ``A`` is the open loop's and ``c`` the row that the load cell adds.

    Args:
        loader: The loader.
        linkage: Rigid or compliant link.
        compensator: The law that drives the amplifier; the original one if not given.

    Example:
        >>> import forcefeel as ff
        >>> ff.linear.overall_open_loop(ff.elevator(), ff.linear.Linkage.RIGID).nstates
        7
    """
    law = compensator or Compensator.original(loader.values)
    closed = loader_model(loader, law, linkage)
    opened = loader_model(loader, Compensator(law.gains, 0.0, law.displacement_unit), linkage)
    entry = [k for k, name in enumerate(closed.state_labels) if name.startswith("feel_velocity")]
    b = np.zeros((closed.nstates, 1))
    b[entry] = 1.0
    c = opened.A[entry, :] - closed.A[entry, :]
    name = f"{loader.name} overall {linkage}"
    signals = ("feel_torque_in",), ("feel_torque_out",)
    return _state_space(name, (opened.A, b, c, np.zeros((1, 1))), opened.state_labels, *signals)


def design_plant(loader: Loader, pilot_arm_m: float | None = None, *, pilot_state: bool = True) -> control.StateSpace:
    """The plant for the design of the compensation, eq. (19): states ``DESIGN_STATES``, input e, output delta - theta.

    Valve dynamics are neglected, the load-cell loop is open and the pilot force F_p is a constant state. No command moves such a
    state, so the plant is not stabilizable and ``control.lqr`` refuses it; recursion (22) over a horizon, ``compensate``, does not.
    Without that state it is, and the six gains are those on the other states.

    Args:
        loader: The loader.
        pilot_arm_m: Torque that the feel computer sees per newton of pilot force. Not given, it is the pilot's lever
            arm R_p: what the load cell reports at rest, eq. (6).
        pilot_state: Whether F_p is a state; without it there are the first six of ``DESIGN_STATES``.

    Raises:
        InputError: If ``loader`` is no loader.

    Example:
        >>> import control, forcefeel as ff
        >>> plant = ff.linear.design_plant(ff.elevator(), pilot_state=False)
        >>> gains, _, poles = control.lqr(plant, 1e4 * plant.C.T @ plant.C, 1.0)
        >>> gains.shape, bool(max(poles.real) < 0)
        ((1, 6), True)
    """
    check_loader(loader)
    arm = loader["column.grip_arm"] if pilot_arm_m is None else pilot_arm_m
    a, b, c, d = _core.design_plant(loader.values, arm)
    states = DESIGN_STATES if pilot_state else DESIGN_STATES[:-1]
    kept = len(states)
    matrices = (a[:kept, :kept], b[:kept], c[:, :kept], d)
    return _state_space(f"{loader.name} design plant", matrices, states, ("amplifier_input_v",), ("error_rad",))


def ideal_feel(loader: Loader) -> control.StateSpace:
    """The programmed feel, eq. (11), driven by the pilot's torque: from pilot force to column angle.

    Example:
        >>> import forcefeel as ff
        >>> ff.linear.ideal_feel(ff.elevator()).output_labels
        ['column_angle_rad']
    """
    check_loader(loader)
    states = ("column_angle_rad", "column_velocity_rad_per_s")
    return _state_space(f"{loader.name} ideal feel", _core.ideal_feel(loader.values), states, INPUTS[:1], OUTPUTS[:1])


def state_feedback(loader: Loader, gains: NDArray[np.float64]) -> Compensator:
    """The compensator e = c x on the six measured states, with the feel computer driven by the column's torque.

    Args:
        loader: The loader.
        gains: Six or seven SI gains on ``DESIGN_STATES``; the seventh, on the pilot force, only where it is measured.

    Raises:
        InputError: If there are not six or seven finite gains.

    Example:
        >>> import forcefeel as ff
        >>> loader = ff.elevator()
        >>> law = ff.linear.state_feedback(loader, ff.compensate(loader).gains)
        >>> law.displacement_unit
        'rad'
    """
    if len(gains) not in {6, 7} or not np.all(np.isfinite(gains)):
        raise InputError(f"gains: expected six or seven finite numbers, got {np.asarray(gains).tolist()}")
    return Compensator.state_feedback(loader.values, (*(float(c) for c in gains), 0.0)[:7])


def _state_space(
    name: str,
    matrices: tuple[NDArray[np.float64], ...],
    states: Sequence[str],
    inputs: Sequence[str],
    outputs: Sequence[str],
) -> control.StateSpace:
    return control.StateSpace(
        *matrices,
        name=name.replace(".", "_"),  # python-control keeps the dot for the signals of a system
        states=list(states),
        inputs=list(inputs),
        outputs=list(outputs),
        remove_useless_states=False,
    )
