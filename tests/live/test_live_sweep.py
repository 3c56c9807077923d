"""The slow sweep of the rule on the live loop, its hundred seconds in virtual time, judged as the console does."""

from dataclasses import replace

import numpy as np

import forcefeel as ff
from forcefeel.live.console.programmed import Programmed
from forcefeel.live.console.verdict_json import verdict_json
from forcefeel.qualification import Record, qualify_loader
from forcefeel.qualification.plan.plan import STATIC
from forcefeel.qualification.plan.run import QualificationSetup
from tests.live.planned import planned

READY_S = 3.0
"""Until the feel is there."""


def test_slow_sweep_of_live_loop_passes_rule():
    # Its feel takes 104 lb at the end of the throw: longer than the supervisor's usual 75 lb may last.
    loader, setup = ff.digital_elevator().replace({"safety.force_limit": "150 lb"}), QualificationSetup()
    period, programmed = loader["controller.period"], Programmed.of(loader, setup).record
    at = programmed.time_s - programmed.time_s[0]
    time_s = np.arange(round((at[-1] + READY_S) / period)) * period
    force = np.interp(time_s - READY_S, at, programmed.force_n)
    found = planned(loader, np.where(time_s < READY_S, 0.0, force), [(0, "on", [])])
    swept = time_s >= READY_S
    assert at[-1] > 90
    assert (found["state"][swept] == ff.live.STATES.index("active")).all()
    record = Record(time_s[swept], found["column_angle_rad"][swept], found["pilot_force_n"][swept], name="live")
    judged = verdict_json(qualify_loader(loader, replace(setup, records={STATIC: record}, tests=(STATIC,))))
    assert judged["passed"], judged["sentence"]
    assert judged["plot"]["kind"] == "sweep"
