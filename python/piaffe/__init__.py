"""Optimal periodic gaits of legged robots, each with a receipt.

>>> import piaffe
>>> trot = piaffe.robots["quadruped"].gait("trot")
>>> result = piaffe.optimize(trot, speed=0.6)
>>> print(result.cost, result.unit)

Units are SI and angles are in rad, everywhere. World axes are x forward, y up, z to the right.
"""

from __future__ import annotations

from ._optimize import optimize
from ._piaffe import Error, Gait, NoOptimum, Robot, SpecificationError, __version__
from ._robots import robots
from ._dynamics import Dynamics, InverseDynamics, InverseJacobian, dynamics
from ._result import (
    Audit,
    Certificate,
    Course,
    Finding,
    Gap,
    Receipt,
    Result,
    Sensitivity,
    Stability,
    Statement,
    Status,
)
from ._schedule import Interrupted
from ._study import Study, Table, study
from ._walk import Walk

__all__ = [
    "Audit",
    "Certificate",
    "Course",
    "Dynamics",
    "Error",
    "Finding",
    "Gait",
    "Gap",
    "Interrupted",
    "InverseDynamics",
    "InverseJacobian",
    "NoOptimum",
    "Receipt",
    "Result",
    "Robot",
    "Sensitivity",
    "SpecificationError",
    "Stability",
    "Statement",
    "Status",
    "Study",
    "Table",
    "Walk",
    "__version__",
    "dynamics",
    "optimize",
    "robots",
    "study",
]
