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

try:
    sumo_mfc.run("my.sumocfg", controller="adaptiv")
except sumo_mfc.Error as error:
    print(error)
