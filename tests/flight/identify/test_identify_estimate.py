"""What a log tells of a vehicle: simulated flights of vehicles drawn at random, and logs made by the model itself."""

import math

import msgspec
import numpy as np
import pytest
from benchmarks.flight.identify import drawn_flight, flown

from matchset.flight.chain.excitation import ExcitationParameters, wave
from matchset.flight.identify.estimate import EstimateParameters, estimate
from matchset.flight.identify.flight_log import STICKS, StickLog
from matchset.flight.identify.parameters import IdentifyParameters
from matchset.flight.identify.unknowns import UNKNOWNS
from matchset.flight.identify.vehicle_model import VehicleModel, VehicleValues
from matchset.flight.identify.verdict import SHOWN, findings

PARAMETERS = IdentifyParameters()
BARS = {"hover_throttle": 0.03, "full_yaw_rate": 0.05}  # as shares of the truth
LATENCY_BAR = 0.008  # s


def made_log(
    seed: int, excitation: ExcitationParameters, seconds: float = 6.0
) -> tuple[StickLog, VehicleValues[float]]:
    """A log that the model made: drawn values, the sticks of an excitation, noise, and a level that wanders."""
    rng = np.random.default_rng((seed, 0x1D))
    small = {"speed_x", "speed_y", "speed_z", "ahead", "roll_trim", "pitch_trim", "yaw_trim"}
    values = VehicleValues(
        *(
            unknown.value(float(rng.uniform(-0.4, 0.4)) * (0.2 if name in small else 1.0))
            for name, unknown in zip(VehicleValues._fields, UNKNOWNS, strict=True)
        )
    )
    sent = np.arange(round(seconds * 30.0)) / 30.0
    pulses = [
        [wave(t, getattr(excitation, f"{name}_holds")) * getattr(excitation, name) for t in sent] for name in STICKS
    ]
    sticks = np.array(pulses).T
    sticks[:, 0] -= values.roll_trim / values.full_tilt
    sticks[:, 1] -= values.pitch_trim / values.full_tilt
    sticks[:, 2] -= values.yaw_trim / values.full_yaw_rate
    sticks[:, 3] = values.hover_throttle * (1.0 + sticks[:, 3])
    taken = sent[20:]
    covariance = np.diag((1e-6, 1e-6, 6e-5))
    log = StickLog(
        sent, sticks, taken, np.zeros((len(taken), 3)), np.tile(covariance, (len(taken), 1, 1)),
        np.zeros((len(taken), 3)), np.full(len(taken), 1e-4), 0.067,
    )  # fmt: skip
    answer = VehicleModel(log).predict(values)
    to_camera = np.swapaxes(answer.rotation, 1, 2)
    balls = np.einsum("nij,nj->ni", to_camera, np.array((0.0, -0.19, 1.6)) - answer.position)
    balls += rng.multivariate_normal(np.zeros(3), covariance, len(taken)) - np.array((0.0, 0.0, values.ahead))
    angles = 0.01 * rng.standard_normal(len(taken))
    outs = np.stack((np.sin(angles), np.zeros(len(taken)), -np.cos(angles)), axis=1)
    log = msgspec.structs.replace(log, balls=balls, outs=np.einsum("nij,nj->ni", to_camera, outs))
    return log, values


def test_the_standard_deviations_are_those_of_the_errors() -> None:
    errors = []
    for seed in range(4):
        log, values = made_log(seed, ExcitationParameters(), seconds=9.0)
        found = estimate(log, parameters=EstimateParameters(starts=1))
        errors.append([(getattr(found.values, n) - getattr(values, n)) / getattr(found.sigmas, n) for n in SHOWN])
    assert 0.5 < math.sqrt(np.mean(np.square(errors))) < 1.3
    assert np.abs(errors).max() < 4.5


def test_sticks_that_do_not_move_tell_nothing_and_that_is_said() -> None:
    log, _ = made_log(3, ExcitationParameters(yaw=0.0))
    found = {each.name: each for each in findings(estimate(log), log, PARAMETERS)}
    assert "the yaw stick hardly moved" in found["full_yaw_rate"].missing
    assert "the yaw stick hardly moved" in found["yaw_lag"].missing
    assert not found["hover_throttle"].missing
    assert not found["delay"].missing, "the other sticks tell it, too"


def test_what_is_out_of_bounds_is_said() -> None:
    log, _ = made_log(4, ExcitationParameters())
    late = msgspec.structs.replace(log, sent=log.sent - 0.45)
    found = {each.name: each for each in findings(estimate(late), late, PARAMETERS)}
    assert found["delay"].missing == "out of bounds: at 0.5, the largest that is searched"


def test_pictures_that_have_nothing_to_do_with_the_sticks_are_not_believed() -> None:
    log, _ = made_log(4, ExcitationParameters())
    other, _ = made_log(5, ExcitationParameters(yaw_holds=(0.25,), pitch_holds=(0.15,)))
    mixed = msgspec.structs.replace(log, sticks=other.sticks)
    found = findings(estimate(mixed), mixed, PARAMETERS)
    assert all("the ball does not move as the sticks say" in each.missing for each in found)


def test_another_ball_in_some_pictures_does_not_count() -> None:
    log, values = made_log(5, ExcitationParameters(), seconds=9.0)
    balls = log.balls.copy()
    balls[[30, 90, 150]] += (0.3, 0.0, 1.5)
    found = estimate(msgspec.structs.replace(log, balls=balls))
    assert 3 <= found.left_out <= 25
    assert found.values.hover_throttle == pytest.approx(values.hover_throttle, rel=0.01)
    assert found.values.delay == pytest.approx(values.delay, abs=0.005)


def test_a_short_log_is_refused_and_says_so() -> None:
    log, _ = made_log(6, ExcitationParameters(), seconds=2.0)
    with pytest.raises(ValueError, match="the ball was located in 40 pictures of the flight; 60 are needed"):
        estimate(log)


def test_a_log_without_a_marker_will_do() -> None:
    log, values = made_log(7, ExcitationParameters())
    found = estimate(msgspec.structs.replace(log, outs=np.full_like(log.outs, math.nan)))
    assert found.values.full_yaw_rate == pytest.approx(values.full_yaw_rate, rel=0.1)


def test_a_drawn_vehicle_is_found_within_the_bars() -> None:
    flight = flown(drawn_flight(125))
    assert not flight.ended
    found = estimate(flight.log)
    for name, bar in BARS.items():
        assert getattr(found.values, name) == pytest.approx(flight.truth[name], rel=bar)
    assert found.values.delay == pytest.approx(flight.truth["delay"], abs=LATENCY_BAR)
    assert found.values.full_tilt == pytest.approx(flight.truth["full_tilt"], rel=0.08)


def test_a_follower_that_is_not_shaken_is_found_in_part() -> None:
    still = ExcitationParameters(roll=0.0, pitch=0.0, yaw=0.0, throttle=0.0)
    flight = flown(drawn_flight(121), msgspec.structs.replace(PARAMETERS, excitation=still))
    found = {each.name: each for each in findings(estimate(flight.log), flight.log, PARAMETERS)}
    assert found["hover_throttle"].value == pytest.approx(flight.truth["hover_throttle"], rel=0.03)
    assert "stick hardly moved" in found["lift_lag"].missing
