"""The test guide of a cockpit: the tests of a rule on each axis of a project."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from forcefeel.conclusions import Conclusions, capital, of_result
from forcefeel.errors import InputError
from forcefeel.laws.law import LawLike
from forcefeel.loader.axes import rule_axis
from forcefeel.loader.loader import Loader
from forcefeel.loader.project import Project
from forcefeel.qualification.own_checks import LinkChecks, OwnCheck, link_findings
from forcefeel.qualification.plan.result import Qualification, QualificationStatus, worst_status
from forcefeel.qualification.plan.run import Progress, QualificationSetup, qualify_loader
from forcefeel.qualification.plan.sentences import reasons, rule_text, standing_text
from forcefeel.units import UnitSystem


@dataclass(frozen=True, eq=False)
class CockpitQualification:
    r"""The qualification of each axis of a cockpit.

    Attributes:
        name: Name of the project's file.
        axes: Qualification by axis, in the file's order.
        links: Checks of each link, forcefeel's own; none where only some tests were requested.
    """

    name: str
    axes: Mapping[str, Qualification]
    links: LinkChecks = field(default_factory=dict)

    @property
    def system(self) -> UnitSystem:
        """Unit system of the first axis."""
        return next(iter(self.axes.values())).system

    @property
    def status(self) -> QualificationStatus:
        """The worst status of the axes."""
        return worst_status(qualification.status for qualification in self.axes.values())

    @property
    def qualifies(self) -> bool:
        """Whether every axis qualifies."""
        return self.status is QualificationStatus.QUALIFIES

    @property
    def fulfilled(self) -> bool:
        """Whether every axis qualifies, or passed all requested tests where only some were requested, and every link its checks."""
        links = all(check.passed for checks in self.links.values() for check in checks)
        return links and all(qualification.fulfilled for qualification in self.axes.values())


def qualify_cockpit(
    project: Project,
    setup: Callable[[Loader], QualificationSetup] = lambda _: QualificationSetup(),
    *,
    check_link: Callable[[Project, str, LawLike], tuple[OwnCheck, ...]] | None = None,
    progress: Progress = lambda test, done, total: None,
) -> CockpitQualification:
    r"""Runs the tests of a rule on each axis of a project.

    Args:
        project: The project.
        setup: Setup for a loader. The axis of the project overrides that of the setup; a stick is tested as pitch and roll.
        check_link: Checks of a link under the first law of its first axis: ``linked.check_link``. Default: links are left out.
        progress: Called when a test of an axis begins.

    Raises:
        InputError: As ``qualify_loader``, with the axis; or if a setup has records or references, which belong to one control.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\nyaw = "rudder-pedals"\n', encoding="utf-8")
        >>> one_test = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> cockpit = ff.qualification.qualify_cockpit(ff.loader.read_project("cockpit.toml"), lambda loader: one_test)
        >>> cockpit.fulfilled, cockpit.axes["yaw"].axis
        (True, 'yaw')
    """

    def qualified(axis: str, loader: Loader) -> Qualification:
        axis_setup = setup(loader)
        if axis_setup.records or axis_setup.references:
            raise InputError("setup: records and references belong to one control; qualify its loader separately")
        return qualify_loader(
            loader,
            replace(axis_setup, axis=rule_axis(axis)),
            progress=lambda test, done, total: progress(f"{axis}, {test}", done, total),
        )

    axes = project.each(qualified)
    links = {
        name: check_link(project, name, _first_law(first))
        for name, link in project.pilot_links.items()
        if check_link and not (first := setup(project.loaders[link.between[0]])).tests
    }
    return CockpitQualification(project.name, axes, links)


def _first_law(setup: QualificationSetup) -> LawLike:
    if isinstance(setup.laws, Mapping):
        return next(iter(setup.laws.values()))
    return next(iter(setup.laws or (None,)))


@of_result
def cockpit_conclusions(cockpit: CockpitQualification) -> Conclusions:
    """Conclusions for the cockpit: the verdict of each axis, and the first tests that fail."""
    rules = " and ".join(dict.fromkeys(map(rule_text, cockpit.axes.values())))
    lines = []
    for axis, qualification in cockpit.axes.items():
        texts = [
            text
            for section in qualification.sections
            for text in (standing_text(section), *reasons(section, qualification)[:1])
        ]
        lines.append(f"{capital(axis)}, {qualification.loader.name}: {' '.join(texts)}")
    return Conclusions(
        cockpit.fulfilled,
        f"By {rules} the cockpit {_standing(cockpit)}.",
        (*lines, *link_findings(cockpit.links, cockpit.system)),
    )


def _standing(cockpit: CockpitQualification) -> str:
    if cockpit.status is QualificationStatus.QUALIFIES:
        return f"qualifies: {_listed(cockpit, QualificationStatus.QUALIFIES)}"
    short = {
        QualificationStatus.DOES_NOT_QUALIFY: "does not qualify",
        QualificationStatus.INCOMPLETE: "is not complete",
    }
    if cockpit.fulfilled:
        return f"passed the requested tests: {', '.join(cockpit.axes)}"
    return "; ".join(f"{text}: {axes}" for status, text in short.items() if (axes := _listed(cockpit, status)))


def _listed(cockpit: CockpitQualification, status: QualificationStatus) -> str:
    return ", ".join(axis for axis, qualification in cockpit.axes.items() if qualification.status is status)
