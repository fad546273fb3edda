"""Vehicles and parts of the model without SUMO."""

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import pairs, section
from ._core import Error, Table

Array = NDArray[np.float64]
Profile = str | os.PathLike[str] | tuple[ArrayLike, ArrayLike] | None


class Drive:
    """What one vehicle did on one profile."""

    def __init__(self, trace: Table, statistics: Mapping[str, float | None], finished: bool) -> None:
        #: The end of every control period: time [s], distance [m], reference, speed, measured_speed [m/s], torque [N·m], ...
        self.trace = trace
        #: error_mean, error_std, error_rms, error_max_abs, overshoot_max [m/s], over all control periods.
        self.statistics = dict(statistics)
        #: False if the vehicle did not reach the end, or its state is not a number.
        self.finished = finished

    def __getitem__(self, name: str) -> Any:
        """A column of the trace."""
        return self.trace[name]

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} {value:.4g}" for name, value in self.statistics.items() if value is not None)
        return f"<sumo_mfc.Drive of {len(self.trace)} control periods: {shown} m/s>"


def drive(
    profile: Profile = None,
    law: str | Mapping[str, Any] | None = None,
    body: str | Mapping[str, Any] | None = None,
    *,
    noise: float | None = None,
    by: str = "time",
    steps: bool = False,
    start: float | None = None,
    seconds: float | None = None,
    metres: float | None = None,
    **keys: Any,
) -> Drive:
    """Drives one vehicle along a profile, without SUMO, in the closed loop of ``run``.

    ``profile`` is a file (CSV ``t_s,v_mps`` or ``s_m,v_mps``, a recording, a driving cycle), or two arrays of the same
    length: times [s] (places [m] with ``by="position"``) and speeds [m/s], joined by straight lines, or by steps with
    ``steps=True``. ``law`` and ``body`` are names of ``choices()`` or mappings of keys, ``law={"name": "pid", "k_p": 1.5}``,
    ``body={"preset": "van", "mass_factor": 1.2}``. ``noise`` is the power of the noise on the measured speed [dB].
    ``start`` is the first speed [m/s], if it is not that of the profile; ``seconds`` or ``metres`` end the drive, if it is
    not to end with the profile. ``keys`` are other sections of the scenario: ``actuator={"delay_s": 0.2}``,
    ``sumo={"seed": 2}``.
    """
    if by not in ("time", "position"):
        raise Error(f'by: found {by!r}, wanted "time" or "position"')
    settings: dict[str, Any] = {**section("controller", law, "name"), **section("vehicle", body, "preset")}
    if noise is not None:
        settings["noise"] = {"power_db": noise}
    lines = None
    if isinstance(profile, (str, os.PathLike)):
        settings["target"] = {"file": os.path.abspath(profile)}
    elif profile is not None:
        at, speeds = (_array(name, values) for name, values in zip(("profile[0]", "profile[1]"), profile, strict=True))
        lines = ("steps" if steps else "lines", by, at.tolist(), speeds.tolist())
        if seconds is None and metres is None and steps:
            raise Error("steps hold for ever: wanted seconds or metres with them")
    for name, value in keys.items():
        merged = settings.get(name)
        settings[name] = {**merged, **value} if isinstance(merged, dict) and isinstance(value, Mapping) else value
    trace, statistics, finished = _core.drive(pairs(settings), lines, start, seconds, metres)
    return Drive(trace, statistics, finished)


class Body:
    """The body of one vehicle, moved by torques: the plant alone.

    ``preset`` is a body of ``choices()``; ``keys`` are those of the section ``vehicle``: ``mass_kg=1500``. ``speed`` is the
    first speed [m/s], ``period`` the length of a step [s]; ``plant`` is a plant of ``choices()`` or a mapping of its keys.
    """

    def __init__(
        self,
        preset: str = "car",
        *,
        speed: float = 0.0,
        period: float = 0.01,
        plant: str | Mapping[str, Any] | None = None,
        **keys: Any,
    ) -> None:
        settings = {"vehicle": {"preset": preset, **keys}, **section("plant", plant, "name")}
        self._plant = _core.Plant(pairs(settings), speed, period)
        self.period = period
        self.time = 0.0

    def step(
        self, torque: float, steer: float = 0.0, *, grade: float = 0.0, bank: float = 0.0, headwind: float = 0.0
    ) -> float:
        """One period under a torque [N·m, sum over the wheels, negative brakes] and a steer angle of the front wheels [rad,
        left positive]; ``grade`` and ``bank`` of the road [rad], wind from ahead [m/s]. Returns the speed V_x [m/s]."""
        self._plant.step(torque, steer, grade, bank, headwind)
        self.time += self.period
        return self.speed

    @property
    def state(self) -> Array:
        """V_x, V_y [m/s], yaw rate [rad/s], wheel speeds front left, front right, rear left, rear right [rad/s]: shape (7,)."""
        return np.array(self._plant.state())

    @property
    def speed(self) -> float:
        """V_x [m/s]."""
        return self._plant.state()[0]

    @property
    def lateral_speed(self) -> float:
        """V_y, positive to the left [m/s]."""
        return self._plant.state()[1]

    @property
    def yaw_rate(self) -> float:
        """Positive to the left [rad/s]."""
        return self._plant.state()[2]

    @property
    def distance(self) -> float:
        """The integral of V_x over time [m]."""
        return self._plant.distance()

    @property
    def slip(self) -> Array:
        """Longitudinal slip ratios of front and rear axle: shape (2,)."""
        return np.array(self._plant.slip())

    @property
    def mass(self) -> float:
        """[kg]"""
        return self._plant.constants()[0]

    @property
    def torque_per_acceleration(self) -> float:
        """What the laws know of the body [N·m per m/s²]."""
        return self._plant.constants()[1]

    @property
    def torque_limits(self) -> tuple[float, float]:
        """Largest driving and braking torque, sums over the wheels [N·m]."""
        return self._plant.constants()[2], self._plant.constants()[3]


def tyre_force(slip: ArrayLike, b: float, c: float, e: float) -> Array:
    """Force over peak force of the Magic Formula, sin(C·atan(Bτ − E(Bτ − atan(Bτ)))), at slip ratios or slip angles [rad].

    The shape is that of ``slip``.
    """
    slips = np.asarray(slip, dtype=np.float64)
    return _core.tyre_force(np.ascontiguousarray(slips.ravel()), b, c, e).reshape(slips.shape)


def identify_tyre(slip: ArrayLike, force: ArrayLike) -> tuple[float, float, float, float]:
    """B, C, E and the peak force [N] of a measured curve of forces [N] over slips (Polack et al. 2017, section 4.1.2)."""
    b, c, e, peak = _core.identify_tyre(_array("slip", slip), _array("force", force))
    return b, c, e, peak


def ultra_local_f(speed: ArrayLike, input: ArrayLike, *, window: float, period: float) -> Array:
    """F̂ [m/s²] of ẏ = F + v at every sample, as the laws estimate it (Polack et al. 2017, section 2.2).

    ``speed`` is the measured speed y_k [m/s], ``input`` the acceleration v_{k−1} [m/s²] that was asked for in the period
    before it; ``window`` and ``period`` are in s.
    """
    return _core.ultra_local_f(_array("speed", speed), _array("input", input), window, period)


def _array(name: str, values: ArrayLike | Sequence[float]) -> Array:
    """Numbers in one row."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise Error(f"{name}: found an array of {array.ndim} dimensions, wanted one")
    return array
