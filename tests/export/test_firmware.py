"""The law as firmware: the same bits on a board as here, as the live loop gives them; nothing in it that panics."""

import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.export import firmware_library
from forcefeel.export.firmware_code import board_axis, golden_inputs
from forcefeel.export.firmware_library import TARGETS, library_name, library_origin
from tests.export.toolchain import BOARDS, motor, needs, run, valve
from tests.live.test_bus import running, yoke
from tests.parametrization import mostly_slow

DRIVE_ACTS = 16
"""The bit of the flags."""

TWO = """
#include "roll_data.h"
#include <stdio.h>

int main(void)
{
    static forcefeel_axis axes[2];
    forcefeel_input in = { .stiffness_factor = 1.0, .flags = FORCEFEEL_DRIVE_ACTS };
    forcefeel_output out[2];
    for (int k = 0; k < 2; ++k) {
        if (forcefeel_init(&axes[k], sizeof axes[k], &roll_loader, roll_settings, roll_SETTINGS) != FORCEFEEL_OK) {
            return 1;
        }
    }
    for (int period = 0; period < 4000; ++period) {
        for (int k = 0; k < 2; ++k) {
            in.request = ((k == 0) && (period > 0)) ? FORCEFEEL_ACTIVE : FORCEFEEL_OFF;
            if (forcefeel_step(&axes[k], roll_settings, roll_SETTINGS, &in, &out[k]) != FORCEFEEL_OK) {
                return 1;
            }
        }
    }
    printf("%u %u\\n", (unsigned int)out[0].state, (unsigned int)out[1].state);
    return 0;
}
"""

BOARD = "thumbv7em-none-eabihf"
MOST_BYTES = 200_000
"""Of a library of the installation; 43,000 to 160,000."""
RUN = {  # compiler, emulator and what make is told, by target
    "thumbv7em-none-eabihf": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "thumbv7em-none-eabi": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "aarch64-unknown-linux-gnu": (
        "aarch64-linux-gnu-gcc",
        "qemu-aarch64",
        "CC=aarch64-linux-gnu-gcc -static",
        "RUN=qemu-aarch64",
    ),
    "x86_64-unknown-linux-gnu": ("x86_64-linux-gnu-gcc", "make"),
}
LIBRARY_TARGETS = [
    pytest.param(triple, marks=() if triple in {BOARD, "x86_64-unknown-linux-gnu"} else pytest.mark.slow)
    for triple in TARGETS
]
"""``make test`` builds the libraries of a board and of this machine, ``make validate`` all."""
IN_THEIR_PRECISION = {(BOARD, True), ("x86_64-unknown-linux-gnu", False)}
"""A board computes double precision in software, which takes its emulator six times as long."""
SENSORS = ("load_cell_force_n", "drive_position_m", "column_base_m", "grip_force_n")


def exported(law, out, **how):
    ff.export.write_export(law, ff.export.Target.FIRMWARE, out, **how)
    return out


@pytest.fixture(scope="module")
def board(tmp_path_factory):
    """Two settings with every nonlinear part of the feel, in single precision, for a Cortex-M."""
    needs("cargo", "arm-none-eabi-gcc", "qemu-system-arm", f"rust target {BOARD}")
    return exported(valve(), tmp_path_factory.mktemp("board"), single=True, triple=BOARD)


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """A motor, in double precision, for this machine."""
    needs("cargo", "gcc")
    return exported(motor(), tmp_path_factory.mktemp("here"))


@pytest.mark.parametrize("core", mostly_slow(BOARDS))
def test_emulated_board_matches_bitwise(board, core):
    text = run(board, "make", "-B", "test", f"CPU={core}", f"MACHINE={BOARDS[core]}")
    assert re.search(r"^pitch: \d{5} samples, 0 differ$", text, re.MULTILINE)


@pytest.mark.slow
def test_host_matches_bitwise(here):
    assert re.search(r"^roll: \d{5} samples, 0 differ$", run(here, "make", "test"), re.MULTILINE)


@pytest.mark.slow
def test_host_matches_bitwise_in_single_precision(tmp_path):
    needs("cargo", "gcc")
    text = run(exported(valve(), tmp_path, single=True), "make", "test")
    assert re.search(r"^pitch: \d{5} samples, 0 differ$", text, re.MULTILINE)


