"""Sets a loader up, step by step; each step's folder stays."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from forcefeel.bench.identification.page.folder import LOADER, write_identification
from forcefeel.bench.record_file import read_bench_record
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.choice.page.folder import write_choice
from forcefeel.commission.envelope_step import check_law
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.law_for import choose_law
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.qualification_step import run_tests
from forcefeel.commission.result import Checked, Commission, Identified, LawChosen, RuleTests
from forcefeel.commission.simulated_bench import BenchTime, record_csv, simulated_records
from forcefeel.commission.steps import BENCH, ENVELOPE, IDENTIFICATION, LAW, STEPS, TESTS, State, digest
from forcefeel.envelope.page.folder import write_envelope
from forcefeel.envelope.settings import Settings
from forcefeel.errors import InputError
from forcefeel.files import Kind, input_kind, make_folder, output_kind, write_whole
from forcefeel.laws.law import Law
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.loader import Loader, check_loader, load
from forcefeel.qualification.page.folder import write_qualification
from forcefeel.units import UnitSystem

LAW_FILE_NAME = "law.json"
RECORD = "bench.csv"

Progress = Callable[[str, str], None]
"""Called with a step and what is being done in it."""


def commission_loader(
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    out: str | Path,
    plan: CommissionPlan | None = None,
    *,
    bench: Loader | None = None,
    bench_time: BenchTime | None = None,
    progress: Progress = lambda step, what: None,
) -> Commission:
    """Sets a loader up: identifies it, chooses the law for what is known of it, checks that and makes the tests of the rule.

    Each step writes its folder within ``out``. Called again with the same, it takes up where it was.

    Args:
        loader: The loader as its file has it.
        data: Records and responses of its bench; none where ``bench`` is given.
        out: The folder; made if it is not there.
        plan: What is asked.
        bench: A machine that is simulated in place of a bench.
        bench_time: How long, how fast and with which noise it is recorded.
        progress: Told what is being done.

    Returns:
        What each step came to; ``good`` where the law may be handed over. ``write_commission`` writes the page, the loader file and
        the law.

    Raises:
        InputError: If the data are not of this loader or not what they are said to be, or there are none.

    Example:
        >>> import forcefeel as ff
        >>> try:
        ...     ff.commission.commission_loader(ff.digital_elevator(), [], "commissioned")
        ... except ff.InputError as error:
        ...     print(str(error).partition(":")[0])
        data
    """
    check_loader(loader)
    plan, out = plan or CommissionPlan(), Path(out)
    Settings.of(plan.grid)
    if bool(data) is (bench is not None):
        raise InputError(
            "data: expected records and responses of a bench, or a machine to be simulated (bench), and not both; got "
            + ("both" if data else "neither")
        )
    with _left_as_it_was(out):
        return _set_up(loader, data, out, plan, bench, bench_time, progress)


def _set_up(
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    out: Path,
    plan: CommissionPlan,
    bench: Loader | None,
    bench_time: BenchTime | None,
    progress: Progress,
) -> Commission:
    """The steps, each made or read."""
    state = State.of(out)
    if bench is not None:
        data = _simulated(state, loader, bench, bench_time or BenchTime(), progress)
    text = digest(loader.to_toml(UnitSystem.SI), [_text_of(one) for one in data], _asked(plan))
    identified = state.step(
        IDENTIFICATION, text, Identified, lambda folder: _identify(folder, loader, data, plan, progress)
    )
    told = Commission(plan, loader, identified, folders=_folders(bench))
    if input_kind(out / IDENTIFICATION / LOADER) is not Kind.FILE:
        return replace(told, folders=_some(told.folders, IDENTIFICATION), resumed=tuple(state.resumed))
    found = load(out / IDENTIFICATION / LOADER)
    text = digest(text, found.fingerprint)
    chosen = state.step(LAW, text, LawChosen, lambda folder: _choose(folder, found, plan, progress))
    told = replace(told, loader=found, chosen=chosen)
    if not chosen.name:
        return replace(told, folders=_some(told.folders, LAW), resumed=tuple(state.resumed))
    feel = Settings.of(plan.grid).feel(found)
    law = replace(
        Law.of(out / LAW / LAW_FILE_NAME, found, np.unique(np.vstack([own_feel(found), feel]), axis=0)),
        name=chosen.name,
    )
    text = digest(text, (out / LAW / LAW_FILE_NAME).read_text(encoding="utf-8"))
    checked = state.step(ENVELOPE, text, Checked, lambda folder: _check(folder, found, law, plan, progress))
    tested = state.step(TESTS, text, RuleTests, lambda folder: _test(folder, found, law, plan, progress))
    return replace(told, law=law, checked=checked, tested=tested, resumed=tuple(state.resumed))


@contextmanager
def _left_as_it_was(out: Path) -> Iterator[None]:
    """Makes the folder; takes it away again where bad input ends the work before anything is in it."""
    there = output_kind(out)
    make_folder(out)
    try:
        yield
    except InputError:
        if not there and not any(out.iterdir()):
            out.rmdir()
        raise


def _simulated(
    state: State, loader: Loader, bench: Loader, asked: BenchTime, progress: Progress
) -> list[Response | BenchRecord]:
    """The record of a simulated machine, as its file has it."""

    def make(folder: Path) -> bool:
        progress(BENCH, f"{asked.time_s:g} s of record")
        (record,) = simulated_records(loader, bench, asked)
        make_folder(folder)
        write_whole(folder / RECORD, record_csv(record))
        return True

    text = digest(loader.to_toml(UnitSystem.SI), bench.to_toml(UnitSystem.SI), asdict(asked))
    state.step(BENCH, text, bool, make)
    return [read_bench_record(state.out / BENCH / RECORD)]


def _identify(
    folder: Path, loader: Loader, data: Sequence[Response | BenchRecord], plan: CommissionPlan, progress: Progress
) -> Identified:
    one = identify_loader(loader, data, plan, lambda what: progress(IDENTIFICATION, what))
    write_identification(one.found, folder, plan.units, replace=True)
    return one.outcome


def _choose(folder: Path, loader: Loader, plan: CommissionPlan, progress: Progress) -> LawChosen:
    outcome, scored, choice = choose_law(loader, plan, lambda what: progress(LAW, what))
    write_choice(scored, choice, folder, plan.units, replace=True)
    if outcome.name:
        feel = np.unique(np.vstack([own_feel(loader), scored.plan.settings.feel(loader)]), axis=0)
        Law.of(outcome.name, loader, feel).save(folder / LAW_FILE_NAME)
    else:
        (folder / LAW_FILE_NAME).unlink(missing_ok=True)
    return outcome


def _check(folder: Path, loader: Loader, law: Law, plan: CommissionPlan, progress: Progress) -> Checked:
    def told(done: int, total: int) -> None:
        progress(ENVELOPE, f"{done:,} of {total:,} releases")

    outcome, found = check_law(loader, law.name, law, plan, told)
    write_envelope(found, folder, plan.units, replace=True)
    return outcome


def _test(folder: Path, loader: Loader, law: Law, plan: CommissionPlan, progress: Progress) -> RuleTests:
    progress(TESTS, "tests of the rule")
    outcome, found = run_tests(loader, law.name, law.at(own_feel(loader)), plan)
    write_qualification(found, folder)
    return outcome


def _folders(bench: Loader | None) -> dict[str, str]:
    return {name: name for name in ((BENCH,) if bench is not None else ()) + STEPS}


def _some(folders: Mapping[str, str], last: str) -> dict[str, str]:
    return {name: name for name in folders if name <= last}


def _asked(plan: CommissionPlan) -> dict[str, object]:
    """What of the plan has a say in the numbers and the pages."""
    asked = {name: value for name, value in vars(plan).items() if name != "threads"}
    return {**asked, "grid": dict(plan.grid), "units": str(plan.units)}


def _text_of(data: Response | BenchRecord) -> list[object]:
    """What tells one set of data from another."""
    if data.data_hash:
        return [data.name, str(data.experiment), data.data_hash, getattr(data, "hold", "")]
    if isinstance(data, BenchRecord):
        values = [[name, it.tobytes().hex()] for name, it in data.channels.items()]
        return [data.name, str(data.experiment), data.hold, data.time_s.tobytes().hex(), values]
    return [data.name, str(data.experiment), data.input, data.output, data.value.tobytes().hex()]
