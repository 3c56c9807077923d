"""The test guide of a cockpit: the tests of a rule on each axis of a project."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from forcefeel.conclusions import Conclusions, capital, of_result
from forcefeel.errors import InputError
from forcefeel.loader.axes import rule_axis
from forcefeel.loader.loader import Loader
from forcefeel.loader.project import Project
from forcefeel.qualification.plan.result import Qualification, QualificationStatus, worst_status
from forcefeel.qualification.plan.run import Progress, QualificationSetup, qualify_loader
from forcefeel.qualification.plan.sentences import reasons, rule_text, standing_text


@dataclass(frozen=True, eq=False)
class CockpitQualification:
    r"""The qualification of each axis of a cockpit.

    Attributes:
        name: The project, by its file.
        axes: By axis, in the file's order.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\nyaw = "rudder-pedals"\n', encoding="utf-8")
        >>> one_test = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> cockpit = ff.qualification.qualify_cockpit(ff.loader.read_project("cockpit.toml"), lambda loader: one_test)
        >>> str(cockpit.status)
        'incomplete'
    """

    name: str
    axes: Mapping[str, Qualification]

    @property
    def status(self) -> QualificationStatus:
        """The worst of the axes'."""
        return worst_status(qualification.status for qualification in self.axes.values())

    @property
    def qualifies(self) -> bool:
        """Whether every axis does."""
        return self.status is QualificationStatus.QUALIFIES

    @property
    def fulfilled(self) -> bool:
        """Whether every axis qualifies, or passed every test where only some were asked for."""
        return all(qualification.fulfilled for qualification in self.axes.values())


def qualify_cockpit(
    project: Project,
    setup: Callable[[Loader], QualificationSetup] = lambda _: QualificationSetup(),
    *,
    progress: Progress = lambda test, done, total: None,
) -> CockpitQualification:
    r"""Makes the tests of a rule on each axis of a project.

    Args:
        project: The project.
        setup: How a loader of it is qualified. The rule's rows are those of its axis, whatever the setup says; of a stick those
            of pitch and roll.
        progress: Called as each test of an axis begins.

    Raises:
        InputError: As ``qualify_loader``, with the axis; or if a setup has records or references, which are of one control.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\nyaw = "rudder-pedals"\n', encoding="utf-8")
        >>> one_test = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> cockpit = ff.qualification.qualify_cockpit(ff.loader.read_project("cockpit.toml"), lambda loader: one_test)
        >>> cockpit.fulfilled, cockpit.axes["yaw"].axis
        (True, 'yaw')
    """

    def qualified(axis: str, loader: Loader) -> Qualification:
        axis_setup = setup(loader)
        if axis_setup.records or axis_setup.references:
            raise InputError("setup: has records or references, which are of one control; qualify its loader by itself")
        return qualify_loader(
            loader,
            replace(axis_setup, axis=rule_axis(axis)),
            progress=lambda test, done, total: progress(f"{axis}, {test}", done, total),
        )

    return CockpitQualification(project.name, project.each(qualified))


@of_result
def cockpit_conclusions(cockpit: CockpitQualification) -> Conclusions:
    """What to conclude of the whole: each axis's verdict, and the first tests that are off."""
    rules = " and ".join(dict.fromkeys(map(rule_text, cockpit.axes.values())))
    lines = []
    for axis, qualification in cockpit.axes.items():
        texts = [
            text
            for section in qualification.sections
            for text in (standing_text(section), *reasons(section, qualification)[:1])
        ]
        lines.append(f"{capital(axis)}, {qualification.loader.name}: {' '.join(texts)}")
    return Conclusions(cockpit.fulfilled, f"By {rules} the cockpit {_standing(cockpit)}.", tuple(lines))


def _standing(cockpit: CockpitQualification) -> str:
    if cockpit.status is QualificationStatus.QUALIFIES:
        return f"qualifies: {_listed(cockpit, QualificationStatus.QUALIFIES)}"
    short = {
        QualificationStatus.DOES_NOT_QUALIFY: "does not qualify",
        QualificationStatus.INCOMPLETE: "is not complete",
    }
    if cockpit.fulfilled:
        return f"passed what was asked for: {', '.join(cockpit.axes)}"
    return "; ".join(f"{text}: {axes}" for status, text in short.items() if (axes := _listed(cockpit, status)))


def _listed(cockpit: CockpitQualification, status: QualificationStatus) -> str:
    return ", ".join(axis for axis, qualification in cockpit.axes.items() if qualification.status is status)
