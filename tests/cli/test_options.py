"""Options are spelled once: wings take them by name, pages print them."""

from dataclasses import MISSING, fields
from importlib import import_module
from pathlib import Path
from shlex import split

import pytest
from cyclopts import App

from forcefeel.bench.excitation import ExcitationPlan
from forcefeel.bench.identification.as_json import FitSettings
from forcefeel.cli.app import command_line
from forcefeel.cli.excite import ExciteOptions
from forcefeel.cli.identify import IdentifyOptions
from forcefeel.cli.options import named_options
from forcefeel.cli.qualify import QualifyOptions
from forcefeel.cli.recursion_options import RecursionOptions
from forcefeel.laws import DesignSettings
from forcefeel.qualification import QualificationSetup

TAKEN = {
    (QualifyOptions, QualificationSetup): {"rule", "axis", "overdamped", "tests", "references", "records", "columns"},
    (ExciteOptions, ExcitationPlan): {"signal", "time_s", "rate_hz", "from_hz", "to_hz"},
    (IdentifyOptions, FitSettings): {"loss", "starts", "as_responses"},
}


@pytest.mark.parametrize(("options", "setup"), TAKEN)
def test_cli_option_defaults_match_the_library(options, setup):
    theirs = {field.name: field.default for field in fields(setup)}
    ours = {field.name: field.default for field in fields(options) if field.name in TAKEN[options, setup]}
    assert ours == {name: theirs[name] for name in TAKEN[options, setup]}


def test_recursion_options_match_its_settings():
    other = {"converge", "pilot_coupling"}
    assert {field.name for field in fields(RecursionOptions)} - other < {field.name for field in fields(DesignSettings)}


def _read(app: App, words: str):
    """The options that a command line gives, and its loader."""
    _, bound, _ = app.parse_args(split(words)[1:], print_error=False, exit_on_error=False)
    return bound.arguments["options"], bound.arguments.get("path")


@pytest.mark.parametrize(
    "words",
    [
        "forcefeel qualify 'a b.toml' --units si --set 'feel.breakout=1 lb' --set valve.orifice=true --test static --test fast "
        "--axis roll --overdamped rise-time --record fast=x.csv --column position=theta --law robust --law 'my law.json'",
        "forcefeel identify --experiment servo-open --input-channel 'test_signal (V)' --from '6 s' --until b=7 "
        "--data a.csv --data b.mat --fit k,c --starts 2 --loss soft-l1 --no-priors --responses",
        "forcefeel law elevator-2khz --horizon 0.1 --r2 0.5 --pilot-coupling column",
        "forcefeel simulate --input release --angle='-10 deg' --seed 3",
    ],
)
def test_options_round_trip_through_the_command_line(words):
    """And what is left out is what has no say in the result."""
    app = command_line(listed=False)
    given, path = _read(app, words)
    again = given.command_line(path)
    assert _read(app, again) == (given, path)
    assert _read(app, f"{words} --replace --out elsewhere --json") != (given, path)
    more, _ = _read(app, f"{words} --replace --out elsewhere --json")
    assert more.command_line(path) == again


def test_every_option_has_help_and_a_default_or_is_required():
    for name in ("design", "sweep", "envelope", "frontier", "schedule", "excite", "resonance", "size"):
        kind = vars(import_module(f"forcefeel.cli.{name}"))[f"{name.capitalize()}Options"]
        needed = [option for field, option, _ in named_options(kind) if field.default is MISSING]
        assert set(needed) <= {"--knots", "--data", "--fit"}, name
    assert (
        IdentifyOptions(data=(Path("x.csv"),), fit="k").command_line(None) == "forcefeel identify --data x.csv --fit k"
    )


def test_option_without_its_value_is_named(forcefeel):
    """The option behind it would be taken for the value, and that one's value for an argument."""
    for words in (("export", "--to", "c", "--tunable", "--out", "x"), ("simulate", "--set", "--json", "x")):
        status, _, told = forcefeel(words[0], "elevator-2khz", *words[1:])
        assert status == 2
        assert f"{words[-3]}: expected a value; forcefeel {words[0]} --help lists the options" in told
    status, _, told = forcefeel("simulate", "elevator-2khz", "elevator", "2")
    assert status == 2
    assert "one argument too many" in told
