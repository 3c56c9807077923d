"""The notebooks run from their first cell to their last, where a reader opens them, and are kept without outputs."""

import json
from pathlib import Path

import matplotlib as mpl
import pytest

NOTEBOOKS = sorted((Path(__file__).parent.parent / "examples/notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_and_has_no_outputs(notebook, monkeypatch):
    mpl.use("Agg")
    monkeypatch.chdir(notebook.parent)
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    names = {}
    for cell in (cell for cell in cells if cell["cell_type"] == "code"):
        assert (cell["outputs"], cell["execution_count"]) == ([], None)
        exec(compile("".join(cell["source"]), notebook.name, "exec"), names)
    assert mpl.pyplot.get_fignums()
    mpl.pyplot.close("all")


def test_there_are_three_notebooks():
    assert [path.stem for path in NOTEBOOKS] == ["design", "identify", "own-feel"]
