"""A second TraCI client beside sumo-mfc: counts the vehicles that stand, and slows one of them down."""

import sys

import traci

# Clients that share a SUMO need different numbers. sumo-mfc takes 1, so it is served first in every step.
traci.init(port=int(sys.argv[1]), numRetries=60)
traci.setOrder(2)

slowed, standing = None, 0
while traci.simulation.getTime() < 100.0:
    traci.simulationStep()
    speeds = {vehicle: traci.vehicle.getSpeed(vehicle) for vehicle in traci.vehicle.getIDList()}
    standing = max(standing, sum(speed < 0.1 for speed in speeds.values()))
    if slowed is None and traci.simulation.getTime() >= 50.0:
        slowed = max(speeds, key=speeds.get)
        traci.vehicle.setMaxSpeed(slowed, 5.0)  # the driver wishes no more: SUMO plans with it, the body follows

print(f"at most {standing} vehicles stood at the same time; vehicle {slowed} was slowed down")
traci.close()
