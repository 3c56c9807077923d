"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.frontier.link_limits import CockpitFrontier as CockpitFrontier
from forcefeel.frontier.link_limits import LinkFrontier as LinkFrontier
from forcefeel.frontier.link_limits import LinkLimit as LinkLimit
from forcefeel.frontier.link_limits import link_frontier as link_frontier
from forcefeel.frontier.page.link_page import write_links as write_links
from forcefeel.frontier.page.page import write_frontier as write_frontier
from forcefeel.frontier.result import Frontier as Frontier
from forcefeel.frontier.run import find_frontier as find_frontier
