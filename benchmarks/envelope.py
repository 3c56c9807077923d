"""An envelope of 20,000 settings with every perturbation and arm: 640,000 releases for each compensator.

Run ``python benchmarks/envelope.py``. Times the whole by the wall's clock on all cores, and on one core what its parts take: the
releases, their measuring, the verdicts. Some of the releases are held against ``control.initial_response``, which is timed as the
peer. Ends with an error if they differ or a promise is not kept.
"""

import os
import resource
import sys
import time

os.environ.update({f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM")})

import control
import numpy as np

from forcefeel import _core
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.releases import Record, released
from forcefeel.envelope.run import compute
from forcefeel.laws.analog.recursion import NAMED_DESIGNS
from forcefeel.laws.law import Law
from forcefeel.linear.state_space import compliant_model
from forcefeel.loader.built_in import elevator
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import INDEX
from forcefeel.qualification.batch_verdicts import judge_releases
from forcefeel.qualification.release_batch import measure_releases

GRID = {"stiffness": "1..100 %:50:log", "frequency": "0.5..4 Hz:25:log", "damping": "0.1..1.5:16"}
LIMIT_S, LIMIT_GB = 60.0, 1.0
WITNESSED = 20
EXACT = 1e-8  # of the angle: what the peer's exponential, unbalanced and multiplied thousands of times, is good to


def whole():
    """Seconds by the wall and gigabytes for one compensator, everything included."""
    plan = make_plan(elevator(), ("published",), GRID)
    begin = time.perf_counter()
    envelope = compute(plan)
    spent = time.perf_counter() - begin
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    releases = envelope.data["outcome"].size
    shares = envelope.shares("published")
    print(
        f"{plan.settings.count:,} settings, {len(plan.cases)} cases: {releases:,} releases in {spent:.1f} s, {memory:.2f} GB"
    )
    print(f"published: stable {shares.stable:.1%}, passes {shares.nominal_share:.1%}")
    print(f"in every case: stable {shares.stable_worst:.1%}, passes {shares.worst_case_share:.1%}")
    return spent, memory


def parts():
    """What each part takes for a release, on one core, and the peer."""
    plan = make_plan(
        elevator(), ("published",), {"stiffness": "1..100 %:40:log", "frequency": "1, 2 Hz", "damping": GRID["damping"]}
    )
    feel = plan.settings.feel(plan.loader)
    laws = Law.of(NAMED_DESIGNS["published"](plan.loader), plan.loader, feel)
    which = np.flatnonzero(plan.settings.rows[:, 1] == plan.settings.frequency[0])
    record = Record.of(plan.settings.frequency[0], plan.settings.damping[0])
    some = laws.some(which)

    def timed(work):
        work()
        spent = []
        for _ in range(5):
            begin = time.process_time()
            result = work()
            spent.append(time.process_time() - begin)
        return result, float(np.median(spent)) / len(which) * 1e6

    (stable, angles), of_release = timed(lambda: released(plan, plan.cases[:1], feel[which], some, record, 1))
    batch, of_measure = timed(lambda: measure_releases(record.time_s, angles, threads=1))
    _, of_verdict = timed(lambda: judge_releases(batch, batch, plan.test))
    begin, worst = time.process_time(), 0.0
    for k in np.flatnonzero(stable)[:: max(1, int(stable.sum()) // WITNESSED)][:WITNESSED]:
        worst = max(worst, float(np.abs(peer(plan, some, feel[which], k, record) - angles[k]).max()) / plan.release_rad)
    of_peer = (time.process_time() - begin) / WITNESSED * 1e6
    each = f"{of_release:.1f} us to release, {of_measure:.1f} to measure, {of_verdict:.1f} to judge"
    print(f"one core, 1 Hz, {record.samples:,} samples, for each: {each}")
    print(f"control.initial_response: {of_peer:,.0f} us; largest difference {worst:.1e} of the angle")
    return worst


def peer(plan, laws, feel, k, record):
    """The same release by python-control."""
    values = plan.loader.si_values.copy()
    values[[INDEX[key] for key in FEEL_SETTING]] = feel[k]
    loader = plan.loader.replace(dict(zip(FEEL_SETTING, feel[k].tolist(), strict=True)), si=True)
    model = compliant_model(loader, laws.numbers.gain_law(plan.loader, k))[0, 0]
    a, b, c, _ = _core.compliant(values, laws.numbers.gain_law(plan.loader, k))
    at_rest = np.linalg.solve(a, b[:, 0])
    start = at_rest * plan.release_rad / (c[0] @ at_rest)
    return control.initial_response(model, record.time_s, start).outputs


def main():
    failed = []
    spent, memory = whole()
    worst = parts()
    if spent > LIMIT_S:
        failed.append(f"{spent:.0f} s, expected {LIMIT_S:.0f} s")
    if memory > LIMIT_GB:
        failed.append(f"{memory:.2f} GB, expected {LIMIT_GB} GB")
    if worst > EXACT:
        failed.append(f"releases differ by {worst:.1e}")
    for failure in failed:
        print("FAILED", failure)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
