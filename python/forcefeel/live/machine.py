"""The simulated machine without a loop, for use in another process."""

from forcefeel import _core
from forcefeel.live.setup import live_law, made_of, script_of
from forcefeel.loader.loader import Loader
from forcefeel.simulation.scenario import Scenario


class Machine:
    """The nonlinear machine of a loader, stepped from sample to sample with given commands.

    Args:
        loader: The loader, with a digital controller.
        scenario: Inputs as in a simulation: force, release, signals, noise seed.

    Raises:
        InputError: If the loader has no digital controller.

    Example:
        >>> machine = ff.live.Machine(ff.digital_elevator())
        >>> force_n, position_m, base_m, pilot_force_n, grip_force_n = machine.read()
        >>> machine.write(0.1, True)
    """

    def __init__(self, loader: Loader, scenario: Scenario | None = None) -> None:
        setup, steps = made_of(loader, live_law(None, loader), supervised=False, scenario=scenario)
        script = None if scenario is None else script_of(steps, scenario)
        self._machine = _core.LiveMachine(setup, script=script)

    def read(self) -> tuple[float, float, float, float, float]:
        """Next sample: load cell (N), drive's end and column's base (m), pilot's force and grip sensor (N)."""
        force, position, base, pilot_force, grip = self._machine.read() or [float("nan")] * 5
        return force, position, base, pilot_force, grip

    def write(self, command: float, enable: bool) -> None:
        """Set the command for this sample: V at a valve's amplifier, A of a motor; zero if not enabled."""
        self._machine.write(command, enable)

    def push(self, force_n: float) -> None:
        """Set the force of a hand at the grip, N."""
        self._machine.disturb("force", number=force_n)
