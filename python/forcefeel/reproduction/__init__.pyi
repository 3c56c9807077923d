"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.reproduction.as_markdown import markdown as markdown
from forcefeel.reproduction.as_markdown import summary as summary
from forcefeel.reproduction.run import reproduce as reproduce
from forcefeel.reproduction.table import Row as Row
from forcefeel.reproduction.table import Section as Section
from forcefeel.reproduction.table import Verdict as Verdict
