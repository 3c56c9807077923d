"""Time and peak of one core, for every benchmark."""

import time

import numpy as np

SIZE = 2000


def cpu_seconds(run, repeats=5, warm_up=1):
    """The process's own time: the median of some repeats."""
    for _ in range(warm_up):
        run()
    spent = []
    for _ in range(repeats):
        begin = time.process_time()
        run()
        spent.append(time.process_time() - begin)
    return float(np.median(spent))


def peak_flops():
    """Floating-point operations a second of this core in double precision, a fused one counted as two: a large matrix product's."""
    a = np.random.default_rng(0).random((SIZE, SIZE))
    return 2 * SIZE**3 / cpu_seconds(lambda: a @ a)
