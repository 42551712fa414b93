"""Weights of the evidence for a detection, fitted again: `make evidence`, or `python -m benchmarks.evidence`.

Candidates of searches are fitted as a detector fits them first, in rendered sequences (seeds 0 to 7) and, with
`--data`, in labelled real clips, whole and at half the size as JPEG of quality 30, also with the colors of other balls.
Fits that are the target and fits that do not touch it are told apart by logistic regression on the terms of
`matchset.fitting.evidence.log_odds`, both classes weighed equally; fits beside the target are left out. Two other seeds
and the other clips are not fitted to, only reported. A person decides whether weights are changed.
"""

import math
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import typer
from rich.console import Console
from rich.table import Table
from scipy.optimize import minimize
from scipy.special import expit

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.real.clips import Clip, find_clips
from benchmarks.real.foreign import Ball, ball_of, differ
from benchmarks.real.starts import beginnings
from benchmarks.tracking.false_locks import foreign_color
from benchmarks.tracking.trial import as_truth, sequence
from benchmarks.workers import one_thread
from matchset.app.track.score import VALID_BELOW_PX, Circle3, TruthRow, error_px
from matchset.fitting.evidence import ColorStep, EvidenceParameters, log_odds, measure_color_step
from matchset.fitting.fit_quality import tolerance_of
from matchset.fitting.validation import Statistics, ValidationParameters
from matchset.fitting.workspace import SearchWindow
from matchset.image.frame import channels_last
from matchset.numeric.jit import interpreted
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import DETECTION_LINES, DetectionParameters
from matchset.tracking.search.voting import Searcher, SearchParameters, stride_for

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

WEIGHTS = ("msac", "inliers", "harmonic", "core", "size", "small", "noise", "step", "agreement", "outside")
"""Fields of `EvidenceParameters` that are fitted, beside `bias`."""

SEQUENCES = ("typical", "bad", "hard", "clutter", "occlusion", "shrink", "light", "return", "blur")
ROOMS = ("empty", "hard")
"""Rendered sequences with the ball, and those that are rendered without it, in a new room every few frames."""

TUNING = ("green_ball_hand", "yellow_occlusion", "tennis_throw", "green_hand_a", "red_pendulum")
"""Real clips that are fitted to."""

SEEDS, REPORTED_SEEDS = range(8), range(100, 102)
FRAMES, ROOM_FRAMES, EVERY = 60, 96, 12  # of a sequence, of one without a ball, and each how manieth is searched
FOREIGN_EVERY = 6  # labelled rows of a clip are searched with the colors of other balls
HALF, QUALITY = 0.5, 30  # of the degraded versions of real clips
NEAR = 0.25  # radii that Eq. 10's error of a fit of the target may be, where that is more than 5 px
BESIDE = 0.3  # half-widths of a fit beyond the disc within which its center lies beside the target
RIDGE = 1e-4
FALSE_RATES = (0.0, 0.001, 0.003, 0.01)
PERCENT_TARGETS, PERCENT_OTHERS = (1, 5, 25, 50), (50, 90, 99, 99.9, 100)


class Sample(NamedTuple):
    """A fit: where it comes from, whether that is only reported, the terms of its log-odds, and what it is."""

    source: str
    reported: bool
    terms: Floats
    is_target: bool


class Picture(NamedTuple):
    """A picture to search in, where the target is in it, and which samples it gives."""

    image: Image
    truth: TruthRow
    source: str
    reported: bool


