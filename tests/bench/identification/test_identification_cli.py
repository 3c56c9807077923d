"""``forcefeel identify`` and ``forcefeel resonance`` as a user types them, and the folder that the first writes."""

import json
import re
from pathlib import Path

import control
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.identification import fit
from forcefeel.bench.identification.page.page import LOADER, PAGE, RESULTS
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.response_file import read_response
from forcefeel.bench.responses import Response
from forcefeel.cli.resonance import read_band
from forcefeel.errors import InputError
from forcefeel.linear.models import Linkage
from forcefeel.linear.state_space import servo
from forcefeel.tables.column_names import by_stem, names_by_stem
from tests.command_line import runner
from tests.identifications import bounded, determined, secrets_in, undetermined
from tests.pages import words

NOISE = 0.01
TEN_DIGITS = 1e-9
"""Relative: a loader file has ten significant digits."""
NINE_DIGITS = 1e-8
"""Relative: records are written with nine here."""
SIX_DIGITS = 5e-6
"""Relative: the report's numbers have six, and so has its pi. Measured: 2e-6."""
CIRCLE, CIRCLE_DAMPING = 1e-4, 1e-3
"""Relative, of a mode without noise whose lines are 0.25 Hz apart, its half-power points 1 Hz. Measured: 2e-6, 8e-5."""
"""Relative, of gain and phase of each line."""

TRUTH = {"linkage.stiffness": 1.08, "linkage.damping": 0.93, "column.inertia": 0.94}
"""The bench over the elevator's file."""


def bench_response(path: Path) -> None:
    """Potentiometer over test signal of a bench that is off its file, by python-control from the servo's state space."""
    file = ff.elevator()
    bench = file.replace({key: factor * file[key] for key, factor in TRUTH.items()}, si=True)
    frequency = np.geomspace(0.5, 40, 60)
    model = servo(bench, Linkage.COMPLIANT, closed=True)
    response = control.frequency_response(model, 2 * np.pi * frequency)
    column = list(model.output_labels).index("column_angle_rad")
    random = np.random.default_rng(21)
    value = np.asarray(response.frdata)[column, 0] * np.exp(
        NOISE * (random.standard_normal(60) + 1j * random.standard_normal(60))
    )
    lines = [
        f"{f:.9g},{20 * np.log10(abs(g)):.9g},{np.degrees(np.angle(g)):.9g},{NOISE}"
        for f, g in zip(frequency, value, strict=True)
    ]
    head = ["# from: test_signal (V)", "# to: column_angle (rad)", "frequency (Hz),gain (dB),phase (deg),deviation"]
    path.write_text("\n".join([*head, *lines]) + "\n")


@pytest.fixture
def identify(monkeypatch, capsys, tmp_path):
    """Runs ``forcefeel identify ...`` in a folder with a bench's response."""
    bench_response(tmp_path / "closed.csv")
    (tmp_path / "my.toml").write_text(ff.elevator().to_toml())
    return runner(monkeypatch, capsys, tmp_path, "identify")


@pytest.fixture
def resonance(monkeypatch, capsys, tmp_path):
    bench_response(tmp_path / "closed.csv")
    return runner(monkeypatch, capsys, tmp_path, "resonance")


@pytest.fixture
def found(monkeypatch):
    """Sets what the fit finds; gives what it was asked."""
    asked = {}

    def set_to(result):
        def pretend(loader, data, fit, **options):
            asked.update(loader=loader, data=data, fit=fit, **options)
            return result

        monkeypatch.setattr(fit, "identify", pretend)
        return asked

    return set_to


GOOD = ("my.toml", "--data", "closed.csv", "--experiment", "servo-closed", "--fit", "k,c,J")


def test_identify_fits_a_loader_to_a_response(identify, tmp_path):
    status, out, err = identify(*GOOD, "--starts", "2", "--out", "found")
    assert (status, err) == (0, "")
    assert "All 3 parameters are determined" in out
    assert {one.name for one in (tmp_path / "found").iterdir()} == {PAGE, RESULTS, LOADER, "plotly.min.js"}
    results = json.loads((tmp_path / "found" / RESULTS).read_text(encoding="utf-8"))
    file, after = ff.elevator(), ff.load(tmp_path / "found" / LOADER)
    for one in results["parameters"]:
        truth = TRUTH[one["parameter"]] * one["file"]["value"]
        # Four standard errors: 6e-5 for normal noise, and the seed is fixed.
        assert abs(one["estimate"]["value"] - truth) < 4 * one["standard_error"]["value"]
        assert one["standard_error"]["value"] < 0.03 * truth
        assert after[one["parameter"]] / file[one["parameter"]] == pytest.approx(
            one["estimate"]["value"] / one["file"]["value"], rel=TEN_DIGITS
        )
    assert re.search(r"k linkage\.stiffness +│ +6108", out)
    assert "loader file: found/loader.toml" in out


