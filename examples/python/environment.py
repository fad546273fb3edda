import gymnasium
import numpy as np
import sumo_mfc.gym

env = gymnasium.make("sumo_mfc/Track-v0", noise=0.1)
seen, info = env.reset(seed=1)
total, over = 0.0, False
while not over:
    speed, reference, rate, last = seen
    action = np.array([(rate + 1.5 * (reference - speed)) / sumo_mfc.gym.ACCEL_MAX], dtype=np.float32)
    seen, reward, terminated, truncated, info = env.step(action)
    total, over = total + reward, terminated or truncated
print(f"{total:.1f}")
