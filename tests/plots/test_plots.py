"""Results plot themselves: what is drawn is what was computed, in the units of the labels, on the axes that were given."""

import subprocess
import sys

import control
import matplotlib as mpl
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.identification.result import Estimate, Identification, Status
from forcefeel.bench.identification.unknowns import Unknown
from forcefeel.envelope.result import COLORS

mpl.use("Agg")
import matplotlib.pyplot as plt

POUND = 4.4482216152605  # N
ROUNDING = 1e-9  # relative: two ways through a few hundred operations


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def run():
    return ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0), duration_s=0.5))


@pytest.fixture(scope="module")
def envelope():
    grid = {"stiffness": "2..100 %:5:log", "frequency": "1..4 Hz:4:log", "damping": "0.2, 0.7"}
    return ff.find_envelope(ff.elevator(), ["original", "converged"], grid)


def legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_run_plots_column_and_programmed_angle(run):
    ax = run.plot()
    column, programmed = ax.get_lines()
    np.testing.assert_allclose(column.get_ydata(), np.degrees(run.history["column_angle_rad"]), rtol=ROUNDING)
    assert abs(programmed.get_ydata()[-1] - column.get_ydata()[-1]) < 0.5 * abs(
        column.get_ydata()[-1]
    )  # both in degrees
    assert legend(ax) == ["column angle", "programmed angle"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Time, s", "Angle, deg")
    assert run.note in ax.get_title()


def test_run_plots_named_outputs_in_requested_units(run):
    _, ax = plt.subplots()
    assert run.plot("pilot_force_n", units=ff.UnitSystem.US, ax=ax) is ax
    np.testing.assert_allclose(ax.get_lines()[0].get_ydata(), run.history["pilot_force_n"] / POUND, rtol=ROUNDING)
    assert ax.get_ylabel() == "Pilot force, lb"


def test_run_plot_of_unknown_output_raises_input_error(run):
    with pytest.raises(ff.InputError, match=r"^outputs: expected names such as .*, got 'angle'$"):
        run.plot("angle")
    with pytest.raises(ff.InputError, match=r"^outputs: expected one kind of quantity on one axis, got A, N$"):
        run.plot("pilot_force_n", "valve_current_a")
    with pytest.raises(ff.InputError, match=r"^ax: expected Matplotlib axes, got 3$"):
        run.plot(ax=3)


def test_bode_matches_python_control():
    loader = ff.elevator()
    gain, phase = loader.plot_bode(frequency_hz=[0.5, 2.0, 11.4])
    models = (ff.compliant_model(loader), ff.linear.ideal_feel(loader))
    for k, model in enumerate(models):
        expected = control.frequency_response(model[0, 0], 2 * np.pi * np.array([0.5, 2.0, 11.4])).frdata[0, 0]
        np.testing.assert_allclose(
            gain.get_lines()[k].get_ydata(), np.degrees(np.abs(expected)), rtol=1e-6
        )  # poles to 3e4
        turned = phase.get_lines()[k].get_ydata() - np.degrees(np.angle(expected))
        np.testing.assert_allclose(turned / 360, np.round(turned / 360), atol=1e-6)  # of a turn
    assert legend(gain) == ["loader", "programmed feel"]
    assert (gain.get_ylabel(), phase.get_ylabel()) == ("Angle per force, deg/N", "Phase, deg")


def test_bode_uses_passed_axes_and_refuses_invalid_axes():
    _, pair = plt.subplots(2, 1)
    assert list(ff.elevator().plot_bode(units=ff.UnitSystem.US, ax=pair)) == list(pair)
    assert pair[0].get_ylabel() == "Angle per force, deg/lb"
    with pytest.raises(ff.InputError, match=r"^ax: expected two Matplotlib axes"):
        ff.elevator().plot_bode(ax=pair[:1])
    for given in (0.0, ["a"], []):
        with pytest.raises(ff.InputError, match=r"^frequency_hz: expected frequencies above 0 Hz"):
            ff.elevator().plot_bode(frequency_hz=given)
    with pytest.raises(ff.InputError, match=r"^law: expected an analog law"):
        ff.elevator().plot_bode("robust")


def test_envelope_plots_map_nearest_to_damping(envelope):
    ax = envelope.plot("original", damping=0.6, worst=False)
    drawn = np.asarray(ax.collections[0].get_array()).reshape(4, 5)
    np.testing.assert_array_equal(drawn, envelope.kinds("original", worst=False)[1])
    assert set(legend(ax)) == {list(COLORS)[k] for k in np.unique(drawn)} | {"the loader's own setting"}
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Stiffness, % of $G_{max}$", "Natural frequency, Hz")
    with pytest.raises(ff.InputError, match=r"^law: expected one of original, converged, got 'best'$"):
        envelope.plot("best")


def found(*statuses):
    loader = ff.elevator()
    unknowns = [
        Unknown("linkage.stiffness", 1e6, 8e5, 1.2e6, loader.tolerances["linkage.stiffness"]),
        Unknown("linkage.damping", 2e3, 0.0, 1e6, None),
    ]
    estimates = tuple(
        Estimate(one, 1.1 * one.nominal, 0.01 * one.nominal, 1.08 * one.nominal, 1.12 * one.nominal, 0.02, status)
        for one, status in zip(unknowns, statuses, strict=True)
    )
    return Identification(loader, estimates, np.eye(2), (), (), (), (), None, ())


def test_identification_plots_intervals_over_tolerances():
    ax = found(Status.DETERMINED, Status.UNDETERMINED).plot()
    assert [text.get_text() for text in ax.get_yticklabels()] == ["k", "c"]
    assert [text.get_text() for text in ax.texts] == ["not determined"]
    value = ax.containers[1][0].get_xdata()
    np.testing.assert_allclose(value, [10.0], rtol=ROUNDING)
    np.testing.assert_allclose([ax.patches[0].get_x(), ax.patches[0].get_width()], [-20.0, 40.0], rtol=ROUNDING)
    assert ax.get_xlabel() == "Off the file's value, %"


def test_results_have_readable_repr(run, envelope):
    assert repr(run) == f"<Run of 'elevator-1974', 0.5 s, {run.method}: {run.note}>"
    assert repr(envelope).startswith("<Envelope of 'elevator-1974', 40 settings: original passes at ")
    assert "c not determined" in repr(found(Status.DETERMINED, Status.UNDETERMINED))
    assert repr(ff.elevator()).startswith("<Loader 'elevator-1974': feel G = 9600 lb in/rad, 2.01 Hz")


def _frontier():
    grid = {"stiffness": "20, 100 %", "frequency": "1.5, 3 Hz", "damping": "0.3, 0.7"}
    return ff.find_frontier(ff.elevator(), "published", grid, changes={"column.inertia": 0.2}, arms=())


def _qualification():
    setup = ff.qualification.QualificationSetup(tests=("release-25-positive",))
    return ff.qualify_loader(ff.elevator(), setup)


@pytest.mark.parametrize(
    ("make", "text", "shown"),
    [
        (
            lambda: ff.design_loader(ff.elevator()),
            "<Design of 'elevator-1974': programmed 2.01 Hz, 0.2; compensated 1.62 Hz, damping ratio 0.24>",
            '<th scope="row">compensated</th><td>1.62 Hz</td><td>0.24</td>',
        ),
        (
            lambda: ff.run_sweep(ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), runs=32)),
            "<Sweep of 'elevator-1974', 32 runs: 32 moving>",
            '<th scope="row">moving</th><td>32</td>',
        ),
        (_frontier, "<Frontier of 'elevator-1974' with published, 8 settings: ", "<b>elevator-1974 with published</b>"),
        (
            _qualification,
            "<Qualification of 'elevator-1974', pitch, by part60-a-2014: original loop does not qualify, 0 of 1 tests passed>",
            '<th scope="row">original loop</th><td>does not qualify</td>',
        ),
    ],
)
def test_results_have_text_and_notebook_repr(make, text, shown):
    result = make()
    assert repr(result).startswith(text)
    assert "\n" not in repr(result)
    assert shown in result._repr_html_()


def test_notebooks_show_tables_and_pictures(run):
    page = ff.elevator().replace({"valve.orifice": True})._repr_html_()
    assert "<td>linkage.stiffness</td>" in page
    assert "<td>6107.9 lb/in</td>" in page
    assert "<td>valve.orifice</td>" in page
    assert "controller.period" not in page  # off
    assert "<td>20 %</td>" in page
    named = ff.Loader("<b>", "", ff.elevator().si_values)
    assert "<b><b></b>" not in named._repr_html_()
    shown = run._repr_html_()
    assert '<img src="data:image/png;base64,' in shown
    assert plt.get_fignums() == []


def test_computation_does_not_import_plots():
    code = "import sys, forcefeel as ff; repr(ff.simulate(ff.elevator(), ff.Scenario(duration_s=0.01)));"
    code += "print('forcefeel.plots.draw' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
