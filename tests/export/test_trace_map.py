"""The map of the exported C: every statement is in it, golden vectors run it, and its rows are those that change its numbers."""

import json
import re
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.export.c_code import c_files
from forcefeel.export.sections import SECTIONS
from forcefeel.export.trace_map import statements
from forcefeel.loader.parameters import table
from tests.export.toolchain import NONLINEAR, STRICT, motor, needs, run, valve, written
from tests.pages import OnDemand
from tests.parametrization import mostly_slow

LONGEST_NAME = 31
"""Significant characters of a name in C99 and rule 5.1 of MISRA C:2012."""

MISSED = 0.01
"""Share of a period's statements that golden vectors may miss: the rare branches that the map names."""

CHANGED = {
    "feel.detent_force": "2.1 lb",
    "feel.quadratic_damping": "51 lb in s^2/rad^2",
    "feel.soft_stop_damping": "2.1 lb in s/rad",
    "feel.velocity_limit": "61 deg/s",
    "feel.trim_rate": "2.1 deg/s",
}
"""Rows whose values nothing else has, and other values for them."""


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """One setting in single precision, and two settings in double, of which functions and tables are made."""
    made = {"roll": (motor, True), "pitch": (valve, False)}
    return OnDemand(lambda name: written(made[name][0](), tmp_path_factory.mktemp(name), single=made[name][1]))


def counted(code):
    """Statements of a file of functions: semicolons outside of parentheses, and heads of branches and loops."""
    bare = re.sub(r"/\*.*?\*/|typedef struct \{.*?\}", "", code, flags=re.DOTALL)
    bare = "\n".join(line for line in bare.splitlines() if not line.startswith("#"))
    count = braces = parentheses = 0
    for sign in bare:
        braces += (sign == "{") - (sign == "}")
        parentheses += (sign == "(") - (sign == ")")
        count += sign == ";" and braces > 0 and parentheses == 0
    return count + len(re.findall(r"\b(?:if|for) \(", bare))


def declared(code):
    """Names of numbers, flags and words."""
    return re.findall(r"\b(?:bool|uint32_t|\w+_real) (\w+)(?: =|;|\[)", code)


@pytest.mark.parametrize("name", mostly_slow(["roll", "pitch"]))
def test_every_statement_is_mapped_to_its_line(folders, name):
    code = (folders[name] / f"{name}_law.c").read_text(encoding="utf-8")
    document = json.loads((folders[name] / "trace.json").read_text(encoding="utf-8"))
    mapped = document["statements"]
    lines = code.splitlines()
    assert len(mapped) == counted(code) > 400
    rows = {*table(ff.loader.electric("elevator-electric").drive), *table(ff.digital_elevator().drive)}
    for statement in mapped:
        assert statement["code"].split()[0] in lines[statement["line"] - 1]
        assert statement["section"] in document["sections"]
        assert all(row in rows or row.startswith("law.") for row in statement["rows"])
    for section in document["sections"].values():
        assert all(section[key] for key in ("title", "equation", "source", "requirement", "test"))


@pytest.mark.parametrize("name", mostly_slow(["roll", "pitch"]))
def test_sources_are_the_files_that_ask_for_the_operations(folders, name):
    """Rest of the column and soft stops stand in files that the sections' own equations do not."""
    document = json.loads((folders[name] / "trace.json").read_text(encoding="utf-8"))
    sources = {key: [Path(file).name for file in of["source"]] for key, of in document["sections"].items()}
    assert all(Path(file).is_file() for of in document["sections"].values() for file in of["source"])
    assert {"contact_law.rs", "known_friction.rs", "control.rs"} <= set(sources["contact"])
    assert {"feel.rs", "feel_parts.rs", "contact.rs"} <= set(sources["feel"])
    assert sources["rest"] == ["observer.rs", "contact_law.rs"]
    assert "/* file:" not in (folders[name] / f"{name}_law.c").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", mostly_slow(["roll", "pitch"]))
