"""`matchset identify`: a short flight, and what a controller must know of the vehicle, written as settings.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

from matchset.flight.identify.options import IdentifyOptions

IDENTIFY_EPILOG = """
[bold]Examples[/bold]

  matchset identify "sim://chain?thrust=0.85&latency_ms=133" -o vehicle.toml

  matchset identify serial:///dev/ttyUSB0 --camera 0 --camera-file camera.toml --color ball.npz --marker-color \
marker.npz -o vehicle.toml

  matchset identify --from flight.mcap -o vehicle.toml

  matchset fly --config vehicle.toml

Hang the ball up so that it does not move, its marker toward the camera, and put the vehicle at its set place. A real \
one is a dry run: no throttle is sent without --arm. docs/flight.md has the way there.

Exit codes: 0 found all that a flight needs, 1 not, 2 bad input or options, 3 a device broke, 130 stopped by Ctrl-C.

The space key, and SIGUSR1, stop the motors at once: the vehicle falls.
"""


def identify(options: IdentifyOptions) -> int:
    """Find what a controller must know of a vehicle, by some seconds of flight: hover, delay, gains, lags."""
    from matchset.flight.identify.run import run

    return run(options)
