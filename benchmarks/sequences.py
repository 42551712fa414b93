"""The sequences, each from a name and a seed, with exact truth."""

from typing import Any

from matchset.sim.clip import Clip

PRESETS = ("clean", "typical", "bad")
SEQUENCES = (*PRESETS, "hard")
FRAMES = 300
QUICK_FRAMES = 100
FPS = 30


def sequence(name: str, seed: int, frames: int = FRAMES, **changes: Any) -> Clip:
    """Build a sequence.

    Parameters
    ----------
    name : str
        "clean", "typical", "bad", or "hard": typical with an occluder, blue clutter, a swing of the light,
        motion blur and JPEG.
    seed : int
        Decides path, room and noise.
    frames : int
        Length.
    **changes
        Parameters of `Clip` that differ.

    Returns
    -------
    Clip
    """
    if name == "hard":
        return Clip.hard(seed=seed, frames=frames, **changes)
    if name not in PRESETS:
        raise ValueError(f"a sequence is one of {', '.join(SEQUENCES)}, got {name!r}")
    return Clip(preset=name, seed=seed, frames=frames, **changes)
