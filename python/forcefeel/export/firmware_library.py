"""Static library of the firmware for a target: one that the installation holds, or one that cargo compiles.

Law, feel and supervisor are the same for each loader, so one library serves all. ``make firmware-libraries`` builds those of the
installation from the sources that are embedded in ``forcefeel._core``; of other sources, none of them is used.
"""

import os
import platform
import shutil
import subprocess
import sys
import tempfile
from hashlib import sha256
from pathlib import Path

from forcefeel._core import board_sources
from forcefeel.errors import InputError
from forcefeel.units import show

LIBRARIES = Path(__file__).parent / "firmware" / "libraries"
DIGEST = "sources.sha256"
TARGETS = ("thumbv7em-none-eabihf", "thumbv7em-none-eabi", "aarch64-unknown-linux-gnu", "x86_64-unknown-linux-gnu")
"""Targets that an installation may hold a library for, in both precisions."""

FROM_REGISTRY = "cargo takes the crate libm from its cache, or fetches it from its registry, crates.io"
"""Dependencies outside forcefeel."""

_FLAGS = "RUSTFLAGS"
_WORKSPACE = Path(__file__).parent / "firmware" / "workspace.toml"


def firmware_library(triple: str, *, single: bool) -> bytes:
    """Library of the installation; compiled if there is no such file, or flags for the compiler are set (``RUSTFLAGS``).

    Raises:
        InputError: If it has to be compiled and Rust or the target is not installed, or cargo fails.
    """
    if path := _held(triple, single=single):
        return path.read_bytes()
    _check_installed(triple)
    return compiled(triple, single=single)


def library_origin(triple: str, *, single: bool) -> str:
    """A sentence on where the library is from."""
    if _held(triple, single=single):
        return "The library is the installation's; nothing was compiled."
    flags, built = bool(os.environ.get(_FLAGS)), triple in TARGETS
    reason = f"{_FLAGS} is set" if flags else f"this installation has no library of its sources for {triple}"
    remedy = "; make firmware-libraries builds it" if built and not flags else ""
    return f"Compiled by cargo, because {reason}{remedy}; {FROM_REGISTRY}."


def target_of(triple: str | None) -> str:
    """The target; default: this machine.

    Raises:
        InputError: If this machine's target is only known to ``rustc``, which is not installed.
    """
    if triple:
        return triple
    if sys.platform == "linux" and (here := f"{platform.machine()}-unknown-linux-gnu") in TARGETS:
        return here
    _check_rust()
    version_lines = _output_of("rustc", "-vV").splitlines()
    return next(line.removeprefix("host: ") for line in version_lines if line.startswith("host: "))


def library_name(triple: str, *, single: bool) -> str:
    """File name below ``LIBRARIES``."""
    return f"{triple}-{'single' if single else 'double'}.a"


def source_digest() -> str:
    """SHA-256 of the sources of a library."""
    return sha256(repr(_sources()).encode()).hexdigest()


def compiled(triple: str, *, single: bool) -> bytes:
    """Library from the embedded sources, compiled by cargo, offline if possible.

    Raises:
        InputError: If cargo fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, text in _sources():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        feature = "single" if single else "alone"
        options = ("--release", "--quiet", "--package", "forcefeel-firmware", "--features", feature, "--target", triple)
        command = ("cargo", "rustc", *options, "--crate-type", "staticlib", "--target-dir", "built")
        for network in (("--offline",), ()):
            done = subprocess.run((*command, *network), cwd=root, capture_output=True, text=True, check=False)
            if not done.returncode:
                break
        else:
            raise InputError(
                f"target: cargo could not compile for {triple}: {done.stderr.strip()}; {FROM_REGISTRY}: without a network, "
                "run the export once where there is one, or copy a CARGO_HOME that has it"
            )
        return (root / "built" / triple / "release" / "libforcefeel_firmware.a").read_bytes()


def _held(triple: str, *, single: bool) -> Path | None:
    """Library of the installation, if it is there and of the embedded sources, and no flags ask for another."""
    digest, path = LIBRARIES / DIGEST, LIBRARIES / library_name(triple, single=single)
    if os.environ.get(_FLAGS) or triple not in TARGETS or not (digest.is_file() and path.is_file()):
        return None
    return path if digest.read_text(encoding="utf-8").strip() == source_digest() else None


def _sources() -> list[tuple[str, str]]:
    return [*board_sources(), ("Cargo.toml", _WORKSPACE.read_text(encoding="utf-8"))]


def _check_installed(triple: str) -> None:
    """Refuses a target that Rust cannot compile for here."""
    _check_rust()
    library = Path(_output_of("rustc", "--print", "sysroot").strip()) / "lib" / "rustlib"
    installed = sorted(path.parent.name for path in library.glob("*/lib"))
    if triple not in installed:
        raise InputError(
            f"target: expected an installed one, {', '.join(installed)}, got {show(triple)}; run rustup target add {triple}"
        )


def _check_rust() -> None:
    if not (shutil.which("cargo") and shutil.which("rustc")):
        raise InputError(
            "target: requires cargo, which was not found, because this installation has no library for it; "
            f"expected one of {', '.join(TARGETS)} in a wheel, or install Rust from https://rustup.rs"
        )


def _output_of(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise InputError(
            f"target: {' '.join(command)} fails: {done.stderr.strip()}; check the Rust installation with rustup show"
        )
    return done.stdout
