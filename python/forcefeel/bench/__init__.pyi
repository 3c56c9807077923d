"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.bench.data_file import read_bench_data as read_bench_data
from forcefeel.bench.estimate import estimate_response as estimate_response
from forcefeel.bench.excitation.bench_file import write_excitation as write_excitation
from forcefeel.bench.excitation.excite import excite as excite
from forcefeel.bench.excitation.plan import ExcitationPlan as ExcitationPlan
from forcefeel.bench.excitation.result import Excitation as Excitation
from forcefeel.bench.experiments import Drive as Drive
from forcefeel.bench.experiments import Experiment as Experiment
from forcefeel.bench.experiments import Loop as Loop
from forcefeel.bench.identification.fit import identify as identify
from forcefeel.bench.identification.linear import model_response as model_response
from forcefeel.bench.identification.page.page import write_identification as write_identification
from forcefeel.bench.identification.result import Estimate as Estimate
from forcefeel.bench.identification.result import Identification as Identification
from forcefeel.bench.record_file import read_bench_record as read_bench_record
from forcefeel.bench.records import BenchRecord as BenchRecord
from forcefeel.bench.resonance import Resonance as Resonance
from forcefeel.bench.resonance import link_from_resonance as link_from_resonance
from forcefeel.bench.resonance import read_resonance as read_resonance
from forcefeel.bench.response_file import read_response as read_response
from forcefeel.bench.responses import Response as Response
