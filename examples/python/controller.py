"""A controller in Python beside the installed one, without SUMO and with it: `python controller.py my.sumocfg`."""

import sys

import sumo_mfc


@sumo_mfc.register
class ColumnPi(sumo_mfc.Controller):
    """PI with feed-forward."""

    name = "column_pi"
    keys = {"k_p": 1.0, "k_i": 1.0}

    def command(self, obs):
        integral = obs.memory("integral")
        integral -= self.k_i * obs.period * obs.error
        return (integral - self.k_p * obs.error + obs.reference_rate) * obs.nominal


if __name__ == "__main__":
    for law in ["pid", "column_pi"]:
        print(law, sumo_mfc.drive(([0, 10, 30], [5, 15, 15]), law).statistics["error_rms"])
    if len(sys.argv) > 1:
        print(sumo_mfc.compare(sys.argv[1], ["pid", "column_pi"], seeds="1..2", end=120, no_report=True))
