"""What a page may ask for: small JSON, of which nothing but this is taken."""

from math import pi
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from forcefeel.errors import InputError
from forcefeel.live.live_session import Fault, Sensor
from forcefeel.loader.parameters import TABLE

LARGEST_BYTES = 4096
"""Of a message."""

_STRONGEST_N = 2000.0
"""A hand's force: more than the 300 lb that 14 CFR 25.397 has a pilot pull at most."""
_MOST_CHANGES = 40


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Plain(_Message):
    """What needs no number. Whoever got in may stop; the rest is for who holds control, or takes it."""

    do: Literal["take", "give", "stop", "acknowledge", "on", "off", "repair", "abort"]


def _row_of_the_feel(key: str) -> str:
    if key not in TABLE or not key.startswith("feel."):
        raise ValueError("expected a row of the feel, such as feel.stiffness")
    return key


class FeelChange(_Message):
    """Rows of the feel in SI units; ``None`` switches an optional one off."""

    do: Literal["feel"]
    rows: Annotated[
        dict[Annotated[str, AfterValidator(_row_of_the_feel)], float | None],
        Field(min_length=1, max_length=_MOST_CHANGES),
    ]


class Around(_Message):
    """What the feel is told from outside."""

    do: Literal["around"]
    trim_rad: Annotated[float, Field(ge=-pi / 2, le=pi / 2)] | None = None
    stiffness_factor: Annotated[float, Field(ge=0, le=100)] | None = None
    shaker: Annotated[float, Field(ge=0, le=1)] | None = None


class Hand(_Message):
    """A simulated hand: it pulls, or holds an angle, or lets go. It lapses, so it is sent again and again."""

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


Command = Plain | FeelChange | Around | Hand | Break | RuleTest
_ADAPTER: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="do")])

FOR_ALL = frozenset({"stop", "take", "give"})
"""What needs no control: anyone may stop."""


def command_of(message: str | bytes) -> Command:
    """A message as a command.

    Raises:
        InputError: If it is none.
    """
    if isinstance(message, bytes):
        raise InputError("expected a command as text, got bytes")
    try:
        return _ADAPTER.validate_json(message)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "command"
        raise InputError(f"{where}: {first['msg']}") from None
