"""Runs in virtual time of which each request and each force has its cycle: the same on any machine, however busy."""

import time

import numpy as np

import forcefeel as ff
from forcefeel import _core
from forcefeel.live.setup import live_law, made_of
from forcefeel.live.starting import MOST_RECORD_BYTES, about_run


def planned(loader, force_n, requests, *, law="robust", host=None, record=None, seed=0):
    """Columns of a run under a law, a force of the hand for each cycle, requests with theirs; recorded where a path is given."""
    driven_by = live_law(law, loader)
    setup, steps = made_of(loader, driven_by)
    period, _ = steps.timing
    script = ({"force": np.repeat(np.column_stack([force_n, force_n]), period, axis=0)}, 0.0, None, seed)
    cycles = len(force_n)
    about = about_run(loader, driven_by.name, ff.live.Simulated())
    (loop,) = _core.start_loops(
        [(setup, script, None, requests, 1, [], ("", about))],
        loader["controller.period"],
        host=host,
        real_time=False,
        beats=cycles,
        record=record and (record, (MOST_RECORD_BYTES, False), cycles, 1),
        history=cycles,
    )
    while not loop.status()[-1]:
        time.sleep(0.001)
    loop.end()
    return dict(zip(ff.live.COLUMNS, loop.history(-1.0, cycles).T, strict=True))
