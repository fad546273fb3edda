"""Parts that need no SUMO, against their equations."""

from pathlib import Path

import numpy as np
import pytest
import sumo_mfc


def test_a_drive_follows_its_profile() -> None:
    drive = sumo_mfc.drive(([0, 20, 40], [10, 20, 20]), law="adaptive", body="van", actuator={"delay_s": 0.1})
    time = drive["time"]
    assert drive.finished and time[-1] == pytest.approx(40)
    np.testing.assert_allclose(drive["reference"], np.interp(time, [0, 20, 40], [10, 20, 20]), atol=1e-9)
    assert abs(drive["speed"][-1] - 20) < 0.1
    error = drive["speed"] - drive["reference"]
    assert drive.statistics["error_rms"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-6)
    assert "error_rms" in repr(drive) and drive.trace.meanings["torque"][0] == "N·m"


def test_noise_seeds_and_laws_change_a_drive() -> None:
    profile = ([0, 30], [10, 15])
    speeds = {
        "plain": sumo_mfc.drive(profile)["speed"],
        "same": sumo_mfc.drive(profile)["speed"],
        "noise": sumo_mfc.drive(profile, noise=-10)["speed"],
        "seed": sumo_mfc.drive(profile, noise=-10, sumo={"seed": 5})["speed"],
        "law": sumo_mfc.drive(profile, law={"name": "pid", "k_p": 0.7})["speed"],
        "heavy": sumo_mfc.drive(profile, body={"preset": "car", "mass_factor": 1.5})["speed"],
    }
    np.testing.assert_array_equal(speeds.pop("same"), speeds["plain"])
    assert len({values.tobytes() for values in speeds.values()}) == len(speeds)


def test_profiles_of_files_and_places(tmp_path: Path) -> None:
    file = tmp_path / "trip.csv"
    file.write_text("t_s,v_mps\n0,5\n10,10\n20,10\n")
    of_file, of_arrays = sumo_mfc.drive(file), sumo_mfc.drive(([0, 10, 20], [5, 10, 10]))
    np.testing.assert_array_equal(of_file["speed"], of_arrays["speed"])
    placed = sumo_mfc.drive(([0, 100, 200], [10, 12, 12]), by="position")
    assert placed["distance"][-1] == pytest.approx(200, abs=0.2)
    steps = sumo_mfc.drive(([0, 5], [10, 12]), steps=True, seconds=8)
    assert set(np.unique(steps["reference"])) == {10.0, 12.0}


def test_what_is_wrong_with_a_drive_is_told() -> None:
    with pytest.raises(sumo_mfc.Error, match='unknown controller "pod"'):
        sumo_mfc.drive(([0, 10], [5, 5]), law="pod")
    with pytest.raises(sumo_mfc.Error, match="vehicle.weight"):
        sumo_mfc.drive(([0, 10], [5, 5]), body={"weight": 3})
    with pytest.raises(sumo_mfc.Error, match="speeds_mps: found .*wanted one speed for every place"):
        sumo_mfc.drive(([0, 10], [5, 5, 5]))
    with pytest.raises(sumo_mfc.Error, match="target"):
        sumo_mfc.drive()


def test_law_a_body_obeys_newton() -> None:
    body = sumo_mfc.Body("car", speed=10.0)
    torque, radius = 600.0, 0.3
    before, acceleration = body.speed, 0.0
    for _ in range(200):
        before = body.speed
        acceleration = (body.step(torque) - before) / body.period
    wheels = 4 * 1.0 / radius**2
    assert acceleration == pytest.approx(torque / radius / (body.mass + wheels), rel=1e-3)
    assert body.time == pytest.approx(2.0) and body.distance == pytest.approx(10 * 2 + 0.5 * acceleration * 4, rel=1e-2)
    assert torque / body.torque_per_acceleration == pytest.approx(acceleration, rel=0.05)


def test_bodies_lie_anywhere_in_memory() -> None:
    bodies, others = [], []
    for size in range(200):
        others.append(bytearray(16 * size))
        bodies.append(sumo_mfc.Body(speed=10.0))
    assert len({body.step(500.0) for body in bodies}) == 1


def test_a_steered_body_turns_to_the_left() -> None:
    left, right = sumo_mfc.Body(speed=15.0), sumo_mfc.Body(speed=15.0)
    for _ in range(100):
        left.step(0.0, 0.02)
        right.step(0.0, -0.02)
    assert left.yaw_rate > 0.05 and left.yaw_rate == pytest.approx(-right.yaw_rate)
    assert left.state.shape == (7,) and left.slip.shape == (2,)
    with pytest.raises(sumo_mfc.Error, match="steer: found 2"):
        left.step(0.0, 2.0)
    with pytest.raises(sumo_mfc.Error, match='unknown body "cra"'):
        sumo_mfc.Body("cra")


def test_val_the_tyre_is_the_magic_formula() -> None:
    slip = np.linspace(-1, 1, 202).reshape(2, 101)
    b, c, e = 10.0, 1.65, 0.5
    bt = b * slip
    formula = np.sin(c * np.arctan(bt - e * (bt - np.arctan(bt))))
    force = sumo_mfc.tyre_force(slip, b, c, e)
    np.testing.assert_allclose(force, formula, atol=1e-14)
    assert force.shape == slip.shape
    slips = np.linspace(0, 0.6, 121)
    found = sumo_mfc.identify_tyre(slips, 4000 * sumo_mfc.tyre_force(slips, b, c, e))
    assert found[3] == pytest.approx(4000, rel=1e-3)
    with pytest.raises(sumo_mfc.Error):
        sumo_mfc.identify_tyre([0.0, 0.1], [0.0, 1.0])


def test_law_the_estimator_finds_slope_and_input() -> None:
    period, window = 0.01, 0.2
    time = np.arange(300) * period
    slope = sumo_mfc.ultra_local_f(10 + 1.5 * time, np.zeros(300), window=window, period=period)
    np.testing.assert_allclose(slope[40:], 1.5, atol=1e-9)
    constant = sumo_mfc.ultra_local_f(np.full(300, 10.0), np.full(300, 2.0), window=window, period=period)
    np.testing.assert_allclose(constant[40:], -2.0, atol=1e-9)
    assert constant[0] != pytest.approx(-2.0)
    with pytest.raises(sumo_mfc.Error, match="found 3 speeds and 2 inputs"):
        sumo_mfc.ultra_local_f([1, 2, 3], [1, 2], window=window, period=period)
