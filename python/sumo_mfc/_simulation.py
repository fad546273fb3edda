"""A run step by step."""

import os
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core, _sumo
from ._arguments import arguments
from ._core import Plan
from ._results import Result, place
from ._runs import tell

Column = NDArray[np.float64]


class Simulation:
    """A run between whose steps Python looks at the egos::

        with sumo_mfc.Simulation("my.sumocfg", controller="adaptive") as sim:
            while sim.step():
                print(sim.time, abs(sim.error).max(initial=0.0))
        sim.result.vehicles

    Arguments are those of ``run``. With ``num_clients=2, port=N`` the same SUMO is open to ``traci`` in another thread or
    process: SUMO steps when all clients have asked for it. Leaving the ``with`` block writes the result, which is marked
    incomplete if the run was not over.

    Every array has one value per ego on the road, in the order of ``ids``, at the end of the last step; it cannot be
    written to, and is not changed by later steps.
    """

    def __init__(
        self,
        scenario: str | os.PathLike[str] | None = None,
        *,
        out: str | os.PathLike[str] | None = None,
        quiet: bool = False,
        **options: Any,
    ) -> None:
        _sumo.find()
        folder, self._keep = place(out)
        plan = Plan(arguments(scenario, {**options, "out": folder}))
        tell(plan.notes, quiet)
        self._quiet, self._notes = quiet, plan.notes
        self._session = _core.Session(plan)
        self._result: Result | None = None

    def step(self) -> bool:
        """One SUMO step. False, and no step, once the run is over."""
        return self._session.step()

    def close(self) -> Result:
        """Leaves SUMO and writes the result. Further calls return the same result."""
        if self._result is None:
            dir, text, notes = self._session.finish()
            tell(notes, self._quiet)
            self._result = Result(dir, text, [*self._notes, *notes], self._keep)
        return self._result

    @property
    def result(self) -> Result:
        """The result, once the simulation is closed."""
        if self._result is None:
            raise _core.Error("the simulation is open: close() it, or leave its with block, to have its result")
        return self._result

    @property
    def time(self) -> float:
        """Simulation time at the end of the last step [s]."""
        return self._session.times[1]

    @property
    def end(self) -> float | None:
        """When the run ends [s]; None if only the traffic decides."""
        return self._session.times[2]

    @property
    def ids(self) -> list[str]:
        """SUMO's ids of the egos on the road."""
        return self._session.ids

    @property
    def speed(self) -> Column:
        """True speeds V_x [m/s]."""
        return self._session.column("speed")

    @property
    def reference(self) -> Column:
        """Reference speeds y_ref [m/s]."""
        return self._session.column("reference")

    @property
    def error(self) -> Column:
        """Speed errors V_x − y_ref [m/s]."""
        return self._session.column("error")

    @property
    def torque(self) -> Column:
        """Applied torques, sums over the wheels [N·m]."""
        return self._session.column("torque")

    def column(self, name: str) -> Column:
        """A column of ``trace.csv`` that has numbers: ``measured_speed``, ``yaw_rate``, ``slip_front``, ``f_hat``, ..."""
        return self._session.column(name)

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
            return
        try:
            self.close()
        except _core.Error:
            # The error that is under way says more.
            pass
