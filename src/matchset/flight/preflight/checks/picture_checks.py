"""Does a camera deliver what a flight needs: rate, gaps, age, new pictures, exposure? `watch_pictures`, then checks."""

import itertools
import math
from collections.abc import Sequence

import msgspec
import numpy as np

from matchset.control.repeated_picture import PicturesSeen, RepeatedPictureParameters, note_picture
from matchset.flight.preflight.outcome import CheckOutcome, failed, judged
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.image.brightness import as_gray
from matchset.image.frame import Frame
from matchset.links.camera import Camera

MILLI = 1e-3  # format: s of a ms


class SeenPicture(msgspec.Struct, frozen=True):
    """What counts of a picture.

    Parameters
    ----------
    time : float
        When it was taken, s.
    age : float
        How old it was when it came, s.
    repeated : bool
        Whether it came before.
    bright, dark : float
        Share of its pixels that are clipped, and nearly black.
    mean : float
        Its mean brightness, 0 ... 255.
    """

    time: float
    age: float
    repeated: bool
    bright: float
    dark: float
    mean: float


def seen_picture(frame: Frame, age: float, repeated: bool, parameters: PreflightParameters) -> SeenPicture:
    """Measure a picture.

    Parameters
    ----------
    frame : Frame
    age : float
        s.
    repeated : bool
    parameters : PreflightParameters
    """
    image = frame.image
    brightest = image if image.ndim == 2 else image.max(axis=2)
    bright = float(np.mean(brightest >= parameters.bright_level))
    dark = float(np.mean(brightest < parameters.dark_level))
    return SeenPicture(frame.time, age, repeated, bright, dark, float(as_gray(image).mean()))


def watch_pictures(
    camera: Camera, parameters: PreflightParameters, repeated: RepeatedPictureParameters
) -> list[SeenPicture]:
    """Read the newest pictures for `PreflightParameters.watch`.

    Parameters
    ----------
    camera : Camera
    parameters : PreflightParameters
    repeated : RepeatedPictureParameters
        When a picture counts as sent again.
    """
    begin, seen, found = camera.now(), PicturesSeen(), list[SeenPicture]()
    while camera.now() - begin < parameters.watch:
        frame = camera.read()
        if frame is None:
            continue
        age = camera.now() - frame.time
        seen = note_picture(frame.image, seen, repeated)
        found.append(seen_picture(frame, age, seen.repeats > 0, parameters))
    return found


def rate_of(pictures: Sequence[SeenPicture]) -> float:
    """Return the pictures a second; 0 for fewer than two."""
    lasted = pictures[-1].time - pictures[0].time if pictures else 0.0
    return (len(pictures) - 1) / lasted if lasted > 0.0 else 0.0


def picture_checks(
    pictures: Sequence[SeenPicture], oldest: float, fault: str, parameters: PreflightParameters
) -> list[CheckOutcome]:
    """Check what came while the camera was watched.

    Parameters
    ----------
    pictures : sequence of SeenPicture
    oldest : float
        Largest age that a flight accepts, s.
    fault : str
        What the camera says of itself; empty if nothing.
    parameters : PreflightParameters

    Returns
    -------
    list of CheckOutcome
        Those after one that failed may make no sense.
    """
    wanted = f"pictures for {parameters.watch:g} s"
    if fault or len(pictures) < 2:
        why = fault or f"{len(pictures)} pictures in {parameters.watch:g} s"
        return [failed("camera: delivers", wanted, why, "look at its cable and its power, then 'matchset live'")]
    return [
        judged("camera: delivers", wanted, f"{len(pictures)} pictures", True, ""),
        _rate(pictures, parameters),
        _steady(pictures, parameters),
        _new(pictures, parameters),
        _young(pictures, oldest),
    ]


def exposure_checks(pictures: Sequence[SeenPicture], parameters: PreflightParameters) -> list[CheckOutcome]:
    """Check that the light is neither too much nor too little, and steady.

    Parameters
    ----------
    pictures : sequence of SeenPicture
        At least one.
    parameters : PreflightParameters
    """
    bright, dark = (float(np.median([getattr(each, name) for each in pictures])) for name in ("bright", "dark"))
    means = np.array([each.mean for each in pictures])
    flicker = float(means.std() / max(means.mean(), 1.0))
    return [
        judged(
            "exposure: not clipped",
            f"at most {parameters.most_clipped:.0%} of the pixels as bright as they can be",
            f"{bright:.1%}",
            bright <= parameters.most_clipped,
            "hold the exposure shorter ('exposure' of a [[follower]] in the settings), or turn it away from the window",
        ),
        judged(
            "exposure: not dark",
            f"at most {parameters.most_dark:.0%} of the pixels nearly black",
            f"{dark:.1%}",
            dark <= parameters.most_dark,
            "more light, or a longer exposure; is the lens cap off?",
        ),
        judged(
            "exposure: steady",
            f"brightness changes by at most {parameters.most_flicker:.0%}",
            f"{flicker:.1%}",
            flicker <= parameters.most_flicker,
            "hold the exposure and the white balance; lamps that flicker: 10 ms of exposure, or other lamps",
        ),
    ]


def _rate(pictures: Sequence[SeenPicture], parameters: PreflightParameters) -> CheckOutcome:
    rate = rate_of(pictures)
    return judged(
        "camera: rate",
        f"at least {parameters.least_rate:g} pictures a second",
        f"{rate:.1f} a second",
        rate >= parameters.least_rate,
        "a lower resolution, a shorter exposure, another cable or hub; 'fps' of a [[follower]] asks for a rate",
    )


def _steady(pictures: Sequence[SeenPicture], parameters: PreflightParameters) -> CheckOutcome:
    gap = max(after.time - before.time for before, after in itertools.pairwise(pictures))
    return judged(
        "camera: steady",
        f"no gap above {parameters.longest_gap / MILLI:.0f} ms",
        f"longest {gap / MILLI:.0f} ms",
        gap <= parameters.longest_gap,
        "end other programs, use another port or cable; of a stream: a better network",
    )


def _new(pictures: Sequence[SeenPicture], parameters: PreflightParameters) -> CheckOutcome:
    repeated = sum(each.repeated for each in pictures)
    stands = repeated == len(pictures) - 1
    share = repeated / len(pictures)
    return judged(
        "camera: new pictures",
        f"at most {parameters.most_repeats:.0%} came before",
        "the picture stands still" if stands else f"{repeated} of {len(pictures)} came before",
        share <= parameters.most_repeats,
        "the grabber repeats pictures: another rate ('fps'), or another grabber; a camera without noise before a still "
        "scene: 'lines = 0' in [flight.pilot.repeated]",
    )


def _young(pictures: Sequence[SeenPicture], oldest: float) -> CheckOutcome:
    age = max(each.age for each in pictures)
    early = min(each.age for each in pictures) < 0.0
    return judged(
        "camera: age of pictures",
        f"within 0 ... {oldest / MILLI:.0f} ms",
        f"at most {age / MILLI:.0f} ms" if math.isfinite(age) and not early else "times of the future",
        0.0 <= age <= oldest and not early,
        "something queues pictures: a wire in place of a stream, fewer buffers; is the clock of the camera wrong?",
    )