def test_input_loader_file_is_unchanged(identify, tmp_path, found):
    before = (tmp_path / "my.toml").read_bytes()
    asked = found(determined())
    assert identify(*GOOD)[0] == 0
    assert (tmp_path / "my.toml").read_bytes() == before
    assert asked["loader"] == ff.load(tmp_path / "my.toml")


def test_output_folder_with_the_input_loader_is_refused(identify, tmp_path, found):
    found(determined())
    folder = tmp_path / "found"
    folder.mkdir()
    (folder / LOADER).write_text(ff.elevator().to_toml())
    before = (folder / LOADER).read_bytes()
    for replace in ((), ("--replace",)):
        status, out, err = identify("found/loader.toml", *GOOD[1:], "--out", "found", *replace)
        assert (status, out) == (2, "")
        assert "is what the identification is made from, and stays as it is" in err
    assert (folder / LOADER).read_bytes() == before
    assert [one.name for one in folder.iterdir()] == [LOADER]


@pytest.mark.slow
def test_existing_identification_is_replaced_only_with_replace(identify, tmp_path, found):
    found(determined())
    identify(*GOOD)
    folder = tmp_path / "forcefeel-identified"
    before = (folder / RESULTS).read_bytes()
    status, _, err = identify(*GOOD, "--loss", "linear")
    assert status == 2
    assert "--replace" in err
    assert (folder / RESULTS).read_bytes() == before
    assert identify(*GOOD, "--loss", "linear", "--replace")[0] == 0
    assert json.loads((folder / RESULTS).read_text())["settings"]["loss"] == "linear"


def test_undetermined_parameter_writes_no_loader(identify, tmp_path, found):
    found(determined())
    identify(*GOOD)
    folder = tmp_path / "forcefeel-identified"
    assert (folder / LOADER).is_file()
    found(undetermined())
    status, out, err = identify(*GOOD, "--replace")
    assert (status, err) == (1, "")
    # One of an earlier identification would be taken for the answer.
    assert not (folder / LOADER).exists()
    results = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    assert not results["determined"]
    flat = " ".join(out.split())
    assert "2 of 3 parameters are not determined by these data" in flat
    assert "only their product C_i K_2 is determined" in flat
    assert "Measure the response from test_signal to valve_current" in flat
    assert "not determined" in out
    assert "loader:" not in out
    assert secrets_in(out) == []
    assert secrets_in(" ".join(words(folder / PAGE).words)) == []


def test_product_only_fit_exits_1_without_loader(identify, tmp_path):
    status, out, _ = identify(*GOOD[:-1], "C_i,K_2", "--starts", "1", "--set", "linkage.stiffness=6596 lb/in")
    assert status == 1
    assert "only their product" in " ".join(out.split())
    assert not (tmp_path / "forcefeel-identified" / LOADER).exists()


def test_json_matches_the_output_folder(identify, tmp_path, found):
    found(determined())
    status, out, err = identify(*GOOD, "--json", "--units", "si", "--no-priors", "--starts", "3")
    assert (status, err) == (0, "")
    printed = json.loads(out)
    stored = json.loads((tmp_path / "forcefeel-identified" / RESULTS).read_text(encoding="utf-8"))
    assert printed.pop("page").endswith(PAGE)
    assert printed.pop("loader_file").endswith(LOADER)
    assert printed == stored
    assert stored["units"] == "si"
    assert stored["settings"]["priors"] is False
    assert stored["parameters"][0]["estimate"]["unit"] == "N/cm"


def test_options_reach_the_fit(identify, found):
    asked = found(determined())
    words = ("--starts", "7", "--loss", "cauchy", "--responses", "--no-priors", "--set", "column.grip_arm=30 in")
    assert identify(*GOOD, *words)[0] == 0
    assert (asked["fit"], asked["starts"], asked["loss"]) == ("k,c,J", 7, "cauchy")
    assert (asked["as_responses"], asked["priors"], asked["law"]) == (True, False, None)
    # 30 in are 0.762 m.
    assert asked["loader"]["column.grip_arm"] == pytest.approx(0.762)
    (data,) = asked["data"]
    assert (data.experiment, data.input, data.output) == (Experiment(Loop.SERVO_CLOSED), "test_signal", "column_angle")


