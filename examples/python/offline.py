import numpy as np
import sumo_mfc

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

import polars

paper = sumo_mfc.paper("step", preset="default", quiet=True)
print(polars.DataFrame(paper.results).drop_nulls("published").select("controller", "quantity", "value", "published", "verdict"))
