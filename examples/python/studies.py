import sumo_mfc

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
