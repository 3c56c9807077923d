"""Makes what the program can make of itself: the validation table, the README's picture, the table of common factors of units."""

import gc
import pkgutil
from importlib import import_module
from pathlib import Path

import matplotlib as mpl
import numpy as np

import forcefeel as ff
from forcefeel import units
from forcefeel.files import write_whole
from forcefeel.loader.parameters import ALTERNATIVES, TABLE, unit
from forcefeel.reproduction import markdown
from forcefeel.simulation.programmed_feel import ideal_angle

mpl.use("Agg")
from matplotlib import pyplot

HERE = Path(__file__).parent
FACTORS = Path(units.__file__).parent / "data" / "factors.csv"

VALIDATION = """\
# The 1974 report, number by number

Made by `make docs` from `forcefeel reproduce`. "Agrees" means: rounds to the printed digits, or the claim holds. The curves of
figures 7 to 11 and 14 are lost, so the report's statements on them are compared. Figures 1, 3 to 6, 12 and 13 are drawings.

"""


def main() -> None:
    write_whole(FACTORS, factors())
    write_whole(HERE / "reference" / "validation.md", VALIDATION + markdown(ff.reproduction.reproduce()))
    picture(HERE / "step-response.png")


def factors() -> str:
    """Pint's factors between the units that the program writes: of the parameters, and of every `Unit` of every module."""
    for module in pkgutil.walk_packages(ff.__path__, "forcefeel."):
        import_module(module.name)
    own = [thing for thing in gc.get_objects() if isinstance(thing, units.Unit)]
    rows = set()
    for known in [*own, *map(unit, (TABLE | ALTERNATIVES).values())]:
        for name in {known.si, known.metric, known.us}:
            rows |= {(name, known.si), (known.si, name)}
    lines = [f"{name},{other},{units.factor_by_pint(name, other)!r}" for name, other in sorted(rows)]
    return "\n".join(["unit,in,factor", *lines]) + "\n"


def picture(path: Path) -> None:
    """Step of the pilot's force on the built-in digital loader: original loop, law `robust` and the programmed feel."""
    loader = ff.digital_elevator()
    scenario = ff.Scenario(ff.Step(loader["pilot.force"], start_s=0.1), duration_s=2.0)
    original, robust = (ff.simulate(loader, scenario, law) for law in ("original", "robust"))
    curves = (
        ("original loop", original.history["column_angle_rad"], {"color": "#d55e00"}),
        ("law robust", robust.history["column_angle_rad"], {"color": "#009e73", "linewidth": 3.5, "alpha": 0.7}),
        ("programmed feel", ideal_angle(robust), {"color": "black", "linestyle": ":", "linewidth": 1.8}),
    )
    figure, axes = pyplot.subplots(figsize=(9, 4.2), layout="constrained")
    for label, angle, style in curves:
        axes.plot(original.history["time_s"], np.degrees(angle), label=label, **style)
    axes.set(xlabel="Time, s", ylabel="Column angle, deg", xlim=(0, scenario.duration_s))
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", frameon=False)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main()
