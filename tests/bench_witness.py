"""Frequency responses of a bench from the tests' independent witness, at values of k, c, J, C_i that are not the file's."""

from contextlib import contextmanager

import numpy as np

from forcefeel.bench.experiments import Experiment
from forcefeel.bench.responses import Response
from tests import witness

TRUTH = {"linkage.stiffness": 5230.0, "linkage.damping": 19.4, "column.inertia": 40.6, "valve.current_gain": 4.87}
"""In U.S. customary units: lb/in, lb s/in, lb in s^2, in^3/(s mA)."""

SI_PER_US = {
    "linkage.stiffness": witness.LBF / witness.INCH,
    "linkage.damping": witness.LBF / witness.INCH,
    "column.inertia": witness.LBF * witness.INCH,
    "valve.current_gain": witness.INCH**3 / 1e-3,
}
TRUTH_SI = {key: value * SI_PER_US[key] for key, value in TRUTH.items()}

FREQUENCY_HZ = np.geomspace(0.2, 50.0, 60)

_OUTPUT = {
    "column_angle": (6, 1 / witness.RB),
    "piston_position": (0, witness.INCH),
    "load_pressure": (1, witness.LBF / witness.INCH**2),
    "potentiometer": (0, witness.K3),
}


@contextmanager
def machine(truth):
    """The witness with other constants."""
    names = {"linkage.stiffness": "K", "linkage.damping": "C", "column.inertia": "J", "valve.current_gain": "CI"}
    before = {name: getattr(witness, name) for name in names.values()}
    try:
        for key, value in truth.items():
            setattr(witness, names[key], value)
        yield
    finally:
        for name, value in before.items():
            setattr(witness, name, value)


def servo_response(output, loop="servo-closed", truth=TRUTH, noise=0.0, random=None):
    """Response from the test signal to ``output``, SI units, with relative noise on gain and phase."""
    gain = -witness.K3 if loop == "servo-closed" else 0.0
    with machine(truth):
        a = witness.jacobian(witness.compliant, 8, gains=np.array([gain, 0, 0, 0, 0, 0]))
        b = np.zeros(8)
        b[3] = witness.WN**2 * witness.CI * witness.K2
    row, scale = _OUTPUT[output]
    s = 2j * np.pi * FREQUENCY_HZ
    value = scale * np.array([np.linalg.solve(at * np.eye(8) - a, b)[row] for at in s])
    if noise:
        value = value * np.exp(noise * (random.standard_normal(60) + 1j * random.standard_normal(60)))
    deviation = np.full(60, noise) if noise else None
    return Response(output, Experiment.read(loop), "test_signal", output, FREQUENCY_HZ, value, deviation=deviation)