def test_rows_of_the_feel_are_in_its_sections(folders, name):
    """Its own, and what the law does at its neutral and in contact; the observer knows the feel by the law's numbers alone."""
    document = json.loads((folders[name] / "trace.json").read_text(encoding="utf-8"))
    of_feel = [of for of in document["statements"] if any(row.startswith("feel.") for row in of["rows"])]
    assert len(of_feel) > 30
    assert {of["section"] for of in of_feel} <= {"feel", "feel_friction", "feel_stops", "trim", "neutral", "contact"}


@pytest.mark.parametrize("name", mostly_slow(["roll", "pitch"]))
def test_names_say_their_section_and_are_distinct_in_c99(folders, name):
    names = declared((folders[name] / f"{name}_law.c").read_text(encoding="utf-8"))
    assert len(names) > 300
    assert max(map(len, names)) <= LONGEST_NAME
    assert not [name for name in names if re.fullmatch(r"[a-z]\d+", name)]


@pytest.mark.parametrize("name", mostly_slow(["roll", "pitch"]))
def test_golden_vectors_run_the_statements_of_a_period(folders, name, tmp_path):
    """By gcov; what they miss is in sections whose rare branches the map names."""
    needs("gcc", "gcov")
    for file in (f"{name}_law.c", f"{name}_law.h", f"{name}_data.h", f"{name}_golden.h", f"{name}_test.c"):
        (tmp_path / file).write_bytes((folders[name] / file).read_bytes())
    run(tmp_path, "gcc", *STRICT, "--coverage", "-O0", "-o", "covered", f"{name}_law.c", f"{name}_test.c", "-lm")
    run(tmp_path, "./covered")
    run(tmp_path, "gcov", f"covered-{name}_law.gcda")
    lines = (tmp_path / f"{name}_law.c.gcov").read_text(encoding="utf-8").splitlines()
    missed = {int(line.split(":")[1]) for line in lines if line.split(":")[0].strip() in {"#####", "====="}}
    code = (folders[name] / f"{name}_law.c").read_text(encoding="utf-8")
    vectors = [statement for statement in statements(code) if "_test.c" in SECTIONS[statement.section].test]
    assert len(vectors) > 400
    rare = [statement for statement in vectors if statement.line in missed]
    assert len(rare) < MISSED * len(vectors)
    assert not [statement for statement in rare if not SECTIONS[statement.section].rare]


@pytest.mark.slow
def test_a_changed_row_changes_only_statements_that_name_it():
    loader = ff.digital_elevator().replace(NONLINEAR)
    law = ff.Law.of("robust", loader)

    def mapped(changes):
        exported = ff.export.Exported(loader.replace(changes), law, "law")
        return statements(str(c_files(exported, single=False)["law_law.c"]))

    before = mapped({})
    for row, value in CHANGED.items():
        pairs = list(zip(before, mapped({row: value}), strict=True))
        differing = [first for first, second in pairs if first.code != second.code]
        differing = [first for first in differing if "READY" not in first.code]
        assert differing, row
        assert all(row in statement.rows for statement in differing), (row, differing)


@pytest.mark.slow
def test_link_has_a_map_too(tmp_path):
    project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
    link = project.links["stick-pitch"]
    sides = tuple(
        ff.export.Exported(loader, ff.Law.of("robust", loader), name, linked=True)
        for name, loader in zip(("left", "right"), (project.loaders[axis] for axis in link.between), strict=True)
    )
    pair = ff.export.PairExport.of(project, link, "cockpit", sides)
    ff.export.write_pair(pair, tmp_path)
    code = (tmp_path / f"{pair.name}.c").read_text(encoding="utf-8")
    document = json.loads((tmp_path / "trace.json").read_text(encoding="utf-8"))
    assert len(document["statements"]) == counted(code)
    assert "link" in document["sections"]
