"""The links of a project file: what joins the controls of two pilots, or two axes of one.

[links.pitch]
between = ["pitch", "pitch-first-officer"]
kind = "mechanical"           # or "electronic"
stiffness = "4000 lb in/rad"
breakout = "1000 lb in"

[links.aileron-rudder]        # an interconnect: pedals toward a tenth of the wheel's angle
between = ["yaw", "roll"]
kind = "electronic"
ratio = 0.1
stiffness = "500 lb in/rad"
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError, suggestion
from forcefeel.loader.axes import motion_axis
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import in_range, range_text, unit, with_unit
from forcefeel.units import UnitSystem, parse, show

LINK_TABLE = MappingProxyType({row.name: row for row in _core.link_parameters()})
"""The rows of a link, in the order of its values."""

_ELECTRONIC_ROWS = ("delay", "injected_damping", "priority_force")

_BREAKOUT_ROWS = ("stiffness_after", "after_breakout")


class LinkKind(StrEnum):
    """Where a link acts."""

    MECHANICAL = "mechanical"
    ELECTRONIC = "electronic"


class AfterBreakout(StrEnum):
    """What a link does that has given way."""

    OVERRIDE = "override"
    UNCOUPLE = "uncouple"


@dataclass(frozen=True, eq=False)
class Link:
    """A link between the controls of two axes.

    Attributes:
        name: Its name in the project file.
        between: The two axes, the first pilot's first.
        kind: A shaft between the columns, or a torque in both feel computers.
        after_breakout: An override goes on along ``stiffness_after`` and takes hold again on its way back. A link that uncouples
            stays open.
        values: SI values in the order of ``LINK_TABLE``.

    Example:
        >>> ff.loader.read_project("examples/cockpit/transport-column.toml").links["pitch"].kind.value
        'mechanical'
    """

    name: str
    between: tuple[str, str]
    kind: LinkKind
    after_breakout: AfterBreakout
    values: NDArray[np.float64]

    @property
    def joins_pilots(self) -> bool:
        """Whether it joins the same control of two pilots; otherwise it is an interconnect of two axes."""
        return motion_axis(self.between[0]) == motion_axis(self.between[1])

    @property
    def stiffness_to_jam(self) -> float:
        """Stiffness in N m/rad that the first control feels, the second jammed: of both halves and the body between them."""
        half, middle = 2 * self["stiffness"], self["middle_stiffness"]
        return half * (half + middle) / (2 * half + middle)

    def __getitem__(self, name: str) -> float:
        """The SI value of a row of ``LINK_TABLE``."""
        return float(self.values[list(LINK_TABLE).index(name)])


def read_links(given: object, loaders: Mapping[str, Loader]) -> Mapping[str, Link]:
    """The links of a project from its table ``links``; none without one.

    Raises:
        InputError: With the key, what was expected, what came, and the remedy.
    """
    if given is None:
        return MappingProxyType({})
    if not isinstance(given, dict) or not given:
        raise InputError(f"links: expected a table for each link, such as [links.pitch], got {show(given)}")
    links, taken = {}, dict[str, str]()
    for name, rows in given.items():
        try:
            links[name] = link = _link(name, rows, loaders)
            # A shaft takes a column of its own, a link of pilots the buttons that open it.
            for axis in link.between if link.joins_pilots or link.kind is LinkKind.MECHANICAL else ():
                if axis in taken:
                    raise InputError(
                        f"between: {axis} is linked by {taken[axis]} already; expected one link for each axis, and interconnects "
                        f'of kind = "electronic"'
                    )
                taken[axis] = name
        except InputError as error:
            raise InputError(f"links.{name}.{error}") from error
    return MappingProxyType(links)


def _link(name: str, given: object, loaders: Mapping[str, Loader]) -> Link:
    if not isinstance(given, dict):
        raise InputError(f"between: expected a table of the link's rows, got {show(given)}")
    known = ("between", "kind", "after_breakout", *LINK_TABLE)
    for key in given:
        if key not in known:
            raise InputError(f"{key}: expected one of {', '.join(known)}{suggestion(key, known)}")
    between = _between(given.get("between"), loaders)
    kind = _choice(LinkKind, "kind", given.get("kind", LinkKind.MECHANICAL))
    after = _choice(AfterBreakout, "after_breakout", given.get("after_breakout", AfterBreakout.OVERRIDE))
    for row in _ELECTRONIC_ROWS:
        if row in given and kind is LinkKind.MECHANICAL:
            raise InputError(f'{row}: is of an electronic link, and this one is mechanical; write kind = "electronic"')
    for row in _BREAKOUT_ROWS:
        if row in given and "breakout" not in given:
            raise InputError(f'{row}: holds after a breakout, and the link has none; add breakout = "1000 lb in"')
    if after is AfterBreakout.UNCOUPLE and "stiffness_after" in given:
        raise InputError("stiffness_after: is of an override, and this link uncouples; leave one out")
    values = np.array([_value(row, given.get(row.name)) for row in LINK_TABLE.values()])
    link = Link(name, between, kind, after, values)
    for row in ("middle_damping", "middle_stiffness"):
        if link[row] and not link["middle_inertia"]:
            raise InputError(
                f'{row}: is of a body at the middle, which needs inertia; add middle_inertia = "5 lb in s^2/rad"'
            )
    if link.joins_pilots and "ratio" in given:
        raise InputError(
            "ratio: is of an interconnect of two axes, and this link joins one control of two pilots; leave it out"
        )
    if not link["ratio"]:
        raise InputError(
            "ratio: expected a number other than 0, got 0; leave the link out, or give it an angle to follow"
        )
    return link


def _between(given: object, loaders: Mapping[str, Loader]) -> tuple[str, str]:
    example = 'two axes such as ["pitch", "pitch-first-officer"]'
    if not isinstance(given, list) or len(given) != 2 or not all(isinstance(axis, str) for axis in given):
        raise InputError(f"between: expected {example}, got {show(given) if given is not None else 'nothing'}")
    for axis in given:
        if axis not in loaders:
            raise InputError(f"between: expected axes of [axes] ({', '.join(loaders)}), got {show(axis)}; add it there")
    if given[0] == given[1]:
        raise InputError(f"between: expected {example}, got {given[0]} twice; a link joins two controls")
    return given[0], given[1]


def _choice(kind: Any, key: str, given: object) -> Any:
    try:
        return kind(given)
    except ValueError:
        raise InputError(f"{key}: expected {' or '.join(kind)}, got {show(given)}") from None


def _value(row: _core.Parameter, given: object) -> float:
    example = with_unit(row, row.default_si, UnitSystem.US)
    if given is None:
        if row.off_si is None:
            raise InputError(f"{row.name}: expected {row.meaning}, such as {row.name} = {example!r}, got nothing")
        return row.off_si
    try:
        value = parse(given, unit(row).si, example)
    except InputError as error:
        raise InputError(f"{row.name}: {error}") from error
    if not in_range(row, value):
        raise InputError(f"{row.name}: expected {range_text(row)}, got {show(given)}")
    return value
