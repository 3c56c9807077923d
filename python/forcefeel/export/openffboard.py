"""A feel as commands of the OpenFFBoard firmware, and what its effects cannot render.

The firmware adds up forces in counts, 32767 of which are the drive's torque at ``axis.N.power``. Position is in counts of half the
range ``D / 2``, speed in deg/s, acceleration in deg/s^2; ``c`` is the coefficient of an effect, 0 to 32767, its kind's gain 255:

========  ==================  ==============================================
effect    metric              torque at the column
========  ==================  ==============================================
spring    16 position         ``T c / 32767 * 16 theta / (D / 2)``
damper    4 x 40 speed        ``T c / 32767 * 160 omega / 32767``
inertia   2 x 4 acceleration  ``T c / 32767 * 8 alpha / 32767``
friction  sign of the speed   ``T c / 32767``, from 1 % of 32767/45 deg/s on
========  ==================  ==============================================

``T = n K_t i_max`` at the column, ``n = alpha R_b / r``. Of the inertia the machine has ``J + n^2 J_m`` by itself.

Source: github.com/Ultrawipf/OpenFFBoard, version 1.17.1: ``EffectsCalculator.cpp``, ``SerialFFB.cpp``, ``Axis.cpp``,
``CmdParser.cpp``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, degrees, isfinite, radians

from forcefeel.errors import InputError
from forcefeel.export.exported import Exported
from forcefeel.loader.loader import FEEL_SETTING, Loader, check_electric
from forcefeel.loader.parameters import TABLE, meaning, with_unit
from forcefeel.templating import environment
from forcefeel.units import UnitSystem

COMMANDS, README = "{}_openffboard.txt", "{}_openffboard.md"
"""File names."""

FULL = 32767
"""Counts of the drive's full torque, of half the range, and largest coefficient."""

_SPRING, _DAMPER, _INERTIA, _FRICTION = 8, 9, 10, 11
"""Types of effects."""

_RAMP_DEG_PER_S = FULL / 45 / 100
"""Speed from which a friction effect has its full force."""

_WIDEST_DEG = 32767
_MOST_PARTS = 256


def check_board_loader(loader: Loader) -> None:
    """Refuses a loader that the board cannot drive.

    Raises:
        InputError: If its drive is not electric.
    """
    check_electric(loader, "--to openffboard", "choose an electric loader")


@dataclass(frozen=True)
class Effect:
    """One effect: its type, the row that it renders, the value needed, and that of a coefficient of 32767, in SI units."""

    type: int
    key: str
    needed: float
    largest: float

    @property
    def coefficient(self) -> int:
        """The firmware's coefficient."""
        return min(round(FULL * max(self.needed, 0.0) / self.largest), FULL)

    @property
    def rendered(self) -> float:
        """The value that it gives."""
        return self.largest * self.coefficient / FULL


@dataclass(frozen=True)
class BoardFeel:
    """A feel on the board.

    Attributes:
        loader: The loader, with the setting of the feel.
        range_deg: Range of the axis, end to end.
        full_torque_n_m: Torque at the column at the drive's largest current.
        effects: The effects, by their numbers on the board.
        deadband: The spring's dead band in counts of position.

    Raises:
        InputError: If the loader has a valve, no largest current, or no end of its travel.
    """

    loader: Loader
    range_deg: int
    full_torque_n_m: float
    effects: tuple[Effect, ...]
    deadband: int

    @property
    def reduction(self) -> Fraction:
        """Turns of the column per turn of the motor, of parts up to 256 as the firmware takes them."""
        return Fraction(1 / _geared(self.loader)).limit_denominator(_MOST_PARTS)

    @classmethod
    def of(cls, exported: Exported) -> "BoardFeel":
        """The feel of an export of one setting.

        Raises:
            InputError: As the class, or if there are several settings.
        """
        check_board_loader(exported.loader)
        if len(exported.settings) > 1:
            raise InputError(
                f"--to openffboard: expected one setting of the feel, got {len(exported.settings)}; leave --knots out"
            )
        loader = exported.loader.replace(dict(zip(FEEL_SETTING, exported.settings[0].tolist(), strict=True)), si=True)
        current = loader["current_loop.current_limit"]
        if not isfinite(current):
            raise InputError(
                "--to openffboard: current_loop.current_limit: missing value; the board's numbers are shares of the torque at it"
            )
        geared = _geared(loader)
        full = current * loader["motor.torque_constant"] * geared
        span = _range_deg(loader)
        half, arm = radians(span / 2), loader["column.grip_arm"]
        own = loader["column.inertia"] + geared**2 * loader["motor.inertia"]
        per_degree = degrees(full) / FULL
        effects = (
            Effect(_SPRING, "feel.stiffness", loader["feel.stiffness"], 16 * full / half),
            Effect(_DAMPER, "feel.damping", loader["feel.damping"], 160 * per_degree),
            Effect(_INERTIA, "feel.inertia", loader["feel.inertia"] - own, 8 * per_degree),
            Effect(_FRICTION, "feel.coulomb_friction", loader["feel.coulomb_friction"] * arm, full),
        )
        return cls(loader, span, full, effects, round(FULL * loader["feel.deadband"] / half))

    def commands(self) -> Iterator[str]:
        """The commands, in their order; the last one turns the forces on."""
        yield "fxm.0.reset"
        yield f"axis.0.degrees={self.range_deg}"
        yield from (f"axis.0.{name}=0" for name in ("axisdamper", "axisfriction", "axisinertia", "expo"))
        yield "axis.0.fxratio=255"
        yield from (f"fx.0.{name}=255" for name in ("spring", "damper", "inertia", "friction"))
        yield "fx.0.frictionPctSpeedToRampup=1"
        yield from (f"fxm.0.new={effect.type}" for effect in self.effects)
        # An effect that a command makes has no filter until a profile is chosen; without one the firmware follows a null pointer.
        yield "fx.0.filterProfile_id=0"
        for number, effect in enumerate(self.effects):
            yield f"fxm.0.coeff={effect.coefficient}?{number}"
            yield f"fxm.0.sat={FULL}?{number}"
            yield f"fxm.0.deadzone={self.deadband if effect.type == _SPRING else 0}?{number}"
            yield f"fxm.0.state=1?{number}"
        yield "fxm.0.ffbstate=1"

    def lost(self) -> Iterator[str]:
        """A line for each part of the loader that the board does not render."""
        loader = self.loader
        yield "law: none; the hand feels rotor, column, their friction and the link, and no load cell or grip sensor is read"
        yield "supervisor (safety.*): none; the board has limits of its own, axis.0.maxspeed and axis.0.maxtorquerate"
        for effect in self.effects:
            yield from _short(loader, effect)
        if loader["feel.coulomb_friction"]:
            yield f"feel.coulomb_friction: rises with the speed, and is full from {_RAMP_DEG_PER_S:.1f} deg/s on; it does not hold"
        yield "feel.damping, feel.inertia: behind low-pass filters of the board, of 30 and 15 Hz"
        for name in loader.curves:
            yield f"feel.{name}: the spring is a straight line"
        for key in loader.given:
            if key.startswith("feel.") and key not in _RENDERED:
                yield f"{key} = {_text(loader, key, loader[key])}: {meaning(TABLE[key], loader.drive)}"


