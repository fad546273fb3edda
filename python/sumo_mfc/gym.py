"""Environments of Gymnasium: a vehicle that tracks a speed profile, and one that follows SUMO's traffic.

Importing this module registers ``sumo_mfc/Track-v0`` and ``sumo_mfc/Traffic-v0``; it needs ``gymnasium``.
"""

from __future__ import annotations

import itertools
import queue
import re
import threading
from collections import deque
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._controllers import Controller, Observation, make_known
from ._offline import Body
from ._runs import run

Seen = NDArray[np.float32]
Action = NDArray[np.float32]

#: Largest speed that is shown [m/s].
SPEED_MAX = 100.0
#: Largest rate of the reference that is shown, and largest acceleration that can be asked for [m/s²].
RATE_MAX = 20.0


def _seen(speed: float, reference: float, rate: float, asked: float) -> Seen:
    """What an agent sees: measured speed, reference [m/s], rate of the reference, last action times RATE_MAX [m/s²]."""
    high = _SPACE.high
    return np.clip(np.array([speed, reference, rate, asked], dtype=np.float32), -high, high)


_SPACE = spaces.Box(
    -np.array([SPEED_MAX, SPEED_MAX, RATE_MAX, RATE_MAX], dtype=np.float32),
    np.array([SPEED_MAX, SPEED_MAX, RATE_MAX, RATE_MAX], dtype=np.float32),
)
#: The acceleration of the nominal vehicle that is asked for, as a share of ACCEL_MAX.
_ACTION = spaces.Box(-1.0, 1.0, (1,), np.float32)
ACCEL_MAX = 5.0


def _reward(error: float, change: float) -> float:
    """Tracking costs the square of the error [m²/s²], and a hundredth of the squared change of the acceleration [m²/s⁴]."""
    return -(error * error) - 0.01 * change * change


