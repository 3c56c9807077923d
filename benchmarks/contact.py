"""Contact: settings of a loader against 30 clamps and 18 end stops, with and without the law's part for contact.

Contacts and verdict are those of ``forcefeel.envelope.contact``, with more damping ratios. The settings are 4 stiffnesses x 4
frequencies x 3 damping ratios, from a twenty-fifth of the loader's own stiffness on.

    python benchmarks/contact.py [LOADER ...] [--law robust] [--sensors "500 Hz"] [--friction "1 lb"] [--light]

``--sensors`` gives load cell, encoder and column sensor a bandwidth, ``--friction`` the column dry friction, both known to the law.
``--light`` takes 1 to 5 % of the largest stiffness, softer than each of the contacts.
After a change of the contact rules run all options, too: light feels, friction and slow sensors lose most.
"""

import argparse
from itertools import product

import numpy as np

from forcefeel.envelope.contact import SOFT_STOP, STIFFNESSES, Contact, swings_on
from forcefeel.envelope.settings import Settings
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import Loader

LOADERS = (
    "elevator-2khz",
    "elevator-electric",
    "aileron-wheel",
    "rudder-pedals",
    "sidestick-pitch",
    "sidestick-roll",
    "desktop-yoke",
)
BANDWIDTHS = [f"{sensor}.bandwidth" for sensor in ("load_cell", "potentiometer", "column_sensor")]
FRICTION = "column.coulomb_friction", "column.static_friction"
DAMPING_RATIOS = (0.02, 0.1, 0.5)
CONTACTS = {
    "clamp": [Contact(False, k, ratio, mass) for mass, k, ratio in product((0.0, 3.0), STIFFNESSES, DAMPING_RATIOS)],
    "stop": [Contact(True, k, ratio) for k, ratio in product((SOFT_STOP, *STIFFNESSES), DAMPING_RATIOS)],
}


def settings(loader: Loader, *, light: bool) -> np.ndarray:
    """I, B, G in SI units, a row each."""
    own = loader["feel.stiffness"] / loader["feel.maximum_stiffness"]
    shares = (0.01, 0.025, 0.05) if light else (0.04 * own, 0.1 * own, 0.3 * own, own)
    hertz = (1.0, 2.0, 3.0, 4.0) if light else (0.8, 1.5, 2.2, 3.0)
    return Settings((0.1, 0.3, 0.7), tuple(2 * np.pi * frequency for frequency in hertz), shares).feel(loader)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("loaders", nargs="*", default=LOADERS)
    parser.add_argument("--law", default="robust")
    parser.add_argument("--sensors", help="their bandwidth, in place of ideal ones")
    parser.add_argument("--friction", help="dry friction at the grip, known to the law")
    parser.add_argument("--light", action="store_true", help="light feels: 1 to 5 % of the largest stiffness")
    given = parser.parse_args()
    changes = dict.fromkeys(BANDWIDTHS, given.sensors) if given.sensors else {}
    changes |= dict.fromkeys(FRICTION, given.friction) if given.friction else {}
    print("loader             contact  law        swings on     largest force, lb")
    for name in given.loaders:
        loader = BUILT_IN[name]().replace(changes)
        feel = settings(loader, light=given.light)
        law = Law.of(given.law, loader, feel)
        for (where, contacts), (kind, one) in product(
            CONTACTS.items(), (("free", law.without_contact()), ("contact", law))
        ):
            swings, forces = zip(*(swings_on(loader, one, feel, contact) for contact in contacts), strict=True)
            counts = f"{np.sum(swings):5d} of {np.size(swings):5d}"
            print(f"{name:18s} {where:8s} {kind:8s} {counts} {np.max(forces) / 4.4482:10.0f}")


if __name__ == "__main__":
    main()
