"""The models of the report, and a motor's beside them, as matrices; ``state_space`` has them as python-control's objects.

Their matrices are exact Jacobians of the Rust model; nothing here repeats an equation. Signals are named in words with
their SI unit at the end. The feel computer's displacement is a voltage in the original system (``feel_position_v``) and
an angle under state feedback (``feel_position_rad``). What a valve does without a law is the original position loop, eq. (13);
what a motor does is the feel by current alone, ``electric``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError, expect
from forcefeel.linear import electric
from forcefeel.linear.electric import ElectricPlant
from forcefeel.loader.loader import Loader, check_hydraulic, check_loader
from forcefeel.loader.parameters import ELECTRIC

INPUTS = ("pilot_force_n", "test_signal_v")
"""Inputs of the loader models: pilot force F_p, test signal e_T at the amplifier."""

MOTOR_INPUTS = ("pilot_force_n", "test_signal_a")
"""Of a motor: the test signal is added to the command of its current."""

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
    """How the link between piston and column is modeled."""

    RIGID = "rigid"
    COMPLIANT = "compliant"


@runtime_checkable
class StateSpaceLike(Protocol):
    """Interface of a linear model. A ``control.StateSpace`` has it, and so has a ``LinearModel``."""

    @property
    def A(self) -> NDArray[np.float64]:  # noqa: N802  python-control's name
        """State matrix."""

    @property
    def B(self) -> NDArray[np.float64]:  # noqa: N802
        """By which the inputs drive the states."""

    @property
    def C(self) -> NDArray[np.float64]:  # noqa: N802
        """What the outputs take from the states."""

    @property
    def D(self) -> NDArray[np.float64]:  # noqa: N802
        """And from the inputs."""

    @property
    def dt(self) -> float | bool | None:
        """Sample period; nothing in continuous time."""

    @property
    def name(self) -> str:
        """What it is a model of."""

    @property
    def output_labels(self) -> Sequence[str]:
        """Names of the outputs."""


@dataclass(frozen=True, eq=False)
class LinearModel:
    """``x' = A x + B u``, ``y = C x + D u``, under the names that python-control has for them.

    Attributes:
        name: What it is a model of.
        A: State matrix, and so on.
        state_labels: Names of the states, of inputs and of outputs.
        dt: Zero: time is continuous.
    """

    name: str
    A: NDArray[np.float64]
    B: NDArray[np.float64]
    C: NDArray[np.float64]
    D: NDArray[np.float64]
    state_labels: Sequence[str]
    input_labels: Sequence[str]
    output_labels: Sequence[str]
    dt: ClassVar[float] = 0.0

    def to_output(self, output: int) -> "LinearModel":
        """The model with one of its outputs alone."""
        only = slice(output, output + 1)
        return replace(self, C=self.C[only], D=self.D[only], output_labels=self.output_labels[only])


def check_model(name: str, model: StateSpaceLike, *, single: bool = False) -> None:
    """Refuses what is no linear model in continuous time; with ``single``, one of more than one input and one output too.

    Raises:
        InputError: If so.
    """
    expect(name, model, StateSpaceLike, "a control.StateSpace, such as compliant_model(loader)")
    if model.dt:
        raise InputError(f"{name}: expected a model in continuous time, got one with a sample period (dt = {model.dt})")
    outputs, inputs = np.shape(model.D)
    if single and (outputs, inputs) != (1, 1):
        raise InputError(
            f"{name}: expected one input and one output, got {inputs} and {outputs}; take one of each, as in model[0, 0]"
        )


def loader_model(loader: Loader, law: GainLaw | None, linkage: Linkage) -> LinearModel:
    """Eq. (15) or (17), as ``linkage`` says, under the original law, eq. (13), if none is given; a motor's feel by current alone.

    Raises:
        InputError: If there is an analog law for a motor.
    """
    check_loader(loader)
    if law is not None:
        expect("law", law, GainLaw, "an analog law, as design_gains(loader).law(loader) gives it")
        check_hydraulic(loader, "an analog law", _NO_ANALOG_LAW)
    if loader.drive == ELECTRIC:
        return _motor_model(loader, linkage)
    law = law or GainLaw.original(loader.si_values)
    unit = law.displacement_unit.lower()
    feel = [f"feel_position_{unit}", f"feel_velocity_{unit}_per_s"]
    if linkage is Linkage.RIGID:
        matrices = _core.rigid(loader.si_values, law)
        states = ["piston_position_m", "piston_velocity_m_per_s", *_SERVO_STATES, *feel]
    else:
        matrices = _core.compliant(loader.si_values, law)
        states = ["piston_position_m", *_SERVO_STATES, *feel, "base_position_m", "base_velocity_m_per_s"]
    outputs = [feel[0] if name == "feel_position" else name for name in OUTPUTS]
    return _model(f"{loader.name} {linkage}", matrices, states, INPUTS, outputs)


_NO_ANALOG_LAW = "its laws are sampled, such as Law.of('robust', loader), and sampled_loops has their loops"
_PLANT_INSTEAD = "linear.plant has what moves its column"


def _motor_model(loader: Loader, linkage: Linkage) -> LinearModel:
    """The feel by current alone."""
    plant = ElectricPlant.of(loader, rigid=linkage is Linkage.RIGID)
    row = plant.feel_by_current(loader)
    entry, direct = plant.b[:, 1], plant.d[:, 1]
    matrices = plant.a - np.outer(entry, row), plant.b, plant.c - np.outer(direct, row), plant.d
    return _model(f"{loader.name} {linkage}", matrices, plant.states, MOTOR_INPUTS, electric.OUTPUTS)


def plant_model(loader: Loader, linkage: Linkage) -> LinearModel:
    """Servo or motor, link and column, without a feel and without a law."""
    check_loader(loader)
    name = f"{loader.name} plant {linkage}"
    if loader.drive == ELECTRIC:
        plant = ElectricPlant.of(loader, rigid=linkage is Linkage.RIGID)
        matrices = plant.a, plant.b, plant.c, plant.d
        return _model(name, matrices, plant.states, ("pilot_force_n", "current_command_a"), electric.OUTPUTS)
    model = loader_model(loader, GainLaw.none(loader.si_values), linkage)
    # Without input the feel computer neither moves nor acts, so leaving its states out is exact.
    states, outputs = (
        [k for k, label in enumerate(labels) if not label.startswith("feel_")]
        for labels in (model.state_labels, model.output_labels)
    )
    matrices = model.A[np.ix_(states, states)], model.B[states], model.C[np.ix_(outputs, states)], model.D[outputs]
    return _model(name, matrices, [model.state_labels[k] for k in states], INPUTS, [OUTPUTS[k] for k in outputs])


def servo_model(loader: Loader, linkage: Linkage, *, closed: bool) -> LinearModel:
    """The servo alone, from the amplifier's input e_T, its position loop closed or open."""
    check_hydraulic(loader, "the servo", _PLANT_INSTEAD)
    law = GainLaw.position_loop(loader.si_values) if closed else GainLaw.none(loader.si_values)
    model = loader_model(loader, law, linkage)
    kept = [k for k, name in enumerate(model.state_labels) if not name.startswith("feel_")]
    # Without input the feel computer neither moves nor acts, so leaving its states out is exact.
    matrices = (
        model.A[np.ix_(kept, kept)],
        model.B[np.ix_(kept, [1])],
        model.C[np.ix_([OUTPUTS.index(name) for name in SERVO_OUTPUTS], kept)],
        np.zeros((len(SERVO_OUTPUTS), 1)),
    )
    name = f"{loader.name} servo {linkage} {'closed' if closed else 'open'}"
    return _model(name, matrices, [model.state_labels[k] for k in kept], INPUTS[1:], SERVO_OUTPUTS)


