"""The commands of the README and of docs/ run as typed, page by page, in a folder with the files that a page promises.

They run one after the other in this process, from the first line of a page to the last: what one line writes, the next
one reads. What cannot run here has its reason in `NOT_RUN`; flights are shorter (`SHORTER`), all else is as typed. Two
lines with which many pages begin do not run for each of them (`SAME`).
"""

import functools
import importlib.util
import math
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

import bags
import batched_videos
import matchset as ms
from matchset import cli
from matchset.app.films.clip_export import write_clip
from matchset.app.guidance import choice
from matchset.image.candidates import Candidate, find_candidates
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.clip import Clip
from rendered_flight import write_flight

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"```.*?```", re.DOTALL)
TYPED = re.compile(r"^    (?:\$ )?((?:matchset|python|pip|make|git|cd|head|cut) .*)$", re.MULTILINE)

HARDWARE, NETWORK, LONG = "needs a device", "needs the network, or changes what is installed", "takes minutes to hours"
ENDLESS = "runs until Ctrl-C; tests/live/test_live_command.py"
ENDLESS_PAGE = "waits for clicks; tests/batch"
SCHEDULER = "needs a scheduler; tests/batch/test_batch_docs.py"
EXAMPLE = "tests/test_examples.py"
NOT_RUN = {
    r"matchset (learn|track|calibrate|locate) (0\b|http:|rtsp:)": HARDWARE,
    r"matchset radio ": HARDWARE,
    r"matchset fly --camera ": HARDWARE,
    r"matchset preflight ": HARDWARE,
    r"matchset identify serial:": HARDWARE,
    r"matchset live\b": ENDLESS,
    r"matchset batch .*--page": ENDLESS_PAGE,
    r"matchset batch .*--scheduler": SCHEDULER,
    r"cd firmware/|make (flash|isp) ": HARDWARE,
    r"pip install|git clone|cd matchset$": NETWORK,
    r"make (demo|bench|soak|mutants)": LONG,
    r"python -m benchmarks": LONG,
    r"python examples/": EXAMPLE,
    r"matchset track .* --rerun ": "needs Rerun's package, 740 MB; tests/app/viewers/test_viewers.py",
    r"matchset (simulate|warm|demo)\b": LONG,
}
SHORTER = {
    "--duration 10": "--duration 0.4",
    'matchset identify "sim://': 'matchset identify --quick "sim://',
    "matchset fly --config vehicle.toml": "matchset fly --config vehicle.toml --duration 0.2",
    "matchset fly sim://chain ": "matchset fly sim://chain --duration 0.2 ",
    'matchset fly "sim://chain?vehicles=5&seed=7"': 'matchset fly "sim://chain?vehicles=3&seed=7" --duration 0.2',
    '&gust_m_s=0.5" --report': '&gust_m_s=0.5" --duration 0.2 --report',
}
SAME = "matchset learn ball.mp4", "matchset track ball.mp4 --candidate 1@0"  # on many pages: one of them runs these
RUNS_SAME = "cli.md", "getting_started.md"  # what follows there needs what they have made
TABLES = "pandas.md"  # runs with its Python, in tests/test_docs_tasks.py
FAILS = {"--hsv 0,0,0:179,255,255": 1}  # exit codes of lines that show what goes wrong


def rendered(folder: Path, frames: int = 2) -> None:
    """`python examples/render_clip.py`, shorter."""
    write_clip(Clip(frames=frames), folder / "ball.mp4")


def clicked_late(folder: Path) -> None:
    rendered(folder, 61)


def played_for_a_second(folder: Path) -> None:
    rendered(folder, 30)


def sign_and_bag(folder: Path) -> None:
    rendered(folder)
    image = np.full((480, 640, 3), 210, np.uint8)
    turns = np.arange(8) * math.pi / 4.0 + math.pi / 8.0
    corners = np.stack((310.0 + 90.0 * np.cos(turns), 200.0 + 90.0 * np.sin(turns)), axis=1)
    cv2.fillPoly(image, [np.round(16 * corners).astype(np.int32)], (40, 40, 190), cv2.LINE_AA, 4)
    writer = cv2.VideoWriter("sign.mp4", cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (640, 480))
    for _ in range(3):
        writer.write(cv2.GaussianBlur(image, (0, 0), 0.8))
    writer.release()
    bag(folder)
    coins(folder)


