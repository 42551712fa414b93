"""`matchset fly --camera ... --link ...`: from the options to a flight: `fly_linked`."""

from collections.abc import Sequence

from matchset.app.progress import announce_if_slow
from matchset.flight.fly.options import FlyOptions
from matchset.flight.fly.run import run_flight
from matchset.flight.linked.opening import open_flight
from matchset.flight.linked.parameters import LinkedFollower

SIMULATED = {"vehicles": "--vehicles", "seed": "--seed", "pal": "--pal", "latency_ms": "--latency-ms"}


def fly_linked(followers: Sequence[LinkedFollower], options: FlyOptions) -> int:
    """Fly real vehicles, or all but fly them; returns the exit code.

    Raises
    ------
    ValueError
        If options do not belong together, or a file is not what it should be.
    LinkError
        If a camera or a link does not open, or was to blame for the end.
    """
    for name, option in SIMULATED.items():
        if getattr(options, name) is not None:
            raise ValueError(f"{option} is for a simulated chain, not for a real vehicle")
    parameters = options.linked.flight(options.flight())
    options.files.make_folders(options.force)
    with announce_if_slow("getting ready ..."):
        flight = open_flight(parameters, followers, dry=not options.linked.arm)
    return run_flight(flight, options)
