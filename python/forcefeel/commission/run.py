"""Commissioning of a loader step by step, with a folder for each step."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from forcefeel.bench.identification.result import Identification
from forcefeel.bench.record_csv import record_csv
from forcefeel.bench.record_file import read_bench_record
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.choice.rule import Choice
from forcefeel.choice.score import LawScores
from forcefeel.commission.envelope_step import check_law
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.law_for import choose_law
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.qualification_step import run_tests
from forcefeel.commission.result import Commission, EnvelopeResult, Identified, LawChosen, RuleTests
from forcefeel.commission.simulated_bench import BenchTime, simulated_records
from forcefeel.commission.steps import BENCH, ENVELOPE, IDENTIFICATION, LAW, STEPS, TESTS, State, digest
from forcefeel.envelope.result import Envelope
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError
from forcefeel.files import Kind, input_kind, make_folder, output_kind, write_whole
from forcefeel.laws.law import Law
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import Loader, check_loader, load
from forcefeel.qualification.plan.result import Qualification
from forcefeel.units import UnitSystem

LOADER, LAW_FILE_NAME = "loader.toml", "law.json"
"""Files of the first and second step, inputs of the next ones."""

RECORD = "bench.csv"

Progress = Callable[[str, str], None]
"""Called with a step and its current task."""


def _nothing(*_: object) -> None:
    """Writes nothing."""


@dataclass(frozen=True)
class StepWriters:
    """Writers of the result of each step into its folder; default, none.

    Attributes:
        identification: The last fit.
        law: The scores of the laws, and the choice among them.
        envelope: The envelope of the law.
        tests: The qualification under the law.

    Example:
        >>> writers = ff.commission.StepWriters(envelope=lambda envelope, folder: print(folder.name))
        >>> writers.tests is ff.commission.StepWriters().tests
        True
    """

    identification: Callable[[Identification, Path], object] = _nothing
    law: Callable[[LawScores, Choice, Path], object] = _nothing
    envelope: Callable[[Envelope, Path], object] = _nothing
    tests: Callable[[Qualification, Path], object] = _nothing


def commission_loader(  # noqa: PLR0913  what the command takes
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    out: str | Path,
    plan: CommissionPlan | None = None,
    *,
    bench: Loader | None = None,
    record: Callable[[], BenchRecord] | None = None,
    bench_time: BenchTime | None = None,
    progress: Progress = lambda step, what: None,
    writers: StepWriters | None = None,
) -> Commission:
    """Commission a loader: identify it, choose a law, compute its envelope and run the tests of the rule.

    Each step has a folder within ``out``, with the input file of the next step. Run again with the same inputs to resume.

    Args:
        loader: The loader of the file.
        data: Records and responses of its bench; empty with ``bench`` or ``record``.
        out: The folder; created if missing.
        plan: The plan.
        bench: A machine to simulate in place of a bench.
        record: Makes the record of a machine first, such as ``lambda: ff.bus.record(loader, 60.0)``; not again where it is there.
        bench_time: Length of that record; rate and seed of a simulated one.
        progress: Called with the current task.
        writers: Writers of the results, such as pages.

    Returns:
        The result of each step; ``ok`` if the law is accepted. ``write_commission`` writes the page, the loader file and the law.

    Raises:
        InputError: If the data are missing, not of this loader, or contradict their labels.

    Example:
        >>> try:
        ...     ff.commission.commission_loader(ff.digital_elevator(), [], "commissioned")
        ... except ff.InputError as error:
        ...     print(str(error).partition(":")[0])
        data
    """
    check_loader(loader)
    plan, out = plan or CommissionPlan(), Path(out)
    Settings.of(plan.grid)
    given = [name for name, there in (("data", data), ("bench", bench), ("record", record)) if there]
    if len(given) != 1:
        raise InputError(
            "data: expected records and responses of a bench, or a machine to simulate (bench), or one to record (record); got "
            + (" and ".join(given) or "none of them")
        )
    source = _bench(loader, bench, record, bench_time or BenchTime())
    with _left_as_it_was(out):
        return _set_up(loader, data, out, plan, source, _Work(plan, progress, writers or StepWriters()))


def _set_up(
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    out: Path,
    plan: CommissionPlan,
    bench: "_Bench | None",
    work: "_Work",
) -> Commission:
    """The steps, each made or read."""
    state = State.of(out)
    if bench is not None:
        data = _recorded(state, loader, bench, work.progress)
    text = digest(loader.to_toml(UnitSystem.SI), [_text_of(measurement) for measurement in data], _plan_values(plan))
    identified = state.step(IDENTIFICATION, text, Identified, lambda folder: work.identify(folder, loader, data))
    commission = Commission(plan, loader, identified, folders=_folders(bench), bench=bench.machine if bench else "")
    if input_kind(out / IDENTIFICATION / LOADER) is not Kind.FILE:
        return replace(
            commission, folders=_folders_up_to(commission.folders, IDENTIFICATION), resumed=tuple(state.resumed)
        )
    identified_loader = load(out / IDENTIFICATION / LOADER)
    text = digest(text, identified_loader.fingerprint)
    chosen = state.step(LAW, text, LawChosen, lambda folder: work.choose(folder, identified_loader))
    commission = replace(commission, loader=identified_loader, chosen=chosen)
    if not chosen.name:
        return replace(commission, folders=_folders_up_to(commission.folders, LAW), resumed=tuple(state.resumed))
    feel = Settings.of(plan.grid).feel(identified_loader)
    law = replace(
        Law.of(
            out / LAW / LAW_FILE_NAME,
            identified_loader,
            np.unique(np.vstack([own_feel(identified_loader), feel]), axis=0),
        ),
        name=chosen.name,
    )
    text = digest(text, (out / LAW / LAW_FILE_NAME).read_text(encoding="utf-8"))
    envelope = state.step(ENVELOPE, text, EnvelopeResult, lambda folder: work.check(folder, identified_loader, law))
    tested = state.step(TESTS, text, RuleTests, lambda folder: work.test(folder, identified_loader, law))
    return replace(commission, law=law, envelope=envelope, tested=tested, resumed=tuple(state.resumed))


@contextmanager
def _left_as_it_was(out: Path) -> Iterator[None]:
    """Makes the folder; takes it away again where bad input ends the work before anything is in it."""
    kind = output_kind(out)
    make_folder(out)
    try:
        yield
    except InputError:
        if not kind and not any(out.iterdir()):
            out.rmdir()
        raise


@dataclass(frozen=True)
class _Bench:
    """A machine that is recorded first.

    Attributes:
        machine: What it is.
        inputs: What the record depends on beside the loader.
        task: What is done.
        make: Makes the record.
    """

    machine: str
    inputs: tuple[object, ...]
    task: str
    make: Callable[[], BenchRecord]


def _bench(
    loader: Loader, machine: Loader | None, record: Callable[[], BenchRecord] | None, bench_time: BenchTime
) -> _Bench | None:
    """A simulated machine, or a real one; ``None`` without either."""
    length = f"{bench_time.time_s:g} s of record"
    if record is not None:
        return _Bench("the machine", ("record", bench_time.time_s), length, record)
    if machine is not None:
        inputs = (machine.to_toml(UnitSystem.SI), asdict(bench_time))
        return _Bench(
            "the simulated machine", inputs, length, lambda: simulated_records(loader, machine, bench_time)[0]
        )
    return None


def _recorded(state: State, loader: Loader, bench: _Bench, progress: Progress) -> list[Response | BenchRecord]:
    """The record of a machine, as its file has it."""

    def make(folder: Path) -> bool:
        progress(BENCH, bench.task)
        record = bench.make()
        make_folder(folder)
        write_whole(folder / RECORD, record_csv(record))
        return True

    text = digest(loader.to_toml(UnitSystem.SI), *bench.inputs)
    state.step(BENCH, text, bool, make)
    return [read_bench_record(state.out / BENCH / RECORD)]


@dataclass(frozen=True)
class _Work:
    """The steps, each of which keeps what the next begins from and hands its result to the writer.

    Attributes:
        plan: The plan.
        progress: Called with a step and its part that begins.
        writers: What writes the results.
    """

    plan: CommissionPlan
    progress: Progress
    writers: StepWriters

    def identify(self, folder: Path, loader: Loader, data: Sequence[Response | BenchRecord]) -> Identified:
        identified = identify_loader(loader, data, self.plan, lambda part: self.progress(IDENTIFICATION, part))
        loader_file = None if identified.loader is None else identified.loader.to_toml(self.plan.units)
        _keep(folder / LOADER, loader_file)
        self.writers.identification(identified.identification, folder)
        return identified.outcome

    def choose(self, folder: Path, loader: Loader) -> LawChosen:
        outcome, scores, choice = choose_law(loader, self.plan, lambda part: self.progress(LAW, part))
        _keep(folder / LAW_FILE_NAME, None)
        if outcome.name:
            feel = np.unique(np.vstack([own_feel(loader), scores.plan.settings.feel(loader)]), axis=0)
            Law.of(outcome.name, loader, feel).save(folder / LAW_FILE_NAME)
        self.writers.law(scores, choice, folder)
        return outcome

    def check(self, folder: Path, loader: Loader, law: Law) -> EnvelopeResult:
        def show(done: int, total: int) -> None:
            self.progress(ENVELOPE, f"{done:,} of {total:,} releases")

        outcome, envelope = check_law(loader, law.name, law, self.plan, show)
        self.writers.envelope(envelope, folder)
        return outcome

    def test(self, folder: Path, loader: Loader, law: Law) -> RuleTests:
        self.progress(TESTS, "tests of the rule")
        outcome, qualification = run_tests(loader, law.name, law.at(own_feel(loader)), self.plan)
        self.writers.tests(qualification, folder)
        return outcome


def _keep(path: Path, text: str | None) -> None:
    """Writes a file of a step's folder, or takes an earlier one away."""
    make_folder(path.parent)
    if text is None:
        path.unlink(missing_ok=True)
    else:
        write_whole(path, text)


def _folders(bench: "_Bench | None") -> dict[str, str]:
    return {name: name for name in ((BENCH,) if bench is not None else ()) + STEPS}


def _folders_up_to(folders: Mapping[str, str], last: str) -> dict[str, str]:
    return {name: name for name in folders if name <= last}


def _plan_values(plan: CommissionPlan) -> dict[str, object]:
    """What of the plan has a say in the numbers and the pages."""
    bench_time = {name: value for name, value in vars(plan).items() if name != "threads"}
    return {**bench_time, "grid": dict(plan.grid), "units": str(plan.units)}


def _text_of(data: Response | BenchRecord) -> list[object]:
    """What tells one set of data from another."""
    if data.data_hash:
        return [data.name, str(data.experiment), data.data_hash, getattr(data, "hold", "")]
    if isinstance(data, BenchRecord):
        values = [[name, bench_time.tobytes().hex()] for name, bench_time in data.channels.items()]
        return [data.name, str(data.experiment), data.hold, data.time_s.tobytes().hex(), values]
    return [data.name, str(data.experiment), data.input, data.output, data.value.tobytes().hex()]
