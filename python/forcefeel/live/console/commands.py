"""Commands of a page: small JSON with exactly these fields."""

from math import pi
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from forcefeel.errors import InputError
from forcefeel.live.live_session import Fault, Sensor
from forcefeel.loader.parameters import TABLE

LARGEST_BYTES = 4096
"""Largest message."""

_STRONGEST_N = 2000.0
"""Largest force of a hand: above the 300 lb limit pilot force of 14 CFR 25.397."""
_MOST_CHANGES = 40


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Plain(_Message):
    """A command without numbers. Every client may stop; all other commands require control."""

    do: Literal[
        "take",
        "give",
        "stop",
        "acknowledge",
        "on",
        "off",
        "repair",
        "abort",
        "accept_host",
        "connect",
        "disconnect",
        "take_priority",
        "give_priority",
        "restart_flight",
    ]


def _row_of_the_feel(key: str) -> str:
    if key not in TABLE or not key.startswith("feel."):
        raise ValueError("expected a row of the feel, such as feel.stiffness")
    return key


class FeelChange(_Message):
    """Rows of the feel in SI units; ``None`` switches an optional row off."""

    do: Literal["feel"]
    rows: Annotated[
        dict[Annotated[str, AfterValidator(_row_of_the_feel)], float | None],
        Field(min_length=1, max_length=_MOST_CHANGES),
    ]


class Around(_Message):
    """External inputs of the feel."""

    do: Literal["around"]
    trim_rad: Annotated[float, Field(ge=-pi / 2, le=pi / 2)] | None = None
    stiffness_factor: Annotated[float, Field(ge=0, le=100)] | None = None
    shaker: Annotated[float, Field(ge=0, le=1)] | None = None


class MoveLever(_Message):
    """A lever of the flight, in SI units."""

    do: Literal["lever"]
    name: Literal["tab", "trim", "throttle"]
    position: float


class Hand(_Message):
    """A simulated hand: a force, a held angle, or release. It expires, so a page sends it repeatedly."""

    do: Literal["hand"]
    force_n: Annotated[float, Field(ge=-_STRONGEST_N, le=_STRONGEST_N)] | None = None
    angle_rad: Annotated[float, Field(ge=-pi / 2, le=pi / 2)] | None = None


class Break(_Message):
    """A fault of a simulated machine."""

    do: Literal["break"]
    fault: Fault
    sensor: Sensor | None = None
    by: float = 0.0


class RuleTest(_Message):
    """A test of the qualification rule."""

    do: Literal["test"]
    test: Literal["release", "sweep"]
    side: Literal["positive", "negative"] = "positive"


Command = Plain | FeelChange | Around | MoveLever | Hand | Break | RuleTest
_ADAPTER: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="do")])

FOR_ALL = frozenset({"stop", "take", "give"})
"""Commands that do not require control."""


def command_of(message: str | bytes) -> Command:
    """Parse a command.

    Raises:
        InputError: If the message is invalid.
    """
    if isinstance(message, bytes):
        raise InputError("expected a command as text, got bytes")
    try:
        return _ADAPTER.validate_json(message)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "command"
        raise InputError(f"{where}: {first['msg']}") from None
