"""Exact steps of machines that are linear but for switches: a column that sticks and slips, an amplifier with a limit.

A machine is in one of nine modes, three of the column (back, stuck, forth) by three of the amplifier (limit, line, limit). In
each, a vector z of states and inputs follows z' = R z, so a step is a matrix exponential. Whether the mode still holds is looked
at in eight instants of the step; a switch is found by halving the step down to smallest parts, and taken in one of them to
second order.

``w`` rate of the column · ``M`` torque on it without dry friction · ``h`` step
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

INSTANTS = 8
"""Of a step or a part of it, at which is looked whether a mode still holds."""


@dataclass(frozen=True)
class Modes:
    """What the machines are.

    Attributes:
        rates: R in each mode, see `mode`, (9, machines, size, size).
        rows: w, M and the current that is asked of the amplifier, as rows on z, (machines, 3, size).
        w: Place of w in z.
        breakaway: |M| up to which a column at rest sticks, (machines,).
        limit: Of the current, (machines,).
    """

    rates: np.ndarray
    rows: np.ndarray
    w: int
    breakaway: np.ndarray
    limit: np.ndarray


def mode(motion, current):
    """Place of a mode: direction of the column's motion, 0 stuck, and of the limit that the current is at, 0 none."""
    return 3 * (motion + 1) + current + 1


class ExactSteps:
    """Machines on their way: the mode of each, and the exponentials of all modes for a step, its half and so on."""

    def __init__(self, modes: Modes, step: float, smallest: float):
        self.modes, self.step = modes, step
        self.halvings = max(0, math.ceil(math.log2(step / smallest)))
        # A step, its half and so on: what is watched at the instants, then the end, all as rows on the vector at the start.
        self.parts = np.stack([self._part(step / 2**level) for level in range(self.halvings + 1)])
        self.each = np.arange(len(modes.limit))

    def _part(self, span):
        small = expm(self.modes.rates * (span / INSTANTS))
        powers = [small]
        while len(powers) < INSTANTS:
            powers.append(small @ powers[-1])
        return np.concatenate([*(self.modes.rows @ power for power in powers), powers[-1]], axis=2)

    def begin(self, z):
        """Modes that fit the state at the start."""
        w, torque, command = np.einsum("mij,mj->im", self.modes.rows, z)
        self.motion = np.where(w != 0, np.sign(w), self._leaving(torque, self.each)).astype(int)
        self.current = self._limited(command, self.each)
        self.whole = self.parts[0, self._mode(self.each), self.each]
        self.low, self.high = self._held_within(self.each)

    def jump(self, z):
        """The amplifier's mode where what it is given may have jumped."""
        before, self.current = self.current, self._limited(np.einsum("mj,mj->m", self.modes.rows[:, 2], z), self.each)
        if len(which := np.flatnonzero(before != self.current)):
            self._enter(which)

    def _mode(self, which):
        return mode(self.motion[which], self.current[which])

    def _enter(self, which):
        """Takes up the modes of some machines."""
        self.whole[which] = self.parts[0, self._mode(which), which]
        self.low[which], self.high[which] = self._held_within(which)

    def _held_within(self, which):
        """Bounds of w, M and the current that is asked within which the modes hold, (machines, 3) each."""
        motion, current = self.motion[which], self.current[which]
        breakaway, limit = self.modes.breakaway[which], self.modes.limit[which]
        low = [
            np.where(motion > 0, 0.0, -np.inf),
            np.where(motion == 0, -breakaway, -np.inf),
            np.where(current > 0, limit, np.where(current == 0, -limit, -np.inf)),
        ]
        high = [
            np.where(motion < 0, 0.0, np.inf),
            np.where(motion == 0, breakaway, np.inf),
            np.where(current < 0, -limit, np.where(current == 0, limit, np.inf)),
        ]
        return np.stack(low, axis=1), np.stack(high, axis=1)

    def _limited(self, command, which):
        """Limit that the current is at; 0: none."""
        return np.where(np.abs(command) > self.modes.limit[which], np.sign(command), 0).astype(int)

    def _leaving(self, torque, which):
        """Direction in which a column at rest moves off; 0: it sticks."""
        return np.where(np.abs(torque) <= self.modes.breakaway[which], 0, np.sign(torque))

    def _moved(self, part, z, low, high):
        """States after a part of a step, and in which machines something switches before its end."""
        after = np.einsum("mij,mj->mi", part, z)
        size = z.shape[1]
        watched = after[:, :-size].reshape(len(z), INSTANTS, 3)
        outside = (watched < low[:, np.newaxis]) | (watched > high[:, np.newaxis])
        return after[:, -size:], outside.any(axis=(1, 2))

    def advance(self, z):
        """One step of all machines."""
        end, switched = self._moved(self.whole, z, self.low, self.high)
        if len(which := np.flatnonzero(switched)):
            end[which] = self._through(z[which], which)
        end[self.motion == 0, self.modes.w] = 0.0
        return end

    def _through(self, z, which):
        """A step of the machines ``which`` that switch inside it: by halves towards the switch, then on from there."""
        left = np.full(len(which), 2**self.halvings)  # in smallest parts
        top = np.full(len(which), self.halvings)  # the most that is tried next, as a power of two of them
        while len(busy := np.flatnonzero(left)):
            on = which[busy]
            size = np.minimum(top[busy], np.frexp(left[busy])[1] - 1)
            part = self.parts[self.halvings - size, self._mode(on), on]
            end, switched = self._moved(part, z[busy], self.low[on], self.high[on])
            if (last := switched & (size == 0)).any():
                end[last] = self._switched(z[busy[last]], end[last], on[last])
            # What was refused is tried by its first half, then by the half of its second, and so on.
            searching = (switched | (top[busy] < self.halvings)) & (size > 0)
            top[busy] = np.where(searching, size - 1, self.halvings)
            taken = ~switched | (size == 0)
            z[busy[taken]] = end[taken]
            left[busy[taken]] -= 2 ** size[taken]
        return z

    def _switched(self, before, after, which):
        """States at the end of a smallest part with a switch in it, of the second order in its length; sets the new modes."""
        first, last = (np.einsum("mij,mj->mi", self.modes.rows[which], z) for z in (before, after))
        margins = [np.minimum(edge - self.low[which], self.high[which] - edge) for edge in (first, last)]
        passed = margins[1] < 0
        good, over = np.where(passed, np.maximum(margins[0], 0.0), 0.0), np.where(passed, -margins[1], 1.0)
        shares = np.where(passed, good / (good + over), np.inf)  # of the part, until the margin is used up
        share = np.minimum(shares.min(axis=1), 1.0)
        left = shares <= share[:, np.newaxis]
        column, amplifier = left[:, 0] | left[:, 1], left[:, 2]
        z = before + share[:, np.newaxis] * (after - before)
        z[column, self.modes.w] = 0.0
        position = np.einsum("mj,mj->m", self.modes.rows[which, 1], z)
        leaving = np.where(self.motion[which] == 0, np.sign(last[:, 1]), self._leaving(position, which))
        self.motion[which] = np.where(column, leaving, self.motion[which])
        self.current[which] = np.where(amplifier, self._limited(last[:, 2], which), self.current[which])
        self._enter(which)
        rates = self.modes.rates[self._mode(which), which]
        rest = self.step / 2**self.halvings * (1 - share)
        return z + rest[:, np.newaxis] * np.einsum("mij,mj->mi", rates, z)
