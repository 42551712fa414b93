"""`matchset preflight` with emulated devices that fail in each way: it stops there, and no motor ever turns."""

import json
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest
from preflight_bench import GONE, SHORT, Devices, ball_from_behind, files_in, films

from blue_ball import Matchset
from matchset.flight.preflight import run as preflight_run
from matchset.flight.preflight.outcome import CheckOutcome
from matchset.flight.preflight.person import Nobody, somebody
from matchset.flight.preflight.run import disk_check, run
from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf

ORDER = [
    *("files", "camera: opens", "camera: delivers", "camera: rate", "camera: steady", "camera: new pictures"),
    *("camera: age of pictures", "exposure: not clipped", "exposure: not dark", "exposure: steady", "link: opens"),
    *("link: state", "link: warnings", "link: errors", "link: vehicle", "link: battery", "sticks: arrive"),
    *("ball: tracked", "ball: distance", "marker: seen, yaw known", "pose: noise", "marker: noise"),
    *("age: picture to effect", "computing: in time", "dry run: would fly"),
    *("signs: roll", "signs: pitch", "signs: throttle", "signs: yaw", "disk: room"),
]


@pytest.fixture(scope="module")
def rendered() -> dict[str, list[np.ndarray]]:
    return films()


@pytest.fixture
def devices(
    rendered: dict[str, list[np.ndarray]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], Devices]:
    monkeypatch.chdir(tmp_path)
    written = files_in(tmp_path)
    return lambda kind: Devices(rendered, written, kind)


def made(devices: Devices) -> tuple[int, list[CheckOutcome]]:
    """Run it; returns the exit code and what it found. Whatever happens, nothing is armed and all is closed."""
    code = run(devices.options, devices.bench)
    assert not devices.motors_turned
    found = msgspec.json.decode(Path("preflight.json").read_bytes(), type=list[CheckOutcome])
    assert [each.name for each in found[:-1] if each.is_failed] == []
    assert found[-1].is_failed == (code != 0)
    return code, found


