"""Render a balloon that flies through a room: ball.mp4, and ball.csv with the true circle of every frame."""

import sys
from pathlib import Path

from matchset.app.films.clip_export import write_clip
from matchset.sim.clips.clip import Clip

for name in ("ball.mp4", "ball.csv"):
    if Path(name).exists():
        sys.exit(f"error: {name} exists and is not overwritten: go to another folder, or delete it")
write_clip(Clip(frames=300), Path("ball.mp4"))
print("written: ball.mp4, ball.csv")
