"""What a follower of a long chain does otherwise than one of a short chain: `in_chain`."""

import msgspec

from matchset.control.follower import FollowerParameters
from matchset.numeric.arguments import require, require_at_least, require_positive


class LongChainParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When a chain is long, and what changes then.

    Chosen on flights without pictures of three to ten vehicles, seeds 0 to 5 and 40 to 43:
    docs/log/control.md#gains-in-gusts.

    Parameters
    ----------
    short_followers : int
        Up to so many followers the chain is short: the high gains of `GainScheduleParameters` hold in full. More of
        them enlarge what the one next to the rope does wrong.
    long_followers : int
        From so many followers on the low gains hold alone; in between both, in proportion.
    remote_followers : int
        Followers of the same chain that another computer flies.
    tilt_sigma : float
        `NeighborFilterParameters.tilt_sigma` of a chain that is not short, rad. More makes it fall in its start at long
        delays; the larger one of a short chain helps vehicles whose tilt is not as told.
    """

    short_followers: int = 2
    long_followers: int = 6
    remote_followers: int = 0
    tilt_sigma: float = 0.025

    def __post_init__(self) -> None:
        require_at_least(self, 0, "short_followers")
        require(self, ("long_followers",), lambda value: value > self.short_followers, "more than short_followers")
        require_at_least(self, 0, "remote_followers")
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
    number = followers + limits.remote_followers
    if number <= limits.short_followers:
        return follower
    share = max(limits.long_followers - number, 0) / (limits.long_followers - limits.short_followers)
    replace = msgspec.structs.replace
    return replace(
        follower,
        gain_schedule=replace(follower.gain_schedule, weight=share * follower.gain_schedule.weight),
        neighbor_filter=replace(
            follower.neighbor_filter, tilt_sigma=min(follower.neighbor_filter.tilt_sigma, limits.tilt_sigma)
        ),
    )
