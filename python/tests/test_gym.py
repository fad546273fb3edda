"""The environments of Gymnasium."""

import re
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env
from sumo_mfc import gym

from lines import REPOSITORY


def drive(env: gymnasium.Env[gym.Seen, gym.Action], seed: int, gain: float) -> tuple[float, int]:
    """The sum of rewards and the number of steps of one episode under a P law with feed-forward."""
    seen, _ = env.reset(seed=seed)
    total, ended, steps = 0.0, False, 0
    while not ended:
        speed, reference, rate, _ = seen
        action = np.array([(rate - gain * (speed - reference)) / gym.ACCEL_MAX], dtype=np.float32)
        seen, reward, terminated, truncated, _ = env.step(action)
        total, ended, steps = total + float(reward), terminated or truncated, steps + 1
    return total, steps


def test_track_is_an_environment() -> None:
    check_env(gymnasium.make("sumo_mfc/Track-v0", noise=0.1, dead_time=0.1).unwrapped, skip_render_check=True)


def test_track_rewards_tracking_and_repeats_with_its_seed() -> None:
    env = gymnasium.make("sumo_mfc/Track-v0", noise=0.05)
    good, again, lazy, other = (drive(env, *how) for how in [(4, 1.5), (4, 1.5), (4, 0.0), (5, 1.5)])
    assert good == again != other
    assert good[1] == 600 and 2 * good[0] > lazy[0] and good[0] < 0


def test_the_example_tunes_an_agent_that_drives_other_episodes_better() -> None:
    example = REPOSITORY / "examples" / "python" / "tuned_agent.py"
    ended = subprocess.run([sys.executable, example], capture_output=True, text=True, check=True, timeout=280)
    last = re.search(r"on other episodes: (\S+) before, (\S+) after", ended.stdout)
    assert last is not None and float(last[2]) > 0.1 * float(last[1])


def test_track_in_a_vector() -> None:
    envs = gymnasium.make_vec("sumo_mfc/Track-v0", num_envs=3, seconds=5.0)
    seen, _ = envs.reset(seed=1)
    assert seen.shape == (3, 4) and len({float(speed) for speed in seen[:, 0]}) == 3
    envs.close()


def test_traffic_ends_with_the_trip_and_repeats_with_its_seed(straight: Path) -> None:
    env = gymnasium.make("sumo_mfc/Traffic-v0", scenario=str(straight), ego="ego")
    first, again, lazy = drive(env, 1, 1.5), drive(env, 1, 1.5), drive(env, 1, 0.2)
    assert first == again
    assert first[1] > 500 and first[0] > lazy[0]
    env.close()


def test_traffic_is_an_environment(straight: Path) -> None:
    env = gymnasium.make("sumo_mfc/Traffic-v0", scenario=str(straight), ego="ego").unwrapped
    check_env(env, skip_render_check=True)
    env.close()
