"""Controllers written in Python: one call per control period for all vehicles of a group."""

from __future__ import annotations

import importlib.util
import inspect
import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Error

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Observation:
    """What a controller sees in one control period. Every array has shape (slots,): a vehicle keeps its slot as long as it
    drives, and the arrays grow when all slots are taken. Where no vehicle drives all numbers are 0."""

    period: float
    """Control period (s)."""
    drives: Flags
    """A vehicle drives here; the torques of the others are not used."""
    starts: Flags
    """Since the last period a vehicle came here, was carried elsewhere, or came to rest: what was remembered is void."""
    speed: Floats
    """Measured speed (m/s), with noise if there is any."""
    reference: Floats
    """Reference speed at the same instant (m/s)."""
    reference_rate: Floats
    """Its rate (m/s²)."""
    nominal: Floats
    """Torque that accelerates the nominal vehicle at 1 m/s² (N·m per m/s²)."""
    commanded: Floats
    """What the torque of the last period would give the nominal vehicle (m/s²)."""
    saturated: Floats
    """The same within the actuators' limits (m/s²)."""
    applied: Floats
    """The same for the torque that acts on the wheels now: limited, delayed, lagged (m/s²)."""

    def __init__(self, period: float) -> None:
        self.period = period
        self._memory: dict[str, tuple[Floats, float]] = {}

    @property
    def error(self) -> Floats:
        """Measured speed less reference (m/s)."""
        return self.speed - self.reference

    def memory(self, name: str, first: float = 0.0) -> Floats:
        """An array of shape (slots,) that stays from one period to the next, to be changed in place. A slot holds ``first``
        when a vehicle starts in it."""
        array, _ = self._memory.get(name, (None, first))
        if array is None:
            array = np.full(self.speed.shape, first)
            self._memory[name] = (array, first)
        return array

    def _see(self, columns: tuple[Any, ...]) -> None:
        (self.drives, self.starts, self.speed, self.reference, self.reference_rate, self.nominal, self.commanded,
         self.saturated, self.applied) = columns
        starts = self.starts if self.starts.any() else None
        for name, (array, first) in self._memory.items():
            more = len(self.speed) - len(array)
            if more > 0:
                array = np.concatenate([array, np.full(more, first)])
                self._memory[name] = (array, first)
            if starts is not None:
                array[starts] = first


class Controller:
    """A speed controller for all vehicles of a group. A subclass has a ``command``; ``register`` makes it known under its
    ``name``. ``keys`` are names with defaults, set as ``controller.NAME`` and found as attributes of the object."""

    name: str = ""
    summary: str = ""
    keys: Mapping[str, float] = {}

    period: float
    """Control period (s)."""

    def command(self, obs: Observation) -> ArrayLike:
        """Sum of wheel torques (N·m) of every slot, positive drives, negative brakes: shape (slots,) or a number."""
        raise NotImplementedError


class _Caller:
    """Between the engine and one controller."""

    def __init__(self, controller: Controller, period: float) -> None:
        self.controller = controller
        self.observation = Observation(period)

    def __call__(self, *columns: Any) -> Floats:
        seen = self.observation
        seen._see(columns)
        answer = np.asarray(self.controller.command(seen), dtype=np.float64)
        if answer.shape != seen.speed.shape:
            if answer.shape != ():
                raise ValueError(f"command(): found torques of shape {answer.shape}, wanted {seen.speed.shape}")
            answer = np.full(seen.speed.shape, answer)
        bad = ~np.isfinite(answer) & seen.drives
        if bad.any():
            slot = int(np.flatnonzero(bad)[0])
            raise ValueError(f"command(): found the torque {answer[slot]} in slot {slot}, wanted a finite number")
        return np.ascontiguousarray(answer)


#: The file that every registered controller stands in; None if it stands in none, as in a notebook.
_files: dict[str, str | None] = {}
#: True while a file of controllers is loaded for the command line.
_loading = False

C = TypeVar("C", bound=type[Controller])


def register(controller: C) -> C:
    """Makes a controller known under its name, in ``run``, ``compare``, ``sweep`` and ``drive``. Use it as a decorator.

    Studies start each case in a process of its own, which loads the file that the class stands in. A name that Python has
    registered before is registered anew.
    """
    make_known(controller)
    _files[controller.name] = getattr(sys.modules.get(controller.__module__), "__file__", None)
    return controller


def make_known(controller: type[Controller]) -> None:
    """Registers a controller for runs in this process."""
    name = controller.name
    if not name:
        raise Error(f'{controller.__name__}: found no name, wanted a class attribute such as name = "my_pi"')
    summary = controller.summary or (inspect.getdoc(controller) or "a controller in Python").splitlines()[0]
    keys = [(key, float(first), f"key of {name}") for key, first in controller.keys.items()]

    def make(period: float, values: dict[str, float]) -> _Caller:
        made = controller()
        made.period = period
        for key, value in values.items():
            setattr(made, key, value)
        return _Caller(made, period)

    _core.register(name, summary, keys, make)


def load(file: str | os.PathLike[str]) -> None:
    """Loads a file of controllers, as ``python -m sumo_mfc --load FILE`` does."""
    global _loading
    path = Path(file).resolve()
    name = f"_sumo_mfc_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise Error(f"--load {file}: wanted a file of Python")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    # What the file imports from beside it is found as when it is run.
    sys.path.insert(0, str(path.parent))
    _loading = True
    try:
        spec.loader.exec_module(module)
    finally:
        _loading = False


def files(words: Iterable[str]) -> list[str]:
    """The files of all registered controllers, for a study with these arguments."""
    if _loading:
        raise Error('a study loads the file of its controllers: wanted `if __name__ == "__main__":` around the calls in it')
    words = list(words)
    for name, file in _files.items():
        if file is None and any(name in word for word in words):
            raise Error(f'a study loads the file of its controllers: found "{name}" in none, wanted it in a file')
    return list(dict.fromkeys(file for file in _files.values() if file is not None))
