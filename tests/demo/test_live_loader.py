"""The live loader of the docs: its committed model gives the bits of a simulation, its page shows them.

Where a change of the model changes numbers, ``make demo`` compiles it anew.
"""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.loader.feel_settings import own_feel
from forcefeel.qualification.batch_verdicts import NAMES
from forcefeel.simulation.engine import prepared
from tests.pages import WIDTHS, new_window, seldom_drawn
from tests.parametrization import mostly_slow

DEMO = Path(__file__).parents[2] / "docs" / "demo"
LARGEST_BYTES = 300_000
HELD_RAD = math.radians(5)
OUTPUTS = 10
OTHER_MACHINE = 1e-6
"""Relative; designs of laws on another processor."""
OTHER_IDEAL = 1e-6
"""Of a margin: the programmed feel by other functions, and in another sum."""

spec = importlib.util.spec_from_file_location("live_loader", DEMO.parent / "live_loader.py")
make = importlib.util.module_from_spec(spec)
spec.loader.exec_module(make)

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def page(browser):
    with new_window(browser) as window:
        seldom_drawn(window).goto((DEMO / "index.html").as_uri())
        window.wait_for_selector(".passed, .failed")
        yield window


@pytest.fixture(scope="module")
def data() -> dict:
    """What ``make demo`` writes beside the model."""
    return make.data()


def loaders() -> dict[str, tuple[ff.Loader, str]]:
    """Loaders that are stepped, and their laws; the third is not the one of its law."""
    rough = {"column.coulomb_friction": "1 lb"}
    return {
        "original": (ff.elevator().replace(rough), "original"),
        "published": (ff.elevator().replace(rough), "published"),
        "robust": (ff.digital_elevator().replace(rough | {"linkage.stiffness": "3000 lb/in"}), "robust"),
        "heavy": (ff.digital_elevator().replace({"column.stop_high": "3 deg", "feel.deadband": "1 deg"}), "robust"),
    }


@pytest.mark.parametrize("name", mostly_slow(loaders(), 2))
def test_run_gives_the_bits_of_a_simulation(page, name):
    loader, law = loaders()[name]
    law = ff.Law.of(law, loader)
    step_s, *_ = make.timing(loader)
    run = ff.simulate(loader, ff.Scenario(ff.Release(HELD_RAD), 2500 * step_s, make.STEP_S, step_s), law)
    expected = np.transpose([run.history[output].values for output in run.history.data_vars])
    actual = rows(page, make.setup(loader, law, HELD_RAD), len(expected))
    assert run.method == "stepped"
    assert expected.shape == (2501, OUTPUTS)
    np.testing.assert_array_equal(actual, expected)
    assert np.ptp(actual[:, 0]) > HELD_RAD


def test_force_and_spring_of_a_host_give_the_bits_of_a_simulation(page):
    loader = ff.digital_elevator()
    law, steps, added = ff.Law.of("robust", loader), 2500, (20.0, 300.0)
    engine = prepared(loader, ff.Scenario(duration_s=steps * 5e-4), law=law)
    inputs = {"added_force": added[0], "added_stiffness": added[1], "force": 0.0}
    given = {key: np.full((steps, 2), value) for key, value in inputs.items()}
    engine = _core.Simulation(given, 5e-4, outputs=range(OUTPUTS), held=(HELD_RAD, 0), timing=(1, 1))
    _, histories = engine.run(loader.si_values[np.newaxis], **law.engine(loader))
    actual = rows(page, make.setup(loader, law, HELD_RAD), steps + 1, added)
    np.testing.assert_array_equal(actual, histories[0].T)