def test_law_requires_data_of_the_whole_loader(identify, found, tmp_path):
    asked = found(determined())
    status, out, err = identify(*GOOD, "--law", "published")
    assert (status, out) == (2, "")
    assert "all data are of the servo alone" in err
    assert identify(*GOOD, "--law", "original")[0] == 0
    assert asked["law"] is None
    other = [word.replace("servo-closed", "loader test_signal") for word in GOOD]
    assert identify(*other, "--law", "published", "--replace")[0] == 0
    assert isinstance(asked["law"].numbers.law, ff.laws.GainLaw)
    results = json.loads((tmp_path / "forcefeel-identified" / RESULTS).read_text())
    assert results["settings"]["law"] == "published"


def test_responses_of_records_are_written(identify, found, tmp_path):
    """The fit gives responses that were not among the data: they were estimated."""
    found(determined())
    assert identify(*GOOD)[0] == 0
    (file,) = (tmp_path / "forcefeel-identified" / "responses").iterdir()
    # The hand-made result stands on a response of its own.
    assert file.name == "closed.csv"
    assert file.read_text().startswith("# experiment: servo-closed test_signal\n# from: test_signal (V)\n")
    page = (tmp_path / "forcefeel-identified" / PAGE).read_text(encoding="utf-8")
    assert 'href="responses/closed.csv"' in page


@pytest.mark.slow
def test_record_is_identified_through_its_response(identify, tmp_path):
    """A bench under a multisine, by python-control from the servo's state space, drive straight between samples."""
    file = ff.elevator()
    bench = file.replace({key: factor * file[key] for key, factor in TRUTH.items()}, si=True)
    model = servo(bench, Linkage.COMPLIANT, closed=True)
    wave = ff.simulation.Multisine(2.0, tuple(np.arange(1, 61) / 2), 2.0, seed=3).sample(12.0, 0.002).start
    drive = np.concatenate([np.zeros(100), wave])
    time = np.arange(len(drive)) * 0.002
    column = list(model.output_labels).index("column_angle_rad")
    angle = control.forced_response(model, time, drive).outputs[column]
    angle += 1e-3 * angle.std() * np.random.default_rng(4).standard_normal(len(angle))
    rows = "\n".join(f"{t:.6g},{u:.9g},{y:.9g}" for t, u, y in zip(time, drive, angle, strict=True))
    (tmp_path / "run.csv").write_text(
        f"# experiment: servo-closed\ntime (s),test_signal (V),column_angle (rad)\n{rows}\n"
    )
    status, _, err = identify("elevator-1974", "--data", "run.csv", "--fit", "k,c,J", "--responses", "--starts", "1")
    assert (status, err) == (0, "")
    folder = tmp_path / "forcefeel-identified"
    results = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    for one in results["parameters"]:
        truth = TRUTH[one["parameter"]] * one["file"]["value"]
        # Four standard errors, as above.
        assert abs(one["estimate"]["value"] - truth) < 4 * one["standard_error"]["value"] < 0.002 * truth
    (written,) = (folder / "responses").iterdir()
    assert written.name == "run-test_signal-to-column_angle.csv"
    response = read_response(written)
    measured = control.frequency_response(model, 2 * np.pi * response.frequency_hz).frdata[column, 0]
    # Of 60 lines with two parts each; few periods make the deviations themselves uncertain.
    assert (np.abs(response.value / measured - 1) < 6 * response.deviation).all()
    assert results["data"][0]["kind"] == "frequency response"


