#!/usr/bin/env python3
"""Reference manoeuvres of two CommonRoad vehicle models, for tests/plant.rs.

    pip install commonroad-vehicle-models==3.0.2
    python3 tests/data/commonroad.py std > tests/data/commonroad_std.csv
    python3 tests/data/commonroad.py mb > tests/data/commonroad_mb.csv

std is the single-track drift model, mb the multi-body model with suspension, roll, pitch, camber and combined slip;
vehicles 1 to 3 of the package. The parameter files are read here, as they are, so that neither omegaconf nor numpy is
needed. Both models turn an acceleration input u into the wheel torque m·R_w·u and split it over the axles.
"""
import math
import pathlib
import sys
from importlib.metadata import version
from types import SimpleNamespace

import vehiclemodels
from vehiclemodels.init_mb import init_mb
from vehiclemodels.init_std import init_std
from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb
from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

FOLDER = pathlib.Path(vehiclemodels.__file__).parent / "parameters"
BODIES = ["ford_escort", "bmw_320i", "vw_vanagon"]


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


def vehicles():
    for number, body in enumerate(BODIES, start=1):
        parameters = read(f"parameters_vehicle{number}.yaml")
        parameters.tire = read("parameters_tire.yaml").tire
        yield body, parameters


def runge_kutta(rate, x, t, step):
    k1 = rate(t, x)
    k2 = rate(t + step / 2, [a + step / 2 * k for a, k in zip(x, k1)])
    k3 = rate(t + step / 2, [a + step / 2 * k for a, k in zip(x, k2)])
    k4 = rate(t + step, [a + step * k for a, k in zip(x, k3)])
    return [a + step / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(x, k1, k2, k3, k4)]


# Single-track drift: v0 [m/s], u [m/s^2], steer [rad], duration [s]; constant inputs from straight ahead.
STD = [
    (15, 2, 0, 5), (25, -3, 0, 5), (5, 3, 0, 3),
    (15, 0, 0.03, 2), (10, 0, -0.07, 2), (20, 0, 0.012, 2), (15, 1, -0.02, 3), (15, -1, 0.02, 3),
]


def std():
    print("body,v0_mps,accel_mps2,steer_rad,duration_s,vx_mps,vy_mps,yaw_rate_radps")
    for body, p in vehicles():
        for speed, accel, steer, seconds in STD:
            def rate(_, x):
                return vehicle_dynamics_std(list(x), [0.0, accel], p)
            x = [float(value) for value in init_std([0, 0, steer, speed, 0, 0, 0], p)]
            for k in range(round(seconds / 2e-4)):
                x = runge_kutta(rate, x, k * 2e-4, 2e-4)
            end = x[3] * math.cos(x[6]), x[3] * math.sin(x[6]), x[5]
            print(",".join([body, *map(str, (speed, accel, steer, seconds)), *(f"{v:.9f}" for v in end)]))


# Multi-body: manoeuvre, v0 [m/s], u [m/s^2], steer [rad]. A circle turns the wheel at 0.1 rad/s up to `steer`, a lane
# change turns it by steer*sin(pi*t) for 2 s. The steer rate is the model's input. The package bounds driving above
# v_switch and divides by the speed of a locked wheel's hub: the manoeuvres stay clear of both.
MB = [
    ("straight", 15, 1, 0), ("straight", 3, 3, 0), ("straight", 25, -1, 0), ("straight", 25, -3, 0), ("straight", 35, -6, 0),
    ("circle", 10, 0, 0.05), ("circle", 15, 0, 0.03), ("circle", 20, 0, -0.015),
    ("circle", 15, 0, 0.06), ("circle", 20, 0, 0.04),
    ("lane_change", 15, 0, 0.02), ("lane_change", 20, 0, -0.015), ("lane_change", 25, 0, 0.03),
]
MB_SECONDS, MB_STEP_S = 5, 5e-4


def steer_rate(manoeuvre, steer, t):
    if manoeuvre == "circle":
        return math.copysign(0.1, steer) if t < abs(steer) / 0.1 - 1e-9 else 0.0
    if manoeuvre == "lane_change":
        return steer * math.pi * math.cos(math.pi * t) if t < 2 - 1e-9 else 0.0
    return 0.0


def drive_mb(p, manoeuvre, speed, accel, steer):
    """Time and state every 1 ms."""
    x = [float(value) for value in init_mb([0, 0, 0, speed, 0, 0, 0], p)]
    for k in range(round(MB_SECONDS / MB_STEP_S)):
        t = k * MB_STEP_S
        # Held at the value of the step's middle, so that a corner of the steering is met at a step's end.
        inputs = [steer_rate(manoeuvre, steer, t + MB_STEP_S / 2), accel]
        x = runge_kutta(lambda _, x: vehicle_dynamics_mb(list(x), inputs, p), x, t, MB_STEP_S)
        if k % 2 == 1:
            yield (k + 1) // 2, x


def mb():
    """Once as in the package, then circles with upright tyres: without what camber does to the lateral force."""
    print("body,tyres,manoeuvre,v0_mps,accel_mps2,steer_rad,time_s,vx_mps,vy_mps,yaw_rate_radps")
    for body, p in vehicles():
        for tyres in ["cambered", "upright"]:
            if tyres == "upright":
                for name in ["p_hy1", "p_hy3", "p_vy1", "p_vy3", "p_dy3"]:
                    setattr(p.tire, name, 0.0)
            for manoeuvre, speed, accel, steer in MB:
                if tyres == "upright" and manoeuvre != "circle":
                    continue
                every, until = (250, 3000) if manoeuvre == "lane_change" else (1000, 5000)
                for ms, x in drive_mb(p, manoeuvre, speed, accel, steer):
                    if ms % every == 0 and ms <= until:
                        end = f"{ms / 1000:g}", f"{x[3]:.6f}", f"{x[10]:.6f}", f"{x[5]:.6f}"
                        print(",".join([body, tyres, manoeuvre, *map(str, (speed, accel, steer)), *end]), flush=True)


print(f"# commonroad-vehicle-models {version('commonroad-vehicle-models')}")
{"std": std, "mb": mb}[sys.argv[1]]()
