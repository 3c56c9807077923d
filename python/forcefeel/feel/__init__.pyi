"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.feel.findings import feel_conclusions as feel_conclusions
from forcefeel.feel.fit import fit_feel as fit_feel
from forcefeel.feel.page.page import write_feel as write_feel
from forcefeel.feel.plan import FeelPlan as FeelPlan
from forcefeel.feel.result import FeelFit as FeelFit