def rows(page, setup: list[float], steps: int, added: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Outputs at the start of each step, as the page's model gives them."""
    values = page.evaluate(
        """async ([setup, steps, added]) => {
            const loader = (await demoCore).loader(setup);
            loader.add(...added);
            return [...loader.run(steps)];
        }""",
        [setup, steps, added],
    )
    return np.reshape(values, (steps, OUTPUTS))


@pytest.mark.parametrize(
    ("law", "frequency", "damping"),
    mostly_slow([("original", 2.0, 0.2), ("published", 0.7, 0.4), ("robust", 1.4, 1.0), ("robust", 4.0, 0.1)]),
)
def test_verdict_is_that_of_the_rule(page, data, law, frequency, damping):
    loader = make.with_feel(make.LAWS[law](), frequency, damping)
    test = ff.qualification.load_rules().of("release", "pitch")
    law = ff.Law.of(law, loader)
    feel = next(one for one in data["feels"] if (one["frequency"], one["damping"]) == (frequency, damping))
    step_s, *_ = make.timing(loader)
    count, every = round(feel["duration"] / feel["sample"]) + 1, round(feel["sample"] / step_s)
    setup = make.setup(loader, law, HELD_RAD)
    angles = rows(page, setup, (count - 1) * every + 1)[::every, 0]
    judged = page.evaluate(
        """async ([setup, angles, sample]) => {
            const core = await demoCore;
            return core.judge(angles, core.ideal(setup, sample, angles.length), sample);
        }""",
        [setup, angles.tolist(), feel["sample"]],
    )
    time_s = np.arange(count) * feel["sample"]
    ideal = ideal_releases(own_feel(loader), HELD_RAD, feel["sample"], count)
    batch, reference = (ff.qualification.measure_releases(time_s, run) for run in (angles[np.newaxis], ideal))
    verdict = ff.qualification.judge_releases(batch, reference, test)
    first = verdict.first_failing[0]
    assert judged["fails"] == (None if first < 0 else NAMES[first])
    np.testing.assert_allclose(1 - judged["used"], verdict.margin[0], atol=OTHER_IDEAL)


def test_laws_and_rule_are_those_of_the_program(page, data):
    assert same(page.evaluate("forcefeelEngine.data"), data) == []
    feel = data["feels"][-1]
    for name, base in make.LAWS.items():
        loader = make.with_feel(base(), feel["frequency"], feel["damping"])
        setup = page.evaluate(
            "([law, held]) => setup(law, forcefeelEngine.data.feels.at(-1), {}, { held })", [name, HELD_RAD]
        )
        assert same(setup, make.setup(loader, ff.Law.of(name, loader), HELD_RAD)) == []


def same(actual: object, expected: object, at: str = "data") -> list[str]:
    """Where two trees differ."""
    if isinstance(expected, dict):
        return [wrong for key in expected | actual for wrong in same(actual.get(key), expected.get(key), f"{at}.{key}")]
    if isinstance(expected, list | tuple) and len(actual) == len(expected):
        pairs = zip(actual, expected, strict=True)
        return [wrong for k, pair in enumerate(pairs) for wrong in same(*pair, f"{at}[{k}]")]
    if isinstance(expected, float | int) and isinstance(actual, float | int):
        scale = max(abs(expected), 1e-300)
        near = actual == expected or abs(actual - expected) <= OTHER_MACHINE * scale
        return [] if near or (math.isnan(actual) and math.isnan(expected)) else [f"{at}: {actual} and {expected}"]
    return [] if actual == expected else [f"{at}: {actual} and {expected}"]


def test_all_of_it_is_small():
    assert sum(path.stat().st_size for path in DEMO.iterdir()) < LARGEST_BYTES


@pytest.mark.parametrize("width", [WIDTHS[0], pytest.param(WIDTHS[1], marks=pytest.mark.slow)])
def test_column_follows_the_pointer_and_verdict_follows_the_law(browser, width):
    with new_window(browser) as window:
        seldom_drawn(window)
        window.set_viewport_size({"width": width, "height": 900})
        window.emulate_media(reduced_motion="reduce")
        window.goto((DEMO / "index.html").as_uri())
        section = window.locator(".live-loader section").first
        words, verdict = section.locator(".reading"), section.locator(".verdict")
        verdict.filter(has_text="Fails: period P0").wait_for()
        grip, drawing = (section.locator(name).first.bounding_box() for name in (".grip", "svg[tabindex]"))
        x, y = grip["x"] + grip["width"] / 2, grip["y"] + grip["height"] / 2
        window.mouse.move(x, y)
        window.mouse.down()
        window.mouse.move(
            x + drawing["width"] / 16, y, steps=3
        )  # 30 of 152 units beside the pivot: 11.2 deg, drawn 4 times
        words.filter(has_text="column 2.8 deg").wait_for()
        assert "hand 0.0 lb" not in words.text_content()
        window.mouse.up()
        words.filter(has_text="column 0.0 deg · hand 0.0 lb").wait_for()
        section.locator("svg[tabindex]").press("ArrowRight")
        words.filter(has_text="column 1.0 deg").wait_for()
        section.get_by_label("robust").check()
        verdict.filter(has_text="Passes").wait_for()
        window.locator(".verdict", has_text="Does not settle").wait_for()
        window.get_by_label("Rate of the host").fill("5")
        window.locator(".verdict", has_text="Settles").wait_for()
        assert window.evaluate("document.documentElement.scrollWidth") <= width
        assert window.complaints == []
        assert {Path(url).parent.name for url in window.requested} == {"demo"}
