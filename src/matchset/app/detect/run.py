"""What `matchset detect` does: `run_detect`."""

import math
import sys
from collections.abc import Sequence

from matchset.app.detect.options import MOST, DetectOptions
from matchset.app.drawing.draw import draw
from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import FOUND, NOT_FOUND, print_note, print_warnings
from matchset.app.run_folder import output_file, output_folder
from matchset.app.several.chosen import labelled
from matchset.app.target.frame_picker import lit_frame_at
from matchset.app.target.target_options import color_at, parse_pick, taken_words
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.detection import detect
from matchset.tracking.many.sightings import is_near_one, place_of
from matchset.tracking.track import Track

Found = tuple[str, Track[Circle]]
SAME = 0.7  # format: discs of two colors nearer than so many of the larger radius are one
COUNTED = 200  # format: how many are counted at least, to say how many there are beside those that are shown


def run_detect(options: DetectOptions) -> int:
    """Find what the options say, write the picture, and print a line for each.

    Returns
    -------
    int
        The exit code.
    """
    picks = [parse_pick(text) for text in options.picks]
    if len({at or 0 for *_, at in picks}) > 1:
        raise ValueError("every --pick must be in one picture: give all of them the same @FRAME")
    with options.silence.open(options.source, topic=options.topic, view=options.view) as video:
        frame = lit_frame_at(video, picks[0][2] or 0)
        print_warnings(video.warnings)
    colors = dict[str, ColorModel]()
    clicks = [(_learned(frame, colors, (x, y), options.reading), x, y) for x, y, _ in picks]
    most = options.most or MOST
    found = _found(frame, colors, max(COUNTED, most))
    shown = found[:most] if options.every else _clicked(found, clicks)
    path = (
        output_folder(None, "detect") / "found.png"
        if options.out is None
        else output_file(options.out, options.force, options.source)
    )
    write_picture(path, draw(frame, [track for _, track in shown]))
    _print_found(shown, len(colors) > 1)
    if options.every:
        print(_count_words(len(shown), len(found)))
    print(f"picture: {path}", file=sys.stderr)
    return FOUND if shown else NOT_FOUND


def _learned(frame: Frame, colors: dict[str, ColorModel], point: tuple[float, float], reading: int) -> str:
    """Learn the color at a click, beside those of earlier ones; return its label."""
    color = color_at(frame, *point, reading)
    print_note(taken_words(color, reading))
    return labelled(colors, color)


def _found(frame: Frame, colors: dict[str, ColorModel], limit: int) -> list[Found]:
    """Balls of all colors with their labels, the likeliest first; of two at one place the likelier one."""
    found = [(label, track) for label, color in colors.items() for track in detect(frame, Circle, color, limit=limit)]
    if len(colors) == 1:
        return found
    kept = list[Found]()
    for label, track in sorted(found, key=lambda each: -each[1].support):
        if not is_near_one(place_of(track.shape), [place_of(other.shape) for _, other in kept], SAME):
            kept.append((label, track))
    return kept


def _clicked(found: Sequence[Found], clicks: Sequence[tuple[str, float, float]]) -> list[Found]:
    """Choose for each click what holds it and has its label, with its middle nearest to it; none if no one does."""
    chosen = list[Found]()
    for label, x, y in clicks:
        far = {
            number: math.hypot(track.shape.x - x, track.shape.y - y)
            for number, (other, track) in enumerate(found)
            if other == label
        }
        holding = [number for number, distance in far.items() if distance <= found[number][1].shape.radius]
        chosen += [found[number] for number in sorted(holding, key=far.__getitem__)[:1]]
    return chosen


def _print_found(shown: Sequence[Found], labels: bool) -> None:
    """Print a line for each: its number, where it is, how sure that is, and its label if there are several."""
    if shown:
        print("    #       x       y  radius   x std   y std   r std" + "   label" * labels)
    for number, (label, each) in enumerate(shown, start=1):
        values = each.shape.x, each.shape.y, each.shape.radius
        deviations = [math.sqrt(max(float(each.covariance[k, k]), 0.0)) for k in range(3)]
        places = "".join(f"{value:8.1f}" for value in values) + "".join(f"{value:8.2f}" for value in deviations)
        print(f"{number:5d}{places}" + f"{label:>8s}" * labels)


def _count_words(shown: int, found: int) -> str:
    """Say how many were found, and of how many that are shown."""
    if shown == found:
        return f"{found} found"
    counted = f"{found} or more" if found >= COUNTED else f"{found}"
    return f"{shown} of {counted} shown: --most {found} shows more"
