"""Frequency responses of the linear model and their slopes with respect to parameters.

``G = C (s 1 - A)^-1 B + D`` and, with ``'`` for the slope by a parameter,

``G' = C' X + W (A' X + B') + D'``,   ``X = (s 1 - A)^-1 B``,   ``W = C (s 1 - A)^-1``,

``s = j w`` for an analog loader. Under a digital controller A is the matrix of a period and ``s`` becomes ``z = exp(j w T)``: from
the sampled command signal, or a force that stays through the period, to the channels at the samples. A test signal at the amplifier
runs on between the samples. Held through each of the n steps h of a period it leads to the next state by columns ``b_j``, so that
``B = sum b_j exp(j w (j + 1/2) h) / sinc(w h / 2)``: the quotient makes the staircase's part at w that of the sine; what else is in
it is beyond 1 / h less w, where valve and column let nothing through. All matrices are exact derivatives of the Rust model by dual
numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.bench.channels import inputs, outputs
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.errors import InputError
from forcefeel.laws.law import ORIGINAL, ROBUST, Law, LawLike
from forcefeel.linear.models import Linkage
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, INDEX
from forcefeel.loader.timing import controller_steps
from forcefeel.simulation.scenario import LONGEST_STEP_S

_LAWS = {Loop.SERVO_OPEN: "open", Loop.MOTOR_OPEN: "open", Loop.SERVO_CLOSED: "position", Loop.LOADER: "original"}
_TEST, _FORCE, _COMMAND = _INPUTS = range(3)
"""Positions of the inputs: the signal at the amplifier, the force at the grip, the signal on the command."""


@dataclass(frozen=True, eq=False)
class ChannelResponses:
    """Responses from every input to every channel, SI units.

    Attributes:
        kind: Drive of the loader, hydraulic or electric.
        frequency_hz: Lines, (lines,).
        value: (channels, inputs, lines), in the order of ``channels.outputs`` and ``channels.inputs`` of that drive.
        slopes: Derivatives by each parameter, (keys, channels, inputs, lines).
    """

    kind: str
    frequency_hz: NDArray[np.float64]
    value: NDArray[np.complex128]
    slopes: NDArray[np.complex128]

    def between(self, source: str, target: str, drive: Drive) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Response and slopes from channel to channel while ``drive`` moves the loader.

        From the drive itself it is the model's; from another channel the quotient ``G = G_target / G_source``, whose slope is
        ``G (G_target' / G_target - G_source' / G_source)``.
        """
        driven, outputs_of_kind = list(inputs(self.kind)), list(outputs(self.kind))
        i = driven.index(Drive.PILOT_FORCE if drive is Drive.RELEASE else drive)
        k = outputs_of_kind.index(target)
        value, slopes = self.value[k, i], self.slopes[:, k, i]
        if source == driven[i]:
            return value, slopes
        j = outputs_of_kind.index(source)
        ratio = value / self.value[j, i]
        return ratio, (slopes - ratio * self.slopes[:, j, i]) / self.value[j, i]


@dataclass(frozen=True)
class LinearModel:
    """The linear model of a loader in one loop.

    Attributes:
        loader: The loader, about its rest at neutral, without friction, stops and resolution, which have no slope there.
        loop: Which loop is closed.
        law: The law of the whole loader.
        linkage: Rigid, eq. (15), or compliant, eq. (17).

    Raises:
        InputError: When built, if a rigid link is requested under a digital controller.
    """

    loader: Loader
    loop: Loop
    law: LawLike = None
    linkage: Linkage = Linkage.COMPLIANT

    def __post_init__(self) -> None:
        if self.loader["controller.period"] and self.linkage is Linkage.RIGID:
            raise InputError("linkage: there is no rigid model of a loader under a digital controller; make it analog")

    @cached_property
    def _engine_law(self) -> dict[str, Any]:
        """The law in the engine's form, designed or read once."""
        return loop_law(self.loader, self.loop, self.law)

    def responses(
        self, values: NDArray[np.float64], keys: Sequence[str], frequency_hz: NDArray[np.float64]
    ) -> ChannelResponses:
        """Responses of the loader with these SI values, in the order of the table, and their derivatives by ``keys``.

        Raises:
            InputError: If a line is at or above half the rate of the loader's controller.
        """
        columns = [INDEX[key] for key in keys]
        engine_law = self._engine_law
        omega = 2 * np.pi * frequency_hz
        if period := self.loader["controller.period"]:
            _below_half_rate(frequency_hz, period)
            step_s, timing = controller_steps(self.loader, LONGEST_STEP_S)
            matrices = _core.sampled_slopes(values, columns, step_s, timing, **engine_law)
            response = _responses(_over_a_period(matrices, omega * step_s), np.asarray(np.exp(1j * omega * period)))
        else:
            matrices = _core.linear_slopes(values, columns, linkage=self.linkage.value, **engine_law)
            response = _responses(_continuous(matrices), np.asarray(1j * omega))
        return ChannelResponses(self.loader.drive, frequency_hz, *response)


