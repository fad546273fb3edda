"""A run step by step."""

import os
from collections.abc import Iterable
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _sumo
from ._arguments import arguments, literal
from ._core import Plan
from ._results import Result, place
from ._runs import tell

Column = NDArray[np.float64]
#: The id of an ego, or several.
Vehicles = str | Iterable[str]
#: A number, or one for each of several egos.
Values = float | ArrayLike


class Simulation:
    """A run between whose steps Python looks at the egos, and changes them::

        with sumo_mfc.Simulation("my.sumocfg", controller="adaptive") as sim:
            while sim.step():
                print(sim.time, abs(sim.error).max(initial=0.0))
        sim.result.vehicles

    Arguments are those of ``run``. With ``num_clients=2, port=N`` the same SUMO is open to ``traci`` in another thread or
    process: SUMO steps when all clients have asked for it. Leaving the ``with`` block writes the result, which is marked
    incomplete if the run was not over.

    Every array has one value per ego on the road, in the order of ``ids``, at the end of the last step. It is a view of memory that
    every step fills: reading a column copies nothing. It cannot be written to, and is meant for the time until the next step. One
    that is kept for longer is safe to read, but its values are those of later steps, or of no step at all: keep ``sim.speed.copy()``.

    ``set_reference``, ``set_torque_disturbance`` and ``set_parameter`` change single egos from the next step on. The result notes that
    they were used.
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
    def ids(self) -> tuple[str, ...]:
        """SUMO's ids of the egos on the road, in the order of all arrays; the same object until they change."""
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

    def set_reference(self, vehicles: Vehicles, speed: Values | None) -> None:
        """From the next step on these egos are to drive at ``speed`` [m/s] in place of their target; None = at their target again.

        ``vehicles`` is an id or several, ``speed`` one number, or one for each of them. Where SUMO leads (the target ``traffic``), it
        drives there as it drives to any speed: with the vType's accelerations, and never too fast for who is ahead, a light or the
        lane. Where the body leads (all other targets), the speed is the reference at once, and SUMO clamps it as it clamps every
        target.

        Raises ``Error`` for an id that is not in ``ids``, or a number that is no speed; egos in front of it have been set then.
        """
        for id, one in _each(vehicles, speed, "speed"):
            self._session.set_reference(id, one)

    def set_torque_disturbance(self, vehicles: Vehicles, torque: Values) -> None:
        """From the next step on ``torque`` [N·m, sum over the wheels, positive drives] acts on the wheels of these egos beside that of
        their actuators, until another is set; 0 ends it.

        ``vehicles`` and ``torque`` are as in ``set_reference``. The controller does not learn of it, and ``torque`` and the tables do
        not have it: the disturbance shows in the error, and in what the controller answers. An ego that is held at rest stays there.

        Raises ``Error`` as ``set_reference`` does, and for an ego without a body (the controller ``ideal``).
        """
        for id, one in _each(vehicles, torque, "torque"):
            assert one is not None
            self._session.set_torque_disturbance(id, one)

    def set_parameter(self, vehicles: Vehicles, name: str, value: float | str | bool | None) -> None:
        """From the next step on these egos are as if they had departed with ``<param key="name" value="value"/>``: a ``mfc.*``
        parameter of body or actuators, such as ``mfc.mass_factor`` or ``mfc.delay_s``. None takes that back.

        A text may be a distribution, ``"normal(1, 0.1)"``, of which every ego draws. The controller does not learn of it.

        Raises ``Error`` as ``set_torque_disturbance`` does, for an unknown parameter, for a value that it does not take, and for what
        cannot change while a vehicle drives: ``front_axle_m``, ``rear_axle_m``, ``track_width_m``, ``wheel_radius_m`` and
        ``wheel_inertia_kgm2``.
        """
        text = value if value is None or isinstance(value, str) else literal(value)
        for id in [vehicles] if isinstance(vehicles, str) else vehicles:
            self._session.set_parameter(id, name, text)

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


def _each(vehicles: Vehicles, values: Values | None, what: str) -> Iterable[tuple[str, float | None]]:
    """Every id with its value."""
    ids = [vehicles] if isinstance(vehicles, str) else list(vehicles)
    if values is None:
        return [(id, None) for id in ids]
    numbers = np.asarray(values, dtype=np.float64)
    if numbers.ndim > 1 or numbers.ndim == 1 and len(numbers) != len(ids):
        raise _core.Error(f"{what}: found the shape {numbers.shape} for {len(ids)} vehicles, wanted one number, or one for each")
    return list(zip(ids, np.broadcast_to(numbers, len(ids)).tolist(), strict=True))
