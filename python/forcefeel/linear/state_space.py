"""The models of the report as python-control state-space objects, for analysis and design with that library.

What forcefeel itself computes with are the same matrices without it, ``models``: python-control takes longer to import than
``forcefeel analyze`` to answer.
"""

import control

from forcefeel._core import GainLaw
from forcefeel.linear.models import (
    LinearModel,
    Linkage,
    design_model,
    feel_model,
    loader_model,
    open_loop_model,
    plant_model,
    servo_model,
)
from forcefeel.loader.loader import Loader


def rigid_model(loader: Loader, law: GainLaw | None = None) -> control.StateSpace:
    """Loader with a rigid link, eq. (15): states x_p, x_p', p, q_i, q_i', delta, delta'.

    Args:
        loader: The loader.
        law: The law that drives the amplifier; the original position loop, eq. (13), if not given. A motor has none here.

    Returns:
        Continuous-time model with inputs ``INPUTS`` and outputs ``OUTPUTS``, SI units; of a motor as ``compliant_model`` says.

    Raises:
        InputError: If a law is given for a motor.

    Example:
        >>> ff.linear.rigid_model(ff.elevator()).nstates
        7
    """
    return _state_space(loader_model(loader, law, Linkage.RIGID))


def compliant_model(loader: Loader, law: GainLaw | None = None) -> control.StateSpace:
    """Loader with a compliant link, eq. (17): states x_p, p, q_i, q_i', delta, delta', x_b, x_b'.

    Arguments and result are those of ``rigid_model``. Of a motor the feel by current alone: spring and damper of the programmed
    feel by the motor's torque, ``e = -(r / K_t) (G x_m + B x_m') / (alpha R_b)^2``; states x_m, x_m', i, x_b, x_b', with a rigid
    link the first three; inputs pilot force and a test signal in A added to the command of the current.

    Example:
        >>> model = ff.compliant_model(ff.elevator())
        >>> model.nstates, model.input_labels
        (8, ['pilot_force_n', 'test_signal_v'])
    """
    return _state_space(loader_model(loader, law, Linkage.COMPLIANT))


def plant(loader: Loader, linkage: Linkage = Linkage.COMPLIANT) -> control.StateSpace:
    """What moves the column, and the column: servo or motor, transmission and link, without a feel and without a law.

    Args:
        loader: The loader, of either drive.
        linkage: Rigid or compliant link.

    Returns:
        Continuous-time model, SI units. Of a valve: states x_p, p, q_i, q_i', x_b, x_b', inputs pilot force and amplifier input in
        V. Of a
        motor: states x_m, x_m', i, x_b, x_b' (with a rigid link the first three), inputs pilot force and command of the current in
        A, outputs column angle, drive position, load cell force, current, voltage and speed of the motor. Limits, friction,
        cogging, back-EMF against a voltage limit: left out, as nothing of them is linear.

    Example:
        >>> stick = ff.linear.plant(ff.loader.electric("sidestick-roll"))
        >>> stick.nstates, stick.input_labels
        (5, ['pilot_force_n', 'current_command_a'])
    """
    return _state_space(plant_model(loader, linkage))


def servo(loader: Loader, linkage: Linkage, *, closed: bool) -> control.StateSpace:
    """The hydraulic servo alone, from the amplifier's input e_T to ``SERVO_OUTPUTS`` (figs. 8, 9).

    Args:
        loader: The loader; its column hangs on the servo, the feel computer is off.
        linkage: Rigid or compliant link.
        closed: With the position loop of eq. (13) closed, or open.

    Example:
        >>> ff.linear.servo(ff.elevator(), ff.linear.Linkage.COMPLIANT, closed=True).input_labels
        ['test_signal_v']
    """
    return _state_space(servo_model(loader, linkage, closed=closed))


def overall_open_loop(loader: Loader, linkage: Linkage, law: GainLaw | None = None) -> control.StateSpace:
    """The overall loop, opened at the torque that the feel computer sees (fig. 10).

    L from that torque through feel computer, servo and load cell back to it, with the sign for which the closed loop's
    characteristic equation is 1 + L = 0.

    Args:
        loader: The loader.
        linkage: Rigid or compliant link.
        law: The law that drives the amplifier; the original one if not given.

    Example:
        >>> ff.linear.overall_open_loop(ff.elevator(), ff.linear.Linkage.RIGID).nstates
        7
    """
    return _state_space(open_loop_model(loader, linkage, law))


def design_plant(loader: Loader, pilot_arm_m: float | None = None, *, pilot_state: bool = True) -> control.StateSpace:
    """The plant for the design of the compensation, eq. (19): states ``DESIGN_STATES``, input e, output delta - theta.

    Valve dynamics are neglected, the load-cell loop is open and the pilot force F_p is a constant state. No command moves such a
    state, so the plant is not stabilizable and ``control.lqr`` refuses it; recursion (22), ``design_gains``, does not.
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
    return _state_space(design_model(loader, pilot_arm_m, pilot_state=pilot_state))


def ideal_feel(loader: Loader) -> control.StateSpace:
    """The programmed feel, eq. (11), driven by the pilot's torque: from pilot force to column angle.

    Example:
        >>> ff.linear.ideal_feel(ff.elevator()).output_labels
        ['column_angle_rad']
    """
    return _state_space(feel_model(loader))


def _state_space(model: LinearModel) -> control.StateSpace:
    return control.StateSpace(
        model.A,
        model.B,
        model.C,
        model.D,
        name=model.name,
        states=list(model.state_labels),
        inputs=list(model.input_labels),
        outputs=list(model.output_labels),
        remove_useless_states=False,
    )
