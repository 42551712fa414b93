"""Every public class, copied and pickled: the copy answers as the original does, bit for bit, and leaves it alone.

What cannot be copied refuses with a reason.
"""

import copy
import functools
import importlib.util
import inspect
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pytest

import matchset as ms
from matchset.control.ego_motion import EgoMotion
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.sticks.ego_parameters import AttitudeCommand
from matchset.sharing.shared_target import Age
from matchset.sim.world import ChainParameters, World

ROWS, COLUMNS = np.indices((240, 320))
BLUE = ms.ColorModel.hsv((95, 120, 20), (119, 255, 255))
PURPLE = ms.ColorModel.hsv((135, 80, 40), (165, 255, 255))
CAMERA = ms.CameraModel.from_fov(320, 240, 1.07)
TARGET = ms.BallTarget(diameter=0.28, markers=((0.3, 0.0, 0.9539392014169456), (-0.3, 0.0, 0.9539392014169456)))
Triangle = ms.Polygon.of([(0, 0), (4, 0), (0, 3)])
Egg = ms.Convex.of([(0, 0), (4, 0), (5, 2), (4, 4), (0, 4)], motion="affine")

PAST = 12  # steps of a life

WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle 2": lambda thing: pickle.loads(pickle.dumps(thing, 2)),
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
}


@functools.cache
def picture(index: int, ball: bool = True, gray: bool = False) -> Any:
    """A ball with two marks that moves and fades, before a noisy wall."""
    image = np.random.default_rng(index).normal(120.0, 5.0, (240, 320, 3))
    x, y = 130.0 + 5.0 * index, 120.0 + 12.0 * np.sin(index / 3.0)
    fade = 1.0 - 0.01 * index
    if ball:
        image[np.hypot(COLUMNS - x, ROWS - y) < 30.0] = np.array((200, 60, 30)) * fade
        for side in (-9, 9):
            image[np.hypot(COLUMNS - x - side, ROWS - y) < 5.0] = np.array((150, 30, 150)) * fade
    whole = image.clip(0, 255).astype(np.uint8)
    return np.ascontiguousarray(whole[:, :, 2]) if gray else whole


def frames(first: int, count: int, gray: bool = False, missing: Iterable[int] = ()) -> list[ms.Frame]:
    return [ms.Frame(picture(k, k not in missing, gray), k / 30, k) for k in range(first, first + count)]


class Life(NamedTuple):
    """How an object is made, and what it does at a step."""

    make: Callable[[], Any]
    step: Callable[[Any, int], object]
    at: int = 5  # the step at which it is copied


def tracked(gray: bool = False, missing: Iterable[int] = ()) -> Callable[[Any, int], object]:
    gone = frozenset(missing)
    return lambda tracker, k: tracker.update(frames(k, 1, gray, gone)[0])


def started(shape: Any) -> Callable[[], Any]:
    def make() -> Any:
        tracker: Any = ms.Tracker(type(shape), BLUE | PURPLE)
        tracker.start(shape)
        return tracker

    return make


@functools.cache
def balls() -> list[Any]:
    """Frames with the ball as it was tracked."""
    tracker = ms.Tracker(ms.Circle, BLUE | PURPLE)
    return [(frame, tracker.update(frame)) for frame in frames(0, PAST)]


@functools.cache
def marks() -> list[Any]:
    finder = ms.MarkerTracker(PURPLE, TARGET)
    return [finder.update(*each) for each in balls()]


@functools.cache
def poses() -> list[Any]:
    localizer = ms.Localizer(CAMERA, TARGET)
    return [localizer.update(ball, found) for (_, ball), found in zip(balls(), marks(), strict=True)]


def filtered(keeper: ms.PoseFilter, k: int) -> object:
    return keeper.update(poses()[k]), keeper.predict(k / 30 + 0.07)


def adapted(color: ms.ColorModel, k: int) -> object:
    color.log_odds[k] += 1.0
    color.table[k] += 1
    return color.log_odds, color.table, color.channels, color.circle, color.note, color.mask(picture(k))


def flown(motion: EgoMotion, k: int) -> object:
    motion.update(AttitudeCommand(*np.linspace(0.0, 0.1 * k, len(AttitudeCommand._fields)).tolist()), k / 30)
    return [motion.at(k / 30).block, motion.at(k / 30 - 0.05).block]


def neighbored(keeper: NeighborFilter, k: int) -> object:
    motion = EgoMotion()
    for n in range(k + 2):
        flown(motion, n)
    return keeper.update(poses()[k], motion.at(k / 30)), keeper.at(k / 30 + 0.1, 0.3)


def simulated(world: World, k: int) -> object:
    world.advance(8 * k)
    return world.poses(8 * k), world.states, world.rope.position, world.motion.time_step


