"""An interconnect: a link with a ratio between two axes of one pilot, which follow one another as by hand."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError

AXES = '[axes]\nroll = "aileron-wheel"\nyaw = "rudder-pedals"\n'
STIFFNESS, RATIO = 60.0, 0.1
SPRING = f'kind = "electronic"\nstiffness = "{STIFFNESS} N m/rad"\nratio = {RATIO}\n'
LINK = f'[links.aileron-rudder]\nbetween = ["yaw", "roll"]\n{SPRING}'
PLAIN = {"feel.breakout": None, "feel.coulomb_friction": None, "feel.deadband": None}
FORCE_N = 20.0
"""At the wheel's grip."""

SHARE = 0.02
"""Of an angle at rest under robust: compliance, and friction of the drive that the law does not know."""


@pytest.fixture
def project(tmp_path):
    path = tmp_path / "cockpit.toml"
    path.write_text(AXES + LINK, encoding="utf-8")
    return ff.loader.read_project(path)


def equilibrium(project):
    """Angles of pedals and wheel: both springs, and that between them, by two equations."""
    roll, yaw = (project.loaders[axis] for axis in ("roll", "yaw"))
    matrix = np.array(
        [
            [yaw["feel.stiffness"] + STIFFNESS, -STIFFNESS * RATIO],
            [-STIFFNESS * RATIO, roll["feel.stiffness"] + STIFFNESS * RATIO**2],
        ]
    )
    return np.linalg.solve(matrix, [0.0, roll["column.grip_arm"] * FORCE_N])


def test_pedals_follow_the_wheel_as_the_springs_say(project):
    pushed = ff.linked.LinkedScenario(ff.Scenario(duration_s=6.0), second_force=ff.Step(FORCE_N))
    run = ff.linked.simulate_linked(project, "aileron-rudder", pushed, "robust")
    found = [run.measures.first_final_angle_rad, run.measures.second_final_angle_rad]
    yaw, roll = equilibrium(project)
    assert found == pytest.approx([yaw, roll], rel=SHARE)
    assert yaw > 0.004


def test_live_axes_have_the_angles_of_the_simulation(project):
    with ff.live.start_cockpit(project, "robust", real_time=False) as cockpit:
        cockpit.on()
        cockpit.wait(4000)
        cockpit["roll"].hand_force_n = FORCE_N
        cockpit.wait(12_000)
        column = cockpit["yaw"].columns.index("column_angle_rad")
        found = [cockpit[axis].history(most=500)[:, column].mean() for axis in ("yaw", "roll")]
        with pytest.raises(InputError, match="expected a link between two pilots"):
            cockpit.disconnect("aileron-rudder")
    assert found == pytest.approx(equilibrium(project), rel=SHARE)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (AXES + LINK.replace(f"ratio = {RATIO}", "ratio = 0"), "ratio: expected a number other than 0"),
        (
            '[axes]\npitch = "elevator-2khz"\npitch-first-officer = "elevator-2khz"\n'
            '[links.pitch]\nbetween = ["pitch", "pitch-first-officer"]\nstiffness = "1000 lb in/rad"\nratio = 0.5\n',
            "links.pitch.ratio: is of an interconnect",
        ),
        (
            AXES + 'pitch = "elevator-2khz"\n'
            '[links.a]\nbetween = ["yaw", "roll"]\nstiffness = "100 lb in/rad"\n'
            '[links.b]\nbetween = ["yaw", "pitch"]\nstiffness = "100 lb in/rad"\n',
            "yaw is linked by a already",
        ),
    ],
)
def test_bad_interconnect_is_refused(tmp_path, text, message):
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        ff.loader.read_project(path)


def test_wheel_has_a_link_of_both_pilots_and_an_interconnect(tmp_path):
    """The shaft between both wheels, the pedals after the first wheel; nothing but the shaft is judged as a link of two pilots."""
    path = tmp_path / "cockpit.toml"
    wheels = 'roll-first-officer = "aileron-wheel"\n'
    shaft = '[links.roll]\nbetween = ["roll", "roll-first-officer"]\nstiffness = "2000 lb in/rad"\ndamping = "5 lb in s/rad"\n'
    path.write_text(AXES + wheels + LINK + shaft, encoding="utf-8")
    project = ff.loader.read_project(path)
    assert list(project.pilot_links) == ["roll"]
    with ff.live.start_cockpit(project, "robust", real_time=False) as cockpit:
        cockpit.on()
        cockpit.wait(4000)
        cockpit["roll-first-officer"].hand_force_n = 2 * FORCE_N
        cockpit.wait(8000)
        angles = {
            axis: session.history(most=1)[0, session.columns.index("column_angle_rad")]
            for axis, session in cockpit.items()
        }
    assert angles["roll"] == pytest.approx(angles["roll-first-officer"], rel=0.2)  # the twist of the shaft
    assert angles["yaw"] > 0.004


def test_check_of_an_interconnect_is_refused(project):
    with pytest.raises(
        InputError, match=r"expected a link that joins one control of two pilots .* the interconnect aileron-rudder"
    ):
        ff.linked.check_link(project, "aileron-rudder", "robust")
    with pytest.raises(InputError, match="got 'aileron'"):
        ff.linked.check_link(project, "aileron", "robust")


def test_frontier_of_interconnects_alone_says_so(forcefeel, project):
    status, _, error = forcefeel("frontier", project.path)
    assert status == 2
    assert "has interconnects alone; add a link between two pilots' controls" in error
