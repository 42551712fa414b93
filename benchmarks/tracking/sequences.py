"""The sequences, each from a name and a seed, with exact truth."""

from typing import Any

from matchset.sim.clips.clip import Clip

PRESETS = ("clean", "typical", "bad")
SEQUENCES = (*PRESETS, "hard")
"""Those with goals of their own."""

TRIALS = ("occlusion", "clutter", "light", "blur", "shrink", "fast", "return", "hidden", "empty")
"""`typical` with one difficulty each."""

FRAMES = 300
QUICK_FRAMES = 100
FPS = 30
GONE = {"return": ((50, 80),), "hidden": ((30, 60), (90, 120))}
"""Windows of frames in which the ball is out of the picture, or behind a board."""

WHAT = {
    "clean": "sharp, little noise: the easy one",
    "typical": "analog PAL link, interlaced, usual noise",
    "bad": "analog PAL link at the end of its range",
    "hard": "`typical`, a fifth occluded, blue clutter, light × 2, motion blur, JPEG 40",
    "occlusion": "`typical`, a stick over 30 % of the disc",
    "clutter": "`typical`, posters, bars and rims of the same color",
    "light": "`typical`, brightness swings by a factor of 3 in 4 s, white balance by ± 10 %",
    "blur": "`typical`, shutter open for the whole of the field's time: motion blur",
    "shrink": "`typical`, r falls from 120 to 4 px",
    "fast": "`typical`, motion twice as fast: up to 20 px a frame in x and in y",
    "return": "`typical`, leaves the picture and returns, up to 40 px a frame",
    "hidden": "`typical`, a board hides all of it twice, for a second each",
    "empty": "`typical` with clutter of the same color and no ball at all",
}
CHANGES: dict[str, dict[str, Any]] = {
    "occlusion": {"occluder": 0.3},
    "clutter": {"clutter": True},
    "light": {"gain_swing": 3.0, "white_balance_drift": 0.1},
    "blur": {"exposure": 1.0},
    "shrink": {"shrink_to": 4.0},
    "fast": {"speed": 2.0},
    "return": {"away": GONE["return"]},
    "hidden": {"hidden": GONE["hidden"]},
    "empty": {"clutter": True, "ball": False},
}


def sequence(name: str, seed: int, frames: int = FRAMES, **changes: Any) -> Clip:
    """Build a sequence.

    Parameters
    ----------
    name : str
        One of `WHAT`, which says what it is.
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
    if name not in WHAT:
        raise ValueError(f"a sequence is one of {', '.join(WHAT)}, got {name!r}")
    preset = name if name in PRESETS else "typical"
    return Clip(preset=preset, seed=seed, frames=frames, **(CHANGES.get(name, {}) | changes))
