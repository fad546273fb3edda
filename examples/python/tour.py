import sumo_mfc

result = sumo_mfc.run(
    "my.sumocfg",
    controller="adaptive",
    egos="share:0.25",
    seed=1,
    end=120,
    trace="all",
    trace_period=1,
    actuator={"delay_s": 0.2},        # a section of the scenario
    set={"noise.power_db": -20},      # a key by its path
    out="out/first",
    force=True,
)
print(result)

print(result.summary["fleet"]["error_rms"]["p50"], "m/s")
print(result.trace["speed"].max(), result.trace.meanings["speed"])

import duckdb
import polars

vehicles = result.vehicles
print(polars.DataFrame(vehicles).group_by("type").agg(polars.col("error_rms").mean()))
print(duckdb.sql("select type, avg(jerk_rms) from vehicles group by type"))

study = sumo_mfc.compare("my.sumocfg", ["ideal", "adaptive", "pid"], seeds=range(1, 4), end=60, quiet=True)
print(study)
print(study.comparison.columns)

delays = sumo_mfc.sweep(
    "my.sumocfg",
    vary={"actuator.delay_s": [0, 0.2]},
    reference={"actuator.delay_s": 0},
    seeds="1..2",
    end=60,
    quiet=True,
)
print(delays)

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

import numpy as np

time = np.arange(0, 60, 0.5)
drive = sumo_mfc.drive((time, 15 + 5 * np.sin(0.2 * time)), law={"name": "pid"}, body="van", noise=-20)
print(drive, drive["torque"].max(), "N·m")

body = sumo_mfc.Body("car", speed=20.0)
while body.speed > 10.0:
    body.step(torque=-2000.0)
print(f"{body.time:.2f} s, {body.distance:.1f} m, slips {body.slip}")

force = sumo_mfc.tyre_force(np.linspace(-0.3, 0.3, 61), b=10, c=1.65, e=0.5)
f_hat = sumo_mfc.ultra_local_f(10 + 0.5 * time, np.zeros_like(time), window=2.0, period=0.5)
print(force.max(), f_hat[-1])

paper = sumo_mfc.paper("step", preset="default", quiet=True)
print(polars.DataFrame(paper.results).drop_nulls("published").select("controller", "quantity", "value", "published", "verdict"))

try:
    sumo_mfc.run("my.sumocfg", controller="adaptiv")
except sumo_mfc.Error as error:
    print(error)
