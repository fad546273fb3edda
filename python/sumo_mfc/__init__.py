"""Vehicle bodies and model-free speed control for the cars of a SUMO simulation.

``run`` runs a scenario, ``compare`` and ``sweep`` make studies of many runs, ``Simulation`` steps through a run; ``drive``,
``Body``, ``tyre_force``, ``identify_tyre`` and ``ultra_local_f`` need no SUMO. Units are SI, and stand in the documentation
of every value; speeds are m/s, torques N·m (sum over the wheels), angles radians unless it says otherwise.
"""

from ._controllers import Controller, Observation, register
from ._core import Error, Table, __version__, choices
from ._offline import Body, Drive, drive, identify_tyre, tyre_force, ultra_local_f
from ._results import Folder, Paper, Result, Study, open_result
from ._runs import check, compare, paper, report, run, sweep
from ._simulation import Simulation

__all__ = [
    "Body",
    "Controller",
    "Drive",
    "Error",
    "Folder",
    "Observation",
    "Paper",
    "Result",
    "Simulation",
    "Study",
    "Table",
    "__version__",
    "check",
    "choices",
    "compare",
    "drive",
    "identify_tyre",
    "open_result",
    "paper",
    "register",
    "report",
    "run",
    "sweep",
    "tyre_force",
    "ultra_local_f",
]