_RENDERED = (*FEEL_SETTING, "feel.coulomb_friction", "feel.deadband")


def _geared(loader: Loader) -> float:
    """Angle of the motor per angle of the column, alpha R_b / r."""
    return loader["column.base_arm"] * loader["linkage.ratio"] / loader["transmission.travel"]


def _short(loader: Loader, effect: Effect) -> Iterator[str]:
    """A line for an effect that gives less, or more, than the feel needs."""
    if effect.needed < 0:
        machine = loader[effect.key] - effect.needed
        yield (
            f"{effect.key} = {_text(loader, effect.key, loader[effect.key])}: the machine has "
            f"{_text(loader, effect.key, machine)} by itself, and the board takes none away"
        )
    elif effect.needed > effect.largest:
        scale = loader[effect.key] / effect.needed if effect.key == "feel.coulomb_friction" else 1.0
        yield (
            f"{effect.key}: the board adds at most {_text(loader, effect.key, effect.largest * scale)}, and "
            f"{_text(loader, effect.key, effect.needed * scale)} is needed"
        )


def _text(loader: Loader, key: str, value: float) -> str:
    return with_unit(TABLE[key], value, UnitSystem.SI, 4)


def _range_deg(loader: Loader) -> int:
    """Range of the axis: twice the programmed control's wider side, without hard stops the column's."""
    for part in ("feel.hard_stop", "column.stop"):
        ends = [abs(loader[f"{part}_{end}"]) for end in ("low", "high")]
        if all(isfinite(end) for end in ends):
            span = ceil(2 * degrees(max(ends)) - 1e-9)  # rounding of degrees
            if 0 < span <= _WIDEST_DEG:
                return span
    raise InputError(
        "--to openffboard: the range of the axis is unknown; expected column.stop_low and column.stop_high, such as "
        "--set 'column.stop_low=-90 deg' --set 'column.stop_high=90 deg'"
    )


def openffboard_files(exported: Exported) -> dict[str, str | bytes]:
    """The commands, one a line, and a page with what they give and what is lost.

    Raises:
        InputError: As ``BoardFeel.of``.
    """
    feel, name = BoardFeel.of(exported), exported.name
    page = environment(html=False).get_template("export/openffboard.md.j2")
    text = page.render(
        name=name,
        commands=COMMANDS.format(name),
        feel=feel,
        loader=feel.loader,
        rows=[
            (
                effect.key,
                effect.coefficient,
                _rendered(feel.loader, effect),
                _text(feel.loader, effect.key, feel.loader[effect.key]),
            )
            for effect in feel.effects
        ],
        lost=list(feel.lost()),
    )
    return {
        COMMANDS.format(name): "".join(f"{command};\n" for command in feel.commands()),
        README.format(name): text,
    }


def _rendered(loader: Loader, effect: Effect) -> str:
    """What the board and the machine give of a row."""
    value = effect.rendered
    if effect.key == "feel.coulomb_friction":
        value /= loader["column.grip_arm"]
    if effect.key == "feel.inertia":
        value += loader[effect.key] - effect.needed
    return _text(loader, effect.key, value)