@pytest.mark.parametrize(
    ("triple", "single"),
    [
        pytest.param(
            triple,
            single,
            marks=() if (triple, single) in IN_THEIR_PRECISION else pytest.mark.slow,
            id=f"{triple}-{name}",
        )
        for triple in TARGETS
        for single, name in ((False, "double"), (True, "single"))
    ],
)
def test_library_of_the_installation_matches_bitwise_without_cargo(triple, single, tmp_path, monkeypatch):
    compiler, emulator, *words = RUN[triple]
    needs(compiler, emulator, f"firmware library {library_name(triple, single=single)}")
    for name in ("cargo", "rustc"):
        (tmp_path / name).write_text("#!/bin/sh\nexit 99\n", encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    out = exported(valve() if single else motor(), tmp_path / "out", single=single, triple=triple)
    name = "pitch" if single else "roll"
    assert re.search(rf"^{name}: \d{{5}} samples, 0 differ$", run(out, "make", "test", *words), re.MULTILINE)
    assert "The library is the installation's" in (out / "README.md").read_text(encoding="utf-8")
    assert "libm" in (out / "LICENSES.txt").read_text(encoding="utf-8")


FLIGHT = """#include "pitch_data.h"
#include <math.h>
#include <stdio.h>

int main(void)
{
    forcefeel_flight flight = {2400.0, 70.0, 0.06, -0.03, 0.1, 0.2, -0.05, 1.4, 0.3, 0.05, 0.1};
    forcefeel_added out;
    printf("%u ", forcefeel_hinge_moment(&pitch_settings[1], &flight, &out));
    printf("%.17g %.17g %.17g ", out.added_force, out.added_stiffness, out.added_damping);
    flight.tab = NAN;
    const unsigned int refused = forcefeel_hinge_moment(&pitch_settings[1], &flight, &out);
    printf("%u %g %u", refused, out.added_force, forcefeel_hinge_moment(NULL, &flight, &out));
    return 0;
}
"""


def test_hinge_moment_of_the_library_is_the_simulations_and_refuses_what_is_no_number(tmp_path):
    needs("cargo", "gcc")
    law = valve()
    exported(law, tmp_path)
    (tmp_path / "flight.c").write_text(FLIGHT, encoding="utf-8")
    run(tmp_path, "gcc", "-Wl,--gc-sections", "-o", "flight", "flight.c", "libforcefeel.a", "-lm")
    status, *numbers, refused, nothing, null = run(tmp_path, "./flight").split()
    flown = [[2400.0, 70.0, 0.06, -0.03, 0.1, 0.2, -0.05, 1.4, 0.3, 0.05, 0.1]]
    must = _core.hinge_moment(law.loader.si_values, np.array(flown))[0]
    assert [float(number) for number in numbers] == must.tolist()
    assert (status, refused, float(nothing), null) == ("0", "2", 0.0, "2")


@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
@pytest.mark.parametrize("triple", LIBRARY_TARGETS)
def test_library_of_the_installation_is_one_object_of_three_functions(triple, single):
    name = library_name(triple, single=single)
    tools = RUN[triple][0].removesuffix("gcc")
    needs(f"{tools}nm", f"firmware library {name}")
    path = firmware_library.LIBRARIES / name
    assert path.stat().st_size < MOST_BYTES
    defined = re.findall(r" [A-Z] (\w+)$", run(path.parent, f"{tools}nm", "--defined-only", name), re.MULTILINE)
    assert sorted(defined) == ["forcefeel_hinge_moment", "forcefeel_init", "forcefeel_step"]
    needed = re.findall(r" U (\w+)$", run(path.parent, f"{tools}nm", "--undefined-only", name), re.MULTILINE)
    assert set(needed) <= {"memcpy", "memset", "memmove"}
    content = path.read_bytes()
    assert not re.search(rb"panic|unwrap|slice_index_fail|/home/|/root/|/tmp/", content)


@pytest.mark.slow
def test_double_precision_board_matches_bitwise_without_a_download(tmp_path, monkeypatch):
    """A cargo in between notes how it is called; the README tells what else it would have fetched."""
    needs("cargo", "arm-none-eabi-gcc", "qemu-system-arm", f"rust target {BOARD}")
    real, asked, out = shutil.which("cargo"), tmp_path / "asked", tmp_path / "out"
    (tmp_path / "cargo").write_text(f'#!/bin/sh\necho "$@" >> {asked}\nexec {real} "$@"\n', encoding="utf-8")
    (tmp_path / "cargo").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("RUSTFLAGS", "-C target-cpu=cortex-m7 -C target-feature=+fp64")
    exported(motor(), out, triple=BOARD)
    assert [line.split()[-1] for line in asked.read_text(encoding="utf-8").splitlines()] == ["--offline"]
    assert "cargo takes the crate libm from its cache" in (out / "README.md").read_text(encoding="utf-8")
    text = run(out, "make", "test", "CPU=cortex-m7", f"MACHINE={BOARDS['cortex-m7']}")
    assert re.search(r"^roll: \d{5} samples, 0 differ$", text, re.MULTILINE)
    # The law itself has no call of a sum or product in software.
    assert "vmul.f64" in run(out, "arm-none-eabi-objdump", "-d", "roll_test")


def test_modified_law_is_detected(here, tmp_path):
    shutil.copytree(here, tmp_path, dirs_exist_ok=True)
    data = tmp_path / "roll_data.h"
    lines = data.read_text(encoding="utf-8").splitlines()
    place = max(k for k, line in enumerate(lines) if line.startswith("        {"))
    first = lines[place].split("{", 1)[1].split(",", 1)[0]
    lines[place] = lines[place].replace(first, f"{float(first) * (1 + 1e-12)!r}", 1)
    data.write_text("\n".join(lines), encoding="utf-8")
    assert ", 0 differ" not in run(tmp_path, "make", "-B", "test", status=2)


def test_linked_program_cannot_panic(board, here):
    run(board, "make", "pitch_main")
    run(here, "make", "roll_main")
    symbols = run(board, "arm-none-eabi-nm", "pitch_main") + run(here, "nm", "roll_main")
    assert symbols.count("forcefeel_step") == 2
    assert not re.search(
        "panic|unwrap|slice_index_fail|alloc", re.sub(r"\S*_malloc\S*|\S*alloc_r|\S*alloc\b", "", symbols)
    )


def test_example_reaches_the_active_state(here):
    assert re.match(r"roll: state 3, command \S+ A\n", run(here, "sh", "-c", "make -s && ./roll_main"))


@pytest.mark.parametrize("loader", [ff.digital_elevator(), ff.loader.electric("elevator-electric")], ids=str)
def test_firmware_matches_the_live_loop(loader):
    # A board finds from its first sample where the column rests, which a simulation knows: noise within a step does not move it.
    quiet = {
        f"{name}.noise": 0.1 * loader[f"{name}.resolution"] for name in ("load_cell", "potentiometer", "column_sensor")
    }
    loader = loader.replace({"feel.shaker_force": "2 lb"}).replace(quiet, si=True)
    with ff.live.start(loader, "robust", real_time=False) as session:
        session.off()
        session.trim_rad, session.shaker = 0.02, 0.5
        session.wait(1000)  # they are there before the feel comes
        session.on()
        session.wait(4000)
        session.hand_force_n = 20.0
        session.stiffness_factor = 1.3
        session.wait(1000)
        session.off()
        session.wait(500)
        seen = columns(session)
    assert np.count_nonzero(np.diff(seen["spring_factor"])) > 100  # it is led there
    factor = np.where(np.maximum.accumulate(seen["spring_factor"]) > 1.0, 1.3, 1.0)
    expect_bits_of_the_board(loader, seen, (0.02, factor, 0.5))


def test_firmware_matches_the_live_loop_of_a_drive_that_acts_late():
    loader = yoke()
    with running(loader, power_s=0.8) as (session, emulator):
        emulator.hold(0.05)
        session.wait(500)
        session.on()
        session.wait(6000)
        seen = columns(session)
    assert np.count_nonzero((seen["enable"] == 1) & (seen["drive_acts"] == 0)) > 1000
    assert (seen["delay"] == 0).all()
    expect_bits_of_the_board(loader, seen, (0.0, 1.0, 0.0))


def columns(session):
    rows = session.history(most=100_000)
    return dict(zip(session.columns, rows.T, strict=True))


def expect_bits_of_the_board(loader, seen, around):
    """A board that is given a live run's samples, trim, factor and shaker does the same."""
    given = np.zeros((len(seen["state"]), 11))
    given[:, :4] = np.column_stack([seen[name] for name in SENSORS])
    given[:, 4], given[:, 5], given[:, 6] = around
    words = np.zeros((len(given), 8), dtype=int)
    active = np.flatnonzero(seen["state"] == 3)
    words[np.argmax(seen["state"] == 1) : active[-1] + 1, 2] = 2
    words[:, 6] = DRIVE_ACTS * seen["drive_acts"]
    numbers, states = board_axis(ff.export.Exported.of("robust", loader)).answers(given, words.tolist(), single=False)
    assert len(active) > 2000
    for column, name in enumerate(("command", "feel_torque_n_m", "feel_angle_rad", "feel_rate_rad_per_s")):
        np.testing.assert_array_equal(numbers[:, column], seen[name], err_msg=name)
    for column, name in enumerate(("enable", "state", "acting", "trips")):
        np.testing.assert_array_equal(states[:, column], seen[name], err_msg=name)


def test_host_force_acts_like_hand_force():
    """At rest ``G theta = R_p F + T``, where T is what the law hears from a column that does not follow."""
    loader = ff.loader.electric("elevator-electric")
    given = np.zeros((16000, 11))
    given[:, 5] = 1.0
    given[4000:, 8] = force = 0.5
    words = np.zeros((len(given), 8), dtype=int)
    words[1:, 2], words[:, 6] = 2, DRIVE_ACTS
    numbers, states = board_axis(ff.export.Exported.of("robust", loader)).answers(given, words.tolist(), single=False)
    assert states[-1, 1] == 3
    assert numbers[3999, 2] == 0.0
    torque = force * loader["column.grip_arm"] + numbers[-1, 1]
    assert abs(numbers[-1, 1]) < 0.01 * torque
    # At rest but for what eight seconds leave of the transient.
    assert numbers[-1, 2] == pytest.approx(torque / loader["feel.stiffness"], rel=1e-5)


def test_two_axes_in_one_program_run_independently(here, tmp_path):
    """Two of the motor's, one of which is on and one off, with a library and numbers that they share."""
    needs("gcc")
    (tmp_path / "two.c").write_text(TWO, encoding="utf-8")
    program = tmp_path / "two"
    run(
        here, "gcc", "-std=gnu99", "-Wall", "-Werror", "-I.", "-o", program, tmp_path / "two.c", "libforcefeel.a", "-lm"
    )
    assert run(here, program) == "3 0\n"


def test_golden_vectors_cover_every_state():
    law = valve()
    given, words = golden_inputs(law)
    _, states = board_axis(law).answers(given, words.tolist(), single=True)
    counts = np.bincount(states[:, 1], minlength=6)
    assert len(given) > 9000
    assert (counts > 0).all()
    assert counts[3] > 4000


@pytest.mark.parametrize("triple", ["avr-unknown-none", "not a target"])
def test_missing_rust_target_is_named_and_nothing_is_written(tmp_path, triple):
    needs("cargo")
    with pytest.raises(ff.InputError, match=r"expected an installed one, .*; run rustup target add"):
        exported(motor(), tmp_path / "out", triple=triple)
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def without_libraries(tmp_path_factory, monkeypatch):
    """An installation from source before ``make firmware-libraries``."""
    folder = tmp_path_factory.mktemp("libraries")
    monkeypatch.setattr(firmware_library, "LIBRARIES", folder)
    return folder


def test_library_of_other_sources_is_not_used(without_libraries):
    triple = TARGETS[-1]
    name, digest = library_name(triple, single=False), without_libraries / firmware_library.DIGEST
    (without_libraries / name).write_bytes(b"!<arch>\n")
    digest.write_text(firmware_library.source_digest(), encoding="utf-8")
    assert firmware_library.firmware_library(triple, single=False) == b"!<arch>\n"
    digest.write_text("0" * 64, encoding="utf-8")
    assert library_origin(triple, single=False) == (
        f"Compiled by cargo, because this installation has no library of its sources for {triple}; make firmware-libraries builds "
        "it; cargo takes the crate libm from its cache, or fetches it from its registry, crates.io."
    )


def test_missing_cargo_writes_nothing(tmp_path, monkeypatch, without_libraries):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ff.InputError, match="requires cargo, which was not found"):
        exported(motor(), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_command_tells_where_the_library_is_from(forcefeel):
    status, shown, _ = forcefeel("export", "elevator-electric", "--to", "firmware", "--out", "out")
    origin = library_origin(firmware_library.target_of(None), single=False)
    assert (status, origin in " ".join(shown.split())) == (0, True)


def test_missing_crate_without_network_is_named(tmp_path, monkeypatch, without_libraries):
    needs("cargo")
    monkeypatch.setenv("RUSTUP_HOME", str(Path(os.environ.get("RUSTUP_HOME", Path.home() / ".rustup"))))
    monkeypatch.setenv("CARGO_HOME", str(tmp_path / "empty"))
    monkeypatch.setenv("CARGO_NET_OFFLINE", "true")
    with pytest.raises(ff.InputError, match=r"the crate libm .* crates\.io: without a network"):
        exported(motor(), tmp_path / "out")
    assert not (tmp_path / "out").exists()
