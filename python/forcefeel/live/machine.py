"""The simulated machine on its own, for another process to serve."""

from forcefeel import _core
from forcefeel.live.setup import live_law, made_of, script_of
from forcefeel.loader.loader import Loader
from forcefeel.simulation.scenario import Scenario


class Machine:
    """The nonlinear machine of a loader: from sample to sample under the commands that it is given.

    Args:
        loader: The loader, with a digital controller.
        scenario: What is done to it, as in a simulation: force, release, signals, noise's seed.

    Raises:
        InputError: If the loader has no digital controller.

    Example:
        >>> import forcefeel as ff
        >>> machine = ff.live.Machine(ff.digital_elevator())
        >>> force_n, position_m, base_m, pilot_force_n, grip_force_n = machine.read()
        >>> machine.write(0.1, True)
    """

    def __init__(self, loader: Loader, scenario: Scenario | None = None) -> None:
        setup, steps = made_of(loader, live_law(None, loader), supervised=False, scenario=scenario)
        script = None if scenario is None else script_of(steps, scenario)
        self._machine = _core.LiveMachine(setup, script=script)

    def read(self) -> tuple[float, float, float, float, float]:
        """The next sample: load cell (N), drive's end and column's base (m), pilot's force and its sensor's at the grip (N)."""
        force, position, base, pilot_force, grip = self._machine.read() or [float("nan")] * 5
        return force, position, base, pilot_force, grip

    def write(self, command: float, enable: bool) -> None:
        """Takes the command that answers the sample: V at a valve's amplifier, A of a motor; without power it is zero."""
        self._machine.write(command, enable)

    def push(self, force_n: float) -> None:
        """A hand pushes at the grip."""
        self._machine.disturb("force", number=force_n)
