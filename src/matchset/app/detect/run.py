"""What `matchset detect` does: `run_detect`."""

import math
import sys
from collections.abc import Sequence

from matchset.app.detect.options import MOST, DetectOptions
from matchset.app.drawing.draw import draw
from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import FOUND, NOT_FOUND, print_note, print_warnings
from matchset.app.run_folder import output_file, output_folder
from matchset.app.target.frame_picker import lit_frame_at
from matchset.app.target.target_options import color_at, parse_pick, taken_words
from matchset.shapes.circle import Circle
from matchset.tracking.detection import detect
from matchset.tracking.track import Track

COUNTED = 200  # format: how many are counted at least, to say how many there are beside those that are shown


def run_detect(options: DetectOptions) -> int:
    """Find what the options say, write the picture, and print a line for each.

    Returns
    -------
    int
        The exit code.
    """
    x, y, at = parse_pick(options.pick)
    with options.silence.open(options.source, topic=options.topic, view=options.view) as video:
        frame = lit_frame_at(video, at or 0)
        print_warnings(video.warnings)
    color = color_at(frame, x, y, options.reading)
    print_note(taken_words(color, options.reading))
    most = options.most or MOST
    found = detect(frame, Circle, color, limit=max(COUNTED, most))
    shown = found[:most] if options.every else _clicked(found, x, y)
    path = (
        output_folder(None, "detect") / "found.png"
        if options.out is None
        else output_file(options.out, options.force, options.source)
    )
    write_picture(path, draw(frame, shown))
    _print_found(shown)
    if options.every:
        print(_count_words(len(shown), len(found)))
    print(f"picture: {path}", file=sys.stderr)
    return FOUND if shown else NOT_FOUND


def _clicked(found: Sequence[Track[Circle]], x: float, y: float) -> list[Track[Circle]]:
    """Choose the one that holds the click, with its middle nearest to that; none if no one does."""
    holding = [each for each in found if math.hypot(each.shape.x - x, each.shape.y - y) <= each.shape.radius]
    return sorted(holding, key=lambda each: math.hypot(each.shape.x - x, each.shape.y - y))[:1]


def _print_found(shown: Sequence[Track[Circle]]) -> None:
    """Print a line for each: its number, where it is, and how sure that is."""
    if shown:
        print("    #       x       y  radius   x std   y std   r std")
    for number, each in enumerate(shown, start=1):
        values = each.shape.x, each.shape.y, each.shape.radius
        deviations = [math.sqrt(max(float(each.covariance[k, k]), 0.0)) for k in range(3)]
        places = "".join(f"{value:8.1f}" for value in values) + "".join(f"{value:8.2f}" for value in deviations)
        print(f"{number:5d}{places}")


def _count_words(shown: int, found: int) -> str:
    """Say how many were found, and of how many that are shown."""
    if shown == found:
        return f"{found} found"
    counted = f"{found} or more" if found >= COUNTED else f"{found}"
    return f"{shown} of {counted} shown: --most {found} shows more"