class Collector:
    """Fits the candidates of searches as a detector does, and takes what its evidence would be made of."""

    def __init__(self) -> None:
        self._fitter = tracking_fitter(ms.Circle, DETECTION_LINES)
        self._limits, self._search = DetectionParameters(), SearchParameters()
        self._searchers: dict[tuple[int, int, int], Searcher] = {}

    def samples(self, picture: Picture, color: ms.ColorModel) -> Iterator[Sample]:
        """Yield the fits of a picture's candidates that pass the other limits of a detection."""
        image, color = channels_last(picture.image), color.for_image(picture.image)
        searcher, fitter = self._searcher(image, color), self._fitter
        quality, evidence = fitter.parameters.quality, fitter.parameters.evidence
        fitter.forget()
        for x, y, radius, _ in searcher.candidates(image, color).tolist():
            reach = max(self._limits.range_cells * searcher.stride, self._limits.range_share * radius)
            found = fitter.fit(image, color, ms.Circle.from_coarse(x, y, radius).state, SearchWindow(reach))
            if not found.is_fitted or not is_sound(found.fit, fitter.validator.limits):
                continue
            place = (float(found.state[0]), float(found.state[1]), found.fit.half_width)
            is_target = is_right(place, picture.truth)
            if not is_target and is_beside(place, picture.truth.circle):
                continue
            step = measure_color_step(image, color, fitter.outline, found.fit.half_width, evidence)
            tolerance = interpreted(tolerance_of)(quality, place[2])
            yield Sample(picture.source, picture.reported, terms_of(found.fit, step, tolerance), is_target)

    def _searcher(self, image: Image, color: ms.ColorModel) -> Searcher:
        height, width = image.shape[:2]
        radius = math.inf if color.circle is None else self._limits.smaller * color.circle[2]
        key = width, height, stride_for(width, self._search, radius)
        if key not in self._searchers:
            self._searchers[key] = Searcher(width, height, self._search, radius)
        return self._searchers[key]


def is_sound(fit: Statistics, limits: ValidationParameters) -> bool:
    """Whether a fit passes the limits of a detection that are asked beside its evidence."""
    return bool(
        fit.visible >= limits.min_visible * DETECTION_LINES
        and fit.interior_share >= limits.detection_interior
        and fit.core_share >= limits.detection_core
        and fit.hollowness <= limits.max_hollowness
        and fit.ellipticity <= limits.max_ellipticity
    )


def is_right(place: Circle3, truth: TruthRow) -> bool:
    """Whether a fit is the target."""
    if truth.circle is None or not truth.tight:
        return False
    return error_px(place, truth.circle) < max(VALID_BELOW_PX, NEAR * truth.circle[2])


def is_beside(place: Circle3, disc: Circle3 | None) -> bool:
    """Whether the center of a fit lies on the target or beside it."""
    return disc is not None and math.dist(place[:2], disc[:2]) < disc[2] + BESIDE * place[2]


def terms_of(fit: Statistics, step: ColorStep, tolerance: float) -> Floats:
    """Terms of the log-odds of a fit, each without its weight, in the order of `WEIGHTS`, and 1 for the bias.

    Parameters
    ----------
    fit : FitStatistics
    step : ColorStep
    tolerance : float
        Of an inlier, px.

    Returns
    -------
    ndarray of shape (11,), float64
    """
    nothing = dict.fromkeys(("bias", *WEIGHTS), 0.0)
    empty = msgspec.structs.replace(EvidenceParameters(), **nothing)
    alone = [msgspec.structs.replace(empty, **{name: 1.0}) for name in (*WEIGHTS, "bias")]
    return np.array([log_odds(fit, step, tolerance, limits) for limits in alone])


def fit_weights(terms: Floats, is_target: Bools) -> Floats:
    """Fit weights by logistic regression, both classes weighed equally, with a ridge.

    Parameters
    ----------
    terms : ndarray of shape (n, k), float64
    is_target : ndarray of shape (n,), bool

    Returns
    -------
    ndarray of shape (k,), float64

    Raises
    ------
    ValueError
        If one of the classes is empty.
    """
    targets = int(is_target.sum())
    if not 0 < targets < len(is_target):
        raise ValueError(f"a regression needs targets and others, got {targets} targets of {len(is_target)} fits")
    sign = np.where(is_target, 1.0, -1.0)
    share = np.where(is_target, 1.0 / targets, 1.0 / (len(is_target) - targets))

    def loss(weights: Floats) -> tuple[float, Floats]:
        margin = sign * (terms @ weights)
        slope = -(share * sign * expit(-margin)) @ terms + 2.0 * RIDGE * weights
        return float(share @ np.logaddexp(0.0, -margin) + RIDGE * weights @ weights), slope

    return np.asarray(minimize(loss, np.zeros(terms.shape[1]), jac=True, method="BFGS").x)


