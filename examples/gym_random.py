"""Fly the Gymnasium environment with random sticks, two worlds at a time, and write the last picture of each."""

import sys
from pathlib import Path

import cv2
import gymnasium
import numpy as np

import matchset as ms

for name in ("world0.png", "world1.png"):
    if Path(name).exists():
        sys.exit(f"error: {name} exists and is not overwritten: go to another folder, or delete it")
gymnasium.register_envs(ms.gym)
envs = gymnasium.make_vec(
    "matchset/Follow-v0", num_envs=2, vectorization_mode="sync", width_px=320, height_px=240, render_mode="rgb_array"
)
pictures, info = envs.reset(seed=3)
envs.action_space.seed(3)
returns, ended = np.zeros(2), np.zeros(2, bool)
while not ended.all():
    pictures, rewards, terminated, truncated, info = envs.step(envs.action_space.sample())
    for k in np.flatnonzero((terminated | truncated) & ~ended):
        print(f"world {k}: {info['crash'][k]} at {info['time'][k]:.1f} s, return {returns[k] + rewards[k]:.1f}")
        cv2.imwrite(f"world{k}.png", np.asarray(envs.render())[k][:, :, ::-1])  # RGB to OpenCV's BGR
    returns += np.where(ended, 0.0, rewards)
    ended |= terminated | truncated
envs.close()
