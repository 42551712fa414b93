"""Filter poses and predict them over the latency of a command, 67 ms, with exact truth to compare."""

import math

import numpy as np

import matchset as ms

AGE = 0.067  # s, from the exposure of a picture to the effect of a command
rng = np.random.default_rng(1)
covariance = np.diag((0.003, 0.003, 0.010, 1.8, 1.8, 1.8)) ** 2  # m; the rotation is not observed


def place(time: float) -> np.ndarray:
    """Return the true position: it oscillates by half a meter, m."""
    return np.array((0.5 * math.sin(time), 0.1, 1.5 + 0.3 * math.cos(0.7 * time)))


poses = ms.PoseFilter()
plain, ahead, time = [], [], 0.0
while time < 20.0:
    time += 1 / 30 + rng.uniform(-0.004, 0.004)  # time stamps jitter
    if rng.random() < 0.1:  # and in some frames the ball is hidden
        poses.update(ms.Lost("hidden", time))
        continue
    seen = place(time) + 0.003 * rng.standard_normal(3) * (1.0, 1.0, 3.0)
    pose = ms.Pose(position=seen, rotation_matrix=None, covariance=covariance, observed="position", time=time)
    poses.update(pose)
    then = poses.predict(time + AGE)
    if isinstance(then, ms.Pose) and time > 1.0:
        plain.append(np.linalg.norm(seen - place(time + AGE)))
        ahead.append(np.linalg.norm(then.position - place(time + AGE)))
print(f"without prediction {1000 * np.sqrt(np.mean(np.square(plain))):.1f} mm rms off when the command acts")
print(f"with prediction    {1000 * np.sqrt(np.mean(np.square(ahead))):.1f} mm")
