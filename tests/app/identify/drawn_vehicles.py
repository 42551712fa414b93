"""Simulated vehicles that nobody measured, flown to be identified, with their true numbers."""

from typing import NamedTuple

from matchset.app.flight.config import with_world
from matchset.app.flight.flight import Flight, FlightParameters
from matchset.app.identify.flight_log import FlightLog, LoggedStep
from matchset.app.identify.parameters import IdentifyParameters, careful
from matchset.app.simulate.variation import changed, parse_vary
from matchset.sim.world import RATE

DRAWN = (
    "thrust=0.8..1.2,mass=0.8..1.2,full_tilt=0.8..1.2,full_yaw_rate=0.8..1.2,motor_lag=0.8..1.2,attitude_lag=0.8..1.2,"
    "yaw_lag=0.8..1.2,roll_trim_deg=-3..3,pitch_trim_deg=-3..3,yaw_trim_deg_s=-8..8,battery_loss_per_min=0..0.2,"
    "latency_ms=33..200"
)


class Flown(NamedTuple):
    """A flight to identify a vehicle by.

    Attributes
    ----------
    log : FlightLog
    truth : dict
        Of the vehicle, by the names of `VehicleValues`.
    ended : str
        Why before its time; empty if it did not.
    """

    log: FlightLog
    truth: dict[str, float]
    ended: str


def drawn_flight(seed: int, vary: str = DRAWN, duration: float = 10.0, **world: float) -> FlightParameters:
    """Parameters of a flight without pictures before a ball that hangs still."""
    flight = with_world(FlightParameters(duration=duration), vehicles=2, quick=True, seed=seed, swing=0.0, yaw_deg=0.0)
    values = {axis.name: axis.drawn(seed) for axis in parse_vary(vary)} if vary else {}
    return changed(flight, values | world)


def flown(flight: FlightParameters, parameters: IdentifyParameters | None = None) -> Flown:
    """Fly carefully, and keep the log."""
    parameters = parameters or IdentifyParameters()
    steps, ended = [], ""
    with Flight(careful(flight, parameters)) as flying:
        for step in flying:
            steps.append(LoggedStep.of(step.steps[0]))
            if step.crashes or step.down:
                ended = step.crashes[0].description if step.crashes else step.steps[0].safety.reason
                break
        log = FlightLog.of(steps, parameters.airborne)
        return Flown(log, truth(flying, flying.chain.now()), ended)


def truth(flight: Flight, now: float) -> dict[str, float]:
    """What is true of the first vehicle; a command acts a step before it arrives, since that step is flown by it."""
    world, parameters = flight.chain.world, flight.parameters.world
    motion, vehicle, conditions = world.motion, world.vehicle, parameters.conditions
    electronics, told = motion.electronics, parameters.vehicle
    used = float(motion.battery_age[0]) + now
    left = 1.0 - electronics.battery_sag * min(used / electronics.flight_time, 1.0) - electronics.battery_loss * now
    untold = 0.0 if conditions.told_latency_ms is None else parameters.latency_ms - conditions.told_latency_ms
    return {
        "delay": (round(vehicle.radio_delay * RATE) - 1) / RATE + 1e-3 * untold,
        "hover": vehicle.mass / (conditions.full_thrust(told) * left),
        "full_tilt": float(electronics.full_tilt),
        "full_yaw_rate": float(electronics.full_yaw_rate),
        "yaw_lag": 1.0 / float(motion.vehicle.yaw_gain),
        "yaw_trim": float(electronics.yaw_trim),
        "heft": vehicle.moved_mass / vehicle.mass,
        "sag": (electronics.battery_sag / electronics.flight_time + electronics.battery_loss) / left,
        "roll_trim": float(motion.level_bias[0, 0]),
        "pitch_trim": float(motion.level_bias[0, 1]),
    }
