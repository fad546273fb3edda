"""A law with three gains learns to drive a heavy car whose torque comes late: random search on some episodes of `Track-v0`, judged on others.

Needs `gymnasium`, and no SUMO: `python tuned_agent.py`.
"""

import gymnasium
import numpy as np
from sumo_mfc import gym

#: Proportional gain [1/s], integral gain [1/s²], share of the reference rate that is fed forward.
FIRST = np.array([0.5, 0.0, 0.0])


def reward(env, gains, seeds):
    """The mean reward per step under a PI law with feed-forward."""
    total, steps = 0.0, 0
    for seed in seeds:
        (speed, reference, rate, _), _ = env.reset(seed=seed)
        integral, ended = 0.0, False
        while not ended:
            error = speed - reference
            integral += 0.1 * error
            accel = gains[2] * rate - gains[0] * error - gains[1] * integral
            action = np.array([accel / gym.ACCEL_MAX], dtype=np.float32)
            (speed, reference, rate, _), got, terminated, truncated, _ = env.step(action)
            total, steps, ended = total + got, steps + 1, terminated or truncated
    return total / steps


def main():
    env = gymnasium.make("sumo_mfc/Track-v0", seconds=30.0, dead_time=0.2, noise=0.05, body={"mass_factor": 1.4})
    random, train, test = np.random.default_rng(1), range(6), range(100, 120)
    best, value = FIRST, reward(env, FIRST, train)
    for trial in range(60):
        tried = np.abs(best + random.normal(0.0, 0.3, 3) * 0.97**trial)
        found = reward(env, tried, train)
        if found > value:
            best, value = tried, found
            print(f"trial {trial + 1:3}: gains {np.round(best, 2)}, reward {value:.4f}")
    print(f"on other episodes: {reward(env, FIRST, test):.4f} before, {reward(env, best, test):.4f} after")


if __name__ == "__main__":
    main()
