"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.commission.page.page import write_commission as write_commission
from forcefeel.commission.plan import CommissionPlan as CommissionPlan
from forcefeel.commission.result import Commission as Commission
from forcefeel.commission.run import StepWriters as StepWriters
from forcefeel.commission.run import commission_loader as commission_loader
from forcefeel.commission.simulated_bench import simulated_records as simulated_records
