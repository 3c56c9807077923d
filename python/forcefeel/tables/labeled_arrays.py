"""Arrays with the names of their dimensions and units: what commands compute with, and what xarray's data sets are made of.

xarray and its pandas weigh 50 MB and take longer to import than many a command to answer; a data set is made when it is asked for.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import named_extra

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class LabeledArrays:
    """Named arrays over named dimensions.

    Attributes:
        arrays: Dimensions, values and attributes such as ``units`` of each array, the form in which xarray takes them.
        coordinates: The same along single dimensions; values alone if they have neither.
        about: Attributes of the whole.

    Example:
        >>> from forcefeel.tables.labeled_arrays import LabeledArrays
        >>> angles = LabeledArrays({"angle_rad": ("time_s", np.zeros(3), {"units": "rad"})}, {"time_s": [0.0, 0.1, 0.2]})
        >>> angles.unit("angle_rad"), angles.dataset.sizes["time_s"]
        ('rad', 3)
    """

    arrays: Mapping[str, Any]
    coordinates: Mapping[str, Any]
    about: Mapping[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> NDArray[Any]:
        entry = self.arrays[name] if name in self.arrays else self.coordinates[name]
        return np.asarray(entry[1] if isinstance(entry, tuple) else entry)

    def __iter__(self) -> Iterator[str]:
        return iter(self.arrays)

    def __contains__(self, name: object) -> bool:
        return name in self.arrays

    def unit(self, name: str) -> str:
        """SI unit of an array or a coordinate."""
        return str((self.arrays[name] if name in self.arrays else self.coordinates[name])[2]["units"])

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """The same as a data set of xarray, made once.

        Raises:
            MissingExtraError: If xarray is not installed.
        """
        with named_extra():
            import xarray as xr  # noqa: PLC0415  an extra

        return xr.Dataset(dict(self.arrays), dict(self.coordinates), dict(self.about))
