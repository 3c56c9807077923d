"""Cost of an exported step: stated in README and header, and as another program measures it."""

import re

import pytest
from benchmarks import export as benchmark

import forcefeel as ff
from tests.command_line import runs
from tests.export.toolchain import needs

export = runs("export")

RESOLUTION = 5 + 40 / 32
"""Instructions: a tick of 40 over eight steps, and over the benchmark's 32."""


@pytest.mark.slow
def test_readme_and_header_state_the_cost_that_the_benchmark_measures(tmp_path):
    needs("gcc", "arm-none-eabi-gcc", "qemu-system-arm")
    exported = ff.export.Exported.of("robust", ff.digital_elevator(), "law")
    ff.export.write_export(exported, ff.export.Target.C, tmp_path / "measured", single=True, measure=True)
    header = (tmp_path / "measured" / "law_law.h").read_text(encoding="utf-8")
    readme = (tmp_path / "measured" / "README.md").read_text(encoding="utf-8")
    found = re.search(r"cortex-m4, gcc -O2: at most (\d+) bytes of stack, (\d+) instructions", header)
    assert found
    assert f"| cortex-m4, gcc -O2 | {found[1]} | {found[2]} |" in readme
    most, _, stack = benchmark.of_c(exported, tmp_path / "benchmark")
    assert int(found[1]) == stack
    assert int(found[2]) == pytest.approx(most, abs=RESOLUTION)


def test_measuring_another_target_is_refused(export):
    status, _, message = export("elevator-2khz", "--law", "robust", "--to", "matlab", "--measure")
    assert status == 2
    assert "--measure: is for --to c" in message
