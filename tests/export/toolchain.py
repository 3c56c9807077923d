"""Compilers, checker and emulator of the exported C: found, or the test is skipped, or fails where they are required."""

import os
import shutil
import subprocess
from ctypes.util import find_library
from dataclasses import replace
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.export.firmware_library import DIGEST, LIBRARIES, source_digest

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-ffp-contract=off")
BOARD = Path(ff.__file__).parent / "export" / "board"
BOARDS = {"cortex-m4": "mps2-an386", "cortex-m7": "mps2-an500"}
NONLINEAR = {
    "feel.breakout": "2 lb",
    "feel.coulomb_friction": "1 lb",
    "feel.static_friction": "1.5 lb",
    "feel.detent_force": "2 lb",
    "feel.detent_angle": "3 deg",
    "feel.hysteresis": "1 lb",
    "feel.deadband": "0.2 deg",
    "feel.preload": "1 lb",
    "feel.quadratic_damping": "50 lb in s^2/rad^2",
    "feel.soft_stop_low": "-4 deg",
    "feel.soft_stop_high": "4 deg",
    "feel.soft_stop_damping": "2 lb in s/rad",
    "feel.hard_stop_low": "-6 deg",
    "feel.hard_stop_high": "6 deg",
    "feel.velocity_limit": "60 deg/s",
    "feel.trim_rate": "2 deg/s",
    "feel.shaker_force": "5 lb",
    "column.coulomb_friction": "1 lb",
}
SURFACE = {
    "surface.area": "1 m^2",
    "surface.chord": "0.4 m",
    "surface.gearing": 1.2,
    "surface.gearing_change": "0.3 1/rad",
    "surface.bobweight": "10 N",
    "surface.deflection_1": "-0.3 rad",
    "surface.coefficient_1": 0.14,
    "surface.deflection_2": "-0.15 rad",
    "surface.coefficient_2": 0.05,
    "surface.deflection_3": "0.05 rad",
    "surface.coefficient_3": -0.01,
    "surface.deflection_4": "0.2 rad",
    "surface.coefficient_4": -0.07,
    "surface.deflection_5": "0.35 rad",
    "surface.coefficient_5": -0.2,
    "surface.per_flow": "-0.1 1/rad",
    "surface.per_tab": "-0.1 1/rad",
    "surface.per_rate": "-0.5 1/rad",
    "surface.flow_per_attack": 0.6,
    "surface.pitch_arm": "4 m",
    "surface.cable_stiffness": "20000 N m/rad",
    "surface.compressible": True,
    "surface.mach_1": 0.6,
    "surface.deflection_factor_1": 1.4,
}
"""A loader with a surface takes what that adds as inputs, and C computes it."""
USUAL = {
    key: NONLINEAR[key]
    for key in (
        "feel.breakout",
        "feel.coulomb_friction",
        "feel.static_friction",
        "feel.soft_stop_high",
        "feel.hard_stop_high",
    )
}
CONVERTERS = {
    "controller.input_range": "10 V",
    "controller.input_bits": 16,
    "controller.output_range": "10 V",
    "controller.output_bits": 16,
    "controller.antiwindup": "50 1/s",
}
KNOTS = Path(__file__).parents[2] / "examples" / "schedule" / "knots.csv"


GRIP_SENSOR = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.5 N"}


def valve():
    """A valve's law for two settings, with every nonlinear part of the feel, and a surface."""
    loader = ff.digital_elevator().replace(NONLINEAR | CONVERTERS | SURFACE, si=True)
    return ff.export.Exported.of("robust", loader, "pitch", ff.flight_schedule.read_knots(KNOTS).feel[:2])


def motor(feel=NONLINEAR):
    """A motor's law for one setting, with every nonlinear part of the feel, a curve for its spring, and cogging."""
    loader = ff.loader.electric("elevator-electric").replace(feel | {"motor.cogging_torque": "0.1 N m"})
    curve = ff.loader.Curve((-0.3, -0.1, 0.0, 0.1, 0.3), (-300.0, -120.0, 0.0, 100.0, 320.0))
    return ff.export.Exported.of("robust", replace(loader, force_curve=curve), "roll")


def written(exported, out, *, single=False):
    ff.export.write_export(exported, ff.export.Target.C, out, single=single)
    return out


def needs(*commands):
    """Skips the test where a command is missing, ``rust target ...``, ``library ...`` or ``firmware library ...``, aloud; fails
    where they are required."""
    missing = [command for command in commands if not _is_there(command)]
    if missing and os.environ.get("FORCEFEEL_REQUIRE_TARGETS") == "1":
        pytest.fail(f"not found: {', '.join(missing)}; run make firmware-libraries")
    if missing:
        pytest.skip(f"not found: {', '.join(missing)}; run make firmware-libraries")


def _is_there(command):
    if command.startswith("library "):
        return find_library(command.removeprefix("library ")) is not None
    if command.startswith("firmware library "):
        fresh = (LIBRARIES / DIGEST).is_file() and (LIBRARIES / DIGEST).read_text(
            encoding="utf-8"
        ).strip() == source_digest()
        return fresh and (LIBRARIES / command.removeprefix("firmware library ")).is_file()
    name = command.removeprefix("rust target ")
    if name == command or not shutil.which("rustc"):
        return shutil.which(command) is not None
    sysroot = subprocess.run(["rustc", "--print", "sysroot"], capture_output=True, text=True, check=True).stdout.strip()
    return (Path(sysroot) / "lib" / "rustlib" / name / "lib").is_dir()


def run(folder, *command, status=0, **how):
    """What a command prints; it must end with ``status``."""
    done = subprocess.run(
        list(map(str, command)), cwd=folder, capture_output=True, text=True, check=False, timeout=280, **how
    )
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout + done.stderr


def for_board(folder, core, program, *sources, flags=("-std=c99",)):
    """Compiles for a Cortex-M with its start; ``-std=c99`` leaves newlib's own names out, so the start has its own rule."""
    cpu = (f"-mcpu={core}", "-mthumb", "-mfloat-abi=hard", "-mfpu=auto", "-O2", "-ffp-contract=off")
    run(folder, "arm-none-eabi-gcc", *cpu, "-std=gnu99", "-c", "-o", "reset.o", BOARD / "reset.c")
    link = ("--specs=rdimon.specs", "-nostartfiles", "-T", BOARD / "board.ld", "-Wl,--gc-sections")
    run(folder, "arm-none-eabi-gcc", *cpu, *flags, *link, "-o", program, "reset.o", *sources, "-lm")


def on_board(folder, core, program, *options):
    """What a program prints under QEMU, which must end well."""
    semihosting = ("-nographic", "-semihosting-config", "enable=on,target=native")
    return run(folder, "qemu-system-arm", "-M", BOARDS[core], *semihosting, *options, "-kernel", program)
