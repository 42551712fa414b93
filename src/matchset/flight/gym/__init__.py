"""A Gymnasium environment: a follower holds its place behind a neighbor's ball in the simulated world; extra `gym`.

Loading this folder, as ``ms.gym`` does, registers ``matchset/Follow-v0``; its names are loaded when they are used. Read
`follow_parameters` first, then `follow_env` (spaces, reward, end). Below it: `follow_flight` (world and camera, without
Gymnasium) and `pose_sensor` (what a picture says about the ball's pose). The page is docs/simulation.md.
"""

from matchset.numeric.imports import advice, lazy_names

try:
    import gymnasium
except ModuleNotFoundError:
    raise ImportError(f"the environments need the package gymnasium: {advice('gym')}") from None

TYPE_CHECKING = False  # as in `typing`, which takes longer to import than this package
if TYPE_CHECKING:
    from matchset.flight.gym.follow_env import FollowEnv
    from matchset.flight.gym.follow_parameters import FollowParameters

__all__ = ["FollowEnv", "FollowParameters"]

# The same as the imports above; a test compares them.
_MODULES = {
    "FollowEnv": "matchset.flight.gym.follow_env",
    "FollowParameters": "matchset.flight.gym.follow_parameters",
}

FOLLOW = "matchset/Follow-v0"  # format: name in Gymnasium's registry

if FOLLOW not in gymnasium.registry:
    gymnasium.register(FOLLOW, entry_point="matchset.flight.gym.follow_env:FollowEnv")

if not TYPE_CHECKING:  # a type checker that sees `__getattr__` takes every misspelled name for a public one
    __getattr__ = lazy_names(__name__, _MODULES)


def __dir__() -> list[str]:
    """List what is public, loaded yet or not, and what every module has."""
    return sorted({*(name for name in globals() if name.startswith("__")), *__all__})
