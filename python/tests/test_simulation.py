"""Stepping through a run."""

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
        assert (sim.time, sim.end, sim.ids, sim.speed.shape) == (0.0, 60.0, [], (0,))
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


def test_arrays_stay_as_they_are(straight: Path) -> None:
    with sumo_mfc.Simulation(straight, quiet=True) as sim:
        for _ in range(20):
            sim.step()
        before = sim.speed
        copy = before.copy()
        sim.step()
        np.testing.assert_array_equal(before, copy)
        assert sim.speed[0] > before[0]
        with pytest.raises(ValueError, match="read-only"):
            before[0] = 1.0
        with pytest.raises(sumo_mfc.Error, match="close"):
            sim.result  # noqa: B018
        with pytest.raises(sumo_mfc.Error, match="found the column id"):
            sim.column("id")
    assert json.loads((sim.result.dir / "run.json").read_text())["status"] == "incomplete"
    assert sim.close() is sim.result
    with pytest.raises(sumo_mfc.Error, match="the session has ended"):
        sim.step()


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
