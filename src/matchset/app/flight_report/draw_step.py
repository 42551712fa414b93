"""What a follower saw and decided, drawn into its picture: `annotate_step`."""

import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import as_color, caption
from matchset.app.drawing.text import draw_text
from matchset.app.flight.pilot import Step
from matchset.app.flight.step_words import age_words, place_words, state_words
from matchset.app.locate.annotate_pose import draw_seen
from matchset.camera.camera_model import CameraModel

Picture = npt.NDArray[np.uint8]

DARK = 30


def annotate_step(step: Step, number: int, camera: CameraModel, radius: float, words: bool = True) -> Picture:
    """Draw a turn of a follower's loop into a copy of its picture.

    Parameters
    ----------
    step : Step
    number : int
        Of the follower, from 1.
    camera : CameraModel
        What filmed it.
    radius : float
        Of the ball, m.
    words : bool
        Whether to write below who watches whom, the phase of the safety, and where the follower is.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR: the ball's outline with its match-set, or dashed where it should be; its markers, axes and distance. All
        dark where no picture came.
    """
    image = _picture(step, camera)
    draw_seen(image, step.ball, step.markers, step.pose, camera, radius)
    if words:
        _write(image, step, number)
    return image


def _write(image: Picture, step: Step, number: int) -> None:
    doubt = step.memory.phase != "flying"
    caption(image, f"{number} watches {number + 1}   {state_words(step)}", f"{step.now:.2f} s", bad=doubt, line=1)
    caption(image, place_words(step.answer), f"age {age_words(step.age)}", bad=doubt)


def _picture(step: Step, camera: CameraModel) -> Picture:
    if step.frame is not None:
        return as_color(step.frame.image)
    image = np.full((camera.height, camera.width, 3), DARK, np.uint8)
    draw_text(image, "no picture came", (0.38 * camera.width, 0.45 * camera.height), max(camera.height // 24, 10))
    return image
