#!/usr/bin/env python3
"""Records one lap of SUMO's own racing circuit (tools/game/racing) as a driver's recording.

    SUMO_HOME=... python3 tests/record_racing_lap.py > scenarios/paper/data/racing_lap.csv

SUMO's drivers do not slow down for curves. So the car drives twice, alone: a slow lap to survey the track, and, from rest, a
fast one in which its top speed follows from the surveyed curvature (at most 4 m/s^2 sideways, braking ahead of curves at
3 m/s^2) and SUMO's driver, with its random imperfection, does the rest. The second is written at 20 Hz: time, speed, lateral
speed (SUMO has none: 0) and yaw rate, the change of heading per metre, averaged over 15 m, times the speed.
Made with the PyPI package eclipse-sumo 1.28.0, seed 23423.
"""
import contextlib
import math
import os
import sys

HOME = os.environ["SUMO_HOME"]
sys.path.insert(0, os.path.join(HOME, "tools"))
import traci  # noqa: E402

TRACK = os.path.join(HOME, "tools", "game", "racing")
STEP_S = 0.05
TOP_MPS = 45.0
SIDEWAYS_MPS2 = 4.0
BRAKING_MPS2 = 3.0
WINDOW_M = 15.0


def drive(top_mps):
    """One lap from rest; top_mps(distance) limits the speed. Rows of time, distance, speed, heading [rad, left positive]."""
    with contextlib.redirect_stdout(sys.stderr):
        traci.start([os.path.join(HOME, "bin", "sumo"), "-n", os.path.join(TRACK, "spreewaldring.net.xml"),
                     "-r", os.path.join(TRACK, "racing.rou.xml"), "-a", os.path.join(TRACK, "rerouter.add.xml"),
                     "--step-length", str(STEP_S), "--step-method.ballistic", "--seed", "23423",
                     "--no-step-log", "--no-warnings"])
    rows, start, heading = [], None, None
    while True:
        traci.simulationStep()
        for other in traci.vehicle.getIDList():
            if other != "ego":
                traci.vehicle.remove(other)
        ego = traci.vehicle
        if start is None:
            start = ego.getPosition("ego")
            ego.setLaneChangeMode("ego", 0)
            ego.setSpeedFactor("ego", 10)  # the lane's limit never binds
        turn = math.radians(-ego.getAngle("ego"))
        heading = turn if heading is None else heading + math.remainder(turn - heading, 2 * math.pi)
        distance = ego.getDistance("ego")
        rows.append((traci.simulation.getTime(), distance, ego.getSpeed("ego"), heading))
        ego.setMaxSpeed("ego", max(1.0, top_mps(distance)))
        if distance > 500 and math.dist(ego.getPosition("ego"), start) < 6:
            break
    traci.close()
    return rows


def heading_at(rows):
    """Heading by metre driven, linear between rows, level before and after."""
    metres, at = [], 0
    for metre in range(int(rows[-1][1]) + 1):
        while at + 1 < len(rows) and rows[at + 1][1] <= metre:
            at += 1
        (_, s0, _, h0), (_, s1, _, h1) = rows[at], rows[min(at + 1, len(rows) - 1)]
        metres.append(h0 + (h1 - h0) * (metre - s0) / (s1 - s0) if s1 > s0 else h0)
    return metres


def curvature(rows):
    """Curvature [1/m, left positive] by metre: slope of the heading, taken over WINDOW_M from the average over WINDOW_M."""
    half = int(WINDOW_M // 2)

    def at(values, i):
        return values[max(0, min(len(values) - 1, i))]

    heading = heading_at(rows)
    smooth = [sum(at(heading, i + k) for k in range(-half, half + 1)) / (2 * half + 1) for i in range(len(heading))]
    return [(at(smooth, i + half) - at(smooth, i - half)) / (2 * half) for i in range(len(smooth))]


def main():
    track = curvature(drive(lambda _: 8.0))
    top = [min(TOP_MPS, math.sqrt(SIDEWAYS_MPS2 / max(abs(k), 1e-6))) for k in track]
    for i in range(len(top) - 2, -1, -1):
        top[i] = min(top[i], math.sqrt(top[i + 1] ** 2 + 2 * BRAKING_MPS2))
    rows = drive(lambda s: top[min(int(s), len(top) - 1)])
    turns = curvature(rows)
    print("t_s,vx_mps,vy_mps,yaw_rate_radps")
    for time, distance, speed, _ in rows:
        yaw = turns[min(int(distance), len(turns) - 1)] * speed
        print(f"{time - rows[0][0]:.2f},{speed:.4f},0,{yaw + 0.0:.5f}")


if __name__ == "__main__":
    main()
