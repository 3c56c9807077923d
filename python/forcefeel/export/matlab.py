"""Matrices of law and plant for MATLAB, Octave and Python, with two scripts that close and compare the loop.

All numbers are in one ``.mat`` file, version 5; the scripts contain only the equations of the loop.
"""

from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.export.expected import Expected
from forcefeel.export.exported import Exported
from forcefeel.export.plant import LinearPlant
from forcefeel.laws.sampled.sampled_law import NUMBERS, SampledLaw
from forcefeel.linear.models import DESIGN_STATES
from forcefeel.loader.beyond_linear import left_out
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.templating import environment

MATRICES, PYTHON, OCTAVE = "{}.mat", "{}_loop.py", "{}_loop.m"
"""File names."""


def matlab_names(name: str) -> tuple[str, ...]:
    """File names of :func:`matlab_files`."""
    return tuple(file.format(name) for file in (MATRICES, PYTHON, OCTAVE))


def matlab_files(exported: Exported) -> dict[str, str | bytes]:
    """Matrices and both scripts, by file name."""
    name = exported.name
    expected = Expected.of(exported)
    about = {
        "name": name,
        "loader": exported.loader.name,
        "sha256": exported.loader.fingerprint,
        "law": exported.law.name,
        "sampled": exported.law.sampled is not None,
        "period_s": exported.law.period_s,
        "delay_s": exported.law.delay_s,
        "left_out": left_out(exported.loader),
        "late": has_grip_sensor(exported.loader) and np.isfinite(exported.loader["grip_sensor.bandwidth"]),
        "matrices": MATRICES.format(name),
    }
    templates = environment(html=False)
    return {
        MATRICES.format(name): _matrices(exported, expected),
        PYTHON.format(name): templates.get_template("export/loop.py.j2").render(about),
        OCTAVE.format(name): templates.get_template("export/loop.m.j2").render(about),
    }


def _matrices(exported: Exported, expected: Expected) -> bytes:
    plant = LinearPlant.of(exported.loader)
    law = exported.law
    numbers: dict[str, Any] = {
        "loader": exported.loader.name,
        "loader_sha256": exported.loader.fingerprint,
        "law": law.name,
        "feel_units": _cells(FEEL_SETTING),
        "feel": exported.settings,
        "plant_A": plant.a,
        "plant_B": plant.b,
        "plant_C": plant.c,
        "plant_D": plant.d,
        "plant_states": _cells(plant.states),
        "plant_inputs": _cells(plant.inputs),
        "plant_outputs": _cells(plant.outputs),
        "expected_time_s": expected.time_s,
        "expected_angle_rad": expected.angle_rad,
        "expected_critical": expected.critical,
        "time_between_s": expected.time_s[0],
    }
    numbers |= _gains(exported) if law.sampled is None else _sampled(law.sampled)
    file = BytesIO()
    import scipy.io  # noqa: PLC0415  an extra, and only here

    scipy.io.savemat(file, numbers, oned_as="row", do_compression=True)
    return file.getvalue()


def _sampled(law: SampledLaw) -> dict[str, Any]:
    """Numbers of a sampled law, with the settings on the last axis."""
    arrays = {f"law_{name}": np.moveaxis(getattr(law, name), 0, -1) for name in (*NUMBERS, "settled")}
    return {"period_s": law.period_s, "delay_s": law.delay_s, **arrays}


def _gains(exported: Exported) -> dict[str, Any]:
    """Gains c_1 .. c_7 and the load cell's arm of each setting."""
    laws = [exported.law.numbers.gain_law(exported.loader, setting) for setting in range(len(exported.settings))]
    return {
        "gains": np.array([law.gains for law in laws]),
        "gains_on": _cells(DESIGN_STATES),
        "load_cell_arm": np.array([law.load_cell_arm for law in laws]),
        "displacement_unit": laws[0].displacement_unit,
    }


def _cells(names: tuple[str, ...] | list[str]) -> NDArray[np.object_]:
    """Texts as a cell array."""
    return np.array(list(names), dtype=object)
