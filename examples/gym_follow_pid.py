"""Hold a place behind a ball in the Gymnasium environment, by pictures alone: PID controllers with feedforward."""

import gymnasium
import numpy as np

import matchset as ms
from matchset.control.follower import Follower

gymnasium.register_envs(ms.gym)
env = gymnasium.make("matchset/Follow-v0", observation="pose", duration=10.0)
eye: ms.gym.FollowEnv = env.unwrapped  # type: ignore[assignment]
follower = Follower(eye.parameters.place)
hover = follower.parameters.hover_throttle

observation, info = env.reset(seed=7)
errors = []
while True:
    output = follower.update(eye.pose, info["time"])  # the pose that was measured in the picture
    sticks = (0.0, 0.0, 0.0, hover) if output is None else output.desired
    action = np.clip(np.array(sticks, np.float32), env.action_space.low, env.action_space.high)  # type: ignore[attr-defined]
    follower.sent(ms.sim.Command(*action.tolist()), info["time"])
    observation, reward, terminated, truncated, info = env.step(action)
    errors.append(info["truth"]["error"])
    if len(errors) % 30 == 0:
        place = info["truth"]["place"].round(2)
        print(f"{len(errors) / 30:4.0f} s  side, height, heading {place} m  reward {reward:.3f}")
    if terminated or truncated:
        break
rms = float(np.sqrt(np.mean(np.square(errors[150:]))))
print(info["crash"] or f"flown to the end; off the place by {rms:.3f} m rms from 5 s on")
