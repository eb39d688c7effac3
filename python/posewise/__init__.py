"""Which poses to measure when a robot is calibrated.

>>> import numpy as np, posewise as pw
>>> J = np.random.default_rng(0).normal(size=(200, 3, 10))     # anybody's Jacobians
>>> choice = pw.select(J, k=12, criterion="d")
>>> len(choice), choice.efficiency > 0.9
(12, True)
"""

from . import _posewise
from ._calls import Doubt, InputError, Interrupted
from .boards import draw_board
from .calibration import Estimate, calibrate
from .campaign import Campaign, Sensor
from .choice import Choice, Weights, design, indices, relax, select
from .detection import detect
from .planning import Plan, plan
from .studies import Study, study

__version__ = _posewise.version

__all__ = [
    "Campaign",
    "Choice",
    "Doubt",
    "Estimate",
    "InputError",
    "Interrupted",
    "Plan",
    "Sensor",
    "Study",
    "Weights",
    "calibrate",
    "design",
    "detect",
    "draw_board",
    "indices",
    "plan",
    "relax",
    "select",
    "study",
]
