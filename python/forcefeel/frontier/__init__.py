"""The frontier of a loader: what cannot be rendered on this hardware and why, and what tighter tolerances or parts would buy."""

from forcefeel.frontier.result import Frontier
from forcefeel.frontier.run import find_frontier

__all__ = ["Frontier", "find_frontier"]
