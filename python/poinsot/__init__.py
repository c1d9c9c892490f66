"""Rotation of rigid bodies: exact free motion, torques by splitting, scenes.

Momenta y have the shape (n, 3), or (3,) for one body, attitudes q (n, 4) or (4,): unit quaternions, scalar first, body to
space. Bodies are advanced in place, in the caller's arrays. Body classes are numbered from 0.
"""
from . import elliptic, quaternion
from ._body import Body
from ._library import Error, Status, has_feature, splitting_flows, version
from ._library import names as _names
from ._plan import Plan
from ._scene import Choice, Cost, Run, choose, cost, run

__all__ = ["Body", "Choice", "Cost", "Error", "Plan", "Run", "Status", "choose", "cost", "effects", "elliptic", "has_feature",
           "methods", "quaternion", "run", "splitting_flows", "splittings"]
__version__ = version()


def methods() -> tuple[str, ...]:
    """Names of the free methods: "exact", "jacobi", "dmv2", ..."""
    return _names("method")


def splittings() -> tuple[str, ...]:
    """Names of the splittings: "strang", "srkn6", ..."""
    return _names("splitting")


def effects() -> tuple[str, ...]:
    """Names of the effects: "gravity", "langevin", ..."""
    return _names("effect")
