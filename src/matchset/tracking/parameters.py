"""Everything that decides how a shape is tracked: `TrackerParameters`."""

import msgspec

from matchset.fitting.fitter import FittingParameters
from matchset.fitting.prior import FieldParameters, MotionParameters
from matchset.fitting.soft_region import SoftRegionParameters
from matchset.image.brightness import BrightnessParameters
from matchset.image.light.color_adaptation import AdaptationParameters
from matchset.image.light.relighting import RelightingParameters
from matchset.tracking.ball.disc_search import DiscSearchParameters
from matchset.tracking.ball.distractors import OthersParameters
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.detector import DetectionParameters
from matchset.tracking.initialization import InitializationParameters
from matchset.tracking.motion import ReachParameters
from matchset.tracking.outlines.hypotheses import HypothesisParameters
from matchset.tracking.search.voting import SearchParameters
from matchset.tracking.too_near import TooNearParameters


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
    """

    faint_score: float = 0.4
    clear_score: float = 0.5
    faint_frames: int = 5
    noise: float = 40.0


class TrackerParameters(FittingParameters, frozen=True, repr_omit_defaults=True):
    """Everything that decides how a shape is tracked; what it has in common with any fit is in `FittingParameters`.

    Parameters
    ----------
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
    disc_search : DiscSearchParameters
        Where the network is asked for a lost shape.
    adaptation : AdaptationParameters
        How the color follows the light.
    relighting : RelightingParameters
        When the light of the whole picture has changed at once.
    brightness : BrightnessParameters
        How a level between dark and light is found and used, for what has no color.
    others : OthersParameters
        How what looks like the target is told from it once that is hidden.
    too_near : TooNearParameters
        When a lost shape fills the picture.
    remembered : int
        Frames after which the color of a ball's middle and its size are remembered anew while it is seen.
    coast : float
        How long a shape that is not seen is expected near its prediction, s; after that it may appear anywhere.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    """

    reach: ReachParameters = ReachParameters()
    confidence: ConfidenceParameters = ConfidenceParameters()
    hypotheses: HypothesisParameters = HypothesisParameters()
    soft_region: SoftRegionParameters = SoftRegionParameters()
    network: NetworkParameters = NetworkParameters()
    initialization: InitializationParameters = InitializationParameters()
    search: SearchParameters = SearchParameters()
    detection: DetectionParameters = DetectionParameters()
    disc_search: DiscSearchParameters = DiscSearchParameters()
    adaptation: AdaptationParameters = AdaptationParameters()
    relighting: RelightingParameters = RelightingParameters()
    brightness: BrightnessParameters = BrightnessParameters()
    others: OthersParameters = OthersParameters()
    too_near: TooNearParameters = TooNearParameters()
    remembered: int = 30
    coast: float = 0.35


IN_FLIGHT = TrackerParameters(
    network=NetworkParameters(looks=4),
    motion=MotionParameters(size_acceleration=1.5),
    fields=FieldParameters(memory=0.98),
)
"""How a vehicle follows its neighbor's ball; `in_flight` adds the camera.

Few looks, since a command waits for them; vehicles that keep their distance change it by less than 2 m/s^2; and the
fields of one camera lie as far apart as they are. Chosen on rendered flights, seeds 901, 907 and 1107.
"""


def in_flight(focal_px: float, center_px: tuple[float, float]) -> TrackerParameters:
    """Parameters to follow a neighbor's ball with a camera of a focal length and a principal point, px."""
    x, y = center_px
    motion = msgspec.structs.replace(IN_FLIGHT.motion, focal_px=focal_px, center_x_px=x, center_y_px=y)
    return msgspec.structs.replace(IN_FLIGHT, motion=motion)