def recalls(targets: Floats, others: Floats) -> list[float]:
    """Shares of targets above the log-odds that no more than each of `FALSE_RATES` of the others exceed."""
    ordered = np.sort(others)
    return [float((targets > ordered[len(ordered) - 1 - int(rate * len(ordered))]).mean()) for rate in FALSE_RATES]


def main(
    data: Annotated[Path | None, typer.Option(help="Folder with real clips; without: rendered sequences only.")] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Two seeds instead of eight, each fourth labelled row.")
    ] = False,
) -> None:
    """Collect candidates, fit the weights and print them beside the present ones."""
    one_thread()
    console, begin = Console(highlight=False, width=120), time.process_time()
    if data is not None and not data.is_dir():
        raise typer.BadParameter(f"{data} is not a folder", param_hint="--data")
    collector = Collector()
    samples = [each for seed in _seeds(quick) for each in rendered(collector, seed, seed in REPORTED_SEEDS)]
    clips, skipped = find_clips(data)
    for line in skipped:
        console.print(line)
    samples += real(collector, clips, 4 if quick else 1, console)
    tuning = [each for each in samples if not each.reported]
    weights = fit_weights(np.array([each.terms for each in tuning]), np.array([each.is_target for each in tuning]))
    present = np.array([getattr(EvidenceParameters(), name) for name in (*WEIGHTS, "bias")])
    console.print(weight_table(present, weights))
    for reported in (False, True):
        chosen = [each for each in samples if each.reported == reported]
        if any(each.is_target for each in chosen) and not all(each.is_target for each in chosen):
            title = "not fitted to" if reported else "fitted to"
            console.print(odds_table(title, chosen, present, weights))
            console.print(recall_table(title, chosen, present, weights))
    console.print(f"{time.process_time() - begin:.0f} s of processor time")


def _seeds(quick: bool) -> list[int]:
    return [0, 1, REPORTED_SEEDS[0]] if quick else [*SEEDS, *REPORTED_SEEDS]


def rendered(collector: Collector, seed: int, reported: bool) -> Iterator[Sample]:
    """Yield samples of the rendered sequences of a seed; of their frames only those are rendered that are searched."""
    for name in SEQUENCES:
        clip = sequence(name, seed, FRAMES)
        room = clip.background()
        color = ms.ColorModel.pick(clip.render(0, room).image, *clip.first_click)
        for index in range(EVERY, FRAMES, EVERY):
            picture = Picture(clip.render(index, room).image, as_truth(clip.truth(index)), name, reported)
            yield from collector.samples(picture, color)
    foreign = foreign_color(seed)
    for name in ROOMS:
        clip = sequence(name, seed, ROOM_FRAMES, ball=False, scene_frames=EVERY)
        for index in range(0, ROOM_FRAMES, EVERY):
            image = clip.render(index, clip.background(index // EVERY)).image
            truth = as_truth(clip.truth(index))
            yield from collector.samples(Picture(image, truth, f"{name}, no ball", reported), foreign)


def real(collector: Collector, clips: Sequence[Clip], step: int, console: Console) -> Iterator[Sample]:
    """Yield samples of real clips, whole and degraded, and of the tuning clips with each other's colors."""
    balls: dict[str, Ball] = {}
    for clip in clips:
        pictures, reported = _labelled(clip), clip.name not in TUNING
        for degraded in (False, True):
            shown = [_degrade(each) for each in pictures] if degraded else pictures
            for row in beginnings(clip):
                clicked = next(each for each in shown if each.truth.frame == row.frame)
                ball = _ball(clicked, console)
                if ball is None:
                    continue
                balls = balls if degraded or reported else {clip.name: ball} | balls
                for each in shown[::step]:
                    if each is not clicked and (each.truth.tight or each.truth.circle is None):
                        yield from collector.samples(each._replace(reported=reported), ball.color)
    for clip in clips:
        strange = [ball for ball in balls.values() if clip.name in balls and differ(ball, balls[clip.name])]
        for each in _labelled(clip)[:: FOREIGN_EVERY * step] if strange else []:
            for ball in strange:
                yield from collector.samples(each._replace(source="colors of other balls"), ball.color)


def _labelled(clip: Clip) -> list[Picture]:
    """Pictures of a clip that have labels."""
    truths = {truth.frame: truth for truth in clip.truths}
    with ms.Video(clip.video) as video:
        return [Picture(f.image, truths[f.index], clip.name, False) for f in video if f.index in truths]


def _degrade(picture: Picture) -> Picture:
    """Make a picture half as large, and JPEG of low quality."""
    small = cv2.resize(picture.image, None, fx=HALF, fy=HALF, interpolation=cv2.INTER_AREA)
    _, coded = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    image, disc = np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR), np.uint8), picture.truth.circle
    if disc is not None:  # pixel centers are at integers, before and after
        disc = HALF * (disc[0] + 0.5) - 0.5, HALF * (disc[1] + 0.5) - 0.5, HALF * disc[2]
    truth = msgspec.structs.replace(picture.truth, circle=disc)
    return picture._replace(image=image, truth=truth, source=f"{picture.source}, half, JPEG")


