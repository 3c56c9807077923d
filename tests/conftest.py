"""Hypothesis: a fast profile for every run, a slow one by ``HYPOTHESIS_PROFILE=slow``."""

import os

from hypothesis import settings

# Derandomized: a failure is one of the code, not of the day.
settings.register_profile("fast", max_examples=40, deadline=None, derandomize=True, database=None)
settings.register_profile("slow", max_examples=2000, deadline=None, database=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "fast"))
