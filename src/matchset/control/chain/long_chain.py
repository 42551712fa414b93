"""What a follower of a long chain does otherwise than one of a short chain: `in_chain`."""

import msgspec

from matchset.control.follower import FollowerParameters
from matchset.control.parameter_checks import require, require_positive


class LongChainParameters(
    msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename={"tilt_sigma": "tilt"}
):
    """When a chain is long, and what changes then; the key in a file is in parentheses where it is another one.

    Chosen on flights without pictures of three to ten vehicles, seeds 0 to 5 and 40 to 43:
    docs/log/control.md#gains-in-gusts.

    Parameters
    ----------
    short : int
        Up to so many followers the chain is short: the high gains of `GainScheduleParameters` hold in full. More of
        them enlarge what the one next to the rope does wrong.
    long : int
        From so many followers on the low gains hold alone; in between both, in proportion.
    elsewhere : int
        Followers of the same chain that another computer flies.
    tilt_sigma : float
        `NeighborFilterParameters.tilt_sigma` of a chain that is not short, rad. More makes it fall in its start at long
        delays; the larger one of a short chain helps vehicles whose tilt is not as told (``tilt``).
    """

    short: int = 2
    long: int = 6
    elsewhere: int = 0
    tilt_sigma: float = 0.025

    def __post_init__(self) -> None:
        require(self, ("short",), lambda value: value >= 0, "0 or more")
        require(self, ("long",), lambda value: value > self.short, "more than short")
        require(self, ("elsewhere",), lambda value: value >= 0, "0 or more")
        require_positive(self, ("tilt_sigma",))


def in_chain(follower: FollowerParameters, followers: int, limits: LongChainParameters) -> FollowerParameters:
    """Return the parameters of a follower in a chain with so many followers.

    Parameters
    ----------
    follower : FollowerParameters
        Of a short chain.
    followers : int
        That this computer flies.
    limits : LongChainParameters
    """
    number = followers + limits.elsewhere
    if number <= limits.short:
        return follower
    share = max(limits.long - number, 0) / (limits.long - limits.short)
    replace = msgspec.structs.replace
    return replace(
        follower,
        schedule=replace(follower.schedule, weight=share * follower.schedule.weight),
        neighbor=replace(follower.neighbor, tilt_sigma=min(follower.neighbor.tilt_sigma, limits.tilt_sigma)),
    )
