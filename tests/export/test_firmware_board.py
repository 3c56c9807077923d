"""The project for a board, on the STM32F405 that QEMU emulates: golden bits in its telemetry, codes, watchdog, stack, and a fault.

QEMU logs what is written to the parts that it does not emulate; the watchdog's address has two names there, IWDG and I2S2ext.
"""

import re
import struct
import sys
from dataclasses import dataclass

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.firmware_board import BOARD, BOARD_TARGET, command_channel, sensor_channels
from forcefeel.export.firmware_code import board_axis, golden_inputs
from forcefeel.export.firmware_library import library_name
from tests.export.toolchain import motor, needs, run, valve

FAULT_AT = 3000
STACK_BYTES = 24 * 1024
ON, OFF, MIDDLE = 0x1, 0x10000, 2048
QEMU = (
    *("qemu-system-arm", "-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-icount", "shift=3,sleep=off"),
    *(
        "-semihosting-config",
        "enable=on,target=native",
        "-d",
        "unimp",
        "-D",
        "log.txt",
        "-serial",
        "file:telemetry.bin",
    ),
)
FRAME = np.dtype(
    [("period", "<u4")]
    + [(name, "<f4") for name in ("command", "torque", "angle", "rate")]
    + [(name, "<u4") for name in ("acting", "tripped")]
    + [(name, "<u2") for name in ("stack_free", "busy")]
    + [(name, "u1") for name in ("state", "enable", "status", "late")]
)


@dataclass
class Emulated:
    """A run under QEMU: what it printed, its telemetry, and what it wrote to each part, in order."""

    text: str
    frames: np.ndarray
    codes: list[int]
    enables: list[int]
    watchdog: list[int]


def unstuffed(block):
    """Consistent overhead byte stuffing, by its definition: each code leads to the next zero."""
    plain, at = bytearray(block), 0
    while at < len(block):
        plain[at], at = 0, at + block[at]
    return bytes(plain[1:])


