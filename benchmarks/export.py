"""What an exported law costs on a Cortex-M: instructions a period, code and data, stack, beside a law written by hand.

Run ``python benchmarks/export.py``; it needs what tests/export/install installs. Instructions are counted by QEMU
(``-icount shift=0``: one a nanosecond of its SysTick, 40 a tick) in single precision, by gcc -O2: of an exported law the most
that any period of its golden vectors takes, each run 32 times from the same state, of the others the mean of 1,000 periods. The
law by hand is what a person would write: loops over the matrices, the linear feel by Runge and Kutta, no check of its input.
The stack is that of all functions' frames together. Ends with an error if a law takes 5 % more instructions than ``STATED``.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import forcefeel as ff

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.export.toolchain import BOARD, CONVERTERS, KNOTS, NONLINEAR, USUAL

STATED = {
    "C, I, B, G": 884,
    "C, every nonlinear part of the feel": 1259,
    "C, law's friction and converters too": 1513,
    "C, changing between four settings": 1394,
    "C, so with every part": 2469,
}
"""Instructions per period, of laws with a part for contact."""
MOST = 1.05
FEEL = {key: value for key, value in NONLINEAR.items() if key.startswith("feel.")}
PERIODS, TIMES = 1000, 32
CPU = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=auto", "-O2", "-ffp-contract=off")
LINK = ("--specs=rdimon.specs", "-nostartfiles", "-T", BOARD / "board.ld", "-Wl,--gc-sections", "-Wl,--no-warnings")
QEMU = ("qemu-system-arm", "-M", "mps2-an386", "-nographic", "-semihosting-config", "enable=on,target=native")

MAIN = """
#include <stdio.h>
{before}
int main(void)
{{
    volatile unsigned *const tick = (volatile unsigned *)0xE000E010; /* SysTick: control, reload, count */
    {begin}
    tick[1] = 0xFFFFFFU;
    tick[2] = 0U;
    tick[0] = 5U;
    const unsigned start = tick[2];
    for (unsigned k = 0U; k < {periods}U; ++k) {{
        const float force = 0.5F * (float)(k & 63U);
        {step}
    }}
    printf("%u\\n", (start - tick[2]) & 0xFFFFFFU);
    return ({good}) ? 0 : 1;
}}
"""

WORST = """
#include "law_golden.h"
#include <stdio.h>
#define TIMES(what) for (unsigned r = 0U; r < 32U; ++r) {{ copy = state; __asm volatile("" ::: "memory"); what; }}
int main(void)
{{
    volatile unsigned *const tick = (volatile unsigned *)0xE000E010;
    static law_state state, copy;
    law_output out;
    unsigned most = 0U;
    tick[1] = 0xFFFFFFU;
    tick[2] = 0U;
    tick[0] = 5U;
    for (unsigned k = 0U; k < GOLDEN; ++k) {{
        const law_real *const g = golden_in[k];
        law_input in = {{ g[0], g[1], g[2], g[3], g[4], g[5], g[6] }};
        {settings}
        if ((k % GOLDEN_PART) == 0U) (void)law_law_reset(&state, &in);
        const unsigned begin = tick[2];
        TIMES((void)0)
        const unsigned copied = tick[2];
        TIMES((void)law_law_step(&copy, &in, &out))
        const unsigned took = ((copied - tick[2]) & 0xFFFFFFU) - ((begin - copied) & 0xFFFFFFU);
        most = (took > most) ? took : most;
        if (law_law_step(&state, &in, &out) != law_OK) return 1;
    }}
    printf("%u\\n", most);
    return 0;
}}
"""
SETTINGS = "in.blend = g[7]; in.from = golden_settings[k][0]; in.to = golden_settings[k][1];"

BY_HAND = """
static const float A[9][9] = {A}, B[9][5] = {B}, C[2][15] = {C};
typedef struct {{ float xi[9], delta[2]; }} hand_state;
static void feel(const float x[2], float torque, float out[2])
{{
    out[0] = x[1];
    out[1] = (torque - {b}F * x[1] - {g}F * x[0]) * {per_i}F;
}}
__attribute__((noinline)) float hand_step(hand_state *s, const float y[4])
{{
    float u[2], next[9], k[4][2], x[2];
    for (int r = 0; r < 2; ++r) {{
        u[r] = C[r][13] * s->delta[0] + C[r][14] * s->delta[1];
        for (int j = 0; j < 9; ++j) u[r] += C[r][j] * s->xi[j];
        for (int j = 0; j < 4; ++j) u[r] += C[r][9 + j] * y[j];
    }}
    for (int r = 0; r < 9; ++r) {{
        next[r] = B[r][4] * u[0];
        for (int j = 0; j < 4; ++j) next[r] += B[r][j] * y[j];
        for (int j = 0; j < 9; ++j) next[r] += A[r][j] * s->xi[j];
    }}
    for (int r = 0; r < 9; ++r) s->xi[r] = next[r];
    feel(s->delta, u[1], k[0]);
    for (int q = 1; q < 4; ++q) {{
        const float h = (q < 3 ? 0.5F : 1.0F) * {h}F;
        x[0] = s->delta[0] + h * k[q - 1][0];
        x[1] = s->delta[1] + h * k[q - 1][1];
        feel(x, u[1], k[q]);
    }}
    for (int r = 0; r < 2; ++r) s->delta[r] += {h}F / 6.0F * (k[0][r] + 2.0F * (k[1][r] + k[2][r]) + k[3][r]);
    return u[0];
}}
"""


def run(folder: Path, *command: object) -> str:
    done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, check=False, timeout=120)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def counted(folder: Path, main: str, *sources: str) -> float:
    """Instructions a period."""
    (folder / "count.c").write_text(main, encoding="utf-8")
    return int(run(folder, *QEMU, "-icount", "shift=0", "-kernel", linked(folder, *sources))) * 40 / PERIODS


def linked(folder: Path, *sources: str) -> str:
    """``count.c`` as a program of the board."""
    run(folder, "arm-none-eabi-gcc", *CPU, "-std=gnu99", "-c", "-o", "reset.o", BOARD / "reset.c")
    run(folder, "arm-none-eabi-gcc", *CPU, "-std=gnu99", *LINK, "-o", "count", "count.c", "reset.o", *sources, "-lm")
    return "count"


def code_and_data(folder: Path, program: str) -> int:
    """Bytes of an object."""
    text, data, bss = run(folder, "arm-none-eabi-size", program).splitlines()[1].split()[:3]
    return int(text) + int(data) + int(bss)


def stack(folder: Path, source: str) -> int:
    """Bytes that all functions' frames take together."""
    run(folder, "arm-none-eabi-gcc", *CPU, "-std=c99", "-fstack-usage", "-c", "-o", "law.o", source)
    return sum(int(line.split("\t")[1]) for line in (folder / "law.su").read_text(encoding="utf-8").splitlines())


