"""A loop with the interface of a running one and nothing behind it but I, B, G: a witness of what the console asks for."""

import threading
import time
from collections import deque
from types import SimpleNamespace

import numpy as np

import forcefeel as ff
from forcefeel.loader.loader import FEEL_SETTING

COLUMNS = (
    "time_s",
    "cycle",
    "column_angle_rad",
    "pilot_force_n",
    "feel_angle_rad",
    "feel_torque_n_m",
    "neutral_rad",
    "law_command",
    "command",
    "work_s",
)
_KEPT = 60_000
_HAND = 3000.0
"""Of a hand that holds an angle: pull per rate of the error, 1/s^2 over I."""


class StandIn:
    """Rows of ``I x'' + B x' + G x = R_p F`` at 1 kHz, ``speed`` times as fast as the clock; ``None``: as who waits for it asks."""

    def __init__(self, loader=None, speed=1.0):
        self.loader = loader or ff.digital_elevator()
        self.columns, self._speed, self.period_s = COLUMNS, speed, 1e-3
        self.trim_rad, self.stiffness_factor, self.shaker = 0.0, 1.0, 0.0
        self.hand_force_n, self.hand_angle_rad = 0.0, None
        self.host, self.flight, self.softened, self.fault = None, None, None, ""
        self.settings = SimpleNamespace(link=None, link_holds=True, priority=False)
        self.law = SimpleNamespace(name="robust")
        self.calls, self.trips = [], ()
        self._name, self._x, self._v, self._cycle = "passive", 0.0, 0.0, 0
        self._rows, self._lock, self._end = deque(maxlen=_KEPT), threading.Lock(), threading.Event()
        self._counts = np.zeros(40)
        self.missed = 0
        self.record_ended = ""
        self._thread = threading.Thread(target=self._go, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self._thread.join()

    def _go(self):
        if self._speed is None:
            return
        start = time.monotonic()
        while not self._end.is_set():
            due = int((time.monotonic() - start) * self._speed / self.period_s)
            with self._lock:
                for _ in range(min(due - self._cycle, 4000)):
                    self._step()
            time.sleep(0.002)

    def _step(self):
        inertia, damping, stiffness = (self.loader[row] for row in FEEL_SETTING)
        arm, dt, held = self.loader["column.grip_arm"], self.period_s, self.hand_angle_rad
        force = self.hand_force_n
        if held is not None:
            force += inertia / arm * (_HAND * (held - self._x) - 80.0 * self._v) + stiffness * held / arm
        torque = arm * force
        drives = self._name == "active"
        spring = stiffness * (self._x - self.trim_rad) if drives else 0.0
        self._v += dt * (torque - (damping if drives else 8 * damping) * self._v - spring) / inertia
        self._x += dt * self._v
        self._cycle += 1
        out = 0.1 * np.sin(20 * self._x) if drives else 0.0
        row = (self._cycle * dt, self._cycle, self._x, force, self._x, torque, self.trim_rad, out, out, 4e-6)
        self._rows.append(row)
        self._counts[4 + self._cycle % 3] += 1

    @property
    def state(self):
        return SimpleNamespace(
            cycle=self._cycle,
            time_s=self._cycle * self.period_s,
            name=self._name,
            trips=0,
            missed=self.missed,
            silent=0,
            lost_rows=0,
            recorded=0,
            record_ended=self.record_ended,
            ended=self._end.is_set(),
            drive_fault="",
        )

    @property
    def timing(self):
        edges = np.geomspace(0.5, 8192.0, 41)
        late, work = (
            ff.live.Histogram(edges, counts, edges[-1]) for counts in (np.roll(self._counts, 6), self._counts)
        )
        return ff.live.Timing(late, work, self.period_s)

    @property
    def feel(self):
        return {key: self.loader[key] for key in FEEL_SETTING}

    @feel.setter
    def feel(self, rows):
        self.calls.append(("feel", dict(rows)))
        self.loader = self.loader.replace(rows, si=True)

    def history(self, since=-1, most=None):
        with self._lock:
            wanted = min(most or _KEPT, int(self._cycle - since), len(self._rows))
            rows = [self._rows[k] for k in range(-wanted, 0)]
        found = np.array(rows).reshape(-1, len(COLUMNS))
        return found[found[:, 1] > since]

    def wait(self, cycles, timeout_s):
        if self._speed is None:
            with self._lock:
                for _ in range(cycles):
                    self._step()
            return
        until, end = self._cycle + cycles, time.monotonic() + timeout_s
        while self._cycle < until and time.monotonic() < end and not self._end.is_set():
            time.sleep(0.001)

    def _called(self, what, name=None):
        self.calls.append(what)
        self._name = name or self._name

    def on(self):
        self._called("on", "active" if not self.trips else None)

    def off(self):
        self._called("off", "passive")

    def stop(self):
        self.trips = (ff.live.Trip("stop", "Somebody stopped the loader. Acknowledge, then switch it on again."),)
        self._called("stop", "tripped")

    def acknowledge(self):
        self.trips = ()
        self._called("acknowledge", "passive")

    def accept_host(self):
        self._called("accept_host")

    def inject_fault(self, fault, sensor=None, by=0):
        self.trips = (
            ff.live.Trip("sensors silent", "The drive and its sensors sent nothing. Look at the cable to the drive."),
        )
        self.fault = fault
        self._called(("break", fault, sensor, by), "tripped")

    def clear_faults(self):
        self.fault = ""
        self._called("repair")
