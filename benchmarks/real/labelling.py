"""Truth for real clips: circles placed by hand, refined by an offline fit, and every one looked at.

1. By hand: a file of `frame,x,y,r,remark,skip,smoothing` (`labels/by_hand/NAME.csv`) from sheets of the clip's frames
   with a grid. The remark is empty (fit), `lowconf` (fit, but good to 3-5 px only), `streak` or `streak|lowconf` (fit
   of a swept disc, `benchmarks/real/streak.py`), `still` or `still|lowconf` (the same before the median of the labelled
   frames, if the camera stands still), `manual` or `manual|lowconf` (taken as placed, where fits are led astray), or
   `absent` (no circle). `skip` holds sectors in which the rim is covered or merges with a shadow, as `200-340 10-40`:
   degrees from the x axis toward the y axis, which points down. `smoothing` replaces the fit's.
2. Fit: from the center go many rays. Along each, the color (CIELAB) is projected on the line from the ball's color to
   the color outside of this ray; the rim is the peak of the derivative by a Gaussian, to a fraction of a pixel by a
   parabola. A circle is fitted to all peaks by least squares with a soft-L1 loss; the search narrows around it, and it
   is fitted again. Nothing of matchset's own edges, color table or fit is used: the labels are there to judge those.
3. By eye: sheets of enlarged crops with the circle dashed, so that the rim shows between the dashes. What is wrong gets
   a better start or another remark.

Label a clip, then look at the sheets; or compare the fit with labels that exist, from starts perturbed by 3 px:

    python -m benchmarks.real.labelling label CLIP benchmarks/real/labels/by_hand/NAME.csv --sheets FOLDER
    python -m benchmarks.real.labelling check CLIP TRUTH
"""

import csv
import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import typer
from scipy.ndimage import gaussian_filter1d, map_coordinates
from scipy.optimize import least_squares

from benchmarks.real.streak import fit_streak, still_background
from matchset.app.track.score import TRUTH_COLUMNS, read_truth

Image = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]
Circle3 = tuple[float, float, float]
Sector = tuple[float, float]

HERE = Path(__file__).resolve().parent
METHODS = {
    "": "edge-fit+eye",
    "lowconf": "edge-fit+eye|lowconf",
    "streak": "streak-fit+eye",
    "streak|lowconf": "streak-fit+eye|lowconf",
    "still": "still-streak-fit+eye",
    "still|lowconf": "still-streak-fit+eye|lowconf",
    "manual": "manual",
    "manual|lowconf": "manual|lowconf",
    "absent": "eye:absent",
}
REMARKS = tuple(METHODS)


LEAST_BEND = 1e-6  # theorem: of a slope along a ray, CIELAB per px: less is rounding of an even picture


class LabelParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a rim is measured; chosen on the two labelled clips, see `check`.

    Parameters
    ----------
    rays : int
        Rays around the center.
    step : float
        Distance of the samples along a ray, px.
    smoothing : float
        Standard deviation of the Gaussian whose derivative is taken, px. More of it passes over texture, and pulls the
        peaks of a small circle inward.
    search : float
        First search range on each side of the rim, as a share of the radius.
    least_search : float
        The search range is never less than this, px.
    narrowing : float
        Each round's search range is that of the round before times this.
    rounds : int
        Rounds of search and fit.
    least_peak : float
        Peaks below this share of the median peak are left out: covered rim, or a background of the ball's color.
    soft : float
        Residual at which the loss turns from square to linear, px.
    inlier : float
        The spread and the last fit are taken over residuals up to this, px.
    """

    rays: int = 240
    step: float = 0.25
    smoothing: float = 1.0
    search: float = 0.15
    least_search: float = 1.5
    narrowing: float = 0.6
    rounds: int = 7
    least_peak: float = 0.4
    soft: float = 0.3
    inlier: float = 2.0


class Start(msgspec.Struct, frozen=True):
    """A row placed by hand: `circle` is None and `remark` is `absent` where the ball is out of the picture."""

    frame: int
    circle: Circle3 | None
    remark: str
    skip: tuple[Sector, ...] = ()
    smoothing: float | None = None


class Label(msgspec.Struct, frozen=True):
    """A row of the truth, with what the fit says of itself.

    Parameters
    ----------
    frame : int
    circle : tuple of three floats, or None
        Center x, y and radius, px.
    remark : str
        That of the start.
    spread : float
        Robust standard deviation of the residuals (1.4826 times their median magnitude), px; NaN without a fit.
    share : float
        Share of the rays whose peak is within `LabelParameters.inlier` of the circle; NaN without a fit.
    sweep : float
        Length of the motion during the exposure, px; NaN where no streak was fitted.
    """

    frame: int
    circle: Circle3 | None
    remark: str = ""
    spread: float = float("nan")
    share: float = float("nan")
    sweep: float = float("nan")


def fit_circle(
    image: Image, start: Circle3, skip: Sequence[Sector] = (), parameters: LabelParameters | None = None
) -> Label:
    """Fit a circle to the rim near a start.

    Parameters
    ----------
    image : uint8 array (height, width, 3)
        BGR.
    start : tuple of three floats
        Center x, y and radius, px.
    skip : sequence of pairs of floats
        Sectors without rays, degrees from x toward y; a sector that ends before it begins holds 0.
    parameters : LabelParameters, optional

    Returns
    -------
    Label
        The circle, its spread and its share of rays; the frame is 0.

    Raises
    ------
    ValueError
        If fewer than a tenth of the rays show a rim.
    """
    chosen = parameters or LabelParameters()
    lab = cv2.cvtColor(image.astype(np.float32) / 255.0, cv2.COLOR_BGR2LAB).astype(np.float64)
    circle = np.array(start, dtype=np.float64)
    angles = _ray_angles(chosen.rays, skip)
    reach = max(chosen.search * circle[2], chosen.least_search)
    for _ in range(chosen.rounds):
        points = _rim_points(lab, circle, angles, reach, chosen)
        if len(points) < len(angles) / 10:
            raise ValueError(f"no rim around {start}: {len(points)} of {len(angles)} rays show one")
        circle = _robust_circle(points, circle, chosen.soft)
        reach = max(reach * chosen.narrowing, chosen.least_search)
    near = points[np.abs(_residuals(circle, points)) < chosen.inlier]
    circle = _robust_circle(near, circle, chosen.soft)
    # theorem: 1.4826 makes the median magnitude a standard deviation of a normal distribution (Hampel 1974)
    spread = 1.4826 * float(np.median(np.abs(_residuals(circle, near))))
    x, y, radius = (float(value) for value in circle)
    return Label(0, (x, y, radius), "", spread, len(near) / len(angles))


def _ray_angles(rays: int, skip: Sequence[Sector]) -> Floats:
    """Return the directions of the rays outside of the sectors, rad."""
    degrees = np.arange(rays) * (360.0 / rays)
    kept = np.ones(rays, dtype=bool)
    for begin, end in skip:
        inside = (degrees >= begin) & (degrees <= end) if begin <= end else (degrees >= begin) | (degrees <= end)
        kept &= ~inside
    return np.asarray(np.radians(degrees[kept]))


def _rim_points(lab: Floats, circle: Floats, angles: Floats, reach: float, parameters: LabelParameters) -> Floats:
    """Return the points (n, 2) where the rays cross the rim, px."""
    x, y, radius = circle
    pad = 3.0 * parameters.smoothing
    distances = np.arange(max(radius - reach - pad, 0.0), radius + reach + pad, parameters.step)
    across, down = x + np.outer(np.cos(angles), distances), y + np.outer(np.sin(angles), distances)
    samples = np.stack([map_coordinates(lab[..., k], (down, across), order=1, mode="nearest") for k in range(3)], -1)
    slope = _outward_slope(samples, _inner_color(lab, circle), parameters)
    height, width = lab.shape[:2]
    inside = (across > 1) & (across < width - 2) & (down > 1) & (down < height - 2)
    inside &= np.abs(distances - radius) <= reach
    slope = np.where(inside, slope, 0.0)
    best = np.clip(slope.argmax(axis=1), 1, len(distances) - 2)
    rows = np.arange(len(angles))
    before, peak, after = slope[rows, best - 1], slope[rows, best], slope[rows, best + 1]
    bend = 2.0 * peak - before - after
    is_peak = (before > 0) & (after > 0) & (peak >= before) & (peak >= after) & (bend > LEAST_BEND)
    if not is_peak.any():
        return np.empty((0, 2))
    is_peak &= peak > parameters.least_peak * np.median(peak[is_peak])
    offset = np.divide(0.5 * (after - before), bend, out=np.zeros_like(bend), where=is_peak)
    rim = distances[best] + offset * parameters.step
    points = np.column_stack([x + rim * np.cos(angles), y + rim * np.sin(angles)])
    return np.asarray(points[is_peak])


def _inner_color(lab: Floats, circle: Floats) -> Floats:
    """Return the median color (3,) of the inner 0.7 of a circle, CIELAB."""
    rows, columns = np.ogrid[: lab.shape[0], : lab.shape[1]]
    inner = lab[np.hypot(columns - circle[0], rows - circle[1]) <= max(0.7 * circle[2], 1.0)]
    if not len(inner):
        raise ValueError(f"the circle {circle} is out of the picture")
    return np.asarray(np.median(inner, axis=0))


def _outward_slope(samples: Floats, inner: Floats, parameters: LabelParameters) -> Floats:
    """Return the derivative (rays, distances) of the color, away from the ball's color, CIELAB per px."""
    outer = np.median(samples[:, -max(samples.shape[1] // 5, 1) :], axis=1)
    outer = gaussian_filter1d(outer, parameters.rays / 40, axis=0, mode="wrap")
    away = outer - inner
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)
    projected = np.einsum("rdk,rk->rd", samples, away)
    sigma = parameters.smoothing / parameters.step
    slope = gaussian_filter1d(projected, sigma, axis=1, order=1, mode="nearest") / parameters.step
    return np.asarray(slope)


def _residuals(circle: Floats, points: Floats) -> Floats:
    return np.asarray(np.hypot(points[:, 0] - circle[0], points[:, 1] - circle[1]) - circle[2])


def _robust_circle(points: Floats, circle: Floats, soft: float) -> Floats:
    solution = least_squares(_residuals, circle, args=(points,), loss="soft_l1", f_scale=soft)
    return np.asarray(solution.x)


def read_starts(path: Path) -> list[Start]:
    """Read circles placed by hand.

    Parameters
    ----------
    path : Path
        A CSV file with the columns ``frame,x,y,r,remark,skip,smoothing``; lines that begin with # are skipped.

    Returns
    -------
    list of Start
        In the order of their frames.

    Raises
    ------
    ValueError
        If a remark is unknown or a frame is given twice.
    """
    starts: dict[int, Start] = {}
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            frame, remark = int(row["frame"]), (row["remark"] or "").strip()
            if remark not in REMARKS or frame in starts:
                raise ValueError(f"{path}: frame {frame}, remark {remark!r}: given twice, or none of {REMARKS}")
            circle = None if remark == "absent" else (float(row["x"]), float(row["y"]), float(row["r"]))
            sectors = [sector.split("-") for sector in (row["skip"] or "").split()]
            skip = tuple((float(begin), float(end)) for begin, end in sectors)
            starts[frame] = Start(frame, circle, remark, skip, float(row["smoothing"]) if row["smoothing"] else None)
    return [starts[frame] for frame in sorted(starts)]


def label_frame(image: Image, start: Start, background: Image | None = None) -> Label:
    """Fit a start, or take it as it was placed if its remark says so."""
    if start.circle is None or start.remark.startswith("manual"):
        return Label(start.frame, start.circle, start.remark)
    if start.remark.startswith(("streak", "still")):
        streak, sweep = fit_streak(image, start.circle, background if start.remark.startswith("still") else None)
        return Label(start.frame, streak, start.remark, sweep=sweep)
    parameters = LabelParameters()
    if start.smoothing is not None:
        parameters = msgspec.structs.replace(parameters, smoothing=start.smoothing)
    fitted = fit_circle(image, start.circle, start.skip, parameters)
    return msgspec.structs.replace(fitted, frame=start.frame, remark=start.remark)


def pictures(clip: Path, frames: Sequence[int]) -> Iterator[tuple[int, Image]]:
    """Yield some frames of a clip with their index in decode order, from 0."""
    capture, wanted = cv2.VideoCapture(str(clip)), set(frames)
    for index in itertools.count():
        found, image = capture.read()
        if not found:
            break
        if index in wanted:
            wanted.discard(index)
            yield index, np.asarray(image, dtype=np.uint8)
    if wanted:
        raise ValueError(f"{clip} has no frames {sorted(wanted)}")


def write_labels(path: Path, video: str, labels: Sequence[Label]) -> None:
    """Write a truth file that `matchset.app.track.score.read_truth` reads."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(TRUTH_COLUMNS)
        for label in labels:
            numbers = [f"{value:.2f}" for value in label.circle] if label.circle else ["", "", ""]
            writer.writerow([video, label.frame, *numbers, int(label.circle is not None), METHODS[label.remark]])


def crop(image: Image, label: Label, side: int) -> Image:
    """Return an enlarged crop (side, side, 3) with the circle dashed; the whole frame where the ball is absent."""
    height, width = image.shape[:2]
    if label.circle is None:
        scale = side / max(height, width)
        small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        tile = cv2.copyMakeBorder(small, 0, side - small.shape[0], 0, side - small.shape[1], cv2.BORDER_CONSTANT)
    else:
        x, y, radius = label.circle
        scale = side / max(3.0 * radius, 24.0)
        shift = side / 2 - scale * np.array([x, y])
        matrix = np.array([[scale, 0.0, shift[0]], [0.0, scale, shift[1]]])
        tile = cv2.warpAffine(image, matrix, (side, side), flags=cv2.INTER_CUBIC)
        middle, half = (side * 8, side * 8), (round(radius * scale * 16),) * 2
        for begin in range(0, 360, 15):
            cv2.ellipse(tile, middle, half, 0, begin, begin + 7, (255, 255, 0), 1, cv2.LINE_AA, 4)
    text = f"{label.frame} {label.remark}"
    figures = "" if label.circle is None else f"r {label.circle[2]:.1f} s {label.spread:.2f} n {label.share:.2f}"
    for row, words in ((14, text), (side - 6, figures)):
        cv2.putText(tile, words, (4, row), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (0, 0, 0), 3)
        cv2.putText(tile, words, (4, row), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (255, 255, 255), 1)
    return np.asarray(tile, dtype=np.uint8)


def write_sheets(folder: Path, name: str, tiles: Sequence[Image], columns: int = 4, rows: int = 3) -> None:
    """Write crops of one size as PNG files of columns by rows."""
    folder.mkdir(parents=True, exist_ok=True)
    for page, begin in enumerate(range(0, len(tiles), columns * rows)):
        some = list(tiles[begin : begin + columns * rows])
        some += [np.zeros_like(some[0])] * (-len(some) % columns)
        lines = [np.hstack(some[first : first + columns]) for first in range(0, len(some), columns)]
        cv2.imwrite(str(folder / f"{name}_{page:02d}.png"), np.vstack(lines))


app = typer.Typer(add_completion=False, help="Labels for real clips.")


@app.command()
def label(
    clip: Path,
    starts: Path,
    sheets: Annotated[Path | None, typer.Option(help="Folder for sheets of enlarged crops.")] = None,
    labels: Annotated[Path, typer.Option(help="Folder for the truth file.")] = HERE / "labels" / "fitted",
    side: Annotated[int, typer.Option(help="Side of a crop on the sheets, px.")] = 320,
) -> None:
    """Fit the circles of STARTS in CLIP and write the truth file of the clip's name."""
    placed = {start.frame: start for start in read_starts(starts)}
    still = any(start.remark.startswith("still") for start in placed.values())
    background = still_background([image for _, image in pictures(clip, list(placed))]) if still else None
    fitted, tiles = [], []
    for frame, image in pictures(clip, list(placed)):
        result = label_frame(image, placed[frame], background)
        fitted.append(result)
        tiles.append(crop(image, result, side))
        if result.circle is not None and (circle := placed[frame].circle) is not None:
            moved = np.subtract(result.circle, circle)
            print(f"{frame:5d} {np.round(result.circle, 2)} moved {np.round(moved, 1)}", end=" ")
            print(f"spread {result.spread:.2f} share {result.share:.2f} sweep {result.sweep:.1f} {result.remark}")
    write_labels(labels / f"{clip.stem}.csv", clip.name, fitted)
    if sheets is not None:
        write_sheets(sheets, clip.stem, tiles)


@app.command()
def check(clip: Path, truth: Path, perturbation: float = 3.0, seed: int = 0) -> None:
    """Compare the fit with the tight labels of TRUTH, from starts PERTURBATION px off in a random direction."""
    known = {row.frame: row.circle for row in read_truth(truth) if row.tight and row.circle is not None}
    random, offsets = np.random.default_rng(seed), []
    for frame, image in pictures(clip, list(known)):
        direction = random.normal(size=3)
        start = np.array(known[frame]) + perturbation * direction / np.linalg.norm(direction)
        circle = fit_circle(image, (float(start[0]), float(start[1]), float(start[2]))).circle
        if circle is not None:
            offsets.append(np.subtract(circle, known[frame]))
    errors = np.abs(offsets).sum(axis=1)
    print(f"{len(errors)} frames, |dx| + |dy| + |dr|: median {np.median(errors):.2f} px,", end=" ")
    print(
        f"95 % below {np.percentile(errors, 95):.2f} px; median of dx, dy, dr {np.round(np.median(offsets, axis=0), 2)}"
    )


if __name__ == "__main__":
    app()
