"""A controller in NumPy beside the same law in Rust, in turn: `python python/bench/controllers.py CONFIGURATION [SECONDS]`.

CONFIGURATION is a grid of `sumo_nets/large/make.sh DIR 1000`. Prints the ratio of the wall times of each round, and the median.
"""

import statistics
import sys
import time

import sumo_mfc


@sumo_mfc.register
class NumpyPi(sumo_mfc.Controller):
    """PI with feed-forward, as the installed pid."""

    name = "numpy_pi"
    keys = {"k_p": 1.0, "k_i": 1.0}

    def command(self, obs):
        error = obs.error
        integral = obs.memory("integral")
        step = -self.k_i * obs.period * error
        step[step * (obs.commanded - obs.saturated) > 0] = 0
        integral += step
        return (integral - self.k_p * error + obs.reference_rate) * obs.nominal


def seconds(configuration, controller, end):
    start = time.perf_counter()
    result = sumo_mfc.run(configuration, controller=controller, end=end, no_report=True, quiet=True)
    return time.perf_counter() - start, len(result.vehicles)


def main():
    configuration, end = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 60.0
    ratios = []
    for number in range(5):
        (rust, vehicles), (python, _) = (seconds(configuration, name, end) for name in ("pid", "numpy_pi"))
        ratios.append(python / rust)
        print(f"round {number + 1}: {vehicles} vehicles, pid {rust:.2f} s, numpy_pi {python:.2f} s, {ratios[-1]:.2f} times")
    print(f"median: {statistics.median(ratios):.2f} times")


if __name__ == "__main__":
    main()
