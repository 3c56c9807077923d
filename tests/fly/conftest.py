"""Flights whose loader's range of springs and dampings is tried at fewer of them; ``tests/live`` has the whole range."""

import numpy as np
import pytest

from forcefeel.live import rendered


@pytest.fixture(scope="session", autouse=True)
def coarse_range():
    """The same ends, the loader's own spring among them; the whole table takes 3 s for each loader."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rendered, "_SPRINGS", np.geomspace(1 / 256, 1024, 10))
        patch.setattr(rendered, "_RATIOS", np.geomspace(0.02, 8.0, 6))
        yield
