"""Flights, whose loaders a host moves: their ranges are coarse, as that of ``coarse_range``."""

import pytest


@pytest.fixture(scope="module", autouse=True)
def _range_of_the_host(coarse_range):
    pass
