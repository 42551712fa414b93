"""Parameters of a vehicle from a log, with standard deviations: `estimate`, a pure function.

Nonlinear least squares on whitened residuals. The ball, which hangs still, is turned into the level frame by the
modeled attitude: there it must stay where it is relative to the modeled way, and so must the direction of its marker.
Priors are wide, so what the log does not tell keeps the standard deviation of its prior. The covariance is that of
Gauss and Newton, (J' J)^-1 at the solution (Bates & Watts, Nonlinear Regression Analysis, section 2.2.2), times a
factor for what the model leaves out.
"""

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from matchset.flight.identify.flight_log import StickLog
from matchset.flight.identify.unknowns import UNKNOWNS, Unknown
from matchset.flight.identify.vehicle_model import VehicleModel, VehicleValues
from matchset.flight.identify.whitening import Disturbance, Whitening, outliers

Floats = npt.NDArray[np.float64]


class EstimateParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Parameters of `estimate`.

    Parameters
    ----------
    rounds : int
        How often the noise is found anew from what the model leaves. More changes little after 3.
    gate : float
        A picture whose residual is that many standard deviations off does not count: another ball, or a reflection.
        Less throws good ones away.
    least_pictures : int
        Fewer are not enough to say anything; at least twice the number of parameters.
    delays : tuple of float
        Delays with which the search may begin, s.
    starts : int
        With so many of these, the best, it does begin; the best result counts. More is safer and slower.
    across, down, along, marker : Disturbance
        Usual noise of the ball across, down and along the line of sight, and of its marker's direction; found anew by
        likelihood. Chosen by simulated flights of seeds 0 to 7.
    most_drift, most_turn : float
        Largest `Disturbance.drift` of the ball, m^2/s^3, and of its marker's direction, rad^2/s^3, with which the model
        counts as true. Gusts of 0.5 m/s are 0.3 and 1e-4, a ball that swings by 0.1 m and turns by 20 degrees 0.1 and
        5e-3; delays outside of what is searched 0.01 to 7 and 0.3 to 4. More believes vehicles that answer otherwise.
    spread : float
        Standard deviation of the natural logarithms of the numbers in these. More trusts the log more.
    caution : float
        Factor of all standard deviations, since no vehicle is quite as modeled. Chosen by the errors of simulated
        flights of seeds 0 to 19, in these standard deviations.
    wander : float
        How far a level wanders in some seconds, rad: trims are not known better than that. Estimate.
    evaluations : int
        Most evaluations in each round.
    tolerance : float
        Relative change of the sum of squares at which a round ends.
    """

    rounds: int = 3
    gate: float = 6.0
    least_pictures: int = 60
    delays: tuple[float, ...] = (
        *(0.0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2),
        *(0.23, 0.26, 0.3, 0.34, 0.38, 0.42, 0.46),
    )
    starts: int = 3
    across: Disturbance = Disturbance(1.5, 1e-5, 3e-3)
    down: Disturbance = Disturbance(1.5, 1e-4, 3e-3)
    along: Disturbance = Disturbance(1.5, 1e-5, 3e-3)
    marker: Disturbance = Disturbance(1.0, 1e-5, 1e-5)
    most_drift: float = 0.5
    most_turn: float = 0.1
    spread: float = 2.0
    caution: float = 1.6
    wander: float = 0.005
    evaluations: int = 25
    tolerance: float = 1e-4


class VehicleEstimate(msgspec.Struct, frozen=True):
    """What a log tells of a vehicle.

    Parameters
    ----------
    values : VehicleValues of float
    sigmas : VehicleValues of float
        Their standard deviations.
    shares : VehicleValues of float
        These as shares of the standard deviations before the flight: near 1 where the log tells nothing.
    covariance : ndarray of shape (n, n)
        Of the coordinates, see `Unknown.coordinate`.
    pictures, left_out : int
        How many counted, and how many did not since they were far off.
    doubt : str
        Why nothing of it is to be believed, in words; empty if it may be.
    """

    values: VehicleValues[float]
    sigmas: VehicleValues[float]
    shares: VehicleValues[float]
    covariance: Floats
    pictures: int
    left_out: int
    doubt: str = ""


def estimate(
    log: StickLog, unknowns: VehicleValues[Unknown] = UNKNOWNS, parameters: EstimateParameters | None = None
) -> VehicleEstimate:
    """Find the parameters of a vehicle.

    Parameters
    ----------
    log : StickLog
    unknowns : VehicleValues of Unknown
        What is known before.
    parameters : EstimateParameters, optional

    Raises
    ------
    ValueError
        If the log has too few pictures.
    """
    parameters = parameters or EstimateParameters()
    if len(log.taken) < parameters.least_pictures:
        raise ValueError(
            f"the ball was located in {len(log.taken)} pictures of the flight; {parameters.least_pictures} are needed"
        )
    residuals = _Residuals(log, unknowns, parameters)
    bounds = [[each.coordinate(getattr(each, end)) for each in unknowns] for end in ("low", "high")]
    limits = {"ftol": parameters.tolerance, "xtol": parameters.tolerance, "max_nfev": parameters.evaluations}
    begun = [
        least_squares(residuals.white, at, bounds=bounds, **limits) for at in _begin(residuals, unknowns, parameters)
    ]
    at = min(begun, key=lambda each: float(each.cost)).x
    for last in range(parameters.rounds - 1, -1, -1):
        found = least_squares(residuals.white, at, bounds=bounds, **limits)
        at = found.x
        if last:
            residuals.refine(at)
    covariance = parameters.caution**2 * np.linalg.inv(found.jac.T @ found.jac)
    for name in ("roll_trim", "pitch_trim"):
        k = VehicleValues._fields.index(name)
        covariance[k, k] += (parameters.wander / unknowns[k].spread) ** 2
    shares = VehicleValues(*np.sqrt(np.diag(covariance)).tolist())
    values = residuals.values(at)
    sigmas = VehicleValues(*(u.sigma(v, s) for u, v, s in zip(unknowns, values, shares, strict=True)))
    return VehicleEstimate(
        values, sigmas, shares, covariance, residuals.pictures, len(log.taken) - residuals.pictures, residuals.doubt
    )


def ray_axes(balls: Floats) -> Floats:
    """Return unit vectors across, down and along the line of sight to each ball, (n, 3, 3), camera frame.

    Along it a position rests on the ball's size, and is ten times as uncertain.
    """
    along = balls / np.linalg.norm(balls, axis=1)[:, np.newaxis]
    across = np.stack((along[:, 2], np.zeros(len(balls)), -along[:, 0]), axis=1)
    across /= np.linalg.norm(across, axis=1)[:, np.newaxis]
    return np.stack((across, np.cross(along, across), along), axis=1)


def _begin(residuals: "_Residuals", unknowns: VehicleValues[Unknown], parameters: EstimateParameters) -> list[Floats]:
    """Return nominal coordinates but for the delays that fit best, the best first."""
    tried = []
    for delay in parameters.delays:
        at = np.zeros(len(unknowns))
        at[0] = unknowns.delay.coordinate(delay)
        tried.append((float((residuals.white(at) ** 2).sum()), delay, at))
    return [each[2] for each in sorted(tried, key=lambda each: each[:2])[: parameters.starts]]


class _Residuals:
    """What a model leaves of a log, as a function of the parameters' coordinates."""

    def __init__(self, log: StickLog, unknowns: VehicleValues[Unknown], parameters: EstimateParameters) -> None:
        self._log, self._unknowns, self._parameters = log, unknowns, parameters
        self._model, self._axes = VehicleModel(log), ray_axes(log.balls)
        self._marked = np.isfinite(log.outs[:, 0])
        variances = np.einsum("nai,nij,naj->na", self._axes, log.covariances, self._axes)
        self._usual = parameters.across, parameters.down, parameters.along, parameters.marker
        self._kept = [np.full(len(log.taken), True)] * 3 + [self._marked.copy()]
        spread = [*variances.T, log.out_variances]
        self._noises = [
            Whitening(log.taken[kept], each[kept], usual)
            for each, kept, usual in zip(spread, self._kept, self._usual, strict=True)
        ]

    @property
    def pictures(self) -> int:
        """How many count."""
        return int(self._kept[0].sum())

    @property
    def doubt(self) -> str:
        """Why the model does not hold, in words; empty if it may."""
        limits = (*(self._parameters.most_drift,) * 3, self._parameters.most_turn)
        names = ("across the line of sight", "down", "along the line of sight", "in its turn")
        far = [
            f"{name} by {noise.disturbance.drift / limit:.0f} times what is believed"
            for name, noise, limit in zip(names, self._noises, limits, strict=True)
            if noise.disturbance.drift > limit
        ]
        return f"the ball does not move as the sticks say: {far[0]}" if far else ""

    def values(self, coordinates: Floats) -> VehicleValues[float]:
        """Return the parameters."""
        pairs = zip(self._unknowns, coordinates.tolist(), strict=True)
        return VehicleValues(*(unknown.value(each) for unknown, each in pairs))

    def white(self, coordinates: Floats) -> Floats:
        """Residuals as independent numbers of variance 1, those of the priors at the end."""
        parts = [noise.whiten(each) for noise, each in zip(self._noises, self._left(coordinates), strict=True)]
        return np.concatenate((*parts, coordinates))

    def refine(self, coordinates: Floats) -> None:
        """Leave out pictures that are far off, and find the noise anew."""
        left = self._left(coordinates)
        far = [
            outliers(noise.whiten(each), self._parameters.gate) for noise, each in zip(self._noises, left, strict=True)
        ]
        off = far[0] | far[1] | far[2]
        for k, each in enumerate((off, off, off, far[3])):
            kept = self._kept[k].copy()
            kept[np.flatnonzero(kept)[each]] = False
            self._kept[k], self._noises[k], left[k] = kept, self._noises[k].without(each), left[k][~each]
        self._noises = [
            noise.fitted(each, usual, self._parameters.spread)
            for noise, each, usual in zip(self._noises, left, self._usual, strict=True)
        ]

    def _left(self, coordinates: Floats) -> list[Floats]:
        """Return what is left: the ball across, down and along, and the marker's direction, of those that count."""
        values = self.values(coordinates)
        answer = self._model.predict(values)
        seen = self._log.balls + np.array((0.0, 0.0, values.ahead))
        ball = np.einsum("nij,nj->ni", answer.rotation, seen) + answer.position
        ball -= ball[self._kept[0]].mean(axis=0)
        along_axes = np.einsum("nij,naj,ni->an", answer.rotation, self._axes, ball)
        out = np.einsum("nij,nj->ni", answer.rotation, self._log.outs)
        angle = np.arctan2(out[:, 0], -out[:, 2])
        return [each[kept] for each, kept in zip((*along_axes, angle), self._kept, strict=True)]