def _ball(clicked: Picture, console: Console) -> Ball | None:
    """Learn the color of the ball from a click at its center; None, and a line, where it is refused."""
    disc = clicked.truth.circle
    if disc is None:
        raise ValueError(f"frame {clicked.truth.frame} of {clicked.source} shows no ball to click at")
    try:
        color = ms.ColorModel.pick(clicked.image, *disc[:2])
    except ValueError as error:
        console.print(f"{clicked.source}, frame {clicked.truth.frame}: {error}")
        return None
    return ball_of(clicked.image, disc, color)


def weight_table(present: Floats, weights: Floats) -> Table:
    """Show the weights beside the present ones."""
    table = Table("weight", "present", "fitted")
    for name, old, new in zip((*WEIGHTS, "bias"), present, weights, strict=True):
        table.add_row(name, f"{old:.2f}", f"{new:.2f}")
    return table


def odds_table(title: str, samples: Sequence[Sample], present: Floats, weights: Floats) -> Table:
    """Show percentiles of the log-odds of targets and of others, with both sets of weights."""
    terms, is_target = np.array([each.terms for each in samples]), np.array([each.is_target for each in samples])
    table = Table("log-odds", "of", "how many", "percentiles", title=title)
    for name, chosen in (("present", present), ("fitted", weights)):
        for what, mask, percents in (("targets", is_target, PERCENT_TARGETS), ("others", ~is_target, PERCENT_OTHERS)):
            values = np.percentile(terms[mask] @ chosen, percents)
            words = ", ".join(f"{percent:g}: {value:.1f}" for percent, value in zip(percents, values, strict=True))
            table.add_row(name, what, str(int(mask.sum())), words)
    return table


def recall_table(title: str, samples: Sequence[Sample], present: Floats, weights: Floats) -> Table:
    """Show the share of targets of each source that are found at each false rate over all sources."""
    terms, is_target = np.array([each.terms for each in samples]), np.array([each.is_target for each in samples])
    rates = ", ".join(f"{rate:g}" for rate in FALSE_RATES)
    table = Table("source", "targets", "others", "present", "fitted", title=f"{title}: % found at false rates {rates}")
    for source in ["all", *dict.fromkeys(each.source for each in samples)]:
        own = np.array([source in ("all", each.source) for each in samples])
        cells = []
        for chosen in (present, weights):
            odds = terms @ chosen
            shares = recalls(odds[own & is_target], odds[~is_target]) if (own & is_target).any() else []
            cells.append(", ".join(f"{100.0 * share:.0f}" for share in shares) or "-")
        table.add_row(source, str(int((own & is_target).sum())), str(int((own & ~is_target).sum())), *cells)
    return table


if __name__ == "__main__":
    typer.run(main)
