"""Makes what the program can make of the documentation: the validation table and the README's picture."""

import shutil
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

import forcefeel as ff
from forcefeel.files import write_whole
from forcefeel.reproduction import markdown

HERE = Path(__file__).parent

VALIDATION = """\
# The 1974 report, number by number

Made by `make docs` from what `forcefeel reproduce` prints. Printed values are typed in from the report; computed values come
from the models. "Agrees" means: rounds to the printed digits. The lost curves of figures 7 to 11 and 14 are compared by
what the text says of them; figures 1, 3 to 6, 12 and 13 are drawings.

"""


def main() -> None:
    write_whole(HERE / "reference" / "validation.md", VALIDATION + markdown(ff.reproduce()))
    picture(HERE / "step-response.png")


def picture(path: Path) -> None:
    """Figure 14 of the built-in loader, as the report page draws it."""
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None:
        raise SystemExit("docs: no Chromium found; install one to draw the picture")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        page_file = ff.write_report(ff.design(ff.elevator()), Path(folder), ff.UnitSystem.US)
        chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox", "--disable-gpu"])
        page = chromium.new_page(viewport={"width": 1100, "height": 900}, device_scale_factor=1.5)
        page.goto(page_file.as_uri())
        page.locator("#figure-14-figure").screenshot(path=path)
        chromium.close()


if __name__ == "__main__":
    main()
