"""The law ``robust`` for encoders of 17, 20 and 23 bits: its numbers, and what each renders on its own encoder and on the others.

    python benchmarks/encoders.py [loader] [friction]

Noise and resolution of the column's angle are both one step, 360 deg / 2^bits. A row is the law that was designed for an encoder, a
column the encoder that it runs on; 60 settings, nominal plant, hands off. With dry friction of the column, such as "1 lb" at the
grip, machine and law have that.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
from math import pi, radians

import forcefeel as ff
from forcefeel.conclusions import share_text
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.laws.sampled import robust_tuning
from forcefeel.loader.built_in import open_loader

BITS = (17, 20, 23)
GRID = {"stiffness": "1..100 %:5:log", "frequency": "0.5..4 Hz:4:log", "damping": "0.1, 0.4, 1.5"}
RELEASES_DEG = (10.0, 2.0)


def with_encoder(loader: ff.Loader, bits: int) -> ff.Loader:
    """The loader with an encoder of so many bits a turn at its column."""
    return loader.replace(dict.fromkeys(("column_sensor.noise", "column_sensor.resolution"), 2 * pi / 2**bits), si=True)


def main() -> None:
    name, friction = (*sys.argv[1:], *("elevator-2khz", "")[len(sys.argv) - 1 :])
    loader = open_loader(name).replace({"column.coulomb_friction": friction} if friction else {}, si=True)
    loaders = {bits: with_encoder(loader, bits) for bits in BITS}
    own = [[loader[f"feel.{row}"] for row in ("inertia", "damping", "stiffness")]]
    for bits, with_bits in loaders.items():
        tuning = robust_tuning(with_bits)
        law = ff.laws.law_design("robust").design(with_bits, own)
        gain = float(abs(law.command[0, law.states + 2]))
        print(
            f"{bits} bits: angle noise 10^{tuning.angle_noise.decades:.2f}, torque's walk 10^{tuning.torque_walk.decades:.2f}, "
            f"command for the angle's sample {gain:.3g} per rad"
        )
    tunings = {bits: ff.laws.tuned(str(bits), "", robust_tuning(loader)) for bits, loader in loaders.items()}
    bad = []
    for release in RELEASES_DEG:
        shares = {}
        for bits, with_bits in loaders.items():
            laws = {str(made): law for made, law in tunings.items()}
            plan = make_plan(with_bits, laws, GRID, changes={}, arms=(), angle_rad=radians(release))
            envelope = compute(plan, threads=1)
            shares[bits] = {made: envelope.shares(str(made)).nominal_share for made in BITS}
        print(f"released from {release:g} deg; law for | on {', '.join(f'{bits} bits' for bits in BITS)}")
        for made in BITS:
            print(f"  {made} bits: {', '.join(share_text(shares[bits][made]) for bits in BITS)}", flush=True)
        bad += [
            f"{release:g} deg, {bits} bits: {best}"
            for bits in BITS
            if shares[bits][best := max(BITS, key=lambda made: shares[bits][made])] > shares[bits][bits]
        ]
    if bad:
        sys.exit(f"another encoder's law renders more: {'; '.join(bad)}")


if __name__ == "__main__":
    main()
