"""Records of a simulated machine in place of a bench: ``--simulate-bench TRUTH.toml``."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

from forcefeel.bench.channels import GRIP_FORCE
from forcefeel.bench.excitation import Excitation, ExcitationPlan, excite
from forcefeel.bench.excitation.excite import USUAL_FIT, USUAL_TO_HZ
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.identification.bench_of import check_bench
from forcefeel.bench.identification.grip_sensor import grip_force, moments
from forcefeel.bench.identification.linear import bench_law
from forcefeel.bench.identification.record_run import RecordRun
from forcefeel.bench.records import BenchRecord
from forcefeel.commission.sensor_lag import SENSOR_OF
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC, a_drive
from forcefeel.loader.sensors import has_grip_sensor, without_grip_sensor

MEASURED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        HYDRAULIC: ("column_angle", "piston_position", "load_cell_force", "load_pressure", "valve_current"),
        ELECTRIC: ("column_angle", "drive_position", "load_cell_force", "motor_current"),
    }
)
"""Recorded channels by drive: those of the laws' sensors, of the amplifier and of the manifold."""

_EXPERIMENT = MappingProxyType({HYDRAULIC: "servo-closed", ELECTRIC: "loader command_current"})

_INSTRUMENT = 0.003
"""Noise of the bench's own instruments, pressure and current, in the channel's r.m.s."""

_FINER = 8
"""Substeps of a sample for a sensor's lag."""


@dataclass(frozen=True)
class BenchTime:
    """Length, rate and seed of a simulated record.

    Attributes:
        time_s: Length of the record.
        rate_hz: Samples per second.
        seed: Of the sensors' noise.
    """

    time_s: float = 60.0
    rate_hz: float = 1000.0
    seed: int = 1974


def bench_signal(loader: Loader, bench_time: BenchTime) -> Excitation:
    """The bench signal for the loader of a file, within the limits of its drive.

    Raises:
        InputError: If the time is too short.
    """
    plan = ExcitationPlan(
        time_s=bench_time.time_s, rate_hz=bench_time.rate_hz, to_hz=USUAL_TO_HZ, measured=MEASURED[loader.drive]
    )
    # The machine is simulated under this law, whatever law its bus would take.
    law = bench_law(None, loader) if loader.drive == ELECTRIC else None
    return excite(loader, USUAL_FIT[loader.drive], _EXPERIMENT[loader.drive], plan, law)


def simulated_records(loader: Loader, truth: Loader, bench_time: BenchTime | None = None) -> list[BenchRecord]:
    """Simulate the record of a machine under the signal designed for its loader file.

    The signal knows the file alone, the record the machine: its sensors' lag, noise and steps;
    pressure and current with 0.3 % of noise.

    Args:
        loader: The loader as its file has it.
        truth: The machine.
        bench_time: Length, rate and seed.

    Raises:
        InputError: If the machine has another drive, or runs away under the signal.

    Example:
        >>> from forcefeel.commission.simulated_bench import BenchTime
        >>> loader = ff.digital_elevator()
        >>> truth = loader.replace({"column.inertia": "41 lb in s^2/rad"})
        >>> (record,) = ff.commission.simulated_records(loader, truth, BenchTime(time_s=4.0, rate_hz=500.0))
        >>> len(record.time_s)
        2000
    """
    bench_time = bench_time or BenchTime()
    if loader.drive != truth.drive:
        raise InputError(
            f"bench: {truth.name} has {a_drive(truth.drive)}, and {loader.name} {a_drive(loader.drive)}; expected a machine of "
            "this loader: its file with other numbers"
        )
    signal = bench_signal(loader, bench_time)
    experiment = Experiment.read(_EXPERIMENT[loader.drive])
    blank = dict.fromkeys(MEASURED[loader.drive], np.zeros_like(signal.signal))
    drive = {str(experiment.drive): signal.signal}
    asked_of = BenchRecord("bench", experiment, signal.time_s, {**drive, **blank})
    # The law on the bench is that of the file, the only one known at this point.
    # No law uses a sensor at the grip before its identification.
    law = Law.of(None, without_grip_sensor(loader)) if loader.drive == ELECTRIC else None
    run = RecordRun(asked_of, machine := without_grip_sensor(truth), law)
    exact = dict(zip(run.channels, run.at(machine.si_values, ()).value, strict=True))
    if not all(np.isfinite(values).all() for values in exact.values()):
        raise InputError(
            f"bench: {truth.name} runs away under {experiment}; expected a machine that its file's loop holds"
        )
    if has_grip_sensor(truth):
        exact[GRIP_FORCE] = grip_force(truth, moments(asked_of, truth, law)) + truth["grip_sensor.offset"]
    random = np.random.default_rng(bench_time.seed)
    readings = {name: _reading(truth, name, values, bench_time.rate_hz, random) for name, values in exact.items()}
    record = BenchRecord("bench", experiment, signal.time_s, {**drive, **readings})
    check_bench(loader, [record])
    return [record]


def _reading(
    truth: Loader, channel: str, values: NDArray[np.float64], rate_hz: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """Reading of a sensor: with lag, noise and resolution."""
    normal = random.standard_normal(len(values))
    if channel not in SENSOR_OF:
        return values + _INSTRUMENT * float(values.std()) * normal
    sensor = SENSOR_OF[channel]
    noise, step = truth[f"{sensor}.noise"], truth[f"{sensor}.resolution"]
    fine_times = np.arange((len(values) - 1) * _FINER + 1) / _FINER
    fine = CubicSpline(np.arange(len(values)), values)(fine_times)
    reading = lagged(fine, truth[f"{sensor}.bandwidth"] / rate_hz / _FINER)[::_FINER] + noise * normal
    return np.round(reading / step) * step if step else reading


def lagged(values: NDArray[np.float64], turn: float) -> NDArray[np.float64]:
    """A first-order lag of values that run straight between samples; ``turn`` its bandwidth times the time between two.

    With ``x`` straight from ``x_0`` to ``x_1``:  ``f_1 = x_1 - s + (f_0 - x_0 + s) exp(-w h)``,  ``s = (x_1 - x_0) / w h``.
    """
    if not np.isfinite(turn):
        return values
    slope, decay = np.diff(values) / turn, np.exp(-turn)
    behind = lfilter([1.0], [1.0, -decay], np.concatenate([[0.0], -slope * (1 - decay)]))  # f - x
    return np.asarray(values + behind)
