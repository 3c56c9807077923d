"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.envelope.cockpit.cockpit import CockpitEnvelope as CockpitEnvelope
from forcefeel.envelope.cockpit.cockpit import find_cockpit as find_cockpit
from forcefeel.envelope.contact import CONTACTS as CONTACTS
from forcefeel.envelope.contact import Contact as Contact
from forcefeel.envelope.contact import ContactShares as ContactShares
from forcefeel.envelope.contact import swings_on as swings_on
from forcefeel.envelope.draws import Draws as Draws
from forcefeel.envelope.page.page import write_envelope as write_envelope
from forcefeel.envelope.plan import Plan as Plan
from forcefeel.envelope.plan import make_plan as make_plan
from forcefeel.envelope.result import Envelope as Envelope
from forcefeel.envelope.run import find_envelope as find_envelope
from forcefeel.envelope.softening import soften as soften