@pytest.mark.parametrize("kind", ["serial", "crsf", "mavlink", "tello"])
def test_all_is_well(devices: Callable[[str], Devices], kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    bench = devices(kind)
    code, found = made(bench)
    out = capsys.readouterr().out
    assert code == 0, found[-1]
    assert [each.name for each in found] == ORDER
    skipped = {each.name for each in found if each.verdict == "skipped"}
    told = {
        "serial": {"link: vehicle", "link: battery"},
        "crsf": set(),
        "mavlink": {"link: vehicle", "link: battery", "sticks: arrive"},
        "tello": {"link: vehicle", "sticks: arrive"},
    }
    assert skipped == told[kind]
    assert all(each.advice for each in found if each.verdict == "skipped")
    assert "matchset fly --camera 0 --link" in out.replace("\n", " ")
    assert "--record first.mcap" in out
    assert bench.camera.closed
    assert bench.port.closed or bench.module.closed or bench.autopilot.closed or bench.tello.closed


def test_nobody_is_asked_nothing(devices: Callable[[str], Devices]) -> None:
    bench = devices("crsf")
    bench.person.attends = False
    code, found = made(bench)
    assert code == 0
    asked = {"sticks: arrive", "signs: roll", "signs: pitch", "signs: throttle", "signs: yaw"}
    assert {each.name for each in found if each.verdict == "skipped"} == asked
    assert isinstance(somebody(unattended=True), Nobody)


def camera(**changes: object) -> Callable[[Devices], None]:
    """A camera with faults."""

    def change(devices: Devices) -> None:
        for name, value in changes.items():
            setattr(devices.camera, name, value)

    return change


def pictures(function: Callable[[np.ndarray], np.ndarray]) -> Callable[[Devices], None]:
    return camera(change=lambda image, _: function(image))


def noisy(image: np.ndarray, number: int) -> np.ndarray:
    """The whole picture jumps to and fro."""
    return np.roll(image, 3 if number % 2 else -3, axis=1)


def unplugged(devices: Devices) -> None:
    """The camera dies in the dry run."""

    def pace(number: int) -> float:
        devices.camera.dead = number > 20
        return 1.0

    devices.camera.slow = pace


def no_color(_: Devices) -> None:
    Path("ball.npz").unlink()


def a_text(_: Devices) -> None:
    Path("ball.npz").write_text("no")


def deaf_firmware(devices: Devices) -> None:
    """The firmware takes roll for pitch."""
    inner = devices.port._channels

    def crossed(values: list[int]) -> None:
        inner([values[1], values[0], *values[2:]])

    devices.port._channels = crossed  # type: ignore[method-assign]


def silent_later(devices: Devices) -> None:
    """The cable of the transmitter is pulled while sticks are tried."""
    heard = devices.port.heard

    class Counted(list[list[int]]):
        def append(self, values: list[int]) -> None:
            super().append(values)
            devices.port.unplugged = len(self) > 60

    devices.port.heard = Counted(heard)


def told(**changes: object) -> Callable[[Devices], None]:
    def change(devices: Devices) -> None:
        devices.parameters = msgspec.structs.replace(SHORT, **changes)

    return change


def port(**changes: object) -> Callable[[Devices], None]:
    def change(devices: Devices) -> None:
        for name, value in changes.items():
            setattr(devices.port, name, value)

    return change


BEHIND = ball_from_behind()
FAULTS: dict[str, tuple[Callable[[Devices], None], str, int, str]] = {
    "no color": (no_color, "files", 2, "ball.npz"),
    "a color file that is none": (a_text, "files", 2, "ball.npz"),
    "a camera file of another size": (
        lambda d: setattr(d, "camera_error", ValueError("the camera is for 640 x 480 px")),
        "camera: opens",
        2,
        "640 x 480",
    ),
    "no camera": (lambda d: setattr(d, "camera_error", GONE), "camera: opens", 3, "No such file"),
    "no pictures": (camera(dead=True), "camera: delivers", 3, "has delivered no picture"),
    "a slow camera": (camera(slow=lambda _: 3.0), "camera: rate", 1, "10.0 a second"),
    "a camera that stutters": (camera(slow=lambda n: 8.0 if n == 9 else 1.0), "camera: steady", 1, "267 ms"),
    "a picture that stands still": (camera(frozen=True), "camera: new pictures", 1, "stands still"),
    "old pictures": (camera(late=0.5), "camera: age of pictures", 1, "500 ms"),
    "pictures of the future": (camera(late=-0.5), "camera: age of pictures", 1, "future"),
    "too bright": (pictures(lambda i: np.full_like(i, 255)), "exposure: not clipped", 1, "%"),
    "too dark": (pictures(lambda i: i // 40), "exposure: not dark", 1, "%"),
    "an exposure that swings": (
        camera(change=lambda i, n: (i * (0.7 + 0.3 * (n % 2))).astype(np.uint8)),
        "exposure: steady",
        1,
        "%",
    ),
    "no transmitter": (lambda d: setattr(d, "link_error", GONE), "link: answers", 3, "No such file"),
    "no such link": (lambda d: setattr(d, "link_error", ValueError("a link is named")), "link: answers", 2, "named"),
    "a transmitter that is mute": (port(mute=True), "link: answers", 3, ""),
    "a transmitter with a fault": (port(warnings=1), "link: warnings", 1, ""),
    "a transmitter that binds": (port(state="binding", _bind_left=2000), "link: state", 1, "binding"),
    "sticks that are crossed": (deaf_firmware, "sticks: arrive", 1, "roll to the right: sent 38, heard 0"),
    "a cable that is pulled": (silent_later, "link: answers", 3, "unplugged"),
    "the ball is hidden": (pictures(lambda i: np.full_like(i, 128)), "ball: tracked", 1, "0.0%"),
    "the ball is turned": (pictures(lambda _: BEHIND), "marker: seen, yaw known", 1, "0.0%"),
    "a camera that shakes": (camera(change=noisy), "pose: noise", 1, "mm"),
    "a camera without stamps": (camera(stamped=False), "age: picture to effect", 1, "since its arrival"),
    "pictures that are a little old": (camera(late=0.24), "age: picture to effect", 1, "270 ms"),
    "a computer that is slow": (told(busy=1e-6), "computing: in time", 1, "ms"),
    "the camera is pulled": (unplugged, "dry run: devices", 3, "no picture"),
    "a picture that is mirrored": (pictures(lambda i: i[:, ::-1]), "signs: roll", 1, "roll -0."),
    "nobody moves it": (lambda d: setattr(d.person, "moves", False), "signs: roll", 1, "roll +0.0"),
    "no room on the disk": (told(recorded=1e9), "disk: room", 2, "B"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_it_stops_at_what_fails(
    devices: Callable[[str], Devices], fault: str, capsys: pytest.CaptureFixture[str]
) -> None:
    change, name, code, words = FAULTS[fault]
    bench = devices("serial")
    change(bench)
    done, found = made(bench)
    out, err = capsys.readouterr()
    assert (found[-1].name, done) == (name, code), found[-1]
    assert words in found[-1].measured
    assert found[-1].advice or code != 1
    assert len([line for line in err.splitlines() if line.startswith("error: ")]) == 1
    assert "matchset fly" not in out
    assert bench.camera.closed or "camera" in name or name == "files"


def module(**changes: object) -> Callable[[Devices], None]:
    def change(devices: Devices) -> None:
        for name, value in changes.items():
            setattr(devices.module, name, value)

    return change


ARMED = module(armed=True, _channels=lambda _: None, pass_time=lambda: None)
EMPTY = msgspec.structs.replace(SHORT, least_cell=3.9)
WHOOP_FAULTS: dict[str, tuple[Callable[[Devices], None], str, int, str]] = {
    "no module": (module(mute=True), "link: answers", 3, "no module answers"),
    "no vehicle": (module(vehicle=False), "link: vehicle", 1, "nothing heard"),
    "it refuses to be armed": (module(refuses=True), "link: warnings", 1, "ANGL!"),
    "sticks are rates": (module(mode="ACRO"), "link: vehicle", 1, "ACRO*"),
    "armed by another": (ARMED, "link: vehicle", 1, "'ANGL'"),
    "nobody is ready": (lambda d: d.person.answers.append(False), "sticks: arrive", 1, "not ready"),
    "sticks the wrong way": (lambda d: d.person.answers.extend((True, False)), "sticks: arrive", 1, "not as told"),
    "an empty battery": (lambda d: setattr(d, "parameters", EMPTY), "link: battery", 1, "3.80 V a cell"),
}


@pytest.mark.parametrize("fault", WHOOP_FAULTS)
def test_it_stops_at_what_fails_on_a_whoop(devices: Callable[[str], Devices], fault: str) -> None:
    change, name, code, words = WHOOP_FAULTS[fault]
    bench = devices("crsf")
    change(bench)
    done, found = made(bench)
    assert (found[-1].name, done) == (name, code), found[-1]
    assert words in found[-1].measured


@pytest.mark.parametrize(
    ("change", "name", "words"),
    [
        ({"mute": True}, "link: answers", ""),
        ({"settings": {"FS_THR_ENABLE": 0.0}}, "link: warnings", "FS_THR_ENABLE"),
        ({"kind": 1}, "link: answers", "no multicopter"),
    ],
)
def test_it_stops_at_what_fails_on_an_autopilot(
    devices: Callable[[str], Devices], change: dict[str, object], name: str, words: str
) -> None:
    bench = devices("mavlink")
    for key, value in change.items():
        setattr(bench.autopilot, key, value)
    code, found = made(bench)
    assert (found[-1].name, code != 0) == (name, True), found[-1]
    assert words in found[-1].measured


def test_sticks_move_with_the_motors_off(devices: Callable[[str], Devices]) -> None:
    bench = devices("crsf")
    assert made(bench)[0] == 0
    moved = {tuple(values[:4]) for _, values in bench.module.heard}
    assert len(moved) == 7  # each way of three sticks, and neutral
    assert {values[2] for values in moved} == {crsf.CHANNEL_LOW}


def test_a_disk_with_room() -> None:
    assert disk_check(1e12, 1, SHORT).verdict == "pass"
    assert disk_check(1e9, 2, SHORT).measured == "1 GB"
    assert disk_check(1e9, 2, SHORT).wanted == "2.4 GB for a recording of 60 s"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", "say whom to check"),
        ("--camera 0", "--link serial:///dev/ttyUSB0 is missing"),
        ("--camera 0 --link serial:///dev/x --arm", "preflight arms nothing"),
        ("--camera 0 --link serial:///dev/x --config c.toml", "c.toml"),
    ],
)
def test_what_does_not_fit_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], line: str, words: str
) -> None:
    assert matchset("preflight", *line.split()) == 2
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1), err
    assert words in err


def test_lines_of_json_are_alone_on_stdout(
    devices: Callable[[str], Devices], capsys: pytest.CaptureFixture[str]
) -> None:
    bench = devices("serial")
    bench.camera_error = LinkError("it is gone")
    options = msgspec.structs.replace(bench.options, to_stdout=True)
    assert preflight_run.run(options, bench.bench) == 3
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["name"] for line in lines] == ["files", "camera: opens"]
