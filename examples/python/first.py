import sumo_mfc

result = sumo_mfc.run("my.sumocfg", controller="adaptive", egos="share:0.25", seed=1, end=120)
print(result)                                              # what the command line prints
print(result.vehicles["error_rms"].max(), "m/s at most")   # a NumPy array, as every column of numbers

with sumo_mfc.Simulation("my.sumocfg", controller="pid", end=60) as sim:
    while sim.step():
        if sim.time % 20 == 0:
            print(sim.time, len(sim.ids), abs(sim.error).max(initial=0.0))
