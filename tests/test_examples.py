"""The examples run, and end as they should."""

import runpy
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"


def test_ten_things_example_runs(capsys):
    runpy.run_path(str(EXAMPLES / "ten_things.py"), run_name="__main__")
    said = capsys.readouterr().out
    assert "8 states, from ['pilot_force_n', 'test_signal_v'] to 7 outputs" in said
    assert "law robust (law.json), every 0.5 ms" in said
    assert "release from a quarter of the throw passed: True" in said
    kept, given = said.splitlines()[-1].split(" N/m in the file, ")
    assert given == f"{kept} N/m here"