def channel_responses(
    loader: Loader, loop: Loop, keys: Sequence[str], frequency_hz: NDArray[np.float64], law: LawLike = None
) -> ChannelResponses:
    """Responses of a loader with a compliant link and their derivatives by the parameters ``keys``, as ``LinearModel``."""
    return LinearModel(loader, loop, law).responses(loader.si_values, keys, np.asarray(frequency_hz, dtype=np.float64))


def model_response(
    loader: Loader,
    experiment: Experiment,
    source: str,
    target: str,
    frequency_hz: NDArray[np.float64],
    *,
    law: LawLike = None,
) -> NDArray[np.complex128]:
    """The response of the linear model from one channel to another, SI units, (lines,).

    Example:
        >>> experiment = ff.bench.Experiment.read("servo-closed")
        >>> value = ff.bench.model_response(ff.elevator(), experiment, "test_signal", "column_angle", np.array([1.0, 10.0]))
        >>> value.shape
        (2,)
    """
    responses = channel_responses(loader, experiment.loop, (), frequency_hz, law=law)
    return responses.between(source, target, experiment.drive)[0]


def bench_law(law: LawLike, loader: Loader) -> LawLike:
    """``law``, or if it is ``None`` the law under which a whole loader is recorded: ``original``, of a motor ``robust``."""
    if law is not None:
        return law
    return ROBUST if loader.drive == ELECTRIC else ORIGINAL


def loop_law(loader: Loader, loop: Loop, law: LawLike) -> dict[str, Any]:
    """The law of a loop as keywords of the engine.

    Raises:
        InputError: If it was made for another controller.
    """
    if loop is Loop.MOTOR_OPEN:
        return {"law": _LAWS[loop]}
    whole = Law.of(bench_law(law, loader), loader)
    return {"law": _LAWS[loop]} if loop is not Loop.LOADER or whole.numbers.kind == ORIGINAL else whole.engine(loader)


def _below_half_rate(frequency_hz: NDArray[np.float64], period: float) -> None:
    highest = float(np.max(frequency_hz))
    if highest * period >= 0.5:
        raise InputError(
            f"frequency: expected lines below half the controller's rate, {0.5 / period:.6g} Hz, got {highest:.6g} Hz; leave the "
            "higher lines out"
        )


Matrices = Sequence[NDArray[np.float64] | NDArray[np.complex128]]
"""A, B, C, D and their slopes; the columns of B and D in the order of ``channels.inputs``, B (lines or 1, states, inputs)."""


def _continuous(matrices: Sequence[NDArray[np.float64]]) -> Matrices:
    """Matrices of an analog loader, whose command signal enters with the test signal."""
    a, b, c, d, a_slopes, b_slopes, c_slopes, d_slopes = matrices
    order = [{_TEST: 0, _FORCE: 1, _COMMAND: 0}[name] for name in _INPUTS]
    return (
        *(a, b[np.newaxis, :, order], c, d[:, order]),
        *(a_slopes, b_slopes[:, np.newaxis][..., order], c_slopes, d_slopes[..., order]),
    )


def _over_a_period(matrices: Sequence[NDArray[np.float64]], turned: NDArray[np.float64]) -> Matrices:
    """Matrices of a sampled loader at lines of phase w h per step, with the columns of the test signal's steps combined."""
    a, b, c, d, a_slopes, b_slopes, c_slopes, d_slopes = matrices
    command, force, steps = 0, 1, 2
    middle = np.arange(b.shape[-1] - steps) + 0.5
    sine = np.exp(1j * np.outer(turned, middle)) / np.sinc(turned / (2 * np.pi))[:, np.newaxis]

    def inputs(b: NDArray[np.float64]) -> NDArray[np.complex128]:
        test = np.moveaxis(b[..., steps:] @ sine.T, -1, -2)
        rows = {
            _TEST: test,
            _FORCE: b[..., np.newaxis, :, force],
            _COMMAND: b[..., np.newaxis, :, command],
        }
        return np.stack(np.broadcast_arrays(*(rows[name] for name in _INPUTS)), axis=-1)

    order = [{_TEST: steps, _FORCE: force, _COMMAND: command}[name] for name in _INPUTS]
    return a, inputs(b), c, d[:, order], a_slopes, inputs(b_slopes), c_slopes, d_slopes[..., order]


def _responses(matrices: Matrices, at: NDArray[np.complex128]) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """``G`` (outputs, inputs, lines) and its slopes (keys, outputs, inputs, lines) at each ``s`` or ``z``."""
    a, b, c, d, a_slopes, b_slopes, c_slopes, d_slopes = matrices
    resolvent = at[:, np.newaxis, np.newaxis] * np.eye(len(a)) - a
    x = np.linalg.solve(resolvent, np.broadcast_to(b, (len(at), *b.shape[1:])).astype(complex))
    w = np.linalg.solve(resolvent.transpose(0, 2, 1), np.broadcast_to(c.T, (len(at), *c.T.shape)).astype(complex))
    value = c @ x + d
    by = a_slopes[:, np.newaxis] @ x + b_slopes
    slopes = c_slopes[:, np.newaxis] @ x + w.transpose(0, 2, 1) @ by + d_slopes[:, np.newaxis]
    return np.asarray(value.transpose(1, 2, 0)), np.asarray(slopes.transpose(0, 2, 3, 1))