def test_options_replace_the_headers_of_a_record(identify, found, tmp_path):
    asked = found(determined())
    time = np.arange(400) / 200
    angle = 10 * np.exp(-2 * time) * np.cos(9 * time)
    angle[time < 0.5] = 10
    angle[time >= 0.5] = (10 * np.exp(-2 * (time - 0.5)) * np.cos(9 * (time - 0.5)))[time >= 0.5]
    rows = "\n".join(f"{t:.6g},{value:.9g}" for t, value in zip(time, angle, strict=True))
    (tmp_path / "let-go.csv").write_text(f"time (s),theta\n{rows}\n")
    status, _, err = identify(
        "my.toml", "--data", "closed.csv", "--data", "let-go.csv", "--fit", "k",
        "--experiment", "closed=servo-closed", "--experiment", "let-go=release",
        "--column", "let-go:column_angle=theta", "--unit", "let-go:theta=deg", "--hold", "let-go=staircase",
    )  # fmt: skip
    assert (status, err) == (0, "")
    response, record = asked["data"]
    assert isinstance(response, Response)
    assert isinstance(record, BenchRecord)
    assert record.experiment == Experiment(Loop.LOADER, Drive.RELEASE)
    assert record.hold == "staircase"
    np.testing.assert_allclose(record.channels["column_angle"], np.radians(angle), rtol=NINE_DIGITS)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--data"),
        (("my.toml", "--data", "closed.csv"), "--fit"),
        (("my.toml", "--data", "none.csv", "--fit", "k"), "none.csv"),
        (("none.toml", *GOOD[1:]), "none.toml"),
        ((*GOOD[:-1], "stiffness_of_link"), "unknown parameter"),
        ((*GOOD[:-1], "k,k"), "stands twice"),
        ((*GOOD[:-1], " , "), "got none"),
        (("my.toml", "--data", "closed.csv", "--fit", "k"), "experiment"),
        ((*GOOD, "--experiment", "closed=servo-open", "--experiment", "closed=servo-open"), "given twice"),
        ((*GOOD, "--experiment", "open=servo-open"), "'open' matches no file"),
        ((*GOOD, "--hold", "bent"), "straight or staircase"),
        ((*GOOD, "--column", "column_angle"), "--column: expected a name and what it stands for"),
        ((*GOOD, "--data", "closed.csv"), "give each file once"),
        ((*GOOD, "--input-channel", "load_pressure (Pa)"), "leave one of them out"),
        ((*GOOD, "--starts", "0"), "starts"),
        ((*GOOD, "--loss", "square"), "loss"),
        ((*GOOD, "--set", "linkage.stiffness=7000"), "has no unit"),
        ((*GOOD, "--out", "closed.csv"), "is a file; expected a folder"),
    ],
)
def test_invalid_input_exits_2_with_remedy(identify, tmp_path, words, message):
    status, out, err = identify(*words)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert not (tmp_path / "forcefeel-identified").exists()


CLOSED = ("my.toml", "--data", "closed.csv", "--fit", "k")
RUN = ("my.toml", "--data", "run.csv", "--fit", "k")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (CLOSED, "or by --experiment"),
        ((*CLOSED, "--experiment", "servo"), "closed.csv: --experiment: expected servo-open"),
        ((*GOOD, "--output-channel", "load_pressure (Pa)"), "'to' and --output-channel contradict each other"),
        ((*GOOD, "--output-channel", "theta"), "--output-channel: unknown channel 'theta'"),
        ((*GOOD, "--input-channel", "theta"), "--input-channel: unknown channel 'theta'"),
        ((*GOOD, "--unit", "theta=deg"), "--unit: unknown name 'theta'"),
        ((*GOOD, "--unit", "phase=rad"), "the header says 'deg', --unit 'rad'"),
        ((*GOOD, "--hold", "straight"), "to which --hold does not apply"),
        (
            (*GOOD, "--column", "column_angle=theta"),
            "closed.csv: --column: unknown name 'column_angle'; the names are frequency, gain",
        ),
        ((*RUN, "--experiment", "release"), "states servo-closed test_signal, but --experiment is"),
        ((*RUN, "--hold", "straight"), "states 'hold: staircase', but --hold is 'straight'"),
        ((*RUN, "--input-channel", "test_signal"), "to which --input-channel does not apply"),
        ((*GOOD, "--from", "1 s"), "is a frequency response, to which --from and --until does not apply"),
        ((*RUN, "--from", "soon"), "--from: "),
        (
            (*RUN, "--column", "column_angle=theta", "--unit", "theta=deg", "--from", "2 s", "--until", "1 s"),
            "--from and --until: expected a time and a later one",
        ),
        ((*RUN, "--column", "angle=theta"), "--column: unknown name 'angle'"),
        (RUN, "name the file's own columns by --column"),
        ((*RUN, "--column", "column_angle=theta"), "add it to the header or by --unit"),
        (
            (*RUN, "--column", "column_angle=theta", "--unit", "theta=deg"),
            "run.csv: time: has a median step of 2 s; expected 10 microseconds to 0.2 s; is the time in ms? Say so in the "
            "header, 'time (ms)', or where it has no unit by --unit (time=ms)",
        ),
    ],
)
def test_data_messages_name_options(identify, tmp_path, words, message):
    rows = "\n".join(f"{2 * i},{np.sin(i / 9):.6f},{np.cos(i / 9):.6f}" for i in range(200))
    top = "# experiment: servo-closed\n# hold: staircase\ntime (s),test_signal (V),theta\n"
    (tmp_path / "run.csv").write_text(top + rows)
    status, out, err = identify(*words)
    assert (status, out) == (2, "")
    assert message in err
    assert "argument" not in err


