import sumo_mfc

with sumo_mfc.Simulation("my.sumocfg", controller="pid", end=60) as sim:
    while sim.step():
        if abs(sim.error).max(initial=0.0) > 0.5:
            print(sim.time, sim.ids[abs(sim.error).argmax()], sim.torque.max())
print(sim.result.summary["counts"])

with sumo_mfc.Simulation("my.sumocfg", controller="pid", end=60) as sim:
    while sim.step():
        if sim.time == 40:
            slow = [id for id, speed in zip(sim.ids, sim.speed) if speed > 5.0][:3]
            sim.set_reference(slow, 4.0)                             # m/s; None gives them back
            sim.set_torque_disturbance(slow[0], -300.0)              # N·m on the wheels; 0 ends it
            sim.set_parameter(slow[1], "mfc.mass_factor", 1.5)       # as a <param> of the demand
print(sim.result.notes)

import threading


def lights() -> None:
    client = traci.connect(port=18813, numRetries=60)
    client.setOrder(2)                # sumo-mfc is 1, and is served first in every step
    while client.simulation.getTime() < 30:
        client.simulationStep()
        if client.simulation.getTime() == 20:
            print(client.trafficlight.getIDCount(), "traffic lights,", client.vehicle.getIDCount(), "vehicles")
    client.close()


import os
import sys

sys.path.append(os.path.join(os.environ["SUMO_HOME"], "tools"))
import traci

thread = threading.Thread(target=lights)
thread.start()
with sumo_mfc.Simulation("my.sumocfg", num_clients=2, port=18813, end=30) as sim:
    while sim.step():
        pass
thread.join()
