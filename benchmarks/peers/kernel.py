"""The yardstick: the steps of `numba_rk4` hand-written in C with eight lanes, built by ``cc`` when the benchmark runs."""

import ctypes
import os
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from . import case

NAME = "C by hand, eight lanes"
LANES, GROUPS = 8, 2
FLAGS = ("-O3", "-march=native", "-ffast-math", "-Wno-psabi", "-shared", "-fPIC")


def available() -> bool:
    return shutil.which("cc") is not None


@cache
def build(source: str, *flags: str) -> ctypes.CDLL:
    """Library of a C file of this folder."""
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder, "kernel.so")
        path = Path(__file__).with_name(source)
        subprocess.run(["cc", *FLAGS, *flags, os.fspath(path), "-o", os.fspath(library), "-lm"], check=True)
        return ctypes.CDLL(os.fspath(library))


def aligned(*shape: int) -> np.ndarray:
    """Zeros of that shape, aligned to a vector of eight numbers."""
    size = int(np.prod(shape))
    room = np.zeros(size + LANES)
    start = -room.ctypes.data // 8 % LANES
    return room[start : start + size].reshape(shape)


def pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def grouped(parameters: np.ndarray) -> np.ndarray:
    """Coefficients (groups, 18, 8), the last run repeated until the groups are even."""
    count = len(parameters)
    groups = -(-count // (LANES * GROUPS)) * GROUPS
    padded = np.pad(case.scaled(parameters), ((0, 0), (0, groups * LANES - count)), mode="edge")
    coefficients = aligned(groups, len(case.SCALED), LANES)
    coefficients[:] = padded.reshape(-1, groups, LANES).swapaxes(0, 1)
    return coefficients


def simulate(coefficients: np.ndarray, theta: np.ndarray, outputs_per_step: int = 1) -> None:
    """Fills theta (groups, 2001, 8) in rad: steps of 1 ms, or of 2 ms with theta's cubic between. What one times."""
    library = build("kernel.c", f"-DOUTPUTS_PER_STEP={outputs_per_step}")
    library.simulate(ctypes.c_long(len(coefficients)), pointer(coefficients), pointer(theta))


def run(parameters: np.ndarray, outputs_per_step: int = 1) -> np.ndarray:
    """theta in rad at `case.TIMES`, (N, 2001)."""
    coefficients = grouped(parameters)
    theta = aligned(len(coefficients), case.OUTPUTS, LANES)
    simulate(coefficients, theta, outputs_per_step)
    return theta.swapaxes(1, 2).reshape(-1, case.OUTPUTS)[: len(parameters)]
