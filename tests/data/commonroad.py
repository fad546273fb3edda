#!/usr/bin/env python3
"""Reference manoeuvres of the CommonRoad single-track drift model, for tests/plant.rs.

    pip install commonroad-vehicle-models==3.0.2
    python3 tests/data/commonroad.py > tests/data/commonroad.csv

Vehicles 1 to 3 of the package; each row starts straight ahead without slip and keeps the acceleration input u (wheel
torque m·R_w·u) and the steer angle for some seconds. Midpoint rule at 0.1 ms. The parameter files are read here, as they
are, so that neither omegaconf nor numpy is needed.
"""
import math
import pathlib
from types import SimpleNamespace

import vehiclemodels
from vehiclemodels.init_std import init_std
from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

FOLDER = pathlib.Path(vehiclemodels.__file__).parent / "parameters"
STEP_S = 1e-4
# v0 [m/s], u [m/s^2], steer [rad], duration [s]
MANOEUVRES = [
    (15, 2, 0, 5), (25, -3, 0, 5), (5, 3, 0, 3),
    (15, 0, 0.03, 2), (10, 0, -0.07, 2), (20, 0, 0.012, 2), (15, 1, -0.02, 3), (15, -1, 0.02, 3),
]


def read(name):
    """A parameter file: `key: number`, indented below `section:`."""
    root = section = SimpleNamespace()
    for line in (FOLDER / name).read_text().splitlines():
        text = line.split("#")[0].rstrip()
        key, _, value = text.strip().partition(":")
        if not key:
            continue
        section = root if not text.startswith(" ") else section
        if value.strip():
            setattr(section, key, float(value))
        else:
            section = SimpleNamespace()
            setattr(root, key, section)
    return root


def drive(parameters, speed, accel, steer, seconds):
    """V_x, V_y, yaw rate at the end."""
    def rate(state):
        return vehicle_dynamics_std(list(state), [0.0, accel], parameters)

    x = [float(value) for value in init_std([0, 0, steer, speed, 0, 0, 0], parameters)]
    for _ in range(round(seconds / STEP_S)):
        middle = [a + STEP_S / 2 * b for a, b in zip(x, rate(x))]
        x = [a + STEP_S * b for a, b in zip(x, rate(middle))]
    return x[3] * math.cos(x[6]), x[3] * math.sin(x[6]), x[5]


print("body,v0_mps,accel_mps2,steer_rad,duration_s,vx_mps,vy_mps,yaw_rate_radps")
for number, body in enumerate(["ford_escort", "bmw_320i", "vw_vanagon"], start=1):
    parameters = read(f"parameters_vehicle{number}.yaml")
    parameters.tire = read("parameters_tire.yaml").tire
    for manoeuvre in MANOEUVRES:
        print(",".join([body, *map(str, manoeuvre), *(f"{x:.9f}" for x in drive(parameters, *manoeuvre))]))
