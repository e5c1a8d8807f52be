"""Reads the results and the super-elements of squeal, which predicts disc-brake squeal.

`read_results` reads the results of `squeal stability`, `read_exploration` those of `squeal explore`;
`read_super_element` reads the file of `squeal reduce`.
Units are SI (m, kg, s, Pa, 1/s), frequencies are in Hz.
"""

from ._exploration import Exploration, read_exploration
from ._results import Modes, Results, Value, read_results
from ._super_element import SuperElement, read_super_element

__all__ = [
    "Exploration",
    "Modes",
    "Results",
    "SuperElement",
    "Value",
    "read_exploration",
    "read_results",
    "read_super_element",
]
