"""`matchset learn`: show ball-like circles in a frame (`show_candidates`), or save a color (`learn_color`)."""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matchset.app.cli_options import source_words
from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import FOUND, NOT_FOUND, print_warnings
from matchset.app.guidance.candidate_tiles import candidate_tiles, mask_picture
from matchset.app.guidance.choice import BallChoice, choose
from matchset.app.guidance.explain import PARAMETERS, explain_refused_click
from matchset.app.guidance.large_frames import reduced, rescaled
from matchset.app.guidance.next_command import FailedRun, shell_command
from matchset.app.guidance.why_picture import covered, percent
from matchset.app.run_folder import output_file, output_folder
from matchset.app.target.frame_picker import lit_frame_at
from matchset.app.target.shape_option import parse_shape
from matchset.app.target.target_options import RefusedClickError, color_at, parse_pick, taken_words
from matchset.app.track.grid_picture import grid_picture
from matchset.app.track.options import LearnOptions
from matchset.image.candidates import Candidate
from matchset.image.circle_score import SCORE
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.detection import detect


def learn_color(options: LearnOptions) -> int:
    """Learn the color at a pixel and save it, with a picture of what it finds.

    Returns
    -------
    int
        The exit code.
    """
    family = parse_shape(options.shape)
    x, y, at = parse_pick(options.pick or "")
    if at is not None and options.frame not in (None, at):
        raise ValueError(f"--pick says frame {at}, --frame says {options.frame}")
    with options.silence.open(options.source, topic=options.topic, view=options.view) as video:
        frame = lit_frame_at(video, options.frame or at or 0)
        live = video.live
        print_warnings(video.warnings)
    try:
        color = color_at(frame, x, y, options.reading, family is Circle, options.marker)
    except RefusedClickError as refused:
        clicked = f"{x:g},{y:g}@{frame.index}"
        run = FailedRun("learn", options.source, options.topic, family, clicked, live=live, view=options.view)
        explain_refused_click(refused, run, output_folder(None, "learn"))
        raise
    path = (
        output_folder(None, "learn") / "ball.npz"
        if options.out is None
        else output_file(options.out, options.force, options.source)
    )
    picture = output_file(path.with_name(path.stem + "-mask.png"), options.force, options.source)
    color.save(path)
    if family is Circle and not options.marker:
        print(f"note: {taken_words(color, options.reading)}", file=sys.stderr)
    small = reduced(frame)
    write_picture(picture, mask_picture(small.image, color))
    print(f"color saved:  {path}")
    print(f"look at it:   {picture}")
    _print_cover(small, color)
    words = ("--shape", options.shape) if family is not Circle else ()
    if words:
        found = detect(frame, family, color)
        print(f"  # of this color and shape in frame {frame.index}: {len(found)}")
    source = source_words(options.source, options.topic, options.view)
    print(f"  {shell_command('track', *source, '--color', str(path), *words)}")
    return FOUND


def _print_cover(frame: Frame, color: ColorModel) -> None:
    """Say how much of the picture a color covers, and what to do if that is much."""
    share = covered(frame.image, color)
    words = f"The color covers {percent(100.0 * share)} of frame {frame.index}"
    if share > PARAMETERS.wide:
        words += ": narrow it, by a click on a spot of the ball whose color is nowhere else"
    print(f"{words}. The ball should be bright, all else dark. Then type:\n")


def show_candidates(options: LearnOptions) -> int:
    """Write a frame with a pixel grid and numbered candidates, and print the commands that follow.

    Returns
    -------
    int
        The exit code.
    """
    parse_shape(options.shape)
    choice, live = _choose(options)
    frame, found = choice.frame, choice.candidates
    if options.out is None:
        path = output_folder(None, "learn") / f"frame-{frame.index}.png"
    else:
        path = output_file(options.out, options.force, options.source)
    small = reduced(frame)
    smaller = [rescaled(each, frame, small) for each in found]
    colors = [_color_of(small, each) for each in smaller]
    picture = grid_picture(frame.image, found)
    if found:
        picture = np.hstack([picture, candidate_tiles(small.image, smaller, colors, picture.shape[0])])
    write_picture(path, picture)
    print(f"frame {frame.index} with a pixel grid: {path}\n")
    if found:
        _print_candidates(small, found, colors)
    else:
        print("nothing ball-like was found in it")
    if live:
        _print_commands_for_camera(options, choice, colors, path)
    else:
        _print_commands(source_words(options.source, options.topic, options.view), frame, found)
    return FOUND if found else NOT_FOUND


