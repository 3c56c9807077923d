"""The synthetic bench of a loader under a digital controller, from the report's equations integrated here by themselves.

The machine is the built-in ``elevator-2khz``; ``loader.toml`` is what its designers believed. The grip of the whole loader, under
its original law at 2 kHz, is shaken; force, angle, piston and load cell force are recorded. No line of the engine that ``identify``
fits has a part in it. Run it in any folder to make the files anew; they come out the same.

``x`` piston · ``p`` load pressure · ``q_i`` valve · ``theta`` column · ``s`` stretch of the link · ``i`` current · ``e`` command

    s = x - alpha R_b theta,    A p = k s + c s',                                      eq. (9)
    p' = 4 beta / V_E (q - A x'),    q = q_i sqrt(1 - sgn(q_i) p / p_s),               eqs. (5), (1)
    q_i'' = w_n^2 (q_c - q_i) - 2 zeta w_n q_i',    q_c = (q_r / i_r) i,  i = K_2 e    eq. (3)
    J theta'' = alpha R_b A p + R_p F_p,                                               eqs. (6), (7)
    I delta'' + B delta' + G delta = -G_max K_1 A p,    e = delta - K_3 x,             eqs. (11)-(13)

the last line once a period, of sensors as they are sampled; ``e`` reaches the amplifier a period later and stays for one.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import exp, sqrt
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

import forcefeel as ff

HERE = Path(__file__).parent
DURATION_S, RATE_HZ, PERIOD_S = 40.0, 250, 5e-4
STEPS = 10
"""Runge-Kutta steps in a period of the controller: 50 us, where the oil's pole is at -3e4 1/s."""

# U.S. customary units: lb, in, s, mA, V, rad
A, BETA, VE, PS = 2.36, 250000.0, 11.7, 1200.0
K, C, ALPHA, RB, RP, J = 6107.86, 16.2016, 0.59, 10.0, 31.375, 37.4
K2, I_MAX, Q_PER_MA, Q_MAX, WN, ZETA = 1.56, 15.0, 100.0 / 15.0, 100.0, 377.0, 0.9
GMAX, K1, K3, FEEL = 28800.0, 0.005, 7.632, (60.0, 304.0, 9600.0)

BELIEVED = {
    "linkage.stiffness": "5300 lb/in",
    "linkage.damping": "20 lb s/in",
    "linkage.ratio": 0.62,
    "column.inertia": "41 lb in s^2/rad",
    "valve.rated_flow": "112 in^3/s",
    "column.base_arm": "10.05 in",
    "column.grip_arm": "31.5 in",
}
"""What the file says where it is wrong; the two arms were measured by tape."""

BY_TAPE = {"column.base_arm": "1 %", "column.grip_arm": "1 %"}
"""How well a tape measures: the tolerances that the file states."""

NOISE = {"load cell": (0.1, 0.05), "potentiometer": (0.0005, 0.0005)}
"""Noise r.m.s. and step of what the controller samples, lb and in."""

RECORDED = {
    "pilot force (lb)": (0.0, 0.01),
    "column angle (deg)": (4e-5, 4.29e-5),
    "piston position (in)": (0.0005, 0.0005),
    "load cell force (lb)": (0.1, 0.05),
}
"""The same of what the bench records. The force is what its shaker is set to."""

_FORCE_LB, _LOWEST_HZ, _HIGHEST_HZ, _LINES = 12.0, 0.1, 20.0, 40


def shaken(duration_s: float) -> np.ndarray:
    """Force at the grip at the bench's samples, lb: lines from 0.1 to 20 Hz, the higher the weaker, that come softly."""
    random = np.random.default_rng(1)
    time = np.arange(round(duration_s * RATE_HZ) + 1) / RATE_HZ
    lines = np.unique(np.rint(np.geomspace(_LOWEST_HZ, _HIGHEST_HZ, _LINES) * 20)) / 20
    wave = sum(np.cos(2 * np.pi * (f * time + random.random())) / max(1.0, f / 2) ** 0.5 for f in lines)
    return np.round(_FORCE_LB * wave / np.sqrt(len(lines)) * np.clip(time, 0, 1), 2)


