"""What is known of the ball, as the command line says it: `--diameter`, `--marker-diameter`, `--markers FILE`."""

import math
from pathlib import Path

import msgspec

from matchset.localization.ball_target import BallTarget

_KEYS = "diameter, marker_diameter (m) and markers = [[x, y, z], ...]"
_LARGEST_BYTES = 100_000


class BallFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A ball in TOML.

    Parameters
    ----------
    markers : tuple of (float, float, float)
        Directions from the ball's center to its markers, of any length, in the ball frame: z out of the ball through
        marker 0, y down, x = y cross z.
    diameter, marker_diameter : float or None
        m.
    """

    markers: tuple[tuple[float, float, float], ...]
    diameter: float | None = None
    marker_diameter: float | None = None


def read_ball(path: Path) -> BallFile:
    """Read a ball from TOML.

    Parameters
    ----------
    path : Path

    Returns
    -------
    BallFile
        Its markers are unit vectors.

    Raises
    ------
    ValueError
        If there is no such file, or it holds something else; with the file and the key.
    """
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise ValueError(f"{path}: too large for a file of a ball")
        ball = msgspec.toml.decode(path.read_bytes(), type=BallFile)
    except FileNotFoundError:
        raise ValueError(f"no such file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"{path}: a ball is {_KEYS} in TOML: {error}") from None
    if not ball.markers:
        raise ValueError(f"{path}: markers is empty; without markers leave the file out")
    return msgspec.structs.replace(ball, markers=tuple(_unit(path, marker) for marker in ball.markers))


def ball_target(
    diameter: float | None, marker_diameter: float | None, markers: Path | None, marked: bool
) -> BallTarget:
    """Put together what is known of the ball; a number that was typed counts more than the file's.

    Parameters
    ----------
    diameter, marker_diameter : float or None
        m, as typed.
    markers : Path or None
        The file with the directions of the markers; without it there is one.
    marked : bool
        Whether markers are looked for.

    Raises
    ------
    ValueError
        If the diameter is missing, a number is impossible, or markers are described that nobody looks for.
    """
    if not marked and (markers is not None or marker_diameter is not None):
        option = "--marker-diameter" if markers is None else "--markers"
        raise ValueError(f"{option} needs the markers' color: give --marker-pick X,Y[@FRAME] or --marker-color FILE")
    file = BallFile(markers=((0.0, 0.0, 1.0),)) if markers is None else read_ball(markers)
    known = file.diameter if diameter is None else diameter
    if known is None:
        raise ValueError("say how large the ball is: --diameter 0.28, in m")
    if not 0.0 < known < math.inf:
        raise ValueError(f"a ball's diameter must be positive, got {known} m")
    if not marked:
        return BallTarget(known, markers=(), marker_diameter=0.2 * known)
    across = file.marker_diameter if marker_diameter is None else marker_diameter
    return BallTarget(known, file.markers) if across is None else BallTarget(known, file.markers, across)


def _unit(path: Path, marker: tuple[float, float, float]) -> tuple[float, float, float]:
    length = math.hypot(*marker)
    if not 1e-6 < length < 1e6:
        raise ValueError(f"{path}: markers must be directions of three numbers, not all zero, got {list(marker)}")
    x, y, z = (value / length for value in marker)
    return x, y, z
