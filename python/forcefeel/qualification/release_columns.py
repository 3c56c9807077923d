"""Columns of the feature groups in the rows of the Rust kernel."""

from itertools import accumulate

from forcefeel import _core

_GROUPS = _core.release_feature_groups()
_ENDS = list(accumulate(count for _, count, _ in _GROUPS))

COLUMNS = {name: slice(end - count, end) for (name, count, _), end in zip(_GROUPS, _ENDS, strict=True)}
"""Columns of each group by its name."""