def test_interrupted_run_writes_nothing(identify, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(fit, "identify", interrupted)
    status, _, err = identify(*GOOD)
    assert status == 130
    assert "nothing is written" in err
    assert not (tmp_path / "forcefeel-identified").exists()


def test_data_in_the_output_folder_are_kept(identify, tmp_path, found):
    """A response that an earlier run estimated is given again, and would be estimated under the same name."""
    found(determined())
    folder = tmp_path / "forcefeel-identified" / "responses"
    folder.mkdir(parents=True)
    (tmp_path / "closed.csv").rename(folder / "closed.csv")
    before = (folder / "closed.csv").read_bytes()
    words = ("my.toml", "--data", folder / "closed.csv", *GOOD[3:], "--replace")
    status, _, err = identify(*words)
    assert status == 2
    assert "stays as it is" in err
    assert (folder / "closed.csv").read_bytes() == before


def test_console_numbers_are_rounded(identify, found):
    found(bounded())
    _, out, _ = identify(*GOOD)
    assert not re.search(r"\d\.\d{6}", out)
    assert "5375 │ " in out
    assert "at its bound" in out


STEMS = ["closed", "release.1"]


def test_per_file_option_overrides_general_option():
    assert by_stem("--experiment", ["servo-open", "release.1=release"], STEMS) == {
        "closed": "servo-open",
        "release.1": "release",
    }
    assert by_stem("--experiment", None, STEMS) == {}
    assert by_stem("--output-channel", ["closed=column_angle (deg)"], STEMS) == {"closed": "column_angle (deg)"}
    assert names_by_stem("--unit", ["theta=deg", "closed:theta=rad", "release.1:CH1:x=lb"], STEMS) == {
        "closed": {"theta": "rad"},
        "release.1": {"theta": "deg", "CH1:x": "lb"},
    }
    assert names_by_stem("--column", None, STEMS) == {}


@pytest.mark.parametrize(
    ("reader", "given"),
    [
        (by_stem, ["servo-open", "servo-closed"]),
        (by_stem, ["opened=servo-open"]),
        (by_stem, ["closed="]),
        (names_by_stem, ["theta"]),
        (names_by_stem, ["theta="]),
        (names_by_stem, ["theta=deg", "theta=rad"]),
        (names_by_stem, ["opened:theta=deg"]),
    ],
)
def test_unknown_file_or_duplicate_option_raises_input_error(reader, given):
    with pytest.raises(InputError, match=r"^--option: "):
        reader("--option", given, STEMS)


# ----- resonance

BENCH = ("elevator-1974", "--data", "closed.csv", "--experiment", "servo-closed")


def test_resonance_gives_link_values(resonance):
    status, out, err = resonance(*BENCH, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    loader = ff.elevator()
    for method in ("half_power", "circle"):
        reading = found[method]
        w, zeta = 2 * np.pi * reading["frequency"]["value"], reading["damping_ratio"]
        # A column of inertia J on a link at R_b / alpha... the report's 12 Hz and 0.1 give 6107.86 lb/in and 16.2016 lb s/in,
        # k goes with w^2 and c with zeta w.
        k = 6107.86 * (w / (2 * np.pi * 12)) ** 2
        c = 16.2016 * (zeta / 0.1) * w / (2 * np.pi * 12)
        assert reading["linkage.stiffness"]["value"] == pytest.approx(k, rel=SIX_DIGITS)
        assert reading["linkage.damping"]["value"] == pytest.approx(c, rel=SIX_DIGITS)
        assert reading["linkage.stiffness"]["unit"] == "lb/in"
    assert set(found["loader_file"]) == {"resonance_frequency", "resonance_damping_ratio"}
    assert loader["linkage.stiffness"] > 0


def test_printed_lines_are_accepted_by_the_loader_file(resonance, tmp_path):
    status, out, _ = resonance(*BENCH)
    assert status == 0
    lines = [line for line in out.splitlines() if line.startswith("resonance_")]
    assert len(lines) == 2
    text = ff.elevator().to_toml()
    text = re.sub(r"^stiffness = .*$", lines[0], text, count=1, flags=re.MULTILINE)
    text = re.sub(r"^damping = .*$", lines[1], text, count=1, flags=re.MULTILINE)
    text = re.sub(r"^linkage\.(stiffness|damping) = .*$", "", text, flags=re.MULTILINE)
    (tmp_path / "new.toml").write_text(text)
    loader = ff.load(tmp_path / "new.toml")
    frequency = float(re.search(r'"([\d.]+) Hz"', lines[0])[1])
    # 6107.86 lb/in at 12 Hz are 1069650 N/m.
    assert loader["linkage.stiffness"] == pytest.approx(1069650 * (frequency / 12) ** 2, rel=SIX_DIGITS)
    assert "forcefeel identify fits the whole servo" in " ".join(out.split())


def test_response_without_resonance_exits_1(resonance):
    status, out, err = resonance(*BENCH, "--band", "20..40 Hz")
    assert (status, err) == (1, "")
    assert "No resonance can be read off closed" in out
    assert "resonance_frequency" not in out
    status, out, _ = resonance(*BENCH, "--band", "20..40 Hz", "--json")
    assert status == 1
    found = json.loads(out)
    assert found["loader_file"] is None
    assert found["circle"]["frequency"] is None


def test_record_is_converted_to_a_response(resonance, tmp_path):
    """A mode of 5 Hz and damping ratio 0.1 driven by a multisine that repeats every 4 s, computed line by line."""
    lines = np.arange(4, 41) / 4
    time = np.arange(0, 16, 0.005)
    phase = np.random.default_rng(2).uniform(0, 2 * np.pi, len(lines))
    s = 2j * np.pi * lines
    gain = 0.02 * (10 * np.pi) ** 2 / (s**2 + 2 * 0.1 * 10 * np.pi * s + (10 * np.pi) ** 2)
    turning = np.exp(1j * (2 * np.pi * np.outer(time, lines) + phase))
    drive, angle = turning.real.sum(axis=1), (turning * gain).real.sum(axis=1)
    rest = np.minimum(time / 2, 1)  # it begins at rest
    rows = "\n".join(f"{t:.6g},{u:.9g},{y:.9g}" for t, u, y in zip(time, rest * drive, rest * angle, strict=True))
    head = "# experiment: servo-closed\ntime (s),test_signal (V),column_angle (rad)"
    (tmp_path / "sweep.csv").write_text(f"{head}\n{rows}\n")
    status, out, err = resonance("elevator-1974", "--data", "sweep.csv", "--json", "--band", "2 Hz..9 Hz")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["output"] == "column_angle"
    assert found["circle"]["frequency"]["value"] == pytest.approx(5.0, rel=CIRCLE)
    assert found["circle"]["damping_ratio"] == pytest.approx(0.1, rel=CIRCLE_DAMPING)
    assert resonance("elevator-1974", "--data", "sweep.csv", "--channel", "load_pressure")[0] == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--data"),
        ((*BENCH, "--band", "10 Hz"), "two rising frequencies"),
        ((*BENCH, "--band", "16..8 Hz"), "two rising frequencies"),
        ((*BENCH, "--band", "8..16"), "has no unit"),
        ((*BENCH, "--band", "8..8.1 Hz"), "widen the band"),
        ((*BENCH, "--channel", "column_angle"), "is for a record"),
        (("elevator-1974", "--data", "none.csv"), "none.csv"),
    ],
)
def test_invalid_resonance_input_exits_2(resonance, words, message):
    status, out, err = resonance(*words)
    assert (status, out) == (2, "")
    assert message in err


@pytest.mark.parametrize(
    "text", ["8..16 Hz", "8Hz..16Hz", "8 Hz .. 16 Hz", "8000 mHz..0.016 kHz", "50.26548 rad/s..16 Hz"]
)
def test_frequency_bands_are_parsed(text):
    assert read_band(text) == pytest.approx((8.0, 16.0), rel=1e-6)  # as 8 Hz is written in rad/s