def coins(folder: Path) -> None:
    """A photograph of equal discs, two of which touch."""
    image = np.full((480, 640, 3), (150, 170, 180), np.uint8)
    for x, y in ((64, 38), (64, 90), (220, 140), (400, 300), (520, 90)):
        cv2.circle(image, (x, y), 26, (40, 90, 160), -1, cv2.LINE_AA)
    cv2.imwrite(str(folder / "coins.jpg"), cv2.GaussianBlur(image, (0, 0), 0.8))


def bag(folder: Path, kind: str = "ros1") -> None:
    bags.need_rosbags()
    clip = Clip(frames=2)
    background = clip.background()
    types = bags.store(ros1=kind == "ros1")
    frames = [(k * bags.NANO // 30, clip.render(k, background).image) for k in range(len(clip))]
    pictures = [(time, bags.image(types, time, image, "bgr8", image.shape[:2])) for time, image in frames]
    bags.write_bag(folder, kind, [("/cam/image_raw", time, picture) for time, picture in pictures])


def both_bags(folder: Path) -> None:
    bag(folder)
    (folder / "two").mkdir()
    bag(folder / "two", "ros2")
    (written,) = (folder / "two").iterdir()
    shutil.move(written, folder / "flight")
    camera = {"image_width": 640, "image_height": 480, "distortion_model": "plumb_bob"}
    matrix = [540.0, 0.0, 319.5, 0.0, 540.0, 239.5, 0.0, 0.0, 1.0]
    shapes = {"camera_matrix": (3, 3, matrix), "distortion_coefficients": (1, 5, [0.0] * 5)}
    parts = {name: {"rows": rows, "cols": columns, "data": data} for name, (rows, columns, data) in shapes.items()}
    (folder / "camera.yaml").write_text(yaml.safe_dump(camera | parts))
    clip = Clip(frames=1)
    ms.ColorModel.pick(clip.render(0, clip.background()).image, 346, 151).save(folder / "ball.npz")


def two_balls(folder: Path) -> None:
    writer = cv2.VideoWriter("balls.mp4", cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (320, 240))
    for k in range(3):
        image = np.full((240, 320, 3), 90, np.uint8)
        for x, color in ((80 + 5 * k, (200, 60, 30)), (240 - 5 * k, (40, 40, 210))):
            cv2.circle(image, (x, 120), 25, color, -1, cv2.LINE_AA)
        writer.write(image)
    writer.release()


def recorded(folder: Path) -> None:
    both_bags(folder)
    (folder / "flight").rename("recording")


def held_ball(folder: Path) -> None:
    """A ball held at three distances, moved between; its color."""
    camera = ms.CameraModel(width=320, height=240, fx=260.0, fy=260.0, cx=159.5, cy=119.5)

    def place(time: float) -> np.ndarray:
        held, moved = divmod(time, 1.0)
        near, far = ((0.5, 1.0, 1.5, 1.5)[int(held) + k] for k in (0, 1))
        part = max(moved - 0.7, 0.0) / 0.3
        return np.array((0.1 * math.sin(2.0 * math.pi * part), 0.0, near + (far - near) * part + 0.14))

    frames = [frame.image for frame in BallFlightClip(camera=camera, place=place, frames=90)]
    writer = cv2.VideoWriter("ball.mp4", cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (320, 240))
    for image in frames:
        writer.write(image)
    writer.release()
    ms.ColorModel.pick(frames[0], 120, 119).save(folder / "ball.npz")


def many_videos(folder: Path) -> None:
    clips = batched_videos.write_balls(folder / "clips", 2)
    batched_videos.write_color(folder / "ball.npz")
    (folder / "list.txt").write_text("clips/day0/ball0.mp4\n")
    names = sorted(path.name for path in clips.rglob("*.mp4"))
    (folder / "clicks.csv").write_text("video,frame,x,y\n" + "".join(f"{name},0,60,60\n" for name in names))


def nothing(folder: Path) -> None:
    pass


PREPARED: dict[str, Callable[[Path], None]] = {
    "batch.md": many_videos,
    "camera.md": held_ball,
    "cli.md": sign_and_bag,
    "flight.md": nothing,
    "getting_started.md": clicked_late,
    "localization.md": write_flight,
    "meters.md": rendered,
    "own_video.md": played_for_a_second,
    "recording.md": rendered,
    "ros.md": both_bags,
    "ros2.md": recorded,
    "two_balls.md": two_balls,
}


def lines_of(page: Path) -> list[str]:
    """What is typed on a page; where some lines have a prompt, those alone."""
    text = BLOCK.sub("", page.read_text(encoding="utf-8"))
    prompted = re.findall(r"^    \$ (.*)$", text, re.MULTILINE)
    return prompted or TYPED.findall(text)


def reason(line: str) -> str | None:
    return next((why for pattern, why in NOT_RUN.items() if re.match(pattern, line)), None)


def to_run(page: Path) -> list[str]:
    """What of it is run here."""
    lines = [] if page.name == TABLES else [line for line in lines_of(page) if reason(line) is None]
    return lines if page.name in RUNS_SAME else [line for line in lines if line.partition("#")[0].strip() not in SAME]


def shorter(line: str) -> str:
    for typed, instead in SHORTER.items():
        line = line.replace(typed, instead)
    return line


@functools.cache
def searched(height: int, pixels: bytes) -> list[Candidate]:
    """Return the ball-like circles of a picture; many lines look at the same one."""
    return find_candidates(np.frombuffer(pixels, np.uint8).reshape(height, -1, 3))


class Shell:
    """Runs a line as a shell would; commands of matchset in this process.

    Of ball-like circles those are compared that look most like one: the ball of these files is among them.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
        monkeypatch.setattr(choice, "PARAMETERS", choice.BallChoiceParameters(samples=2, looked_at=4, tried=1))
        monkeypatch.setattr(choice, "find_candidates", lambda image: searched(len(image), image.tobytes()))
        monkeypatch.setattr("matchset.batch.run.Processes", batched_videos.HerePool)
        self._monkeypatch, self._capfd = monkeypatch, capfd

    def run(self, line: str) -> tuple[int, str]:
        """Return the exit code and what was printed."""
        if not line.startswith("matchset "):
            here = re.sub("^python ", f"{shlex.quote(sys.executable)} ", line)
            done = subprocess.run(["sh", "-c", here], capture_output=True, text=True, check=False)
            return done.returncode, done.stdout + done.stderr
        words = shlex.split(line, comments=True)
        target = Path(words.pop()) if ">" in words else None
        self._monkeypatch.setattr("sys.argv", [word for word in words if word != ">"])
        self._capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            cli.main()
        out, err = self._capfd.readouterr()
        if target is not None:
            target.write_text(out)
        return int(ended.value.code or 0), out + err


def test_every_page_with_commands_that_can_run_is_run() -> None:
    assert {page.name for page in PAGES if to_run(page)} == set(PREPARED)


def test_what_is_installed_takes_the_place_of_no_checkout() -> None:
    """In the environment that `make demo` made matchset is editable: an installed copy would hide every change."""
    for page in PAGES:
        for paragraph in page.read_text(encoding="utf-8").split("\n\n"):
            for editable, what in re.findall(r"pip install\s+(-e\s+)?('[^']*'|[^\s`]+)", paragraph):
                own = "matchset" in what and "environment" in paragraph
                assert editable or own, (page.name, what)


def test_no_reason_is_left_over() -> None:
    lines = [line for page in PAGES for line in lines_of(page)]
    assert all(any(re.match(pattern, line) for line in lines) for pattern in NOT_RUN)
    assert all(any(typed in line for line in lines) for typed in (*SHORTER, *FAILS))
    for name in RUNS_SAME:
        assert set(SAME) < set(lines_of(ROOT / "docs" / name))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_is_not_run_exists(page: Path) -> None:
    """Targets of make, modules and scripts of the repository; options of matchset: see test_docs.py."""
    makefiles = [ROOT / "Makefile", ROOT / "firmware" / "syma_transmitter" / "Makefile"]
    targets = {name for path in makefiles for name in re.findall(r"^([a-z-]+):", path.read_text(), re.MULTILINE)}
    for line in lines_of(page):
        words = shlex.split(line, comments=True)
        if words[0] == "make":
            assert {word for word in words[1:] if "=" not in word} <= targets, line
        elif words[:2] == ["python", "-m"]:
            assert importlib.util.find_spec(words[2]), line
        elif words[0] == "python":
            assert (ROOT / words[1]).exists(), line


@pytest.mark.parametrize("page", [page for page in PAGES if page.name in PREPARED], ids=lambda page: page.name)
def test_the_commands_of_the_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    PREPARED[page.name](tmp_path)
    shell = Shell(monkeypatch, capfd)
    for line in to_run(page):
        code, said = shell.run(shorter(line))
        assert code == next((code for part, code in FAILS.items() if part in line), 0), f"{line}\n{said}"