def open_loop_model(loader: Loader, linkage: Linkage, law: GainLaw | None = None) -> LinearModel:
    """The overall loop, opened at the torque that the feel computer sees; of a motor, at the command of its current.

    The torque enters the model in one place, so the closed loop's state matrix is ``A - b c``, where ``A`` is the open
    loop's and ``c`` the row that the load cell adds, or that makes the command.
    """
    check_loader(loader)
    if loader.drive == ELECTRIC:
        return _motor_loop(loader, linkage)
    law = law or GainLaw.original(loader.si_values)
    closed = loader_model(loader, law, linkage)
    opened = loader_model(loader, GainLaw(law.gains, 0.0, law.displacement_unit), linkage)
    entry = [k for k, name in enumerate(closed.state_labels) if name.startswith("feel_velocity")]
    b = np.zeros((len(closed.A), 1))
    b[entry] = 1.0
    c = opened.A[entry, :] - closed.A[entry, :]
    name = f"{loader.name} overall {linkage}"
    signals = ("feel_torque_in",), ("feel_torque_out",)
    return _model(name, (opened.A, b, c, np.zeros((1, 1))), opened.state_labels, *signals)


def _motor_loop(loader: Loader, linkage: Linkage) -> LinearModel:
    plant = ElectricPlant.of(loader, rigid=linkage is Linkage.RIGID)
    matrices = plant.a, plant.b[:, 1:], plant.feel_by_current(loader)[np.newaxis], np.zeros((1, 1))
    signals = ("current_command_in",), ("current_command_out",)
    return _model(f"{loader.name} overall {linkage}", matrices, plant.states, *signals)


