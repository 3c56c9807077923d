"""Makes what the program can make of itself: the validation table, the README's picture, the table of common factors of units."""

import gc
import pkgutil
import shutil
import tempfile
from importlib import import_module
from pathlib import Path

from playwright.sync_api import sync_playwright

import forcefeel as ff
from forcefeel import units
from forcefeel.files import write_whole
from forcefeel.loader.parameters import ALTERNATIVES, TABLE, unit
from forcefeel.reproduction import markdown

HERE = Path(__file__).parent
FACTORS = Path(units.__file__).parent / "data" / "factors.csv"

VALIDATION = """\
# The 1974 report, number by number

Made by `make docs` from what `forcefeel reproduce` prints. Printed values are typed in from the report; computed values come
from the models. "Agrees" means: rounds to the printed digits. The lost curves of figures 7 to 11 and 14 are compared by
what the text says of them; figures 1, 3 to 6, 12 and 13 are drawings.

"""


def main() -> None:
    write_whole(FACTORS, factors())
    write_whole(HERE / "reference" / "validation.md", VALIDATION + markdown(ff.reproduction.reproduce()))
    picture(HERE / "step-response.png")


def factors() -> str:
    """Pint's factors between the units that the program writes: of the parameters, and of every `Unit` of every module."""
    for module in pkgutil.walk_packages(ff.__path__, "forcefeel."):
        import_module(module.name)
    own = [one for one in gc.get_objects() if isinstance(one, units.Unit)]
    rows = set()
    for one in [*own, *map(unit, (TABLE | ALTERNATIVES).values())]:
        for shown in {one.si, one.metric, one.us}:
            rows |= {(shown, one.si), (one.si, shown)}
    lines = [f"{one},{other},{units.factor_by_pint(one, other)!r}" for one, other in sorted(rows)]
    return "\n".join(["unit,in,factor", *lines]) + "\n"


def picture(path: Path) -> None:
    """Figure 14 of the built-in loader, as the report page draws it."""
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None:
        raise SystemExit("docs: no Chromium found; install one to draw the picture")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        page_file = ff.design.write_report(ff.design_loader(ff.elevator()), Path(folder), ff.UnitSystem.US)
        chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox", "--disable-gpu"])
        page = chromium.new_page(viewport={"width": 1100, "height": 900}, device_scale_factor=1.5)
        page.goto(page_file.as_uri())
        page.locator("#figure-14-figure").screenshot(path=path)
        chromium.close()


if __name__ == "__main__":
    main()
