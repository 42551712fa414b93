"""The checks of one vehicle in their order, with the devices that they need: `vehicle_checks`."""

import contextlib
import math
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack

import msgspec
import numpy as np

from matchset.app.progress import announce_if_slow
from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.flight.linked.dry_link import DryLink
from matchset.flight.linked.followers import LinkedFollowers
from matchset.flight.linked.linked_flight import LinkedFlight
from matchset.flight.linked.live_camera import LiveCamera
from matchset.flight.linked.opening import LinkedFiles, open_camera, open_link, read_files
from matchset.flight.linked.parameters import LinkedFollower
from matchset.flight.linked.vehicle_kind import for_links
from matchset.flight.preflight.checks.link_checks import battery_check, battery_news, status_checks, vehicle_check
from matchset.flight.preflight.checks.picture_checks import exposure_checks, picture_checks, rate_of, watch_pictures
from matchset.flight.preflight.checks.sight_checks import CheckContext, dry_run_check, sight_checks, time_checks
from matchset.flight.preflight.moves import MOVES, StickWatch, skipped_moves
from matchset.flight.preflight.outcome import CheckOutcome, failed, judged
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.flight.preflight.person import Person
from matchset.flight.preflight.sticks import SteadyZero, stick_check
from matchset.flight.preflight.would_be import WouldBe, sticks_of
from matchset.flight.real_time.rehearsal import RehearsalLink
from matchset.image.errors import LinkError
from matchset.links.link import Link

FILES = "camera file, colors of ball and marker can be read"
CAMERA = "opens, pictures of the size of the camera file"
LINK = "opens and answers"


class Bench(msgspec.Struct, frozen=True, kw_only=True):
    """What the checks are made with: real devices, or others in tests.

    Parameters
    ----------
    parameters : PreflightParameters
    person : Person
    open_camera : callable
        As `matchset.flight.linked.opening.open_camera`.
    open_link : callable
        From a URI to a link that is not armed.
    clock, sleep : callables
        The time, s, and a function that waits.
    """

    parameters: PreflightParameters
    person: Person
    open_camera: Callable[[LinkedFollower, CameraModel | None, FlightParameters], LiveCamera] = open_camera
    open_link: Callable[[str], Link] = lambda uri: open_link(uri, dry=False)
    clock: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep


def vehicle_checks(
    follower: LinkedFollower, flight: FlightParameters, bench: Bench
) -> Generator[CheckOutcome, None, None]:
    """Check one vehicle; each outcome comes as soon as it is known, and nothing may follow one that failed.

    No link is ever armed. Devices are closed when the iterator ends or is closed.

    Parameters
    ----------
    follower : LinkedFollower
    flight : FlightParameters
    bench : Bench
    """
    with ExitStack() as stack:
        try:
            files = read_files(follower)
        except (ValueError, OSError) as error:
            yield failed("files", FILES, error)
            return
        yield judged("files", FILES, "read", True, "")
        bench.person.say("the camera is watched ...")
        try:
            flight = for_links(flight, (follower.link,))
            camera = bench.open_camera(follower, files.camera, flight)
        except (ValueError, LinkError) as error:
            yield failed("camera: opens", CAMERA, error, "'matchset live' shows what a camera delivers")
            return
        stack.callback(camera.close)
        yield judged("camera: opens", CAMERA, f"{camera.model.width} x {camera.model.height} px", True, "")
        rate = yield from _pictures(camera, flight, bench)
        with announce_if_slow("getting ready ..."):
            pilot = Pilot(camera, RehearsalLink(), files.colors, flight.loop)
        link = yield from _link(follower, bench, stack)
        if link is not None:
            pilot.link = DryLink(link)
            linked = _flight(pilot, files, flight, follower)
            stack.callback(_closed, linked)
            stamped = follower.delay_ms > 0.0 or camera.video.stamped
            yield from _dry_run(linked, camera, CheckContext(flight.loop, rate, stamped), bench)


def _pictures(camera: LiveCamera, flight: FlightParameters, bench: Bench) -> Generator[CheckOutcome, None, float]:
    """Watch the camera; returns the rate of its pictures."""
    loop, parameters = flight.loop, bench.parameters
    pictures = watch_pictures(camera, parameters, loop.repeated)
    yield from picture_checks(pictures, loop.safety.max_frame_age, camera.fault, parameters)
    yield from exposure_checks(pictures, parameters)
    return rate_of(pictures)


