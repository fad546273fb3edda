"""Controllers written in Python."""

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sumo_mfc
from numpy.typing import ArrayLike, NDArray

from lines import REPOSITORY


@sumo_mfc.register
class ColumnPi(sumo_mfc.Controller):
    """PI with feed-forward, operation for operation as the installed pid."""

    name = "column_pi"
    keys = {"k_p": 1.0, "k_i": 1.0}
    k_p: float
    k_i: float

    def command(self, obs: sumo_mfc.Observation) -> NDArray[np.float64]:
        integral = obs.memory("integral")
        step = -(self.k_i * obs.period) * obs.error
        step[step * (obs.commanded - obs.saturated) > 0] = 0
        integral += step
        return (integral - self.k_p * obs.error + obs.reference_rate) * obs.nominal


def test_val_the_installed_law_written_in_python_gives_the_same_bytes(city: Path, tmp_path: Path) -> None:
    """The columns of a group carry all that a law for blocks sees, whoever comes and goes, stops and starts."""
    sections: dict[str, Any] = {"noise": {"power_db": -20}, "actuator": {"delay_s": 0.05, "lag_s": 0.1}}
    for law in ["pid", "column_pi"]:
        out = tmp_path / law
        sumo_mfc.run(city, controller=law, seed=3, end=150, trace="all", out=out, quiet=True, no_report=True, **sections)
    tables = ["vehicles.csv", "quality.csv", "edges.csv", "sample.csv", "trace.csv"]
    ours, theirs = ([(tmp_path / law / table).read_text() for table in tables] for law in ["column_pi", "pid"])
    assert ours[0].count("\n") > 100
    assert ours == [table.replace(",pid,", ",column_pi,") for table in theirs]


def test_keys_reach_the_controller_and_misspellings_are_refused() -> None:
    profile = ([0, 10, 30], [5, 15, 15])
    lag = {"lag_s": 0.5}
    stiff, soft = (
        sumo_mfc.drive(profile, {"name": "column_pi", "k_p": k_p}, actuator=lag).statistics["error_rms"]
        for k_p in (1.5, 0.3)
    )
    assert stiff is not None and soft is not None and stiff < 0.8 * soft
    with pytest.raises(sumo_mfc.Error, match="k_pp"):
        sumo_mfc.drive(profile, {"name": "column_pi", "k_pp": 1.0})
    with pytest.raises(sumo_mfc.Error, match='did you mean "column_pi"'):
        sumo_mfc.drive(profile, "column_pj")
    assert ("controller", "column_pi", "PI with feed-forward, operation for operation as the installed pid.") in (
        sumo_mfc.choices()
    )


def test_the_example_drives_alone_and_in_a_study(tmp_path: Path) -> None:
    """Each case of the study is a process of its own, which loads the file."""
    for file in (REPOSITORY / "sumo_nets" / "city").glob("city*"):
        shutil.copy(file, tmp_path)
    example = REPOSITORY / "examples" / "python" / "controller.py"
    words = [sys.executable, str(example), "city.sumocfg"]
    ended = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=280)
    assert ended.returncode == 0, ended.stderr
    assert "column_pi" in ended.stdout.splitlines()[1] and "4 of 4" not in ended.stderr
    # The comparison has a column for it.
    assert ended.stdout.count("column_pi") > 1


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (lambda obs: np.full(obs.speed.shape, np.nan), "found the torque nan in slot"),
        (lambda obs: np.zeros(3), "found torques of shape"),
        (lambda obs: 1 / 0, "ZeroDivisionError"),
    ],
)
def test_a_controller_that_fails_ends_the_run_with_its_words(
    city: Path, tmp_path: Path, answer: Callable[[sumo_mfc.Observation], ArrayLike], text: str
) -> None:
    class Failing(sumo_mfc.Controller):
        name = "failing"

        def command(self, obs: sumo_mfc.Observation) -> ArrayLike:
            return answer(obs) if obs.period and len(obs.speed) > 16 else np.zeros(obs.speed.shape)

    sumo_mfc.register(Failing)
    with pytest.raises(sumo_mfc.Error, match=text):
        sumo_mfc.run(city, controller="failing", out=tmp_path / "out", end=60, quiet=True)
    assert '"incomplete"' in (tmp_path / "out" / "run.json").read_text()
    assert (tmp_path / "out" / "vehicles.csv").exists()


def test_names_are_checked() -> None:
    class Nameless(sumo_mfc.Controller):
        pass

    with pytest.raises(sumo_mfc.Error, match="found no name"):
        sumo_mfc.register(Nameless)
    Nameless.name = "pid"
    with pytest.raises(sumo_mfc.Error, match='there is a controller "pid" already'):
        sumo_mfc.register(Nameless)


def test_a_file_without_a_guard_is_told_so(city: Path, tmp_path: Path) -> None:
    """Such a file would start the study again in each of its cases."""
    script = tmp_path / "unguarded.py"
    script.write_text(f"""
import sumo_mfc

@sumo_mfc.register
class Zero(sumo_mfc.Controller):
    name = "zero"
    def command(self, obs):
        return 0.0

sumo_mfc.compare({str(city)!r}, ["zero", "pid"], seeds="1..1", end=20)
""")
    ended = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=100)
    assert ended.returncode == 1
    assert '__name__ == "__main__"' in ended.stderr