def of_c(exported: ff.export.Exported, folder: Path) -> tuple[float, int, int]:
    ff.export.write_export(exported, ff.export.Target.C, folder, single=True)
    several = len(exported.settings) > 1
    (folder / "count.c").write_text(WORST.format(settings=SETTINGS if several else ""), encoding="utf-8")
    most = int(run(folder, *QEMU, "-icount", "shift=0", "-kernel", linked(folder, "law_law.c"))) * 40 / TIMES
    bytes_of_stack = stack(folder, "law_law.c")
    return most, code_and_data(folder, "law.o"), bytes_of_stack


def of_firmware(exported: ff.export.Exported, folder: Path) -> tuple[float, int, int]:
    """Active, held by its supervisor; its stack is not known to gcc."""
    ff.export.write_export(
        exported, ff.export.Target.FIRMWARE, folder, single=True, triple="thumbv7em-none-eabihf", replace=True
    )
    call = "(void)forcefeel_step(&axis, law_settings, 1U, &in, &out);"
    begin = (
        "static forcefeel_axis axis; forcefeel_input in = { 0 }; forcefeel_output out; in.stiffness_factor = 1.0F; "
        f"(void)forcefeel_init(&axis, sizeof axis, &law_loader, law_settings, 1U); {call} in.request = 2U; "
        "in.flags = FORCEFEEL_DRIVE_ACTS; "
        f"for (int k = 0; k < 3000; ++k) {call}"
    )
    before = '#define FORCEFEEL_SINGLE\n#include "law_data.h"'
    main = MAIN.format(
        before=before,
        begin=begin,
        step=f"in.sensors[0] = 0.01F * force; {call}",
        periods=PERIODS,
        good="out.state == 3U",
    )
    instructions = counted(folder, main, "libforcefeel.a")
    with_it = code_and_data(folder, "count")
    counted(folder, MAIN.format(before="", begin="", step="(void)force;", periods=PERIODS, good="1"))
    return instructions, with_it - code_and_data(folder, "count"), 0


