"""What ``commission`` makes of machines behind a drive's bus that it has never seen, judged on the machines themselves.

Run ``python benchmarks/bus_commission.py --bus moteus``. Each machine has every plant parameter of ``elevator-electric`` within its
tolerance at once (20 %) and 1 lb of friction at the grip that no file names. The emulator has the machine; the record of its bench
signal, a minute under the law, comes over the bus, in the units and with the resolution of the drive. The rest is that of
``benchmarks/commission.py``.

A loop on a bus knows the drive's end by the motor's encoder and the file's travel per radian. The machines have another, within a
ruler's 1 %, and so in the loop's own lengths another ratio, link and inertia: ``as_the_bus_shows_it``. By these the law is judged.

``--rate`` is that of the loop and the record, with one period of delay. EtherCAT needs root, for a pair of virtual interfaces.
"""

import argparse
import sys
import time
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

sys.path.insert(1, str(Path(__file__).parents[1]))

from tests.live.bus_wire import virtual_interfaces

import commission
import forcefeel as ff
from forcefeel.bench.excitation import ExcitationPlan, excite
from forcefeel.cli.emulate import ethercat_drive
from forcefeel.commission.observability import BREAKAWAY, DRY
from forcefeel.commission.plan import CommissionPlan
from forcefeel.loader.bus import ETHERCAT

SENSED = {"load_cell_n": 10_000.0, "column_gear": 1.0}
FIT, TO_HZ = "K_t,J_m,k,c,J", 60.0
MEASURED = ("column_angle", "drive_position", "load_cell_force")


FRICTION = {DRY: "1 lb", BREAKAWAY: "1 lb"}


def on_file(kind, rate_hz):
    """What ``commission`` is told of the machines."""
    period = {"controller.period": 1 / rate_hz, "controller.delay": 1 / rate_hz}
    loader = commission.on_file(electric=True).replace(period, si=True)
    drive = ethercat_drive(loader) if kind == ETHERCAT else {}
    return replace(loader, bus=ff.loader.Bus(kind, "pty", **SENSED, **drive))


def as_the_bus_shows_it(file, machine):
    """A machine in the lengths of a loop with the file's geometry: all that its sensors and its drive show is the same.

    ``x' = rho x``, ``rho = r_file / r``; then ``alpha' R_b' = rho alpha R_b``, ``k' = k / rho``, ``c' = c / rho``. What
    torques move or resist is ``rho`` times as much: ``alpha' R_b' F = rho alpha R_b F``, ``r_file F = rho r F``.
    """
    rho = file["transmission.travel"] / machine["transmission.travel"]
    arm = file["column.base_arm"] / machine["column.base_arm"]
    torques = (DRY, BREAKAWAY, "column.inertia", "motor.inertia", "motor.torque_constant")
    factors = dict.fromkeys(torques, rho) | {
        "transmission.travel": rho,
        "column.base_arm": arm,
        "linkage.ratio": rho / arm,
        "linkage.stiffness": 1 / rho,
        "linkage.damping": 1 / rho,
    }
    return machine.replace({key: factor * machine[key] for key, factor in factors.items()}, si=True)


def recorded(file, machine, seconds, rate_hz, network):
    """The record of a bench signal that the bus plays on a machine; ``network``: the loop's end and the drive's, if it is one."""
    of_loop, of_drive = network or (None, file.bus.port)
    behind = replace(machine, bus=replace(file.bus, port=of_drive))
    with ff.live.BusEmulator([behind], real_time=False) as emulator:
        wired = replace(file, bus=replace(file.bus, port=of_loop or emulator.port))
        # The noise of the sensors alone comes near the voltage.
        limits = {"voltage": file["current_loop.voltage_limit"]}
        plan = ExcitationPlan(time_s=seconds, rate_hz=rate_hz, to_hz=TO_HZ, measured=MEASURED, limits=limits)
        return ff.bus.play(excite(wired, FIT, "loader command_current", plan), real_time=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--bus", default="moteus")
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=60.0, help="of bench")
    parser.add_argument("--rate", type=float, default=2000.0, help="of the loop, Hz")
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--out", type=Path, help="rows of the machines, a CSV; what stands in it is not made again")
    options = parser.parse_args()
    file = on_file(options.bus, options.rate)
    drawn_from = f"seed {options.seed}, {options.machines} machines"
    about = f"{file.name} on {options.bus}, {options.rate:g} Hz, {options.seconds:g} s, {drawn_from}"
    drifts = commission.drawn_drifts(options.machines, options.seed)
    rows = commission.Rows(options.out, commission.ROW, about)
    with virtual_interfaces() if options.bus == ETHERCAT else nullcontext() as network:
        for k, drawn in enumerate(commission.drawn(file, options.machines, options.seed), 1):
            if k in rows.done():
                continue
            # A drive is told its torque, and has the constant of its own settings.
            told = {"motor.torque_constant": file["motor.torque_constant"]}
            machine, begun = drawn.replace(FRICTION).replace(told, si=True), time.process_time()
            record = recorded(file, machine, options.seconds, options.rate, network)
            shown = as_the_bus_shows_it(file, machine)
            row = commission.commissioned(file, shown, [record], CommissionPlan(), drifts[k - 1])
            row |= {"machine": k, "cpu_s": time.process_time() - begun}
            rows.add(row)
            print(commission.row_text(row), flush=True)
    commission.summed_up(rows.all())


if __name__ == "__main__":
    main()
