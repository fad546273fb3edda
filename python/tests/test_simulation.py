"""Stepping through a run."""

import gc
import json
import socket
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sumo_mfc


def test_val_steps_are_those_of_a_run(city: Path) -> None:
    options: dict[str, Any] = {"controller": "pid", "egos": "share:0.5", "seed": 3, "end": 60, "trace": "all", "quiet": True}
    seen: dict[tuple[float, str], tuple[float, ...]] = {}
    with sumo_mfc.Simulation(city, **options) as sim:
        assert (sim.time, sim.end, sim.ids, sim.speed.shape) == (0.0, 60.0, (), (0,))
        while sim.step():
            columns = [sim.speed, sim.reference, sim.torque, sim.column("distance")]
            assert all(column.shape == (len(sim.ids),) and column.dtype == np.float64 for column in columns)
            np.testing.assert_array_equal(sim.error, sim.speed - sim.reference)
            for index, id in enumerate(sim.ids):
                seen[round(sim.time, 3), id] = tuple(float(column[index]) for column in columns)
        assert not sim.step()
    run = sumo_mfc.run(city, no_report=True, **options)
    for table in ["vehicles.csv", "trace.csv", "sample.csv"]:
        assert (sim.result.dir / table).read_bytes() == (run.dir / table).read_bytes(), table
    trace = run.trace
    traced = zip(*(trace[name] for name in ["time", "id", "speed", "reference", "torque", "distance"]), strict=True)
    rows = {(time, id): tuple(float(x) for x in rest) for time, id, *rest in traced}
    assert len(rows) > 1000 and rows.items() <= seen.items()
    assert max(abs(speed - reference) for speed, reference, *_ in seen.values()) > 0.01


def test_arrays_are_views_of_what_the_last_step_filled(straight: Path) -> None:
    with sumo_mfc.Simulation(straight, quiet=True) as sim:
        for _ in range(20):
            sim.step()
        view, copy, ids = sim.speed, sim.speed.copy(), sim.ids
        assert sim.speed is view and sim.ids is ids, "reading allocates nothing"
        assert view.base is not None and not view.flags.owndata and view.flags.c_contiguous
        assert np.shares_memory(view, sim.speed) and view.base is sim.torque.base
        sim.step()
        assert sim.speed is view and view[0] > copy[0], "the step has filled the same memory"
        np.testing.assert_array_equal(sim.error, sim.speed - sim.reference)
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 1.0
        with pytest.raises(sumo_mfc.Error, match="close"):
            sim.result  # noqa: B018
        with pytest.raises(sumo_mfc.Error, match="found the column id"):
            sim.column("id")
    assert json.loads((sim.result.dir / "run.json").read_text())["status"] == "incomplete"
    assert sim.close() is sim.result
    with pytest.raises(sumo_mfc.Error, match="the session has ended"):
        sim.step()
    assert view[0] > 0, "who keeps an array keeps its memory"


def test_arrays_outlive_the_egos_the_memory_and_the_simulation(city: Path) -> None:
    held: list[tuple[int, np.ndarray[Any, Any]]] = []
    with sumo_mfc.Simulation(city, controller="pid", end=60, quiet=True) as sim:
        while sim.step():
            held.append((len(sim.ids), sim.speed))
            assert sim.speed.shape == (len(sim.ids),) and np.isfinite(sim.speed).all()
    del sim
    gc.collect()
    assert len({id(array.base) for _, array in held}) > 1, "more egos than the first memory has room for"
    assert all(array.shape == (count,) and np.isfinite(array).all() and (array > -1).all() for count, array in held)


def until(sim: sumo_mfc.Simulation, time: float) -> None:
    """Steps to a time."""
    while sim.time < time - 1e-6:
        assert sim.step()


@pytest.mark.parametrize("target", ["traffic", "limit"])
def test_a_vehicle_follows_the_reference_that_is_set_and_then_sumo(straight: Path, target: str) -> None:
    with sumo_mfc.Simulation(straight, controller="pid", target=target, quiet=True) as sim:
        until(sim, 25)
        own = float(sim.speed[0])
        sim.set_reference(sim.ids, 6.0)
        until(sim, 40)
        np.testing.assert_allclose([sim.reference[0], sim.speed[0]], 6.0, atol=0.05)
        sim.set_reference(sim.ids[0], None)
        until(sim, 60)
        assert own > 10 and abs(sim.speed[0] - own) < 0.1
    assert any(note.startswith("references of 1 vehicle were set by the caller") for note in sim.result.notes)
    noted = json.loads((sim.result.dir / "run.json").read_text())["notes"]
    assert any(note.startswith("references of 1 vehicle were set") for note in noted)