def of_hand(exported: ff.export.Exported, folder: Path) -> tuple[float, int, int]:
    numbers = exported.law.sampled
    assert numbers is not None
    row = numbers.rows()[0]
    (inertia, damping, stiffness), sizes = exported.settings[0], (81, 45, 30)
    parts, start = [], 0
    for size, width in zip(sizes, (9, 5, 15), strict=True):
        part = row[start : start + size].reshape(-1, width)
        parts.append("{" + ",".join("{" + ",".join(f"{x!r}F" for x in row) + "}" for row in part.tolist()) + "}")
        start += size
    feel = {"b": f"{damping:.9e}", "g": f"{stiffness:.9e}", "per_i": f"{1 / inertia:.9e}"}
    matrices = dict(zip("ABC", parts, strict=True))
    (folder / "law.c").write_text(BY_HAND.format(**matrices, **feel, h=repr(numbers.period_s)), encoding="utf-8")
    before = "typedef struct { float xi[9], delta[2]; } hand_state; float hand_step(hand_state *, const float[4]);"
    begin = "static hand_state s; float y[4] = { 0 }; volatile float e;"
    main = MAIN.format(
        before=before, begin=begin, step="y[0] = force; e = hand_step(&s, y); (void)e;", periods=PERIODS, good="e == e"
    )
    bytes_of_stack = stack(folder, "law.c")
    return counted(folder, main, "law.c"), code_and_data(folder, "law.o"), bytes_of_stack


def main() -> None:
    plain, rough = ff.digital_elevator(), ff.digital_elevator().replace(NONLINEAR | CONVERTERS, si=True)
    knots = ff.flight_schedule.read_knots(KNOTS).feel

    def law(loader: ff.Loader, feel: object = None) -> ff.export.Exported:
        return ff.export.Exported.of("robust", loader, "law", feel)

    cases = (
        ("by hand, I, B, G", of_hand, law(plain)),
        ("C, I, B, G", of_c, law(plain)),
        ("C, and breakout, dry friction, stops", of_c, law(plain.replace(USUAL, si=True))),
        ("C, every nonlinear part of the feel", of_c, law(plain.replace(FEEL, si=True))),
        ("C, law's friction and converters too", of_c, law(rough)),
        ("C, changing between four settings", of_c, law(plain, knots)),
        ("C, so with every part", of_c, law(rough, knots)),
        ("firmware with supervisor, I, B, G", of_firmware, law(plain)),
        ("firmware, every nonlinear part", of_firmware, law(rough)),
    )
    measured = {}
    print(f"{'elevator-2khz, robust, float, Cortex-M4F':<42}{'instructions':>14}{'code, data B':>14}{'stack B':>10}")
    for name, of, exported in cases:
        with tempfile.TemporaryDirectory() as folder:
            measured[name] = of(exported, Path(folder))
        instructions, size, bytes_of_stack = measured[name]
        print(f"{name:<42}{instructions:>14,.0f}{size:>14,}{bytes_of_stack or '-':>10}")
    for name, stated in STATED.items():
        if measured[name][0] > MOST * stated:
            sys.exit(f"{name}: {measured[name][0]:.0f} instructions, at most {MOST:g} times {stated}")


if __name__ == "__main__":
    main()