def emulated(folder, program, status):
    run(folder, "make", program)
    text = run(folder, *QEMU, "-kernel", program, status=status)
    blocks = (folder / "telemetry.bin").read_bytes().split(b"\0")[:-1]
    frames = np.frombuffer(b"".join(map(unstuffed, blocks)), FRAME)
    log = (folder / "log.txt").read_text(encoding="utf-8")

    def written(part, offset):
        pattern = rf"^(?:{part}): .* write \(size 4, offset 0x{offset:03x}, value 0x(\w+)\)$"
        return [int(value, 16) for value in re.findall(pattern, log, re.MULTILINE)]

    return Emulated(text, frames, written("DAC", 8), written("GPIOB", 0x18), written("IWDG|I2S2ext", 0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two settings of a valve with every nonlinear part of the feel."""
    library = library_name(BOARD_TARGET, single=True)
    needs("arm-none-eabi-gcc", "qemu-system-arm", f"firmware library {library}")
    out = tmp_path_factory.mktemp("board")
    ff.export.write_export(valve(), ff.export.Target.FIRMWARE, out, single=True, triple=BOARD)
    return out


@pytest.fixture(scope="module")
def expected():
    """Answers of the simulation's lines on this machine."""
    inputs, words = golden_inputs(valve())
    numbers, states = board_axis(valve()).answers(
        inputs.astype(np.float32).astype(np.float64), words.tolist(), single=True
    )
    return numbers[:, :4].astype(np.float32), states


@pytest.fixture(scope="module")
def golden(folder):
    return emulated(folder, "emulated.elf", 0)


@pytest.mark.slow
def test_telemetry_has_the_golden_bits(golden, expected):
    numbers, states = expected
    assert re.search(rf"^pitch: {len(numbers)} samples, 0 differ; stack \d+ of {STACK_BYTES} bytes$", golden.text)
    frames = golden.frames
    assert len(frames) > 0.99 * len(numbers)  # one a period; while a long one runs, none is waiting
    at = frames["period"]
    assert (np.diff(at) > 0).all()
    for column, name in enumerate(("command", "torque", "angle", "rate")):
        np.testing.assert_array_equal(frames[name].view("u4"), numbers[at, column].view("u4"), err_msg=name)
    for column, name in enumerate(("enable", "state", "acting", "tripped")):
        np.testing.assert_array_equal(frames[name], states[at, column], err_msg=name)
    assert not frames["status"].any()
    # Only the first period of a change of settings takes longer than a period, and makes the next one late.
    words = golden_inputs(valve())[1][:, :2]
    changes = 1 + np.flatnonzero((words[1:] != words[:-1]).any(axis=1))
    assert set(at[frames["late"] > 0] - 1) <= set(changes)
    assert 0 < frames["busy"][at < changes[0]].max() < 250
    assert frames["busy"].max() <= 1000


@pytest.mark.slow
def test_converter_gets_each_command_a_period_later_and_enable_follows(golden, expected):
    commands, enables = expected[0][:, 0].astype(float), expected[1][:, 0]
    volts = command_channel(valve().loader).range
    given = np.sign(commands) * np.floor(np.abs(commands * 2047 / volts) + 0.5)
    codes = [MIDDLE]
    for before, enable in zip([0.0, *given[:-1]], enables, strict=True):
        codes += [MIDDLE + int(before)] + [MIDDLE] * (not enable)
    assert golden.codes == [*codes, MIDDLE + int(given[-1])]
    assert golden.enables == [OFF, *(ON if enable else OFF for enable in enables)]
    assert 1000 < np.count_nonzero(enables) < len(enables)


@pytest.mark.slow
def test_watchdog_starts_once_and_is_refreshed_each_period(golden, expected):
    assert golden.watchdog[:3] == [0xCCCC, 0x5555, 0xAAAA]
    assert golden.watchdog[3:] == [0xAAAA] * len(expected[0])


@pytest.mark.slow
def test_stack_mark_stays_within_the_stack(golden):
    used = int(re.search(r"stack (\d+) of", golden.text)[1])
    assert 1000 < used < STACK_BYTES - 1000
    assert golden.frames["stack_free"][-1] == STACK_BYTES - used


def test_fault_takes_power_and_command_away(folder, expected):
    fault = emulated(folder, "fault.elf", 3)
    assert expected[1][FAULT_AT - 1, 0] == 1
    assert fault.enables[-2:] == [ON, OFF]
    assert fault.codes[-1] == MIDDLE
    assert fault.watchdog[2:] == [0xAAAA] * (FAULT_AT + 1)  # and none after it
    assert fault.frames["period"][-1] == FAULT_AT - 1


@pytest.mark.slow
def test_telemetry_script_prints_the_frames(golden, folder):
    with (folder / "telemetry.bin").open("rb") as stream:
        text = run(folder, sys.executable, "telemetry.py", stdin=stream)
    head, *rows = text.splitlines()
    assert head.split() == list(FRAME.names)
    assert len(rows) >= FAULT_AT - 100
    period, _, torque, *_ = rows[-1].split()
    # A frame is left out where a change of setting takes longer than a period.
    assert float(torque) == golden.frames["torque"][golden.frames["period"] == int(period)]


def test_program_for_the_board_fits_and_needs_no_emulator(folder):
    run(folder, "make")
    text, data, bss = map(int, run(folder, "arm-none-eabi-size", "pitch.elf").splitlines()[1].split()[:3])
    assert text + data < 128 * 1024
    assert data + bss < 64 * 1024
    first = struct.unpack("<2I", (folder / "pitch.bin").read_bytes()[:8])
    assert first[0] == 0x20000000 + STACK_BYTES
    assert first[1] & 1  # Thumb
    assert not re.search("panic|bkpt", run(folder, "arm-none-eabi-objdump", "-d", "pitch.elf"))


INPUTS = """
#define _GNU_SOURCE
#include "board.h"
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#define WORD(address) (*(volatile uint32_t *)(uintptr_t)(address))

void fault(void)
{
    printf("%u %u %u\\n", WORD(0x40023804), WORD(0x40023808), WORD(0x40023C00)); /* PLLCFGR, CFGR, FLASH_ACR */
    exit(4);
}

int main(int count, char **words)
{
    static forcefeel_input in;
    (void)mmap((void *)0x40000000, 0x30000, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    WORD(0x40023800) = (uint32_t)strtoul(count == 2 ? words[1] : "0", NULL, 0); /* RCC_CR */
    if (count == 2)
        clock_begin();
    inputs_begin();
    for (int k = 1; k + 5 < count; k += 6) {
        WORD(0x40012000) = (uint32_t)strtoul(words[k], NULL, 0);
        for (unsigned channel = 0; channel < 4; ++channel)
            WORD(0x4001203C + 4 * channel) = (uint32_t)strtoul(words[k + 1 + channel], NULL, 0);
        WORD(0x40020410) = (uint32_t)strtoul(words[k + 5], NULL, 0);
        read_inputs(&in);
        for (unsigned channel = 0; channel < 4; ++channel)
            printf("%a ", in.sensors[channel]);
        printf("%u %u %u\\n", in.missed, in.request, in.flags);
    }
    return 0;
}
"""
READY = 4
"""The converter's flag for four channels converted."""


def with_grip_sensor():
    return valve().loader.replace({"grip_sensor.gain": 1.0})


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """The code for clock, converter and pins, with memory in place of the chip's registers."""
    needs("gcc", f"firmware library {library_name(BOARD_TARGET, single=True)}")
    tmp_path = tmp_path_factory.mktemp("inputs")
    exported = ff.export.Exported.of("robust", with_grip_sensor(), "pitch")
    ff.export.write_export(exported, ff.export.Target.FIRMWARE, tmp_path, single=True, triple=BOARD)
    (tmp_path / "main.c").write_text(INPUTS, encoding="utf-8")
    strict = (
        "-std=gnu99",
        "-DFORCEFEEL_SINGLE",
        "-Wall",
        "-Werror",
        "-Wno-int-to-pointer-cast",
        "-Wno-unused-variable",
    )
    run(tmp_path, "gcc", *strict, "-o", "inputs", "main.c", "inputs.c")
    return tmp_path / "inputs"


def test_clock_is_168_mhz_or_a_fault(inputs):
    crystal, pll = 1 << 17, 1 << 25  # ready
    assert run(inputs.parent, inputs, "0", status=4) == "0 0 0\n"  # no crystal
    factors, buses, flash = map(int, run(inputs.parent, inputs, str(crystal | pll), status=4).split())
    m, n, p, of_crystal = factors & 63, factors >> 6 & 511, 2 * (factors >> 16 & 3) + 2, factors >> 22 & 1
    assert (8e6 / m * n / p, of_crystal) == (168e6, 1)
    assert 1e6 <= 8e6 / m <= 2e6
    assert 192e6 <= 8e6 / m * n <= 432e6
    assert (buses >> 10 & 7, buses >> 13 & 7) == (0b101, 0b100)  # a quarter, a half
    assert (buses & 3, flash & 7) == (2, 5)  # the multiplied clock, with the wait states of 168 MHz


def test_inputs_scale_codes_and_wait_for_the_switch(inputs):
    stop, ill, off, quiet = (1 << pin for pin in (12, 13, 14, 15))
    periods = [
        (READY, 2048, 4094, 1, 3072, quiet),  # on from the start: not taken for on
        (READY, 0, 4095, 2047, 2049, quiet | off),
        (READY, 2048, 2048, 2048, 2048, quiet),
        (0, 2048, 2048, 2048, 2048, quiet | stop | ill),  # the converter gave nothing
        (0, 2048, 2048, 2048, 2048, 0),
        (READY, 2048, 2048, 2048, 2048, off),
    ]
    words = [str(word) for row in periods for word in row]
    rows = [line.split() for line in run(inputs.parent, inputs, *words).splitlines()]
    sensors = np.array([[float.fromhex(word) if "nan" not in word else np.nan for word in row[:4]] for row in rows])
    codes = np.array([row[1:5] for row in periods], dtype=float)
    ranges = np.array([channel.range for channel in sensor_channels(with_grip_sensor())])
    values = (codes - 2048) / 2048 * ranges
    values[1, :2] = np.nan  # at an end of the converter
    np.testing.assert_allclose(sensors, values, rtol=3e-7)  # two roundings of a float
    assert ranges[0] == pytest.approx(10.0 / with_grip_sensor()["load_cell.gain"], rel=1e-12)  # the file's own volts
    stopped, faulty, acknowledged, acts = 1, 2, 4, 16
    states = [list(map(int, row[4:])) for row in rows]
    assert states == [
        [0, 0, acts],
        [0, 0, acts],
        [0, 2, acts],
        [1, 2, acts | stopped | faulty],
        [2, 2, acts | acknowledged],
        [0, 0, acts | acknowledged],
    ]


def test_range_of_a_motor_is_its_supervisors():
    loader = motor().loader
    assert [channel.range for channel in sensor_channels(loader)] == [
        loader["safety.force_range"],
        loader["safety.position_range"],
        loader["safety.angle_range"] * loader["column.base_arm"],
        loader["safety.absolute_force"],
    ]
    assert command_channel(loader).range == loader["current_loop.current_limit"]


@pytest.mark.parametrize(
    ("changes", "single", "message"),
    [
        ({}, False, "single: stm32f405 computes in single precision"),
        ({"controller.delay": "0.3 ms"}, True, r"expected the period of 0\.5 ms .* got 0\.3 ms"),
        (
            {"controller.period": "0.1 ms", "controller.delay": "0.1 ms"},
            True,
            r"controller\.period: expected at least 0\.2 ms",
        ),
    ],
)
def test_what_the_board_cannot_run_is_refused(tmp_path, changes, single, message):
    needs(f"firmware library {library_name(BOARD_TARGET, single=True)}")
    exported = ff.export.Exported.of("robust", ff.digital_elevator().replace(changes), "pitch")
    with pytest.raises(ff.InputError, match=message):
        ff.export.write_export(exported, ff.export.Target.FIRMWARE, tmp_path / "out", single=single, triple=BOARD)
    assert not (tmp_path / "out").exists()
