"""Every number that decides how a shape is tracked, as one versioned artifact: `TrackerConstants`.

A file of them is read and replaced, as the weights of the network are; what a user turns are the few dials of
`TrackerParameters`.
"""

import msgspec

from matchset.fitting.fitter import FittingParameters
from matchset.fitting.soft_region import SoftRegionParameters
from matchset.image.brightness import BrightnessParameters
from matchset.image.light.color_adaptation import AdaptationParameters
from matchset.image.light.relighting import RelightingParameters
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.ball.parameters import BallSearchParameters
from matchset.tracking.detector import DetectionParameters
from matchset.tracking.initialization import InitializationParameters
from matchset.tracking.motion import ReachParameters
from matchset.tracking.outlines.hypotheses import HypothesisParameters
from matchset.tracking.search.voting import SearchParameters
from matchset.tracking.too_near import TooNearParameters

VERSION = 1  # format: of the groups of constants and their names


class ConfidenceParameters(msgspec.Struct, frozen=True):
    """How long a shape may be seen faintly.

    `faint_score`: fitted again by `make hypotheses`; no other value was better by 1 % on both sets of seeds
    (docs/log/fitting.md#hypothesis-weights).
    The others chosen by hand; `python -m benchmarks --only false_locks` would show a change.

    Parameters
    ----------
    faint_score, clear_score : float
        Color score below which a shape is seen faintly, and from which clearly again.
    faint_frames : int
        Frames in which it may be seen faintly before it counts as lost.
    noise : float
        Pixel noise, gray levels, from which on a shape that is seen faintly must be a detection: less loses shapes
        before coarse textures, more finds shapes in noise. Chosen by hand between uniform noise (74) and links (10).
    near, near_innovations : float
        How far an ambiguous fit of a ball may be from where it was expected without evidence, half-widths plus
        innovations.
    """

    faint_score: float = 0.4
    clear_score: float = 0.5
    faint_frames: int = 5
    noise: float = 40.0
    near: float = 0.5
    near_innovations: float = 2.0


class TrackerConstants(FittingParameters, frozen=True, repr_omit_defaults=True):
    """Every number that decides how a shape is tracked; what it has in common with any fit is in `FittingParameters`.

    Each group says what its numbers were fitted on or chosen by, and which command would show a change.

    Parameters
    ----------
    version : int
        Of the groups and their names: a file of another version is refused.
    match, fit, quality, validation, motion, window, gate, fields
        See `FittingParameters`.
    reach : ReachParameters
        Where a shape that was lost may turn up again.
    confidence : ConfidenceParameters
        How long a shape may be seen faintly.
    hypotheses : HypothesisParameters
        Which other hypotheses are tested where a fit is ambiguous.
    soft_region : SoftRegionParameters
        How the region of a blurred target is found, and what it is worth beside the network's disc.
    network : NetworkParameters
        When the network of discs is believed beside edge points.
    initialization : InitializationParameters
        How tracking begins at a given shape.
    search : SearchParameters
        How the whole frame is searched.
    detection : DetectionParameters
        How the candidates of a search are fitted.
    ball : BallSearchParameters
        How a ball is found that is not where its outline was expected.
    adaptation : AdaptationParameters
        How the color follows the light.
    relighting : RelightingParameters
        When the light of the whole picture has changed at once.
    brightness : BrightnessParameters
        How a level between dark and light is found and used, for what has no color.
    too_near : TooNearParameters
        When a lost shape fills the picture.
    coast : float
        How long a shape that is not seen is expected near its prediction, s; after that it may appear anywhere.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    """

    version: int = VERSION
    reach: ReachParameters = ReachParameters()
    confidence: ConfidenceParameters = ConfidenceParameters()
    hypotheses: HypothesisParameters = HypothesisParameters()
    soft_region: SoftRegionParameters = SoftRegionParameters()
    network: NetworkParameters = NetworkParameters()
    initialization: InitializationParameters = InitializationParameters()
    search: SearchParameters = SearchParameters()
    detection: DetectionParameters = DetectionParameters()
    ball: BallSearchParameters = BallSearchParameters()
    adaptation: AdaptationParameters = AdaptationParameters()
    relighting: RelightingParameters = RelightingParameters()
    brightness: BrightnessParameters = BrightnessParameters()
    too_near: TooNearParameters = TooNearParameters()
    coast: float = 0.35
