"""The loop of elevator-2khz under robust, closed with python-control from the matrices in pitch.mat.

Made by forcefeel for the loader with the SHA-256 8a092bbfbd4a2f34... Needs numpy, scipy and control; run it beside the file:

    python pitch_loop.py

It closes the loop, compares the column's response to 1 N of pilot force with what the engine of forcefeel gives, and the pole that is nearest
to the edge; exit status 1 if one differs. SI units.

The linear models leave out amplifier.current_limit, valve.orifice, valve.flow_limit and 8 more of the loader's optional rows; forcefeel simulate has all of it in play.
"""

import sys
from pathlib import Path

import control
import numpy as np
import scipy.io

RESPONSE = 1e-5  # of the largest angle: the engine's steps are of fourth order
CRITICAL = 1e-6  # of one

file = scipy.io.loadmat(Path(__file__).with_name("pitch.mat"))
settings = len(file["feel"])
feel_of = file["feel"]  # I, B, G a row
plant = control.ss(file["plant_A"], file["plant_B"], file["plant_C"], 0)  # inputs: pilot force, command
n = plant.nstates
T, tau = float(file["period_s"].item()), float(file["delay_s"].item())


def held(system, time):
    """A and B of a system over some time under inputs that stay."""
    if time <= 0:
        return np.eye(system.nstates), np.zeros((system.nstates, system.ninputs))
    over = control.c2d(system, time, "zoh")
    return over.A, over.B


def law(setting):
    """The law and the feel as one system: from what is sampled to the command; states xi, delta, delta'."""
    A, B = (file[key].reshape(*file[key].shape[:2], settings)[..., setting] for key in ("law_transition", "law_input"))
    c, t = file["law_command"][:, setting], file["law_torque"][:, setting]
    m = len(A)
    inertia, damping, stiffness = feel_of[setting]
    feel = control.ss([[0, 1], [-stiffness / inertia, -damping / inertia]], [[0], [1 / inertia]], np.eye(2), 0)
    F, G = held(feel, T)
    # T = t [xi; y; delta; delta'],  e = c [xi; y; delta; delta'],  xi+ = A xi + B [y; e]
    on_state = lambda row: np.concatenate([row[:m], row[m + 3 :]])  # noqa: E731
    on_sample = lambda row: row[m : m + 3]  # noqa: E731
    a = np.zeros((m + 2, m + 2))
    a[:m, :m] = A
    a[m:, m:] = F
    a[:m] += np.outer(B[:, 3], on_state(c))
    a[m:] += np.outer(G[:, 0], on_state(t))
    b = np.vstack([B[:, :3] + np.outer(B[:, 3], on_sample(c)), np.outer(G[:, 0], on_sample(t))])
    return control.ss(a, b, on_state(c)[np.newaxis], on_sample(c)[np.newaxis], T)


# x+ = Phi x + Gamma_0 e_old + Gamma_1 e + Gamma_F F_p: the new command acts over the last T - tau, the old one over the first tau
Phi, whole = held(plant, T)
late, new = held(plant, T - tau)
old = late @ held(plant, tau)[1]
sampled = control.ss(
    np.block([[Phi, old[:, 1:]], [np.zeros((1, n + 1))]]),
    np.block([[whole[:, :1], new[:, 1:]], [np.zeros((1, 1)), np.ones((1, 1))]]),
    np.hstack([plant.C, np.zeros((plant.noutputs, 1))]),
    0,
    T,
)


def closed(setting):
    """The loop from pilot force to what is sampled, its states [x; e_old; xi; delta; delta']."""
    controller = law(setting)
    A, B, C = sampled.A, sampled.B, sampled.C
    by_command = B[:, 1:]
    matrix = np.block(
        [
            [A + by_command @ controller.D @ C, by_command @ controller.C],
            [controller.B @ C, controller.A],
        ]
    )
    entry = np.vstack([B[:, :1], np.zeros((controller.nstates, 1))])
    return control.ss(matrix, entry, np.hstack([C, np.zeros((3, controller.nstates))]), 0, T)


def response(loop):
    """The column's angle after each period under 1 N."""
    time = T * np.arange(file["expected_time_s"].size + 1)
    found = control.forced_response(loop, time, np.ones_like(time))
    return found.outputs[2][1:]


def critical(loop):
    """The largest magnitude of a pole."""
    return np.abs(loop.poles()).max()


good = True
for setting in range(settings):
    loop = closed(setting)
    must = file["expected_angle_rad"][setting]
    off = np.abs(response(loop) - must).max() / np.abs(must).max()
    pole, pole_must = critical(loop), file["expected_critical"].ravel()[setting]
    same = off <= RESPONSE and abs(pole - pole_must) <= CRITICAL * max(1, abs(pole_must))
    good = good and same
    print(f"setting {setting + 1}: response off by {off:.1e} of its largest, pole {pole:.9g} (must be {pole_must:.9g}): "
          f"{'the same' if same else 'DIFFERENT'}")
sys.exit(0 if good else 1)