def _link(follower: LinkedFollower, bench: Bench, stack: ExitStack) -> Generator[CheckOutcome, None, Link | None]:
    """Open the link and check it; returns it."""
    zero = SteadyZero(bench.clock, bench.sleep)
    bench.person.say("the link is opened ...")
    try:
        link = bench.open_link(follower.link)
        stack.callback(_closed, link)
        yield judged("link: opens", LINK, link.uri, True, "")
        sent = zero.send(link, bench.parameters.settle)
        yield from status_checks(link.status(), sent, bench.parameters)
        yield vehicle_check(link)
        yield battery_check(battery_news(link), bench.parameters)
        yield stick_check(link, bench.person, bench.parameters, bench.clock, bench.sleep)
        zero.send(link, bench.parameters.settle)
    except (LinkError, ValueError) as error:
        yield failed("link: answers", LINK, error, "its cable, its power, its port; no other program may have it")
        return None
    return link


def _closed(device: Link | LinkedFlight) -> None:
    """Close what was never armed; that it is broken has been said."""
    with contextlib.suppress(LinkError):
        device.close()


def _flight(pilot: Pilot, files: LinkedFiles, flight: FlightParameters, follower: LinkedFollower) -> LinkedFlight:
    """Make the dry run."""
    setup = FlightSetup(
        flight, (pilot.camera.model,), (), kind="dry run", colors=(files.colors,), devices=(follower.words,)
    )
    return LinkedFlight(LinkedFollowers([pilot]), setup)


def _dry_run(flight: LinkedFlight, camera: LiveCamera, told: CheckContext, bench: Bench) -> Iterator[CheckOutcome]:
    """Fly without throttle, look at what was seen, then have the vehicle moved by hand."""
    parameters, person = bench.parameters, bench.person
    person.say(f"a dry run of {parameters.rest:g} s: hold the vehicle still at its set place ...")
    steps, run = list[PilotStep](), iter(flight)
    begin = camera.now()
    for chain_step in run:
        steps.append(chain_step.steps[0])
        if camera.now() - begin > parameters.rest:
            break
    fault = flight.fault or camera.fault
    if fault:
        yield failed("dry run: devices", "camera and link go on", fault, "its cable, its power")
        return
    yield from sight_checks(steps, told, parameters)
    yield from time_checks(steps, told, parameters)
    yield dry_run_check(steps, told, parameters)
    if not person.attends:
        yield from skipped_moves("nobody was there to move it: run it at a terminal, without --unattended")
        return
    rest = WouldBe(*np.median(sticks_of(steps, told.pilot.follower), axis=0).tolist())
    stepped = (each.steps[0] for each in run)
    for move in MOVES:
        yield _moved(StickWatch(move, getattr(rest, move.stick), parameters), stepped, flight, camera, person)


def _moved(
    watch: StickWatch, steps: Iterator[PilotStep], flight: LinkedFlight, camera: LiveCamera, person: Person
) -> CheckOutcome:
    """Have a person move the vehicle, and watch the stick until it has been seen or the time is over."""
    told = flight.parameters.loop.follower
    person.say(f"Put it back to its set place. {watch.move.words}, and hold it there")
    begin = camera.now()
    for step in steps:
        if any(watch.add(sticks) for sticks in sticks_of([step], told)):
            break
        if camera.now() - begin > watch.parameters.move_time:
            break
    fault = flight.fault or camera.fault
    if fault:
        return failed(watch.move.name, "camera and link go on", fault, "its cable, its power")
    return watch.outcome


def flight_of(flight: FlightParameters, parameters: PreflightParameters, count: int) -> FlightParameters:
    """Return the parameters of the dry runs: long enough, and of a chain of so many followers.

    Parameters
    ----------
    flight : FlightParameters
    parameters : PreflightParameters
    count : int
        How many followers there are.
    """
    world = msgspec.structs.replace(flight.world, vehicles=count + 1)
    longest = parameters.rest + len(MOVES) * parameters.move_time
    return msgspec.structs.replace(flight, world=world, duration=math.ceil(2.0 * longest))
