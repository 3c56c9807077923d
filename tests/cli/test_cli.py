"""The command line as a user types it: what is printed, what is written, the exit status."""

import json

import pytest

import forcefeel as ff
from forcefeel.laws.analog import recursion
from tests.command_line import imported, on_the_report_loader, runs

WHOLE = 0.5
"""lb in/rad: the report's reproduction prints the boundary as a whole number."""
FOUR_DIGITS = 5e-4
"""V/in: -6.342 is printed with four digits."""
READ_BACK = 1e-12
"""Relative: the weight is written with all its digits, so that the same numbers are solved. Measured: 0."""


command_line = runs(columns=100, lines=True)


@pytest.fixture
def run(command_line):
    """Runs ``forcefeel ...``, some commands on the report's loader where they name none."""

    def call(command, *words):
        on_report = command in ("analyze", "law", "design")
        return command_line(command, *(on_the_report_loader(words) if on_report else words))

    return call


UNSTABLE = {"feel.inertia": "0.6 lb in s^2/rad", "feel.damping": "3.04 lb in s/rad", "feel.stiffness": "96 lb in/rad"}


@pytest.fixture
def unstable_file(tmp_path):
    path = tmp_path / "unstable.toml"
    path.write_text(ff.elevator().replace(UNSTABLE).to_toml(), encoding="utf-8")
    return path


def test_help_loads_no_numerical_libraries():
    libraries = {"numpy", "scipy", "control", "pandas", "pint", "plotly"}
    assert imported("--help", libraries=libraries) == set()


def test_analyze_runs_without_python_control():
    """Which takes longer to import than the answer to compute."""
    libraries = {"control", "matplotlib", "pandas", "pint", "plotly", "xarray"}
    assert imported("analyze", libraries=libraries) == set()


@pytest.mark.parametrize("command", ["new", "design", "analyze", "law", "reproduce"])
def test_every_command_has_help_with_an_example(run, command):
    status, out, _ = run(command, "--help")
    assert status == 0
    assert "Example:" in out
    assert "--units" in out
    assert "--json" in out


@pytest.mark.parametrize("units", ["us", "si"])
def test_new_writes_a_file_that_loads(run, tmp_path, units):
    status, out, _ = run("new", "my.toml", "--units", units)
    assert (status, out) == (0, "wrote my.toml; next: forcefeel qualify my.toml, forcefeel law my.toml --law auto\n")
    assert ff.load(tmp_path / "my.toml")["linkage.stiffness"] == pytest.approx(ff.elevator()["linkage.stiffness"])


def test_new_does_not_overwrite_without_replace(run, tmp_path):
    (tmp_path / "my.toml").write_text("mine", encoding="utf-8")
    status, _, err = run("new", "my.toml")
    assert status == 2
    assert "my.toml: is there already" in err
    assert (tmp_path / "my.toml").read_text(encoding="utf-8") == "mine"
    assert run("new", "my.toml", "--replace")[0] == 0
    assert list(tmp_path.iterdir()) == [tmp_path / "my.toml"]


def test_new_in_missing_folder_is_refused(run):
    status, _, err = run("new", "nowhere/my.toml")
    assert status == 2
    assert "nowhere/my.toml: cannot be written" in err


def test_analyze_prints_the_results_of_the_report(run):
    status, out, _ = run("analyze")
    assert status == 0
    assert "11.52" in out  # Hz, the linkage's mode
    assert "3792" in out  # lb in/rad, smallest stable G


def test_analyze_prints_si_units(run):
    _, out, _ = run("analyze", "--units", "si")
    assert "428.4" in out  # N m/rad
    assert "N m/rad" in out


def test_analyze_prints_json(run):
    status, out, _ = run("analyze", "--json")
    found = json.loads(out)
    assert status == 0
    compliant = next(one for one in found["configurations"] if one["name"] == "compliant")
    assert compliant["boundary"]["stiffness"]["unit"] == "lb in/rad"
    assert compliant["boundary"]["stiffness"]["value"] == pytest.approx(3792, abs=WHOLE)


def test_unstable_loader_exits_1(run, unstable_file, tmp_path):
    assert run("analyze", unstable_file)[0] == 1
    status, out, _ = run("law", unstable_file)
    assert status == 1
    assert "unstable" in out
    status, out, _ = run("design", unstable_file, "--out", "report")
    assert status == 1
    assert "do not close this loop" in out
    assert (tmp_path / "report" / "report.html").exists()  # a bad answer is an answer


def test_law_prints_the_published_gains(run):
    status, out, _ = run("law")
    assert status == 0
    for printed in ("-4.929", "22.03", "0.6688", "0.5064", "-0.01828", "-0.006517"):
        assert printed in out
    assert "-1.94" in run("law", "--units", "si")[1]


def test_law_prints_converged_gains_and_takes_options(run):
    _, out, _ = run("law", "--converge", "--json")
    gains = {row["symbol"]: row for row in json.loads(out)["compensation"]["gains"]}
    assert gains["c_1"]["value"] == pytest.approx(-6.342, abs=FOUR_DIGITS)
    assert gains["c_1"]["unit"] == "V/in"
    smaller = json.loads(run("law", "--r2", "10", "--json")[1])["compensation"]["gains"][0]["value"]
    assert abs(smaller) < 4.9