def _choose(options: LearnOptions) -> tuple[BallChoice, bool]:
    """Choose the frame and order its candidates; also whether the source is live."""
    given: Frame | None = None
    with options.silence.open(options.source, topic=options.topic, view=options.view) as video:
        if options.frame is not None:
            given = lit_frame_at(video, options.frame)
        if given is None or video.live:
            choice = choose(video, given)
            print_warnings(video.warnings)
            return choice, video.live
    with options.silence.open(options.source, topic=options.topic, view=options.view) as video:
        choice = choose(video, given)
        print_warnings(video.warnings)
    return choice, False


def _color_of(frame: Frame, candidate: Candidate) -> ColorModel | None:
    try:
        return ColorModel.pick(frame.image, *candidate.pick)
    except ValueError:
        return None


def _print_candidates(frame: Frame, found: Sequence[Candidate], colors: Sequence[ColorModel | None]) -> None:
    print("ball-like:    x      y  radius   click at   its color covers")
    for number, (candidate, color) in enumerate(zip(found, colors, strict=True), start=1):
        x, y = candidate.pick
        share = "-" if color is None else percent(100.0 * covered(frame.image, color))
        place = f"{candidate.x:6.0f} {candidate.y:6.0f} {candidate.radius:7.0f}"
        print(f"  {number}    {place}   {f'{x},{y}':<9s}  {share}")


def _print_commands(source: tuple[str, ...], frame: Frame, found: Sequence[Candidate]) -> None:
    height, width = frame.image.shape[:2]
    if found:
        x, y = found[0].pick
        if found[0].score < SCORE.convincing:
            print("\nNone of them looks much like a ball: look at the picture before you believe number 1.")
        print("\nIf the ball is number 1, type:\n")
        print(f"  {shell_command('track', *source, '--pick', f'{x},{y}@{frame.index}')}")
        print("\nIf it has another number, put its click in. If it has none, read a pixel on it from the grid.")
        return
    print("\nRead a pixel on the ball from the grid and put it in:\n")
    print(f"  {shell_command('track', *source, '--pick', f'{width // 2},{height // 2}@{frame.index}')}")


def _print_commands_for_camera(
    options: LearnOptions, choice: BallChoice, colors: Sequence[ColorModel | None], path: Path
) -> None:
    """Save the frame and every candidate's color: the ball will have moved when the next command is typed."""
    frame, found = choice.frame, choice.candidates
    still = output_file(path.with_name(f"{path.stem}-still.png"), options.force, options.source)
    write_picture(still, frame.image)
    saved: list[tuple[int, Path]] = []
    for number, color in enumerate(colors, start=1):
        if color is None:
            continue
        file = output_file(path.with_name(f"candidate-{number}.npz"), options.force, options.source)
        color.save(file)
        saved.append((number, file))
    if saved:
        number, file = saved[0]
        others = ", ".join(str(each) for each, _ in saved[1:])
        beside = f" (saved beside it: the colors of {others})" if others else ""
        print(f"\nIf the ball is number {number}, type{beside}:\n")
        source = source_words(options.source, options.topic, options.view)
        print(f"  {shell_command('track', *source, '--color', str(file))}")
    missing = ", ".join(str(number) for number, color in enumerate(colors, start=1) if color is None)
    if missing:
        print(f"\nNo color could be learned of: {missing}")
    print("\nIf it has no number, read a pixel on it from the grid and learn its color:\n")
    x, y = found[0].pick if found else (frame.image.shape[1] // 2, frame.image.shape[0] // 2)
    print(f"  {shell_command('learn', str(still), '--pick', f'{x},{y}')}")
