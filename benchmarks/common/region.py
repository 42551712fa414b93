"""Looking only around the last circle, and in the whole frame where nothing is there."""

from benchmarks.common.start import Circle3, Image, Start, Step


def around_the_last(find: Step, start: Start, reach: float, margin: float) -> Step:
    """Apply a detector to a square around the last circle.

    Parameters
    ----------
    find : callable
        A detector.
    start : Start
    reach, margin : float
        Half the side of the square: reach * radius + margin, px.

    Returns
    -------
    callable
    """
    last: Circle3 | None = start.circle if start.here else None

    def step(image: Image) -> Circle3 | None:
        nonlocal last
        found = None if last is None else _in_square(find, image, last, reach * last[2] + margin)
        last = found or find(image)
        return last

    return step


def _in_square(find: Step, image: Image, last: Circle3, half: float) -> Circle3 | None:
    left, top = max(int(last[0] - half), 0), max(int(last[1] - half), 0)
    square = image[top : max(int(last[1] + half) + 1, 0), left : max(int(last[0] + half) + 1, 0)]
    if square.shape[0] < 3 or square.shape[1] < 3:
        return None
    found = find(square)
    return None if found is None else (found[0] + left, found[1] + top, found[2])
