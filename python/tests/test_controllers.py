"""Controllers written in Python."""

import numpy as np
import pytest

import sumo_mfc


@sumo_mfc.register
class ColumnPi(sumo_mfc.Controller):
    """PI with feed-forward, as the installed pid."""

    name = "column_pi"
    keys = {"k_p": 1.0, "k_i": 1.0}

    def command(self, obs):
        integral = obs.memory("integral")
        step = -self.k_i * obs.period * obs.error
        step[step * (obs.commanded - obs.saturated) > 0] = 0
        integral += step
        return (integral - self.k_p * obs.error + obs.reference_rate) * obs.nominal


def bytes_of(result, name="vehicles.csv"):
    return (result.dir / name).read_bytes()


def test_the_installed_law_written_in_python_gives_its_rows(city):
    """To the last digit: the group's columns carry all that a law for blocks sees."""
    options = {"seed": 3, "end": 120, "noise": {"power_db": -6}, "actuator": {"delay_s": 0.05}, "no_report": True}
    ours = sumo_mfc.run(city, controller="column_pi", **options)
    theirs = sumo_mfc.run(city, controller="pid", **options)
    assert len(ours.vehicles) > 3
    speeds = [result.vehicles["error_rms"] for result in (ours, theirs)]
    np.testing.assert_array_equal(*map(np.asarray, speeds))


def test_keys_reach_the_controller_and_misspellings_are_refused(city):
    profile = ([0, 10, 30], [5, 15, 15])
    stiff, soft = (sumo_mfc.drive(profile, {"name": "column_pi", "k_p": gain}) for gain in (3.0, 0.3))
    assert stiff.statistics["error_rms"] < 0.5 * soft.statistics["error_rms"]
    with pytest.raises(sumo_mfc.Error, match="k_pp"):
        sumo_mfc.drive(profile, {"name": "column_pi", "k_pp": 1.0})
    with pytest.raises(sumo_mfc.Error, match='did you mean "column_pi"'):
        sumo_mfc.drive(profile, "column_pj")


def test_a_study_runs_a_controller_of_a_file(city, tmp_path):
    study = sumo_mfc.compare(city, ["ideal", "column_pi"], seeds="1..2", end=60, quiet=True)
    assert len(study.runs) == 4


class Wrong(sumo_mfc.Controller):
    name = "wrong"

    def command(self, obs):
        raise ZeroDivisionError("no such gain")


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (lambda obs: np.full(obs.speed.shape, np.nan), "found the torque nan"),
        (lambda obs: np.zeros(3), "found torques of shape"),
        (lambda obs: 1 / 0, "ZeroDivisionError"),
    ],
)
def test_a_controller_that_fails_ends_the_run_with_its_words(city, tmp_path, answer, text):
    class Failing(sumo_mfc.Controller):
        name = "failing"

        def command(self, obs):
            return answer(obs)

    sumo_mfc.register(Failing)
    with pytest.raises(sumo_mfc.Error, match=text):
        sumo_mfc.run(city, controller="failing", out=tmp_path / "out", end=60)
    # What was computed is kept, marked incomplete, and the name can be registered anew.
    assert '"incomplete"' in (tmp_path / "out" / "run.json").read_text()
    with pytest.raises(sumo_mfc.Error, match="there is a controller"):
        Failing.name = "pid"
        sumo_mfc.register(Failing)


def test_a_controller_needs_a_name():
    class Nameless(sumo_mfc.Controller):
        pass

    with pytest.raises(ValueError, match="found no name"):
        sumo_mfc.register(Nameless)
