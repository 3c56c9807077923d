"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.frontier.page.page import write_frontier as write_frontier
from forcefeel.frontier.result import Frontier as Frontier
from forcefeel.frontier.run import find_frontier as find_frontier