def design_model(loader: Loader, pilot_arm_m: float | None = None, *, pilot_state: bool = True) -> LinearModel:
    """The plant of eq. (19), with the pilot's force as a state or without; the arm is R_p if not given."""
    check_hydraulic(loader, "the design plant of eq. (19)", _PLANT_INSTEAD)
    arm = loader["column.grip_arm"] if pilot_arm_m is None else pilot_arm_m
    a, b, c, d = _core.design_plant(loader.si_values, arm)
    states = DESIGN_STATES if pilot_state else DESIGN_STATES[:-1]
    kept = len(states)
    matrices = (a[:kept, :kept], b[:kept], c[:, :kept], d)
    return _model(f"{loader.name} design plant", matrices, states, ("amplifier_input_v",), ("error_rad",))


def feel_model(loader: Loader) -> LinearModel:
    """The programmed feel, eq. (11), from pilot force to column angle."""
    check_loader(loader)
    states = ("column_angle_rad", "column_velocity_rad_per_s")
    return _model(f"{loader.name} ideal feel", _core.ideal_feel(loader.si_values), states, INPUTS[:1], OUTPUTS[:1])


def state_feedback(loader: Loader, gains: NDArray[np.float64]) -> GainLaw:
    """The compensator e = c x on the six measured states, with the feel computer driven by the column's torque.

    Args:
        loader: The loader.
        gains: Six or seven SI gains on ``DESIGN_STATES``; the seventh, on the pilot force, only where it is measured.

    Raises:
        InputError: If there are not six or seven finite gains, or the loader has a motor.

    Example:
        >>> loader = ff.elevator()
        >>> law = ff.linear.state_feedback(loader, ff.design_gains(loader).gains)
        >>> law.displacement_unit
        'rad'
    """
    check_hydraulic(loader, "state feedback by gains", _NO_ANALOG_LAW)
    if len(gains) not in {6, 7} or not np.all(np.isfinite(gains)):
        raise InputError(f"gains: expected six or seven finite numbers, got {np.asarray(gains).tolist()}")
    return GainLaw.state_feedback(loader.si_values, (*(float(c) for c in gains), 0.0)[:7])


def _model(
    name: str,
    matrices: tuple[NDArray[np.float64], ...],
    states: Sequence[str],
    inputs: Sequence[str],
    outputs: Sequence[str],
) -> LinearModel:
    a, b, c, d = matrices
    # python-control keeps the dot for the signals of a system
    return LinearModel(name.replace(".", "_"), a, b, c, d, states, inputs, outputs)
