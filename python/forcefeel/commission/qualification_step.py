"""The fourth step: the tests of the rule, on the identified loader under the law."""

from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import RuleTests
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.qualification.plan.result import Qualification
from forcefeel.qualification.plan.run import QualificationSetup, qualify_loader
from forcefeel.qualification.plan.sentences import caveats, reasons, rule_text, standing_text


def run_tests(loader: Loader, name: str, law: Law, plan: CommissionPlan) -> tuple[RuleTests, Qualification]:
    """Run the tests of the rule at the loader's own setting, under its law there."""
    setup = QualificationSetup(laws={name: law}, rule=plan.rule, system=plan.units)
    qualification = qualify_loader(loader, setup)
    (section,) = qualification.sections
    outcomes = {result.trial.key: str(result.outcome) for result in section.results}
    why = tuple(reasons(section, qualification))
    return RuleTests(
        section.fulfilled, rule_text(qualification), standing_text(section), outcomes, why, caveats(qualification)
    ), qualification