LIVES: dict[str, Life] = {
    "Tracker": Life(lambda: ms.Tracker(ms.Circle, BLUE | PURPLE), tracked()),
    "Tracker, new": Life(lambda: ms.Tracker(ms.Circle, BLUE | PURPLE, start=(130, 120)), tracked(), 0),
    "Tracker, many lines": Life(lambda: ms.Tracker(ms.Circle, BLUE | PURPLE, points=300), tracked()),
    "Tracker, started": Life(started(ms.Circle(132.0, 119.0, 28.0)), tracked(), 0),
    "Tracker, coasting": Life(lambda: ms.Tracker(ms.Circle, BLUE | PURPLE), tracked(missing=(4, 5, 6))),
    "Tracker, gray": Life(lambda: ms.Tracker(ms.Circle, ms.ColorModel.dark()), tracked(gray=True)),
    "Tracker, Ellipse": Life(started(ms.Ellipse(132.0, 120.0, 31.0, 29.0, 0.3)), tracked(), 2),
    "Tracker, Polygon.of": Life(lambda: ms.Tracker(Triangle, BLUE | PURPLE), tracked(), 2),
    "ColorModel": Life(lambda: BLUE.copy(), adapted),
    "MarkerTracker": Life(lambda: ms.MarkerTracker(PURPLE, TARGET), lambda finder, k: finder.update(*balls()[k])),
    "Localizer": Life(
        lambda: ms.Localizer(CAMERA, TARGET), lambda localizer, k: localizer.update(balls()[k][1], marks()[k])
    ),
    "PoseFilter": Life(ms.PoseFilter, filtered),
    "MultiTracker": Life(lambda: ms.MultiTracker(ms.Circle, BLUE), lambda tracker, k: tracker.update(balls()[k][0])),
    "Neighbors": Life(lambda: ms.Neighbors(CAMERA, TARGET, BLUE | PURPLE, PURPLE), tracked()),
    "EgoMotion": Life(EgoMotion, flown),
    "NeighborFilter": Life(NeighborFilter, neighbored),
    "World": Life(lambda: World(ChainParameters(vehicles=2), 3), simulated),
}


def values() -> dict[str, Any]:
    """What never changes: its copy must look the same."""
    (_, ball), pose = balls()[8], poses()[8]
    return {
        "BallTarget": TARGET,
        "CameraModel": CAMERA,
        "Circle": ms.Circle(1.0, 2.0, 3.0),
        "Convex": Egg(1.0, 2.0, 3.0, 0.5, 0.1, 2.0),
        "Ellipse": ms.Ellipse(1.0, 2.0, 5.0, 3.0, 0.3),
        "Frame": ms.Frame(picture(0), 1.0, 2),
        "LinkError": ms.LinkError("no camera 0"),
        "Lost": ms.Lost("it is gone", 1.0, ms.Circle(1.0, 2.0, 3.0)),
        "Neighbor": ms.Neighbor(3, pose, ball, marks()[8], True),
        "Polygon": Triangle(1.0, 2.0, 3.0, 0.4),
        "Pose": pose,
        "Quadrilateral": ms.Quadrilateral([(0.0, 0.0), (9.0, 1.0), (8.0, 7.0), (1.0, 6.0)]),
        "Rectangle": ms.Rectangle(10.0, 20.0, 8.0, 5.0, 0.2),
        "SharedTarget": ms.SharedTarget(
            partner="left",
            name="ball",
            identity=0,
            pose=poses()[-1],
            shape="Circle",
            values={"x": (1.0, None)},
            age=Age(0.1, 0.01),
            reason="",
        ),
        "Target": ms.Target(3, "blue", ball, 0.5),
        "Track": ball,
        "TrackerConstants": ms.TrackerConstants(),
        "TrackerParameters": ms.TrackerParameters(),
    }


def refused(folder: Path) -> dict[str, Any]:
    """What holds a device or a file."""
    import cv2

    cv2.imwrite(str(folder / "one.png"), picture(0))
    return {"Video": ms.Video(folder / "one.png")} | sharing()


def sharing() -> dict[str, Any]:
    """What holds a connection, as far as its package is installed."""
    made: dict[str, Any] = {}
    if importlib.util.find_spec("zenoh"):
        made["Share"] = ms.Share("me", key="test/copies", discovery="off")
    if importlib.util.find_spec("ntcore"):
        made["NetworkTables"] = ms.NetworkTables("me", "127.0.0.1")
    return made


FUNCTIONS = {"detect", "draw", "draw_pose", "table", "to_supervision", "write_video"}


def written(value: object) -> object:
    """A value as plain numbers and words, to the last bit."""
    if isinstance(value, np.ndarray):
        return str(value.dtype), value.shape, value.tobytes()
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, msgspec.Struct):
        return type(value), [written(getattr(value, name)) for name in value.__struct_fields__]
    if isinstance(value, list | tuple):
        return [written(each) for each in value]
    if isinstance(value, BaseException):
        return type(value), written(value.args)
    if isinstance(value, ms.Quadrilateral):
        return written(value.corners)
    return value


def lived(life: Life, thing: Any, begin: int, end: int) -> list[object]:
    return [written(life.step(thing, k)) for k in range(begin, end)]


