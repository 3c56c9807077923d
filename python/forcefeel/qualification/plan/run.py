"""Run of a qualification."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

from forcefeel.errors import InputError, expect
from forcefeel.laws.law import Law, LawLike
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.axes import rule_axis, usual_axis
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.qualification import DEFAULT_EDITION, ForcePoints, Record, load_rules
from forcefeel.qualification.plan.bench import Task, TestBench
from forcefeel.qualification.plan.feel_alone import FeelAlone
from forcefeel.qualification.plan.input_records import InputRecord, Recognition, check_static, record_files
from forcefeel.qualification.plan.law_names import LAW_TEXTS, named_laws
from forcefeel.qualification.plan.motions import Motions, SimulatedLoader
from forcefeel.qualification.plan.plan import RuleTestCase, rule_plan, trials
from forcefeel.qualification.plan.result import Qualification, Result, Section
from forcefeel.qualification.release_verdicts import Overdamped
from forcefeel.qualification.rules import Axis
from forcefeel.qualification.throw import Throw
from forcefeel.tables.between import times_by_stem
from forcefeel.tables.column_names import ColumnNames
from forcefeel.units import ANGLE, PRESSURE, UnitSystem, show

Records = Sequence[str] | Mapping[str, Record]
"""Records as command-line arguments, ``NAME=FILE``, files or folders; or records in memory by test."""

References = Records | Mapping[str, Record | ForcePoints]
"""Likewise; the reference of the static test may be points of force over position."""


@dataclass(frozen=True)
class QualificationSetup:
    """Settings of a qualification.

    Attributes:
        laws: Names of ``law.NAMED_LAWS``, or laws by name, ``None`` for the original loop; one section each. Default: the
            original loop of a hydraulic loader, the robust law of an electric one.
        rule: Edition of the rule.
        axis: The control. Default: that of the built-in loader with this name, else pitch.
        throw_rad: Throw to either side, rad. Default: the stops of the loader or its feel, else ``throw.USUAL_RAD``.
        references: Recorded references. Default: the programmed feel. Points of force over position are one of the static test,
            and leave the programmed feel as the reference of the others.
        records: Records of a simulator, used instead of the simulated loader; laws are then ignored.
        tests: Keys of the requested tests, such as ``release-25-positive``. Default: the whole test plan.
        columns: Column names of the files, as command-line arguments: ``[STEM:]position=NAME``.
        units: Units of columns without a unit in the header: ``[STEM:]NAME=deg``.
        conditions: Flight condition of points among the references: ``NAME=VALUE``, such as ``q=60 lb/ft^2``.
        starts, ends: First and last time to read from the files: ``[STEM=]TIME``. Default: all.
        dynamic_pressure_pa: Dynamic pressure, for a feel whose stiffness depends on it.
        overdamped: Quantity compared where a response has no overshoot.
        system: Unit system; it also selects the rule's rounding of forces.
        simulator, operator: Tested simulator and tester, for the page.

    Example:
        >>> ff.qualification.QualificationSetup(laws=("original", "published")).rule
        'part60-a-2014'
    """

    laws: Sequence[str] | Mapping[str, LawLike] | None = None
    rule: str = DEFAULT_EDITION
    axis: Axis | None = None
    throw_rad: Annotated[float, ANGLE] | None = None
    references: References = ()
    records: Records = ()
    tests: Sequence[str] = ()
    columns: Sequence[str] = ()
    units: Sequence[str] = ()
    conditions: Sequence[str] = ()
    starts: Sequence[str] = ()
    ends: Sequence[str] = ()
    dynamic_pressure_pa: Annotated[float, PRESSURE] | None = None
    overdamped: Overdamped = "fall time"
    system: UnitSystem = field(default=UnitSystem.US)
    simulator: str = ""
    operator: str = ""


Progress = Callable[[str, int, int], None]
"""Called with the starting test, the number of completed tests, and the total."""


def qualify_loader(
    loader: Loader, setup: QualificationSetup | None = None, *, progress: Progress = lambda test, done, total: None
) -> Qualification:
    """Runs the tests of a rule on a loader, hands off: an arm at the grip is omitted.

    Args:
        loader: The loader; its programmed feel is the reference if none was recorded.
        setup: Laws, rule, axis, throw and records.
        progress: Called when a test begins.

    Returns:
        Every test with its verdicts. A simulated loader fails a test if it diverges, does not come to rest, or cannot be
        measured. A test without a record or a reference is not evaluated.

    Raises:
        InputError: If a part of the setup or a record is invalid, with the record and the time.

    Example:
        >>> setup = ff.qualification.QualificationSetup(laws=("robust",), tests=("release-25-positive",))
        >>> ff.qualify_loader(ff.digital_elevator(), setup).fulfilled
        True
    """
    check_loader(loader)
    if setup is not None:
        expect("setup", setup, QualificationSetup, "a QualificationSetup")
    setup = setup or QualificationSetup()
    rules = load_rules(setup.rule)
    axis = setup.axis or rule_axis(usual_axis(loader.name))
    planned = trials(rules, axis)
    test_plan = rule_plan(rules, axis, recorded=bool(setup.records), named=setup.tests)
    omitted = tuple(row for row in ARM_ROWS if loader[row] != 0)
    loader = loader.replace(dict.fromkeys(omitted))
    throw = Throw.of(loader, setup.throw_rad)
    references, records = _references_and_records(setup, Recognition(planned, rules, throw, tuple(setup.conditions)))
    feel = FeelAlone(loader)
    motions = Motions.of(loader, setup.dynamic_pressure_pa)
    moving = {key: it.record for key, it in references.items() if isinstance(it.record, Record)}
    points = next((it.record for it in references.values() if isinstance(it.record, ForcePoints)), None)
    task = Task(loader, feel, motions, rules, throw, moving, setup.system, setup.overdamped, points)
    laws: Mapping[str, Law] = {} if records else _laws(loader, setup)
    if records:
        moved = {key: it.record for key, it in records.items() if isinstance(it.record, Record)}
        benches = {"record": TestBench(task, "recorded simulator", None, moved)}
    else:
        benches = {
            name: TestBench(task, law_text(name), SimulatedLoader(loader, law), {}) for name, law in laws.items()
        }
    remarks = {name: law.made_for_another(loader) for name, law in laws.items()}
    sections, total = [], len(benches) * len(test_plan.made)
    for index, (name, bench) in enumerate(benches.items()):
        results: list[Result] = []
        for test in test_plan.made:
            progress(f"{name}, {test.key}", index * len(test_plan.made) + len(results), total)
            results.append(bench.result(test))
        sections.append(Section(name, bench.name, tuple(results), test_plan, remarks.get(name, "")))
    files = {
        f"{kind} {key}": record
        for kind, those in (("record", records), ("reference", references))
        for key, record in those.items()
    }
    return Qualification(
        loader,
        omitted,
        rules,
        axis,
        throw,
        setup.system,
        _reference_text(moving, points, feel),
        test_plan,
        tuple(sections),
        files,
        setup.simulator,
        setup.operator,
    )


def _reference_text(moving: Mapping[str, Record], points: ForcePoints | None, feel: FeelAlone) -> str:
    others = "recorded aircraft" if moving else feel.method
    return others if points is None else f"{len(points.force_n)} points of {points.name} at rest; in motion {others}"


def law_text(name: str) -> str:
    """Title of a law for sentences."""
    return LAW_TEXTS.get(name, f"law of {name}")


def _laws(loader: Loader, setup: QualificationSetup) -> Mapping[str, Law]:
    laws = setup.laws
    if isinstance(laws, str):
        raise InputError(f"laws: expected a list of names or laws by name, got {show(laws)}")
    if not isinstance(laws, Mapping):
        return named_laws(loader, laws)
    if not laws:
        raise InputError("laws: expected at least one")
    return {name: Law.of(law, loader, name=name) for name, law in laws.items()}


def _references_and_records(
    setup: QualificationSetup, recognition: Recognition
) -> tuple[dict[str, InputRecord], dict[str, InputRecord]]:
    """References and records by test."""
    both = {"reference": setup.references, "record": setup.records}
    files = {
        kind: record_files(f"--{kind}", those, recognition.planned)
        for kind, those in both.items()
        if not isinstance(those, Mapping)
    }
    stems = list(dict.fromkeys(path.stem for named in files.values() for _, path in named))
    names = ColumnNames.of(setup.columns, setup.units, stems)
    times = times_by_stem(setup.starts, setup.ends, stems)
    references, records = (
        _in_memory(kind, those, recognition.planned)
        if isinstance(those, Mapping)
        else recognition.read(f"--{kind}", files[kind], names, times)
        for kind, those in both.items()
    )
    return references, records


def _in_memory(
    kind: str, those: Mapping[str, Record | ForcePoints], planned: Sequence[RuleTestCase]
) -> dict[str, InputRecord]:
    for key, record in those.items():
        if isinstance(record, ForcePoints):
            check_static(record, key)
    keys = [trial.key for trial in planned]
    if strangers := [key for key in those if key not in keys]:
        raise InputError(f"{kind}s: unknown test {show(strangers[0])}; expected some of {', '.join(keys)}")
    return {key: InputRecord(record) for key, record in those.items()}
