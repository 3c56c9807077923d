"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.linked.engine import PairValues as PairValues
from forcefeel.linked.engine import simulate_linked as simulate_linked
from forcefeel.linked.engine import simulate_linked_batch as simulate_linked_batch
from forcefeel.linked.findings import linked_conclusions as linked_conclusions
from forcefeel.linked.link_checks import check_link as check_link
from forcefeel.linked.page.page import write_linked as write_linked
from forcefeel.linked.result import LinkedRun as LinkedRun
from forcefeel.linked.result import LinkMeasures as LinkMeasures
from forcefeel.linked.scenario import Button as Button
from forcefeel.linked.scenario import Jam as Jam
from forcefeel.linked.scenario import LinkedScenario as LinkedScenario
from forcefeel.loader.links import AfterBreakout as AfterBreakout
from forcefeel.loader.links import Link as Link
from forcefeel.loader.links import LinkKind as LinkKind
