"""What decides where a ball is: `BallSearchParameters`."""

import msgspec

from matchset.tracking.ball.log_odds import FeatureWeights, PlaceParameters, SizeParameters
from matchset.tracking.ball.places.changes import ChangeParameters
from matchset.tracking.ball.places.color_places import ColorPlaceParameters
from matchset.tracking.ball.streak import StreakParameters


class BallSearchParameters(msgspec.Struct, frozen=True):
    """How a ball is found that is not where its outline was expected; chosen by hand.

    Parameters
    ----------
    weights : FeatureWeights
        Of what speaks for a disc.
    place : PlaceParameters
        Where it may be.
    size : SizeParameters
        How large it may be.
    changes : ChangeParameters
        How motion is seen.
    places : ColorPlaceParameters
        Which places its color proposes.
    streaks : StreakParameters
        Which region at a click is the streak of a fast ball.
    moves : bool
        Whether motion is looked at at all: of no use where the camera flies.
    starts : int
        From how many circles the network is led at most.
    rank : float
        What each better place of the same kind takes from the merit of a place.
    same : float
        Share of the radius by which circles may differ that lead to the same disc.
    reach : float
        Half the side of the window in which its color is looked for, radii for each missed picture.
    spread : tuple of float
        Radii that are looked for in the whole picture, as shares of the one that is believed: all of them in a
        picture of few cells, else by turns.
    again : int
        For how many pictures a place at which no ball was seen is not looked at again.
    most_growth : float
        Factor by which its radius differs from the one that is believed at most.
    grows : float
        By how much ln(radius) follows an outline that was seen, at most, in each picture.
    middle : float
        Share of the radius within which its color is taken.
    color_share : float
        Share of the middle that the color table knows.
    chroma, most_chroma : float
        Standard deviation of its chroma, units of CIE Lab, and how many of them count at most.
    far_chroma, far_lightness : float
        From where on a color that the table does not know is foreign, units of CIE Lab.
    other_chroma : float
        From where on such a disc is not the ball at all.
    mixed_color : float
        Least log-likelihood of the color of what has arrived: a streak is mixed with what is behind it.
    least_near : float
        How near to an arrival a disc is at least, px.
    before : float
        Share of a disc that was there before from which on it is a look-alike.
    streak : float
        Way from picture to picture, radii, from which a ball is fast: an ambiguous fit is a search for it then.
    mass_sigma : float
        Standard deviation of the center of a mass that has arrived, radii.
    fits : float
        Factor between the radius of a mass and that of the ball that is as good as none, below the largest one.
    recent : float
        Missed pictures in which an arrival loses most of what it says: the longer, the more else arrives.
    rival : float
        How much an arrival speaks against the ball where something else of its color has left, beside 1 for it.
    due, seen : float
        Something that has arrived may be a ball that is not fast only where the log prior of its place is above the
        first, or the log-odds by the network above the second.
    unseen, unseen_growth : float
        Log-odds by the network of what has arrived where a fast ball is due and is no disc to it, and the largest
        factor between the radius of that mass and of the ball.
    renewed_s : float
        Age from which color and reference are renewed while it is seen, s.
    renewed : float
        Share of a new color in that.
    least_score, sure_score : float
        MSAC score of a fit from which the reference and the color are renewed.
    """

    weights: FeatureWeights = FeatureWeights()
    place: PlaceParameters = PlaceParameters()
    size: SizeParameters = SizeParameters()
    changes: ChangeParameters = ChangeParameters()
    places: ColorPlaceParameters = ColorPlaceParameters()
    streaks: StreakParameters = StreakParameters()
    moves: bool = True
    starts: int = 4
    rank: float = 0.3
    same: float = 0.3
    reach: float = 3.0
    spread: tuple[float, ...] = (1.0, 0.6, 2.5)
    again: int = 8
    most_growth: float = 3.5
    grows: float = 0.1
    middle: float = 0.7
    color_share: float = 0.3
    chroma: float = 6.0
    most_chroma: float = 2.0
    far_chroma: float = 12.0
    far_lightness: float = 30.0
    other_chroma: float = 30.0
    mixed_color: float = -0.5
    least_near: float = 3.0
    before: float = 0.6
    streak: float = 1.5
    mass_sigma: float = 0.2
    fits: float = 1.6
    recent: float = 15.0
    rival: float = 0.5
    due: float = -0.15
    seen: float = 1.5
    unseen: float = 0.0
    unseen_growth: float = 1.5
    renewed_s: float = 0.25
    renewed: float = 0.3
    least_score: float = 0.5
    sure_score: float = 0.75
