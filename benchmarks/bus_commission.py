"""What ``commission`` makes of machines behind a drive's bus that it has never seen, judged on the machines themselves.

Run ``python benchmarks/bus_commission.py --bus moteus``. Each machine has every plant parameter of ``elevator-electric`` within its
tolerance at once (20 %) and 1 lb of friction at the grip that no file names. The emulator has the machine; the record of its bench
signal, a minute under the law, comes over the bus, in the units and with the resolution of the drive. The rest is that of
``benchmarks/commission.py``.

``--rate`` is that of the loop and the record, with one period of delay.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import commission
import forcefeel as ff
from forcefeel.bench.excitation import ExcitationPlan, excite
from forcefeel.commission.observability import BREAKAWAY, DRY
from forcefeel.commission.plan import CommissionPlan

SENSED = {"load_cell_n": 10_000.0, "column_gear": 1.0}
FIT, TO_HZ = "K_t,J_m,k,c,J", 60.0
MEASURED = ("column_angle", "drive_position", "load_cell_force")


FRICTION = {DRY: "1 lb", BREAKAWAY: "1 lb"}


def on_file(kind, rate_hz):
    """What ``commission`` is told of the machines."""
    period = {"controller.period": 1 / rate_hz, "controller.delay": 1 / rate_hz}
    loader = commission.on_file(electric=True).replace(period, si=True)
    return replace(loader, bus=ff.loader.Bus(kind, "pty", **SENSED))


def recorded(file, machine, seconds, rate_hz):
    """The record of a bench signal that the bus plays on a machine."""
    behind = replace(machine, bus=file.bus)
    with ff.live.BusEmulator([behind], real_time=False) as emulator:
        wired = replace(file, bus=replace(file.bus, port=emulator.port))
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
    about = f"{file.name} on {options.bus}, {options.rate:g} Hz, {options.seconds:g} s, seed {options.seed}"
    drifts = commission.drawn_drifts(options.machines, options.seed)
    rows = commission.Rows(options.out, commission.ROW, about)
    for k, drawn in enumerate(commission.drawn(file, options.machines, options.seed), 1):
        if k in rows.done():
            continue
        # A drive is told its torque, and has the constant of its own settings.
        told = {"motor.torque_constant": file["motor.torque_constant"]}
        machine, begun = drawn.replace(FRICTION).replace(told, si=True), time.process_time()
        record = recorded(file, machine, options.seconds, options.rate)
        row = commission.commissioned(file, machine, [record], CommissionPlan(), drifts[k - 1])
        rows.add(row | {"machine": k, "cpu_s": time.process_time() - begun})
        print(commission.row_text(row | {"machine": k, "cpu_s": time.process_time() - begun}), flush=True)
    commission.summed_up([row for row in rows.all() if row["machine"] <= options.machines])


if __name__ == "__main__":
    main()
