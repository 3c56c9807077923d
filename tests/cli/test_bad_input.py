"""Whatever a user hands over is answered or refused in words: no crash, no library's warning, no page of text.

Loader files are changed at random, and commands are given options at random; ``HYPOTHESIS_PROFILE=slow`` tries thousands.
"""

import contextlib
import io
import os
import sys

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import forcefeel as ff
from forcefeel.cli import main
from forcefeel.cli.app import command_line
from forcefeel.errors import InputError
from forcefeel.loader.parameters import TABLE
from forcefeel.printable import visible

LONGEST = 20_000
"""Characters of a message; a word of the command line may be repeated whole."""

NUMBERS = ["0", "-1", "nan", "inf", "1e999", "5e-324", "1e308", "99999999999999999999", "-0", "1_000", "0x10", "٣"]
UNITS = ("lb", "deg", "s", "%", "lb in/rad", "m^99")
TEXTS = ("", " ", "x" * 9_999, "\x1b[31m", "[/2]", "a\u202eb", "\udcff", "==", "a=b", "a,b", "1..2", "2..1 s", "{", '"')
WORDS = """true none off k k,c C_i,,zz robust published release my.toml other.csv folder nowhere/x /dev/null . ~ -
part60-a-2014 linkage.stiffness=-1 valve.orifice=true feel.breakout=0"""
SENTENCES = """feel.stiffness=1000..9000 lb in/rad:3
feel.stiffness=9..1 lb in/rad:-3:log
linkage.stiffness=20 %
linkage.stiffness={ normal = "2 %" }
controller.period=0.5 ms
feel.inertia=1e-300 kg m^2
1 s: feel.stiffness=5000 lb in/rad
8..16 Hz"""
QUANTITIES = [f"{number} {unit}" for number in ("0", "-5", "1e-300", "1e300", "7") for unit in UNITS]
ANYTHING = st.one_of(*map(st.sampled_from, (NUMBERS, QUANTITIES, TEXTS, WORDS.split(), SENTENCES.splitlines())))

BUILT_IN = [ff.elevator().to_toml(), ff.digital_elevator().to_toml(ff.UnitSystem.SI)]
LINES = """[tolerances]
[feel]
[[feel]]
[feel.x]
[
x = [[[[
a.b.c = 1
= 1
period = 1
orifice = true
name = 1
force_curve = { points = [["1 deg", "2 lb"]] }
linkage.stiffness = "20 %"
linkage.stiffness = { normal = "5 %", low = "1 %" }
\x00
\ufeffé
\"\"\"
# x""".splitlines()


@st.composite
def files(draw):
    """A loader file with some lines changed, lost, given twice or put in, and perhaps cut off or with a byte of another value."""
    lines = draw(st.sampled_from(BUILT_IN)).splitlines()
    for _ in range(draw(st.integers(0, 4))):
        place = draw(st.integers(0, len(lines) - 1))
        match draw(st.sampled_from(["value", "line", "drop", "twice", "part"])):
            case "value":
                key, equals, _ = lines[place].partition(" = ")
                text = draw(st.one_of(ANYTHING, st.text(max_size=9)))
                quoted = draw(st.booleans())
                lines[place] = f'{key}{equals}"{text}"' if quoted else f"{key}{equals}{text}"
            case "line":
                lines.insert(place, draw(st.sampled_from(LINES)))
            case "drop":
                del lines[place]
            case "twice":
                lines.insert(place, lines[place])
            case "part":
                lines.insert(place, f"[{draw(st.sampled_from(list(TABLE))).split('.')[0]}]")
    data = bytearray("\n".join(lines).encode("utf-8", "surrogatepass"))
    if draw(st.integers(0, 9)) == 0:
        del data[draw(st.integers(0, len(data))) :]
    if data and draw(st.integers(0, 9)) == 0:
        data[draw(st.integers(0, len(data) - 1))] = draw(st.integers(0, 255))
    return bytes(data)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder to work in, with a loader file and two files that are none."""
    folder = tmp_path_factory.mktemp("bad")
    (folder / "my.toml").write_text(BUILT_IN[0], encoding="utf-8")
    (folder / "other.csv").write_text("time (s),force (lb)\n0,0\n1,5\n", encoding="utf-8")
    (folder / "folder").mkdir()
    return folder


@given(files())
@example(b"")
@example(b"\xff")
def test_random_loader_file_is_read_or_refused(place, data):
    path = place / "changed.toml"
    path.write_bytes(data)
    with contextlib.suppress(InputError):
        loader = ff.load(path)
        path.write_text(loader.to_toml(), encoding="utf-8")
        assert ff.load(path).name == loader.name


COMMANDS = {
    "new": ("x.toml", "--replace"),
    "simulate": ("my.toml", "--duration", "0.2"),
    "sweep": ("my.toml", "--runs", "4", "--duration", "0.2", "--replace"),
    "law": ("my.toml",),
    "excite": ("my.toml", "--fit", "k", "--time", "2", "--replace"),
    "resonance": ("my.toml", "--data", "other.csv"),
    "identify": ("my.toml", "--data", "other.csv", "--fit", "k", "--replace"),
}
"""Commands in a form that takes a tenth of a second; ``--out`` stays as it is."""

OPTIONS = {
    command: [
        option
        for option in command_line(listed=False)[command].assemble_argument_collection()
        if option.name.startswith("--") and option.name != "--out"
    ]
    for command in COMMANDS
}


@st.composite
def commands(draw):
    """A command, with one to three options that have any value."""
    name = draw(st.sampled_from(list(COMMANDS)))
    words = [name, *COMMANDS[name]]
    for option in draw(st.lists(st.sampled_from(OPTIONS[name]), min_size=1, max_size=3, unique_by=id)):
        words += [option.name] if option.hint is bool else [option.name, draw(ANYTHING)]
    return words


@given(commands())
@settings(max_examples=max(15, settings.default.max_examples // 2))
@example(["sweep", "my.toml", "--runs", "4", "--duration", "0.2", "--replace", "--seed", "3000000000"])
@example(["simulate", "my.toml", "--change", "1 s: feel.damping=200 lb in s/rad", "--fade-time", "5e-324"])
def test_random_arguments_succeed_or_are_refused(place, words):
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
    with pytest.MonkeyPatch.context() as patched, contextlib.chdir(place):
        patched.setattr(sys, "argv", ["forcefeel", *words])
        patched.setattr(sys, "stdout", out)
        patched.setattr(sys, "stderr", err)
        with pytest.raises(SystemExit) as ended:
            main()
    said = err.buffer.getvalue().decode()
    assert (ended.value.code or 0) in {0, 1, 2}, said
    assert (ended.value.code == 2) == bool(said), said
    assert len(said) <= LONGEST + len(os.fspath(place))
    assert said == visible(said)