@pytest.mark.slow
def test_gains_that_do_not_converge_exit_1(run, monkeypatch):
    monkeypatch.setattr(recursion, "MOST_STEPS", 1_000_000)
    status, out, _ = run("law", "--converge", "--r2", "1e4")
    assert status == 1
    assert "not converged after 1000000 steps" in " ".join(out.split())


def test_q_is_read_from_a_file(run, tmp_path):
    weight = ff.laws.published_settings(ff.elevator()).weight(ff.elevator())
    (tmp_path / "q.csv").write_text(
        "\n".join(",".join(repr(float(x)) for x in row) for row in weight), encoding="utf-8"
    )
    given, default = (
        json.loads(run("law", *words, "--json")[1])["compensation"]["gains"] for words in (["--q", "q.csv"], [])
    )
    assert [row["value"] for row in given] == pytest.approx([row["value"] for row in default], rel=READ_BACK)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--converge", "--horizon", "0.1"], "given both"),
        (["--tolerance", "1e-9"], "is for --converge"),
        (["--q", "missing.csv"], "expected [Q] as CSV, 7 rows of 7 numbers"),
        (["--q", "q.csv", "--r1", "1"], "gives [Q] whole"),
        (["--r2", "-1"], "r2: expected a number from 1e-12"),
        (["--step", "nan"], "step_s: expected a number from 1e-07"),
        (["--horizon", "1e6"], "horizon_s: expected at most 1000 s"),
        (["--horizon", "0"], "horizon_s: expected a number from 0.0001"),
    ],
)
def test_invalid_options_are_refused_in_one_line(run, words, said):
    status, out, err = run("law", *words)
    assert (status, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("command", ["analyze", "law", "design"])
def test_invalid_loader_file_is_named_and_nothing_is_written(run, tmp_path, command):
    text = ff.elevator().to_toml().replace('area = "2.36 in^2"', 'area = "2.36 lb"')
    (tmp_path / "bad.toml").write_text(text, encoding="utf-8")
    status, out, err = run(command, "bad.toml")
    assert (status, out) == (2, "")
    assert "bad.toml: actuator.area: expected" in err
    assert "2.36 lb" in err
    assert "Traceback" not in err
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


def test_output_folder_that_is_a_file_is_refused(run, tmp_path):
    (tmp_path / "report").write_text("mine", encoding="utf-8")
    status, _, err = run("design", "--out", "report")
    assert status == 2
    assert "report: is a file; expected a folder" in err
    assert (tmp_path / "report").read_text(encoding="utf-8") == "mine"


def test_loader_at_the_edge_of_its_range_is_analyzed(run, tmp_path):
    (tmp_path / "soft.toml").write_text(
        ff.elevator().to_toml().replace('stiffness = "9600 lb in/rad"', 'stiffness = "0.001 lb in/rad"'),
        encoding="utf-8",
    )
    assert run("analyze", "soft.toml")[0] == 0


def test_empty_q_is_refused_in_one_line(run, tmp_path):
    (tmp_path / "q.csv").touch()
    status, _, err = run("law", "--q", "q.csv")
    assert status == 2
    assert err.startswith("forcefeel: q.csv: expected [Q] as CSV")


def test_long_text_in_q_is_truncated_in_the_error(run, tmp_path):
    (tmp_path / "q.csv").write_text("x" * 10_000, encoding="utf-8")
    status, _, err = run("law", "--q", "q.csv")
    assert status == 2
    assert len(err) < 300


def test_unknown_commands_and_units_are_invalid_input(run):
    assert run("desing")[0] == 2
    assert run("analyze", "--units", "metric")[0] == 2


@pytest.mark.slow
def test_design_as_json_names_the_report(run, tmp_path):
    status, out, _ = run("design", "--out", "report", "--units", "si", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["report"] == "report/report.html"
    assert found["design"]["compensation"]["gains"][0]["unit"] == "V/cm"
    assert (tmp_path / "report" / "results.json").exists()


def test_reproduce_prints_one_table(run):
    status, out, _ = run("reproduce")
    assert status == 0
    assert "0 differ for no known reason" in " ".join(out.split())


def test_law_of_another_rate_is_refused_by_its_option(run, tmp_path):
    ff.Law.of("robust", ff.digital_elevator()).save(tmp_path / "fast.json")
    slow = ff.digital_elevator().replace({"controller.period": "1 ms", "controller.delay": "1 ms"})
    (tmp_path / "slow.toml").write_text(slow.to_toml(), encoding="utf-8")
    for command in ("simulate", "envelope", "qualify", "export --to c", "run"):
        status, _, err = run(*command.split(), "slow.toml", "--law", "fast.json", "--out", "out")
        assert status == 2
        assert err.startswith("forcefeel: --law: made for a controller.period of 0.5 ms, the loader has 1 ms"), command
        assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("words", ["law elevator-2khz", "envelope elevator-2khz", "frontier elevator-2khz"])
def test_grip_law_is_refused_without_grip_sensor(run, words):
    status, _, err = run(*words.split(), "--law", "grip", "--out", "out")
    assert status == 2
    assert "grip needs a force sensor at the grip, and elevator-2khz has none; give grip_sensor.gain" in err
    assert "compensator:" not in err
