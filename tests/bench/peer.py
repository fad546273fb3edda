"""The loop that one would write with SUMO's own Python library, without any dynamics: every vehicle's speed and angle are
read, and the speed is given back. One command per value (`values`), or read by subscription (`subscriptions`).

    peer.py PORT values|subscriptions      then on standard input: a number of steps; answered by the seconds they took
"""
import sys
import time

import traci
from traci import constants as tc


def step_by_values(vehicle, step):
    for ego in vehicle.getIDList():
        speed = vehicle.getSpeed(ego)
        vehicle.getAngle(ego)
        vehicle.setPreviousSpeed(ego, speed)
    step()


def step_by_subscriptions(vehicle, step):
    for ego, values in vehicle.getAllSubscriptionResults().items():
        vehicle.setPreviousSpeed(ego, values[tc.VAR_SPEED])
    step()


def main():
    traci.init(int(sys.argv[1]))
    by_values = sys.argv[2] == "values"
    one_step = step_by_values if by_values else step_by_subscriptions
    if not by_values:
        now = traci.simulation.getTime()
        for ego in traci.vehicle.getIDList():
            traci.vehicle.subscribe(ego, (tc.VAR_SPEED, tc.VAR_ANGLE), begin=now)
    print("ready", flush=True)
    for line in sys.stdin:
        begin = time.perf_counter()
        for _ in range(int(line)):
            one_step(traci.vehicle, traci.simulationStep)
        print(time.perf_counter() - begin, flush=True)
    traci.close()


main()
