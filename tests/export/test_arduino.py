"""The sketch of examples/arduino: compiled for a Teensy's processor, and run here with the pins of a test."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.c_code import traced_law
from tests.export.toolchain import needs, run

SKETCH = Path(__file__).parents[2] / "examples" / "arduino" / "yoke" / "yoke.ino"
STUB = Path(__file__).parent / "arduino"
STRICT = ("-std=gnu++17", "-Wall", "-Wextra", "-Werror")
TEENSY = ("-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16", "-O2", "-fno-exceptions", "-fno-rtti")
MIDDLE, FORCE_N, TRAVEL_M, CURRENT_A = 2048, 500.0, 0.08, 25.0
OPEN, CLOSED = 1, 0


@pytest.fixture(scope="module")
def exported():
    return ff.export.Exported.of("robust", ff.loader.electric("desktop-yoke"), "yoke")


@pytest.fixture(scope="module")
def folder(exported, tmp_path_factory):
    out = tmp_path_factory.mktemp("sketch")
    ff.export.write_export(exported, ff.export.Target.C, out, single=True)
    shutil.copy(SKETCH, out / "yoke.cpp")  # as the IDE does
    return out


@pytest.mark.slow
def test_sketch_compiles_for_a_teensy(folder):
    needs("arm-none-eabi-gcc", "arm-none-eabi-g++")
    run(folder, "arm-none-eabi-g++", *TEENSY, *STRICT, "-I", STUB, "-c", "-o", "yoke.o", "yoke.cpp")
    run(folder, "arm-none-eabi-gcc", *TEENSY[:5], "-std=c99", "-Wall", "-Werror", "-c", "-o", "law.o", "yoke_law.c")
    run(folder, "arm-none-eabi-ld", "-r", "-o", "both.o", "yoke.o", "law.o")
    undefined = run(folder, "arm-none-eabi-nm", "--undefined-only", "both.o")
    assert "yoke_law" not in undefined


def test_sketch_gives_the_laws_commands_a_period_later_and_stops(folder, exported, tmp_path):
    needs("gcc", "g++")
    run(folder, "gcc", "-O2", "-std=c99", "-c", "-o", "law.o", "yoke_law.c")
    run(folder, "g++", "-O2", *STRICT, "-I", STUB, "-o", "sketch", "yoke.cpp", STUB / "main.cpp", "law.o")
    time = np.arange(400)
    codes = np.full((400, 4), MIDDLE)
    codes[:, 0] += np.round(40 * np.sin(0.02 * time)).astype(int)
    codes[:, 1] += np.round(10 * np.sin(0.03 * time)).astype(int)
    codes[:, 2] = codes[:, 1]
    codes[:, 3] = CLOSED
    codes[10:12, 3] = OPEN  # closed from the start is not on
    codes[300, 0] = 4000  # beyond the largest force
    codes[320, 3] = OPEN
    (tmp_path / "pins").write_text("\n".join(" ".join(map(str, row)) for row in codes), encoding="utf-8")
    with (tmp_path / "pins").open("rb") as stream:
        begin, *lines = run(folder, folder / "sketch", stdin=stream).splitlines()
    assert begin == f"500.000 {MIDDLE} 0"
    first, last, enable = np.array([line.split() for line in lines], dtype=int).T
    on = np.r_[12:300, 321:400]
    assert np.flatnonzero(enable).tolist() == [
        *on[on < 300][1:],
        *on[on > 300][1:],
    ]  # power comes with the first command
    sensors = np.zeros((400, 11))
    scales = np.float32([FORCE_N, TRAVEL_M, TRAVEL_M]) / np.float32(MIDDLE)
    sensors[:, :3] = (codes[:, :3] - MIDDLE).astype(np.float32) * scales
    sensors[:, 5] = 1.0
    law = traced_law(exported.loader, exported.law, exported.sampled(), single=True, linked=False)
    for part in (on[on < 300], on[on > 300]):
        commands = law.answers(sensors[part], [(0, 0)] * len(part))[:, 0]
        given = np.float32(MIDDLE + 0.5) + commands.astype(np.float32) * np.float32((MIDDLE - 1) / CURRENT_A)
        assert np.ptp(given) > 20
        np.testing.assert_array_equal(first[part[1:]], np.trunc(given[:-1]))
    off = np.setdiff1d(np.arange(400), on)
    assert (last[off] == MIDDLE).all()