class Track(gymnasium.Env[Seen, Action]):
    """One vehicle tracks a speed profile, without SUMO.

    The observation has shape (4,): measured speed and reference [m/s], rate of the reference and last acceleration asked for
    [m/s²]. The action has shape (1,): the acceleration of the nominal vehicle as a share of ``ACCEL_MAX``. An action
    holds for ``decide`` seconds. The reward of a step is −(error² + 0.01 (change of the acceleration)²).

    ``profile`` are times [s] and speeds [m/s]; without it every episode has a profile of its own, drawn from its seed:
    ``seconds`` of ramps between 0 and 20 m/s. ``dead_time`` [s] delays the torque, ``noise`` is the standard deviation of the
    measured speed [m/s]; ``body`` are keys of the section ``vehicle``, e.g. ``{"mass_factor": 1.3}``.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        profile: tuple[ArrayLike, ArrayLike] | None = None,
        *,
        seconds: float = 60.0,
        decide: float = 0.1,
        dead_time: float = 0.0,
        noise: float = 0.0,
        body: dict[str, Any] | None = None,
    ) -> None:
        self.observation_space, self.action_space = _SPACE, _ACTION
        self._given = None if profile is None else tuple(np.asarray(part, dtype=np.float64) for part in profile)
        self._seconds, self._decide, self._dead_time, self._noise = seconds, decide, dead_time, noise
        self._keys = body or {}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Seen, dict[str, Any]]:
        super().reset(seed=seed)
        self._times, self._speeds = self._given or self._drawn()
        self._body = Body(speed=float(self._speeds[0]), **self._keys)
        self._periods = max(1, round(self._decide / self._body.period))
        self._underway = deque([0.0] * round(self._dead_time / self._body.period))
        self._accel = 0.0
        return self._look(), {}

    def _drawn(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        times, speeds = [0.0], [float(self.np_random.uniform(0.0, 20.0))]
        while times[-1] < self._seconds:
            speed = float(self.np_random.uniform(0.0, 20.0))
            ramp = abs(speed - speeds[-1]) / float(self.np_random.uniform(0.5, 2.5))
            hold = float(self.np_random.uniform(0.0, 5.0))
            times += [times[-1] + max(ramp, 0.1), times[-1] + max(ramp, 0.1) + hold]
            speeds += [speed, speed]
        return np.array(times), np.array(speeds)

    def _reference(self, time: float) -> float:
        return float(np.interp(time, self._times, self._speeds))

    def _look(self) -> Seen:
        measured = self._body.speed + self._noise * float(self.np_random.standard_normal())
        now, ahead = self._body.time, self._body.time + self._decide
        rate = (self._reference(ahead) - self._reference(now)) / self._decide
        return _seen(measured, self._reference(now), rate, self._accel)

    def step(self, action: Action) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        accel = float(np.clip(action[0], -1.0, 1.0)) * ACCEL_MAX
        body, squares = self._body, 0.0
        for _ in range(self._periods):
            self._underway.append(accel * body.torque_per_acceleration)
            drive, brake = body.torque_limits
            body.step(min(max(self._underway.popleft(), -brake), drive))
            squares += (body.speed - self._reference(body.time)) ** 2
        reward = _reward((squares / self._periods) ** 0.5, accel - self._accel)
        self._accel = accel
        ended = body.time >= min(self._seconds, float(self._times[-1])) - 0.5 * body.period
        return self._look(), reward, False, ended, {"speed": body.speed, "time": body.time}


class _Left(Exception):
    """The agent has left the episode."""


_numbers = itertools.count()


class Traffic(gymnasium.Env[Seen, Action]):
    """One vehicle of a SUMO simulation, whose driver is SUMO's and whose speed controller is the agent.

    ``scenario`` and ``options`` are those of ``sumo_mfc.run``; ``ego`` is the id of the vehicle. Observation, action and
    reward are those of ``Track``, of the vehicle's own body among the traffic; an episode ends when the vehicle has left.
    ``reset(seed=N)`` runs SUMO with that seed.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, scenario: str, ego: str, *, decide: float = 0.1, **options: Any) -> None:
        self.observation_space, self.action_space = _SPACE, _ACTION
        self._scenario, self._decide = scenario, decide
        self._options = {"egos": f"id:^{re.escape(ego)}$", "no_report": True, "quiet": True, **options}
        self._ego, self._name = ego, f"gym_agent_{next(_numbers)}"
        self._thread: threading.Thread | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Seen, dict[str, Any]]:
        super().reset(seed=seed)
        self.close()
        self._seen: queue.Queue[tuple[Seen, float] | BaseException | None] = queue.Queue()
        self._actions: queue.Queue[float | None] = queue.Queue()
        env = self

        class Agent(Controller):
            """The agent of an environment."""

            def __init__(self) -> None:
                self.left, self.accel, self.squares, self.count = 0, 0.0, 0.0, 0

            def command(self, obs: Observation) -> NDArray[np.float64]:
                return env._command(self, obs)

        Agent.name = self._name
        make_known(Agent)
        sumo_seed = int(self.np_random.integers(1, 2**31 - 1))
        self._thread = threading.Thread(target=self._run, args=(sumo_seed,), daemon=True)
        self._thread.start()
        first = self._next()
        if first is None:
            raise _core.Error(f"{self._scenario}: the vehicle {self._ego!r} never drove")
        self._last, self._shown = 0.0, first[0]
        return first[0], {}

    def _run(self, seed: int) -> None:
        try:
            run(self._scenario, controller=self._name, seed=seed, **self._options)
            self._seen.put(None)
        except BaseException as error:  # handed to the thread of the agent
            self._seen.put(error)

    def _command(self, agent: Any, obs: Observation) -> NDArray[np.float64]:
        """In the thread of the run, once per control period."""
        at = np.flatnonzero(obs.drives)
        torque = np.zeros(obs.speed.shape)
        if len(at) == 0:
            return torque
        slot = at[0]
        agent.squares += float(obs.error[slot]) ** 2
        agent.count += 1
        if agent.left == 0:
            error = (agent.squares / agent.count) ** 0.5
            agent.squares, agent.count = 0.0, 0
            self._seen.put((_seen(obs.speed[slot], obs.reference[slot], obs.reference_rate[slot], agent.accel), error))
            accel = self._actions.get()
            if accel is None:
                raise _Left
            agent.accel, agent.left = accel, max(1, round(self._decide / obs.period))
        agent.left -= 1
        torque[slot] = agent.accel * obs.nominal[slot]
        return torque

    def _next(self) -> tuple[Seen, float] | None:
        seen = self._seen.get()
        if isinstance(seen, BaseException):
            self._thread = None
            raise seen
        return seen

    def step(self, action: Action) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        accel = float(np.clip(action[0], -1.0, 1.0)) * ACCEL_MAX
        self._actions.put(accel)
        seen = self._next()
        change, self._last = accel - self._last, accel
        if seen is None:
            return self._shown, _reward(0.0, change), True, False, {}
        self._shown = seen[0]
        return seen[0], _reward(seen[1], change), False, False, {}

    def close(self) -> None:
        """Ends the run of the episode, if one is under way."""
        thread, self._thread = self._thread, None
        if thread is not None and thread.is_alive():
            self._actions.put(None)
            thread.join()


gymnasium.register(id="sumo_mfc/Track-v0", entry_point="sumo_mfc.gym:Track")
gymnasium.register(id="sumo_mfc/Traffic-v0", entry_point="sumo_mfc.gym:Traffic")