def test_a_torque_disturbance_shows_in_the_error(straight: Path) -> None:
    with sumo_mfc.Simulation(straight, controller="pid", target="traffic", quiet=True) as sim:
        until(sim, 30)
        before = float(abs(sim.error[0]))
        sim.set_torque_disturbance(sim.ids[0], -800.0)
        errors, torques = [], []
        for _ in range(20):
            sim.step()
            errors.append(float(sim.error[0]))
            torques.append(float(sim.torque[0]))
        assert before < 0.02 and min(errors) < -0.05
        assert max(torques) > 400, "the controller answers; the disturbance itself is not in its torque"
        sim.set_torque_disturbance(sim.ids[0], 0.0)
        until(sim, 50)
        assert abs(sim.error[0]) < 0.02
    assert sum("torque disturbances of 1 vehicle" in note for note in sim.result.notes) == 1


def test_a_parameter_changes_what_a_vehicle_does(straight: Path) -> None:
    def torque(name: str | None, value: Any) -> float:
        """The largest torque on the way from 10 to 20 m/s."""
        with sumo_mfc.Simulation(straight, controller="pid", target="traffic", quiet=True) as sim:
            until(sim, 5)
            if name is not None:
                sim.set_parameter(sim.ids, name, value)
            largest = 0.0
            while sim.time < 20:
                sim.step()
                largest = max(largest, float(sim.torque.max()))
        assert any("mfc.* parameters of 1 vehicle" in note for note in sim.result.notes) == (name is not None)
        return largest

    own = torque(None, None)
    assert torque("mfc.mass_factor", 1.5) > 1.2 * own
    assert torque("mfc.torque_factor", np.float64(0.25)) < 0.8 * own
    assert torque("mfc.mass_factor", None) == own, "there is nothing to take back"


def test_what_cannot_be_set_is_refused(city: Path) -> None:
    with sumo_mfc.Simulation(city, controller="pid", end=20, quiet=True) as sim:
        with pytest.raises(sumo_mfc.Error, match="found no ego of this id"):
            sim.set_reference("nobody", 3.0)
        until(sim, 15)
        first, second, *_ = sim.ids
        for wrong in [np.nan, -1.0, np.inf]:
            with pytest.raises(sumo_mfc.Error, match="from 0 to 100 m/s"):
                sim.set_reference(first, wrong)
        with pytest.raises(sumo_mfc.Error, match=r"found nan|found NaN"):
            sim.set_torque_disturbance(first, float("nan"))
        with pytest.raises(sumo_mfc.Error, match=r"found the shape \(3,\) for 2 vehicles"):
            sim.set_reference([first, second], [1.0, 2.0, 3.0])
        with pytest.raises(sumo_mfc.Error, match=r"mfc\.mas, .*did you mean mfc\.mass"):
            sim.set_parameter(first, "mfc.mas", 1000)
        with pytest.raises(sumo_mfc.Error, match="cannot change while the vehicle drives"):
            sim.set_parameter(first, "mfc.wheel_radius_m", 0.4)
        with pytest.raises(sumo_mfc.Error, match='found "heavy", wanted a number from 50 to 100000 kg'):
            sim.set_parameter(first, "mfc.mass", "heavy")
        assert not any("by the caller" in note for note in sim._notes)
        sim.set_reference([first, second], [1.0, 2.0])
        sim.step()
    assert sum("references of 2 vehicles" in note for note in sim.result.notes) == 1
    assert not any("torque" in note and "by the caller" in note for note in sim.result.notes)
    with pytest.raises(sumo_mfc.Error, match="the session has ended"):
        sim.set_reference(first, None)


def test_an_exception_leaves_a_result(straight: Path, tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), sumo_mfc.Simulation(straight, out=tmp_path, quiet=True) as sim:
        sim.step()
        1 / 0  # noqa: B018
    assert json.loads((tmp_path / "run.json").read_text())["status"] == "incomplete"


def test_traci_is_a_second_client(straight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sumo_mfc._sumo.find()
    monkeypatch.syspath_prepend(str(Path(__import__("os").environ["SUMO_HOME"]) / "tools"))
    import traci

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    slowed: list[float] = []

    def other() -> None:
        client = traci.connect(port=port, numRetries=60)
        client.setOrder(2)
        while client.simulation.getTime() < 30:
            client.simulationStep()
            for vehicle in client.vehicle.getIDList() if client.simulation.getTime() == 15 else []:
                client.vehicle.setMaxSpeed(vehicle, 3.0)
                slowed.append(client.vehicle.getSpeed(vehicle))
        client.close()

    thread = threading.Thread(target=other)
    thread.start()
    with sumo_mfc.Simulation(straight, num_clients=2, port=port, end=30, target="traffic", quiet=True) as sim:
        while sim.step():
            pass
        last = sim.speed.copy()
    thread.join(30)
    assert not thread.is_alive() and slowed and slowed[0] > 5
    np.testing.assert_allclose(last, 3.0, atol=0.1)
    assert "traci" in sys.modules