def arrays(thing: object, seen: dict[int, object] | None = None) -> Iterator[Any]:
    """All arrays and records that an object reaches, in order."""
    seen = {} if seen is None else seen
    if id(thing) in seen:
        return
    seen[id(thing)] = thing
    if isinstance(thing, np.ndarray | np.void):
        yield thing
    elif isinstance(thing, dict):
        for each in thing.values():
            yield from arrays(each, seen)
    elif isinstance(thing, list | tuple | set):
        for each in thing:
            yield from arrays(each, seen)
    elif type(thing).__module__.startswith("matchset.") and hasattr(thing, "__dict__"):
        yield from arrays(vars(thing), seen)


def memory(array: Any) -> tuple[int, int]:
    """First address and number of bytes of an array or a record."""
    kind = np.void if isinstance(array, np.void) else np.ndarray  # a field may have the name of an attribute
    start = kind.__array_interface__.__get__(array)["data"][0]
    return int(start), int(kind.nbytes.__get__(array))


def layout(thing: object) -> list[list[tuple[int, int]]]:
    """What lies in each array that has views: how far from its beginning, and how long."""
    places = {memory(each) for each in arrays(thing)}
    found: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for start, size in sorted(places):
        whole = max((n, a) for a, n in places if a <= start and start + size <= a + n)
        found.setdefault(whole, []).append((start - whole[1], size))
    return sorted(each for each in found.values() if len(each) > 1)


def shared(one: object, other: object) -> list[tuple[int, int]]:
    """Memory of arrays that two objects both reach."""
    return sorted({memory(each) for each in arrays(one)} & {memory(each) for each in arrays(other)})


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", LIVES)
def test_a_copy_goes_on_as_the_original_does(name: str, way: str) -> None:
    life = LIVES[name]
    reference = life.make()
    lived(life, reference, 0, life.at)
    expected = lived(life, reference, life.at, PAST)
    original = life.make()
    lived(life, original, 0, life.at)
    other = WAYS[way](original)
    assert type(other) is type(original)
    assert layout(other) == layout(original)
    assert not shared(original, other)
    assert lived(life, other, life.at, PAST) == expected, "the copy"
    assert lived(life, original, life.at, PAST) == expected, "the original, after the copy went on"


@pytest.mark.parametrize("way", WAYS)
def test_a_copy_of_a_value_is_equal(way: str) -> None:
    for name, value in values().items():
        other = WAYS[way](value)
        assert type(other) is type(value), name
        assert written(other) == written(value), name


@pytest.mark.parametrize("way", WAYS)
def test_what_holds_a_device_says_that_it_cannot_be_copied(way: str, tmp_path: Path) -> None:
    for name, thing in refused(tmp_path).items():
        with thing, pytest.raises(TypeError, match=rf"a {name} holds .* cannot be copied or pickled: \w+"):
            WAYS[way](thing)


def test_families_that_were_made_are_found_again_by_what_they_were_made_from() -> None:
    for family in (Triangle, Egg, ms.Circle, ms.Rectangle, type(Triangle)):
        for way in WAYS.values():
            assert way(family) is family


def test_every_public_class_is_looked_at(tmp_path: Path) -> None:
    classes = {name for name in ms.__all__ if inspect.isclass(getattr(ms, name))}
    held = refused(tmp_path)
    for thing in held.values():
        thing.close()
    looked_at = {name.partition(",")[0] for name in LIVES} | set(values()) | {*held, "Share", "NetworkTables"}
    assert set(ms.__all__) - classes == FUNCTIONS
    assert classes <= looked_at


def test_what_owns_a_block_knows_how_to_copy_it() -> None:
    """A class that keeps views into a block of its own names them in `_derive`, as `Copied` asks."""
    package = Path(ms.__file__).parent
    for path in sorted(package.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for part in text.split("\nclass ")[1:]:
            if "self._block = new_block(" in part or "self.block = new_block(" in part:
                assert "(Copied" in part.partition(":")[0], f"{path.name}: {part.partition(':')[0]}"
                assert "def _derive(" in part, f"{path.name}: {part.partition(':')[0]}"


OTHER_PROCESS = """
import pickle, sys
sys.path[:0] = {path!r}
import test_copies
with open({file!r}, "rb") as file:
    things = pickle.load(file)
for name, thing in things.items():
    life = test_copies.LIVES[name]
    things[name] = test_copies.lived(life, thing, life.at, test_copies.PAST)
with open({file!r}, "wb") as file:
    pickle.dump(things, file)
"""


def test_another_process_goes_on_with_what_was_pickled(tmp_path: Path) -> None:
    names = "Tracker", "Tracker, Polygon.of", "Localizer", "MarkerTracker"
    things = {name: LIVES[name].make() for name in names}
    for name, thing in things.items():
        lived(LIVES[name], thing, 0, LIVES[name].at)
    file = tmp_path / "things.pickle"
    data = pickle.dumps(things)
    assert b"numba" not in data, "compiled functions are made again, not pickled"
    file.write_bytes(data)
    program = OTHER_PROCESS.format(path=[str(Path(__file__).parent)], file=str(file))
    subprocess.run([sys.executable, "-c", program], check=True, timeout=600, env=dict(os.environ))
    answers = pickle.loads(file.read_bytes())
    for name, thing in things.items():
        assert answers[name] == lived(LIVES[name], thing, LIVES[name].at, PAST), name
