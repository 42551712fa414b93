"""Residuals with noise that is alike everywhere: `Whitening`.

What a model leaves is noise of the pictures, independent from one to the next, and what the model does not know: a
level that wanders turns the camera, gusts and a ball that sways move it. The former is integrated white noise, the
latter twice integrated, both begun anywhere, so that residuals have the covariance (Rasmussen & Williams 2006, section
2.7 and Eq. 6.28)

    C = s^2 R + w min(t, t') + q K + p 1 1',    K(t, t') = min(t, t')^2 (3 max(t, t') - min(t, t')) / 6,

p large. With C = L L' the numbers L^-1 e are independent and of variance 1, whatever the parameters of the model.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import minimize

Floats = npt.NDArray[np.float64]
ANYWHERE = 100.0  # format: m^2 or rad^2: variance of where it begins


class Disturbance(msgspec.Struct, frozen=True):
    """How strong each part of the noise is.

    Parameters
    ----------
    scale : float
        s: standard deviation over what the pictures claim.
    walk : float
        w, m^2/s or rad^2/s.
    drift : float
        q, m^2/s^3 or rad^2/s^3.
    """

    scale: float
    walk: float
    drift: float


class Whitening:
    """The noise of one residual at the times of the pictures.

    Parameters
    ----------
    times : ndarray of shape (n,)
        s.
    variances : ndarray of shape (n,)
        R: of the pictures, by their own account.
    disturbance : Disturbance
    """

    def __init__(self, times: Floats, variances: Floats, disturbance: Disturbance) -> None:
        self.times, self.variances, self.disturbance = times, variances, disturbance
        since = times - times[:1]
        self._least, most = np.minimum.outer(since, since), np.maximum.outer(since, since)
        self._drift = self._least**2 * (3.0 * most - self._least) / 6.0
        numbers = disturbance.scale, disturbance.walk, disturbance.drift
        self._factor = np.linalg.cholesky(self._covariance(*numbers)) if len(times) else np.empty((0, 0))

    def whiten(self, residuals: Floats) -> Floats:
        """Return residuals, (n, ...), as independent numbers of variance 1."""
        white: Floats = solve_triangular(self._factor, residuals, lower=True, check_finite=False)
        return white

    def fitted(self, residuals: Floats, prior: Disturbance, spread: float) -> "Whitening":
        """Return the noise of which these residuals are most likely.

        Parameters
        ----------
        residuals : ndarray of shape (n,)
        prior : Disturbance
            What is usual.
        spread : float
            Standard deviation of the natural logarithms of its numbers.
        """
        if len(self.times) == 0:
            return self
        usual = np.log(msgspec.structs.astuple(prior))

        def loss(logs: Floats) -> float:
            factor = cho_factor(self._covariance(*np.exp(logs)), lower=True, check_finite=False)
            squares = float(residuals @ cho_solve(factor, residuals, check_finite=False))
            likelihood = 0.5 * squares + float(np.log(np.diag(factor[0])).sum())
            return likelihood + 0.5 * float((((logs - usual) / spread) ** 2).sum())

        begin = np.log(msgspec.structs.astuple(self.disturbance))
        simplex = begin + np.vstack((np.zeros(3), np.diag((0.3, 1.0, 1.0))))
        options = {"xatol": 0.1, "fatol": 0.1, "maxfev": 80, "initial_simplex": simplex}
        best = minimize(loss, begin, method="Nelder-Mead", options=options)
        return Whitening(self.times, self.variances, Disturbance(*np.exp(best.x).tolist()))

    def without(self, left_out: npt.NDArray[np.bool_]) -> "Whitening":
        """Return the noise of the other pictures."""
        return Whitening(self.times[~left_out], self.variances[~left_out], self.disturbance)

    def _covariance(self, scale: float, walk: float, drift: float) -> Floats:
        covariance: Floats = scale**2 * np.diag(self.variances) + walk * self._least + drift * self._drift
        return covariance + ANYWHERE


def outliers(white: Floats, gate: float) -> npt.NDArray[np.bool_]:
    """Which whitened residuals are larger than so many standard deviations, by the median of all."""
    usual = max(float(np.median(np.abs(white))) / 0.6745, 1.0) if len(white) else math.nan
    return np.asarray(np.abs(white) > gate * usual)
