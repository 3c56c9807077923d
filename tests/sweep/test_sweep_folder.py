"""A sweep's folder: what is finished stays, nothing is half written, and no two sweeps get mixed."""

import dataclasses
import io
import json
import shutil
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.parameters import table
from forcefeel.simulation import Scenario
from forcefeel.simulation.inputs import Recorded, Step
from forcefeel.sweep import Sweep, chunk, folder, identity, run_sweep
from forcefeel.sweep.summary import summarize
from tests.sweeps import PUSH, nonlinear, small


class Interrupted:
    """Ctrl-C after so many pieces; notes what it was told."""

    def __init__(self, after: int = 10**9) -> None:
        self.after, self.told = after, []

    def __call__(self, done: int, total: int) -> None:
        self.told.append(done)
        if len(self.told) > self.after:
            raise KeyboardInterrupt


def interrupt(sweep: Sweep, place, after: int = 3) -> Interrupted:
    progress = Interrupted(after)
    with pytest.raises(KeyboardInterrupt):
        run_sweep(sweep, place, progress=progress, resume=True)
    return progress


def names(place) -> set[str]:
    return {path.name for path in place.iterdir()}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The finished sweep and the one with three chunks, as folders to copy: to write a file of results takes half a second."""
    folder = tmp_path_factory.mktemp("made")
    run_sweep(small(), folder / "finished")
    interrupt(small(), folder / "begun")
    return folder


@pytest.fixture(scope="module")
def whole():
    return run_sweep(small()).runs


@pytest.fixture
def finished(made, tmp_path):
    """A folder with all of ``small()``."""
    return shutil.copytree(made / "finished", tmp_path, dirs_exist_ok=True)


@pytest.fixture
def begun(made, tmp_path):
    """A folder with three chunks of ``small()``."""
    return shutil.copytree(made / "begun", tmp_path, dirs_exist_ok=True)


@pytest.mark.slow
def test_a_finished_sweep_leaves_plan_and_runs(tmp_path, whole):
    progress = Interrupted()
    found = run_sweep(small(), tmp_path / "new" / "sweep", progress=progress)
    assert names(tmp_path / "new" / "sweep") == {"plan.json", "runs.nc"}
    assert found.runs.identical(whole)
    assert progress.told == [0, *np.cumsum([len(chunk) for chunk in small().chunks])]


def test_plan_lists_rows_of_drive():
    for loader in (ff.digital_elevator(), ff.loader.electric("sidestick-pitch")):
        document = identity.identity(Sweep(loader, PUSH, runs=8))
        assert [*document["loader"]["values"]] == [*table(loader.drive)]


@pytest.mark.slow
def test_units_and_coordinates_round_trip_through_file(finished, whole):
    stored = xr.load_dataset(finished / "runs.nc", engine="h5netcdf")
    assert set(stored.coords) == set(whole.coords)
    for name, values in whole.variables.items():
        assert stored[name].attrs == values.attrs, name
        assert np.array_equal(stored[name].values, values.values, equal_nan=values.dtype.kind == "f"), name
    assert stored.attrs["loader"] == "elevator-1974"


def test_interrupted_sweep_resumes_at_last_chunk(tmp_path, whole):
    first = interrupt(small(), tmp_path)
    assert names(tmp_path) == {"plan.json", "chunks"}
    assert len(names(tmp_path / "chunks")) == 3
    progress = Interrupted()
    found = run_sweep(small(), tmp_path, resume=True, progress=progress)
    assert progress.told[0] == first.told[-1]
    assert len(progress.told) == 1 + len(small().chunks) - 3
    assert found.runs.identical(whole)
    assert names(tmp_path) == {"plan.json", "runs.nc"}


@pytest.mark.parametrize("other", [[], ["simulation.html"]])
def test_an_interrupted_replacement_leaves_no_script_without_a_page(finished, other):
    for name in ("sweep.html", "plotly.min.js", *other):
        (finished / name).write_text("x")
    with pytest.raises(KeyboardInterrupt):
        run_sweep(small(), finished, progress=Interrupted(1), replace=True)
    assert names(finished) == {"plan.json", "chunks", *(["plotly.min.js"] if other else []), *other}


@pytest.mark.slow
def test_repeated_resume_gives_same_result(tmp_path, whole):
    for _ in range(3):
        interrupt(small(), tmp_path, after=2)
    assert run_sweep(small(), tmp_path, resume=True, threads=1).runs.identical(whole)


def test_finished_sweep_is_read_and_not_repeated(finished, whole, monkeypatch):
    monkeypatch.setattr("forcefeel.sweep.run.measure", None)
    progress = Interrupted()
    assert run_sweep(small(), finished, resume=True, progress=progress).runs.identical(whole)
    assert progress.told == [400]


@pytest.mark.slow
def test_an_interruption_before_the_results_loses_nothing(tmp_path, whole, monkeypatch):
    def fail(self):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(folder.Folder, "finish", fail)
        with pytest.raises(KeyboardInterrupt):
            run_sweep(small(), tmp_path)
    monkeypatch.setattr("forcefeel.sweep.run.measure", None)
    assert run_sweep(small(), tmp_path, resume=True).runs.identical(whole)
    assert names(tmp_path) == {"plan.json", "runs.nc"}


@pytest.mark.slow
def test_damaged_pieces_are_computed_again(tmp_path, whole):
    interrupt(small(), tmp_path, after=6)
    first, *others = (tmp_path / "chunks" / f"0000{k}.npy" for k in range(6))
    pickled, shaped = io.BytesIO(), io.BytesIO()
    np.save(pickled, np.array([{}]), allow_pickle=True)
    np.save(shaped, np.load(first)[:-1])
    damages = (first.read_bytes()[:-100], b"", b"not an array", pickled.getvalue(), shaped.getvalue())
    for piece, damage in zip(others, damages, strict=True):
        piece.write_bytes(damage)
    progress = Interrupted()
    assert run_sweep(small(), tmp_path, resume=True, progress=progress).runs.identical(whole)
    assert len(progress.told) == 1 + len(small().chunks) - 1  # the first is as it was


def test_chunk_on_full_disk_is_not_partly_written(begun, monkeypatch):
    """A full disk in the midst of a piece: it is named, and no part of the piece is there."""
    before = names(begun / "chunks")

    really = Path.open

    def opened(*args, **named):
        file = really(*args, **named)
        return _Full(file) if "xb" in args else file

    monkeypatch.setattr(Path, "open", opened)
    with pytest.raises(InputError, match=r"00003\.npy: cannot be written \(No space left on device\)"):
        run_sweep(small(), begun, resume=True)
    assert names(begun / "chunks") == before


class _Full:
    """A file on a full disk."""

    def __init__(self, file) -> None:
        self.file = file

    def write(self, contents):
        self.file.write(contents[: len(contents) // 2])
        raise OSError(28, "No space left on device")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()


OTHERS = {
    "runs": (lambda: small(401), "runs.total: 400 there, 401 here"),
    "seed": (lambda: small(seed=1), "seed: 0 there, 1 here"),
    "vary": (lambda: small(vary={"feel.damping": "1 %"}), "varied.feel.damping"),
    "bounds": (lambda: small(vary={"linkage.stiffness": "19 %"}), "varied.linkage.stiffness.low"),
    "value": (
        lambda: Sweep(nonlinear().replace({"column.coulomb_friction": "1 lb"}), PUSH, runs=400),
        "loader.values.column",
    ),
    "scenario": (
        lambda: Sweep(nonlinear(), Scenario(Step(426.0, 0.1), 0.5), runs=400),
        "scenario.force.force_n: 427.0 there",
    ),
}


@pytest.mark.parametrize("other", OTHERS)
@pytest.mark.parametrize("resume", [True, False])
def test_a_folder_with_another_sweep_is_refused(begun, other, resume):
    make, said = OTHERS[other]
    with pytest.raises(InputError) as refused:
        run_sweep(make(), begun, resume=resume)
    assert "holds another sweep" in str(refused.value)
    assert said in str(refused.value)
    assert "--replace" in str(refused.value)
    assert len(names(begun / "chunks")) == 3


def test_same_sweep_resumes_only_with_resume(begun):
    kept = sum(map(len, small().chunks[:3]))
    with pytest.raises(InputError, match=f"holds {kept} of 400 runs of this very sweep; --resume to go on with it"):
        run_sweep(small(), begun)
    run_sweep(small(), begun, resume=True)
    with pytest.raises(InputError, match="holds all 400 runs of this very sweep; --resume to write its page anew"):
        run_sweep(small(), begun)


def test_another_engine_is_another_sweep(begun, monkeypatch):
    right = chunk.nominal(small())
    monkeypatch.setattr(identity, "nominal", lambda sweep: np.nextafter(right, np.inf))
    with pytest.raises(InputError, match="the engine here gives other numbers for the nominal loader"):
        run_sweep(small(), begun, resume=True)


@pytest.mark.slow
def test_replace_restarts_sweep_and_keeps_other_files(finished):
    for name in ("sweep.html", "mine.txt"):
        (finished / name).write_text("there", encoding="utf-8")
    interrupt(small(31), finished / "other", after=1)
    found = run_sweep(small(8), finished, replace=True)
    assert found.runs.identical(run_sweep(small(8)).runs)
    assert names(finished) == {"plan.json", "runs.nc", "mine.txt", "other"}


@pytest.mark.parametrize(
    ("held", "said"),
    [
        (["chunks/00000.npy"], r"chunks: has no plan\.json beside it that says of what sweep"),
        (["plan.json", "chunks/00000.npy", "chunks/notes.txt"], r"chunks: holds 'notes\.txt', which no sweep wrote"),
        (["plan.json", "chunks/my/00000.npy"], "chunks: holds 'my', which no sweep wrote"),
        (["plan.json", "chunks"], "chunks: is no folder that a sweep made"),
    ],
)
def test_foreign_chunks_are_never_removed(tmp_path, held, said):
    interrupt(small(8), tmp_path / "own", after=0)
    for name in held:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes((tmp_path / "own" / "plan.json").read_bytes())
    with pytest.raises(InputError, match=f"{said}; move it away, or name another folder"):
        run_sweep(small(8), tmp_path, replace=True)
    assert all((tmp_path / name).exists() for name in held)


def test_a_folder_of_chunks_that_is_a_link_is_not_followed(made, tmp_path):
    shutil.copytree(made / "finished", tmp_path / "sweep")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "00000.npy").write_text("mine")
    (tmp_path / "sweep" / "chunks").symlink_to(tmp_path / "mine", target_is_directory=True)
    with pytest.raises(InputError, match="chunks: is no folder that a sweep made"):
        run_sweep(small(8), tmp_path / "sweep", replace=True)
    assert (tmp_path / "mine" / "00000.npy").read_text() == "mine"


def test_partial_files_of_killed_run_are_removed(tmp_path):
    for name in (".runs.nc.abcd1234", ".plan.json._b_d_2_4", ".bashrc", ".runs.nc.mine"):
        (tmp_path / name).write_text("half")
    run_sweep(small(8), tmp_path)
    assert names(tmp_path) == {"plan.json", "runs.nc", ".bashrc", ".runs.nc.mine"}


@pytest.mark.slow
def test_a_seed_of_any_size_is_kept(tmp_path):
    sweep = small(8, seed=2**63 - 1)
    found = run_sweep(sweep, tmp_path)
    assert run_sweep(sweep, tmp_path, resume=True).runs.identical(found.runs)
    with xr.open_dataset(tmp_path / "runs.nc", engine="h5netcdf") as stored:
        assert stored.attrs["seed"] == "9223372036854775807"


@pytest.mark.parametrize("name", ["runs.nc", "sweep.html", "summary.json", "envelope.csv"])
def test_foreign_files_are_kept(tmp_path, name):
    (tmp_path / name).write_text("mine", encoding="utf-8")
    for resume in (False, True):
        with pytest.raises(InputError, match=rf"holds {name}, but no plan\.json .*; name another folder, or --replace"):
            run_sweep(small(8), tmp_path, resume=resume)
    assert (tmp_path / name).read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("plan", ["", "[1]", "{", "\xff", pytest.param("[" * 100_000, id="deep")])
def test_invalid_plan_raises_input_error(tmp_path, plan):
    (tmp_path / "plan.json").write_bytes(plan.encode("latin-1"))
    with pytest.raises(InputError, match=r"plan\.json: (cannot be read|is no plan)"):
        run_sweep(small(), tmp_path, resume=True)


def test_unreadable_results_are_named(finished):
    (finished / "runs.nc").write_bytes((finished / "runs.nc").read_bytes()[:1000])
    with pytest.raises(InputError, match=r"runs\.nc: cannot be read .*; --replace to begin anew"):
        run_sweep(small(), finished, resume=True)


def test_file_in_place_of_folder_is_refused(tmp_path):
    (tmp_path / "sweep").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="sweep: is a file; expected a folder"):
        run_sweep(small(), tmp_path / "sweep")
    with pytest.raises(InputError, match=r"deeper: cannot be written \(Not a directory\)"):
        run_sweep(small(), tmp_path / "sweep" / "deeper")
    assert (tmp_path / "sweep").read_text(encoding="utf-8") == "mine"


def test_options_without_a_folder_are_refused():
    for options in ({"resume": True}, {"replace": True}):
        with pytest.raises(InputError, match="resume, replace: require a folder; name it"):
            run_sweep(small(8), **options)
    with pytest.raises(InputError, match="threads: expected 1 to 1024"):
        run_sweep(small(8), threads=0)
    with pytest.raises(InputError, match="a cluster has its own"):
        run_sweep(small(8), threads=2, scheduler="tcp://127.0.0.1:1")


def test_plan_contains_all_values_and_version(tmp_path):
    sweep = small(16, grids={"feel.damping": [20.0, 30.0]})
    interrupt(sweep, tmp_path, after=1)
    plan = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert plan["format"] == identity.FORMAT
    assert plan["loader"]["values"]["linkage.stiffness"] == nonlinear()["linkage.stiffness"]
    assert plan["loader"]["values"]["valve.flow_limit"] == "inf"
    assert plan["grid"] == {"feel.damping": [20.0, 30.0]}
    assert plan["varied"]["linkage.stiffness"]["distribution"] == "uniform"
    assert plan["sweep"] == identity.digest(identity.identity(sweep))


def test_long_recording_is_identified_by_hash():
    time = np.linspace(0.0, 0.5, 500)
    forces = [Recorded(time, np.sin(time)), Recorded(time, np.sin(time) + 1e-15)]
    plans = [identity.identity(Sweep(nonlinear(), dataclasses.replace(PUSH, force=force), runs=8)) for force in forces]
    assert plans[0]["scenario"]["force"]["force_n"]["numbers"] == 500
    found = identity.differences(*plans)
    assert [line.partition(":")[0] for line in found] == ["scenario.force.force_n.sha256"]


@pytest.mark.slow
def test_memory_stays_flat(tmp_path, monkeypatch):
    """A run of a sweep in a folder adds no more than the columns that its summary reads one by one; 400 bytes in memory."""
    monkeypatch.setattr("forcefeel.sweep.plan._CHUNK_RUNS", 500)
    monkeypatch.setattr("forcefeel.sweep.result.SAMPLE_RUNS", 250)

    def summarized(runs: int) -> None:
        sweep = Sweep(ff.elevator(), Scenario(Step(100.0), duration_s=0.02), runs=runs)
        summarize(run_sweep(sweep, tmp_path / str(runs), threads=1))

    def peak(runs: int) -> int:
        tracemalloc.start()
        try:
            summarized(runs)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    summarized(1000)  # what is imported on the way
    few, many = 8_000, 16_000  # both of full chunks
    assert (peak(many) - peak(few)) / (many - few) < 40


@pytest.mark.slow
def test_results_that_miss_runs_are_refused(finished):
    run_sweep(small(8), finished / "other")
    (finished / "runs.nc").write_bytes((finished / "other" / "runs.nc").read_bytes())
    with pytest.raises(InputError, match=r"runs\.nc: does not hold the 400 runs; --replace to begin anew"):
        run_sweep(small(), finished, resume=True)


def test_results_without_room_on_the_disk_are_not_begun(tmp_path, whole, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr("shutil.disk_usage", lambda path: shutil._ntuple_diskusage(2**20, 2**20, 2**19))
        with pytest.raises(
            InputError, match=r"runs\.nc: takes 1\.1 MB, and the disk has 0\.5 MB free; make room, then --resume"
        ):
            run_sweep(small(), tmp_path)
    assert names(tmp_path) == {"plan.json", "chunks"}
    assert run_sweep(small(), tmp_path, resume=True).runs.identical(whole)
