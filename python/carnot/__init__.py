"""Geodesics under velocity constraints, without a guess.

>>> import carnot
>>> car = carnot.scene("vehicle")
>>> report = car.geodesics([0, 0, 0, 0], [0, 1, 0, 0])
>>> round(report[0].action, 6)
22.707882
>>> report[0].label
'locally-minimal'

A scene is a system with its parameters: one of the program (`scene`, `scenes`), one's own from text
(`Scene`, `load`) or from formulas of sympy (`Scene.from_sympy`). Its methods compute, and give
arrays of numpy. Angles are radians; units are the scene's own.
"""

from carnot._carnot import version as __version__
from carnot.continuation import Continuation
from carnot.field import Field
from carnot.flow import Flow
from carnot.geodesic import Geodesic, LimitReport, NotConverged, Report
from carnot.scene import Scene, load, scene, scenes
from carnot.steering import Steering, Way

__all__ = [
    "Continuation",
    "Field",
    "Flow",
    "Geodesic",
    "LimitReport",
    "NotConverged",
    "Report",
    "Scene",
    "Steering",
    "Way",
    "__version__",
    "load",
    "scene",
    "scenes",
]
