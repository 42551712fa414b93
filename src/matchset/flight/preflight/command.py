"""`matchset preflight`: the checks before a real vehicle's motors turn, in their order, with its real devices.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

from matchset.flight.preflight.options import PreflightOptions

PREFLIGHT_EPILOG = """
[bold]Examples[/bold]

  matchset preflight --camera 0 --link crsf:///dev/ttyUSB0 --camera-file camera.toml --color ball.npz \
--marker-color marker.npz

  matchset preflight --config flight.toml -o preflight.json

The options are those of 'matchset fly'. The motors stay off: nothing is armed, and no throttle is sent. At a terminal \
it asks what no program can see; --unattended leaves that out. docs/first_flight.md has the way there.

Exit codes: 0 all checks passed or were skipped, 1 one failed, 2 bad input or options, 3 a device broke, 130 stopped \
by Ctrl-C.
"""


def preflight(options: PreflightOptions) -> int:
    """Check camera, radio, ball and computer before a first flight, one after the other; no motor turns."""
    from matchset.flight.preflight.run import run

    return run(options)