def rates(y, e, force):
    """Time derivative of [x, p, q_i, q_i', theta, theta']."""
    x, p, q_i, q_i_rate, theta, theta_rate = y
    x_rate = (A * p - K * (x - ALPHA * RB * theta)) / C + ALPHA * RB * theta_rate
    q = q_i * sqrt(max(0.0, 1 - p / PS if q_i > 0 else 1 + p / PS))
    current = min(max(K2 * e, -I_MAX), I_MAX)
    command = min(max(Q_PER_MA * current, -Q_MAX), Q_MAX)
    return (
        x_rate,
        4 * BETA / VE * (q - A * x_rate),
        q_i_rate,
        WN * WN * (command - q_i) - 2 * ZETA * WN * q_i_rate,
        theta_rate,
        (ALPHA * RB * A * p + RP * force) / J,
    )


def period(y, e, force, step):
    """One period of the machine by the classical Runge-Kutta method; the force runs straight from its first to its last value."""
    h = PERIOD_S / STEPS
    for k in range(STEPS):
        first, middle, last = (force + (k + share) / STEPS * step for share in (0.0, 0.5, 1.0))
        a = rates(y, e, first)
        b = rates([v + h / 2 * d for v, d in zip(y, a, strict=True)], e, middle)
        c = rates([v + h / 2 * d for v, d in zip(y, b, strict=True)], e, middle)
        d = rates([v + h * d for v, d in zip(y, c, strict=True)], e, last)
        y = [v + h / 6 * (p + 2 * q + 2 * r + s) for v, p, q, r, s in zip(y, a, b, c, d, strict=True)]
    return y


def feel_step():
    """The feel over a period under a torque that stays: [delta, delta'] after it, as a matrix on [delta, delta', torque]."""
    inertia, damping, stiffness = FEEL
    rate = damping / (2 * inertia)
    swing = sqrt(stiffness / inertia - rate**2)
    decay, turn = exp(-rate * PERIOD_S), swing * PERIOD_S
    from_angle = decay * (np.cos(turn) + rate / swing * np.sin(turn))
    from_rate = decay * np.sin(turn) / swing
    other = decay * (np.cos(turn) - rate / swing * np.sin(turn))
    return np.array(
        [
            [from_angle, from_rate, (1 - from_angle) / stiffness],
            [-stiffness / inertia * from_rate, other, from_rate / inertia],
        ]
    )


def sensed(value, noise, resolution, normal):
    """What a sensor of noise and step makes of a value."""
    return round((value + noise * normal) / resolution) * resolution


def run(force: np.ndarray) -> Iterator[tuple[float, float, float]]:
    """Angle in deg, piston in in and force in the link in lb at each sample of the force."""
    random, feel = np.random.default_rng(2), feel_step()
    y, delta, e = [0.0] * 6, np.zeros(2), 0.0
    per_sample = round(1 / (RATE_HZ * PERIOD_S))
    for now, after in zip(force, [*force[1:], force[-1]], strict=True):
        yield np.degrees(y[4]), y[0], A * y[1]
        for k in range(per_sample):
            cell, piston = (
                sensed(value, *NOISE[name], random.standard_normal())
                for name, value in (("load cell", A * y[1]), ("potentiometer", y[0]))
            )
            waiting, held = delta[0] - K3 * piston, e
            delta = feel @ [*delta, -GMAX * K1 * cell]
            y = period(y, held, now + k / per_sample * (after - now), (after - now) / per_sample)
            e = waiting


def record(duration_s: float) -> dict[str, np.ndarray]:
    """What the bench records."""
    force = shaken(duration_s)
    columns = np.column_stack([force, list(run(force))])
    record_columns = {"time (s)": np.arange(len(force)) / RATE_HZ}
    for k, (name, (noise, step)) in enumerate(RECORDED.items()):
        reading = columns[:, k] + noise * np.random.default_rng([3, k]).standard_normal(len(force))
        record_columns[name] = (np.round(reading / step) * step).astype(np.float32)
    return record_columns


def believed() -> ff.Loader:
    """The loader as its designers believed it to be."""
    machine = ff.digital_elevator()
    loader = (
        machine.with_tolerances(dict.fromkeys(machine.tolerances)).replace(BELIEVED, si=True).with_tolerances(BY_TAPE)
    )
    return replace(loader, name="bench-2khz", source="synthetic; arms by tape, all else as designed")


def main(out: Path = HERE, duration_s: float = DURATION_S) -> None:
    """Writes the loader file and the record."""
    (out / "loader.toml").write_text(believed().to_toml(), encoding="utf-8")
    table = pa.table(record(duration_s)).replace_schema_metadata({"experiment": "loader"})
    parquet.write_table(table, out / "shaken.parquet", compression="zstd")


if __name__ == "__main__":
    main()
