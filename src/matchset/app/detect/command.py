"""The command `detect`. This module is loaded for every `matchset --help`; the function imports what it needs."""

from matchset.app.detect.options import DetectOptions
from matchset.app.exit_codes import EXIT_CODES

DETECT_EPILOG = f"""
[bold]Examples[/bold]

  matchset detect coins.jpg --pick 64,38 --all

  matchset detect balls.mp4 --pick 427,146@60 --all --most 50 -o found.png

It prints a line for each: number, x, y, radius, px, and their standard deviations. Those most surely right come first.

{EXIT_CODES}
"""


def detect(options: DetectOptions) -> int:
    """Find the ball that was clicked in a photograph, or all that look like it, and draw them."""
    from matchset.app.run_folder import check_run

    if options.most is not None and not options.every:
        raise ValueError("--most is of several: give --all")
    if options.out is not None and options.out.suffix.lower() not in (".png", ".jpg"):
        raise ValueError(f"-o names a picture (.png or .jpg), got {str(options.out)!r}")
    check_run(None, (), [options.out], [options.source], options.force)
    from matchset.app.detect.run import run_detect

    return run_detect(options)
