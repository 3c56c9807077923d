"""The exported matrices: the script that goes with them closes the loop by itself and finds the engine's numbers."""

import runpy
import shutil
import subprocess

import numpy as np
import pytest
import scipy.io

import forcefeel as ff

SETTINGS = np.array([[6.8, 34.0, 1085.0], [4.0, 25.0, 800.0]])
"""I, B, G in SI units."""


def cases():
    hydraulic = ff.digital_elevator().replace({"load_cell.bandwidth": "300 Hz", "column.coulomb_friction": "1 lb"})
    electric = ff.loader.electric("sidestick-roll")
    at_grip = ff.digital_elevator().replace({"grip_sensor.gain": 1.1, "grip_sensor.mass": "0.5 kg"}, si=True)
    return {
        "valve": ff.export.Exported.of("robust", hydraulic, "pitch", SETTINGS),
        "grip": ff.export.Exported.of("grip", at_grip, "pitch"),
        "motor": ff.export.Exported.of("torque-mode", electric, "roll"),
        "analog": ff.export.Exported.of("converged", ff.elevator(), "pitch"),
        "original": ff.export.Exported.of(None, ff.elevator(), "pitch"),
    }


@pytest.fixture(scope="module", params=["valve", "grip", "motor", "analog", "original"])
def folder(request, tmp_path_factory):
    out = tmp_path_factory.mktemp(request.param)
    exported = cases()[request.param]
    ff.export.write_export(exported, ff.export.Target.MATLAB, out)
    return out, exported.name


def status_of(script):
    """In this process, which has python-control already."""
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(script))
    return ended.value.code


def test_python_control_closed_loop_matches(folder, capsys):
    out, name = folder
    assert status_of(out / f"{name}_loop.py") == 0
    assert capsys.readouterr().out.count("the same") == len(scipy.io.loadmat(out / f"{name}.mat")["feel"])


@pytest.mark.skipif(not shutil.which("octave-cli"), reason="no Octave on the machine: the script for it is not run")
def test_octave_closed_loop_matches(folder):
    out, name = folder
    words = ["octave-cli", "--quiet", "--norc", str(out / f"{name}_loop.m")]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "DIFFERENT" not in done.stdout
    assert "the same" in done.stdout


def test_modified_law_in_the_file_is_detected(folder, capsys):
    out, name = folder
    file = out / f"{name}.mat"
    kept = file.read_bytes()
    numbers = {key: value for key, value in scipy.io.loadmat(file).items() if not key.startswith("__")}
    key = "law_command" if "law_command" in numbers else "gains"
    numbers[key] = numbers[key] * 1.01
    scipy.io.savemat(file, numbers)
    status = status_of(out / f"{name}_loop.py")
    file.write_bytes(kept)
    assert status == 1
    assert "DIFFERENT" in capsys.readouterr().out


def test_file_contains_the_exact_law_numbers(folder):
    out, name = folder
    numbers = scipy.io.loadmat(out / f"{name}.mat")
    (exported,) = (one for key, one in cases().items() if key in out.name)
    law = exported.law.sampled
    if law is None:
        gains = exported.law.numbers.gain_law(exported.loader)
        assert np.array_equal(numbers["gains"][0], gains.gains)
        return
    for key in ("transition", "input", "command", "torque", "friction", "settled"):
        array = getattr(law, key)
        assert np.array_equal(numbers[f"law_{key}"].reshape(*array.shape[1:], -1), np.moveaxis(array, 0, -1))


def test_grip_sensor_lag_is_in_the_loop(tmp_path):
    lag = {"grip_sensor.gain": 1.1, "grip_sensor.mass": "0.5 kg", "grip_sensor.bandwidth": "200 Hz"}
    exported = ff.export.Exported.of("grip", ff.digital_elevator().replace(lag, si=True), "pitch")
    ff.export.write_export(exported, ff.export.Target.MATLAB, tmp_path)
    assert status_of(tmp_path / "pitch_loop.py") == 0


def test_gains_for_a_digital_controller_are_refused():
    with pytest.raises(ff.InputError, match="gains of an analog law, and elevator-2khz has a digital controller"):
        ff.export.Exported.of("original", ff.digital_elevator(), "pitch")
