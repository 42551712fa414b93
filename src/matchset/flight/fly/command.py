"""`matchset fly`: one flight of a simulated chain or of real vehicles, shown, filmed, recorded and reported.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

from matchset.app.exit_codes import FOUND
from matchset.flight.fly.options import FlyOptions
from matchset.flight.fly.run import run_flight

FLY_EPILOG = """
[bold]Examples[/bold]

  matchset fly sim://chain

  matchset fly "sim://chain?vehicles=5&seed=7&pal=bad" --video chain.webm --report chain.html

  matchset fly sim://chain --config flight.toml --record chain.mcap

  matchset fly --print-config > flight.toml

  matchset fly --camera 0 --link serial:///dev/ttyUSB0 --camera-file camera.toml --color ball.npz \
--marker-color marker.npz

The last one is a real vehicle, and a dry run: no throttle is sent without --arm. docs/flight.md has the way there.

Exit codes: 0 everyone flew to the end, 1 not, 2 bad input or options, 3 a device broke, 130 stopped by Ctrl-C \
(everyone lands, files are whole).

The space key, and SIGUSR1, stop all motors at once: the vehicles fall.
"""


def fly(options: FlyOptions) -> int:
    """Fly a chain of quadcopters that hold their places by looking at each other."""
    if options.print_config:
        from matchset.flight.chain.config import default_toml

        print(default_toml(), end="")
        return FOUND
    options.files.check(options.force, [options.config, *options.linked.inputs])
    followers = options.linked.followers(options.uri, options.config)
    if followers:
        from matchset.flight.linked.run import fly_linked

        return fly_linked(followers, options)
    return fly_simulated(options)


def fly_simulated(options: FlyOptions) -> int:
    """Fly the simulated chain; returns the exit code."""
    from matchset.app.progress import announce_if_slow
    from matchset.flight.chain.flight import Flight
    from matchset.flight.chain.pacer import Pacer

    parameters = options.flight()
    options.files.make_folders(options.force)
    with announce_if_slow("getting ready ..."):
        flight = Flight(parameters)
    return run_flight(flight, options, Pacer(1.0 / parameters.world.fps) if options.real_time else None)
