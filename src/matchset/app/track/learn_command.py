"""`matchset learn`: show ball-like circles in a frame (`show_candidates`), or save a color (`learn_color`)."""

import shlex
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.cli_options import source_words
from matchset.app.drawing.annotate import as_color
from matchset.app.exit_codes import FOUND, NOT_FOUND
from matchset.app.run_folder import output_file, output_folder
from matchset.app.track.command import LearnOptions
from matchset.app.track.frame_picker import ball_like_frame, lit_frame_at
from matchset.app.track.grid_picture import grid_picture
from matchset.app.track.shape_option import parse_shape
from matchset.app.track.target_options import parse_pick
from matchset.image.candidates import Candidate, find_candidates
from matchset.image.color import ColorModel
from matchset.image.files.whole_file import write_whole
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.detector import detect


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
    with Video(options.source, topic=options.topic) as video:
        frame = lit_frame_at(video, options.frame or at or 0)
    color = ColorModel.pick(frame.image, x, y)
    path = (
        output_folder(None, "learn") / "ball.npz"
        if options.out is None
        else output_file(options.out, options.force, options.source)
    )
    picture = output_file(path.with_name(path.stem + "-mask.png"), options.force, options.source)
    color.save(path)
    write_picture(picture, mask_picture(frame.image, color))
    print(f"color saved:  {path}")
    print(f"look at it:   {picture}")
    print("The ball should be bright, all else dark. Then type:\n")
    words = ("--shape", options.shape) if family is not Circle else ()
    if words:
        found = detect(frame, family, color)
        print(f"  # of this color and shape in frame {frame.index}: {len(found)}")
    print(f"  {shell_command('track', *source_words(options.source, options.topic), '--color', str(path), *words)}")
    return FOUND


def show_candidates(options: LearnOptions) -> int:
    """Write a frame with a pixel grid and numbered candidates, and print the commands that follow.

    Returns
    -------
    int
        The exit code.
    """
    parse_shape(options.shape)
    with Video(options.source, topic=options.topic) as video:
        if options.frame is None:
            frame, found = ball_like_frame(video)
        else:
            frame = lit_frame_at(video, options.frame)
            found = find_candidates(frame.image)
        live = video.live
    if options.out is None:
        path = output_folder(None, "learn") / f"frame-{frame.index}.png"
    else:
        path = output_file(options.out, options.force, options.source)
    write_picture(path, grid_picture(frame.image, found))
    print(f"frame {frame.index} with a pixel grid: {path}\n")
    if found:
        _print_candidates(found)
    else:
        print("nothing ball-like was found in it")
    if live:
        _print_commands_for_camera(options, frame, found, path)
    else:
        _print_commands(source_words(options.source, options.topic), frame, found)
    return FOUND if found else NOT_FOUND


def _print_candidates(found: list[Candidate]) -> None:
    print("ball-like:    x      y  radius")
    for number, candidate in enumerate(found, start=1):
        print(f"  {number}    {candidate.x:6.0f} {candidate.y:6.0f} {candidate.radius:7.0f}")


def _print_commands(source: tuple[str, ...], frame: Frame, found: list[Candidate]) -> None:
    if found:
        print("\nIf the ball is number 1, type:\n")
        print(f"  {shell_command('track', *source, '--candidate', f'1@{frame.index}')}")
        print("\nIf it has no number, read a pixel on it from the grid and put it in:\n")
    else:
        print("\nRead a pixel on the ball from the grid and put it in:\n")
    height, width = frame.image.shape[:2]
    x, y = found[0].pick if found else (width // 2, height // 2)
    print(f"  {shell_command('track', *source, '--pick', f'{x},{y}@{frame.index}')}")


def _print_commands_for_camera(options: LearnOptions, frame: Frame, found: list[Candidate], path: Path) -> None:
    """Save the frame and every candidate's color: the ball will have moved when the next command is typed."""
    still = output_file(path.with_name(f"{path.stem}-still.png"), options.force, options.source)
    write_picture(still, frame.image)
    for number, candidate in enumerate(found, start=1):
        try:
            color = ColorModel.pick(frame.image, *candidate.pick)
        except ValueError:
            continue
        file = output_file(path.with_name(f"candidate-{number}.npz"), options.force, options.source)
        color.save(file)
        if number == 1:
            print("\nIf the ball is number 1, type (the others' colors are saved beside it):\n")
            print(f"  {shell_command('track', options.source, '--color', str(file))}")
    print("\nIf it has no number, read a pixel on it from the grid and learn its color:\n")
    x, y = found[0].pick if found else (frame.image.shape[1] // 2, frame.image.shape[0] // 2)
    print(f"  {shell_command('learn', str(still), '--pick', f'{x},{y}')}")


def shell_command(*words: str) -> str:
    """Return a command of matchset, quoted for a shell."""
    return shlex.join(("matchset", *words))


def mask_picture(image: npt.NDArray[np.uint8], color: ColorModel) -> npt.NDArray[np.uint8]:
    """Darken the pixels that do not have the target's color.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        A picture.
    color : ColorModel
        The target's color.

    Returns
    -------
    ndarray of shape (h, 2 w, 3), uint8
        The picture, and beside it the picture with only the target bright.
    """
    plain = as_color(image)
    masked = np.where(color.mask(image)[..., None] > 0, plain, plain // 6).astype(np.uint8)
    return np.hstack([plain, masked])


def write_picture(path: Path, image: npt.NDArray[np.uint8]) -> None:
    """Write a picture, whole or not at all; ValueError if it cannot be written."""
    good, packed = cv2.imencode(path.suffix, image)
    if not good:
        raise ValueError(f"cannot write a picture as {path.suffix}")
    try:
        write_whole(path, packed.tobytes())
    except OSError as error:
        raise ValueError(f"cannot write {path}: {error.strerror}") from error
