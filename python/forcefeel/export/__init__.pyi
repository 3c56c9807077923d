"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.export.exported import Exported as Exported
from forcefeel.export.folder import export_folder as export_folder
from forcefeel.export.folder import write_export as write_export
from forcefeel.export.folder import write_pair as write_pair
from forcefeel.export.pair_code import PairExport as PairExport
from forcefeel.export.target import Target as Target
