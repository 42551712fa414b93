import csv
from pathlib import Path

import numpy as np
import pytest
from benchmarks.contest.real import pooled_table
from benchmarks.options import Options
from benchmarks.real import failures, scores
from benchmarks.real.clips import Clip, find_clips
from benchmarks.real.detection import Detected, detection_finding, is_right
from benchmarks.real.failures import look_at
from benchmarks.real.following import Follower, Run
from benchmarks.real.foreign import (
    Ball,
    Hunt,
    Tally,
    ball_of,
    differ,
    foreign_finding,
    foreign_table,
    foreign_to,
    frames_each,
    search,
)
from benchmarks.real.gates import examine, is_near
from benchmarks.real.measure import Task, measure
from benchmarks.real.section import run
from benchmarks.real.starts import CLICKS, Start, beginnings, starts_of

import matchset as ms
from matchset.app.films.clip_export import write_clip
from matchset.app.track.score import Circle3, TruthRow, score
from matchset.sim.clips.clip import Clip as RenderedClip

FRAMES, AWAY = 40, (20, 27)
CIRCLE = (100.0, 80.0, 20.0)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as `--data` takes it: one rendered clip that is labelled, one that is not."""
    folder = tmp_path_factory.mktemp("data")
    (folder / "rendered").mkdir()
    clip = RenderedClip(preset="clean", seed=3, width=320, height=240, radii=(10.0, 40.0), frames=FRAMES, away=(AWAY,))
    write_clip(clip, folder / "rendered" / "video.avi", folder / "rendered" / "truth.csv")
    (folder / "unlabelled").mkdir()
    (folder / "unlabelled" / "other.mp4").write_bytes(b"never read")
    return folder


def rendered(data: Path) -> Clip:
    (clip,), _ = find_clips(data, data / "labels")
    return clip


def clip_of(rows: list[TruthRow]) -> Clip:
    return Clip("drawn", Path("drawn.avi"), rows, 200, 160)


def run_of(answers: dict[int, Circle3 | None], click: int = 0, refusal: str = "") -> Run:
    covariances = {frame: np.zeros((3, 3)).tolist() for frame, answer in answers.items() if answer}
    return Run(Start(click, 0, 0, 90.0, 80.0), answers, covariances, refusal)


def test_clips_are_found_and_what_is_missing_is_said(data: Path) -> None:
    clips, skipped = find_clips(data, data / "labels")
    assert [clip.name for clip in clips] == ["rendered"]
    assert (clips[0].width, clips[0].height) == (320, 240)
    assert "`green_ball_hand`: skipped, not found" in skipped
    assert "`other`: skipped, it has no labels" in skipped


def test_labels_of_another_folder_make_an_unlabelled_video_a_clip(data: Path, tmp_path: Path) -> None:
    (tmp_path / "unlabelled").mkdir()
    (tmp_path / "labels").mkdir()
    (tmp_path / "unlabelled" / "ball.mp4").symlink_to(data / "rendered" / "video.avi")
    (tmp_path / "labels" / "ball.csv").symlink_to(data / "rendered" / "truth.csv")
    (tmp_path / "labels" / "gone.csv").write_text("never read")
    clips, skipped = find_clips(tmp_path, tmp_path / "labels")
    assert [clip.name for clip in clips] == ["ball"]
    assert "`gone`: skipped, not found" in skipped


def test_a_clip_of_which_little_is_known_is_skipped(data: Path, tmp_path: Path) -> None:
    (tmp_path / "vague").mkdir()
    (tmp_path / "vague" / "video.avi").symlink_to(data / "rendered" / "video.avi")
    with (tmp_path / "vague" / "truth.csv").open("w", newline="") as file:
        csv.writer(file).writerows(
            [("video", "frame", "x", "y", "r", "visible", "method"), ("v", 3, 100, 80, 20, 1, "eye|lowconf")]
        )
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "truth.csv").write_text("never read")
    clips, skipped = find_clips(tmp_path, tmp_path / "labels")
    assert not clips
    assert "`vague`: skipped, no row of its truth is tight" in skipped
    assert "`empty`: skipped, there is no video beside its truth" in skipped


def test_without_a_folder_the_section_says_so() -> None:
    section = run(Options(data=None))
    assert [finding.verdict for finding in section.findings] == ["-"]
    assert "--data DIR" in section.text


def test_a_clip_is_clicked_in_nine_places_and_three_frames() -> None:
    clip = clip_of([TruthRow(k, CIRCLE) for k in range(30)])
    starts = starts_of(clip)
    assert [row.frame for row in beginnings(clip)] == [0, 10, 20]
    assert len({(start.x, start.y, start.frame) for start in starts}) == 27
    assert starts[0].standard
    assert (starts[0].x, starts[0].y) == (90.0, 80.0)
    away = [np.hypot(x, y) for x, y in CLICKS]
    assert away == pytest.approx([0.5] * 4 + [0.0] + [0.6] * 4)
    assert len(starts_of(clip, quick=True)) == 3


def test_a_start_has_rows_behind_it_and_lies_in_the_picture() -> None:
    few = clip_of([TruthRow(k, CIRCLE) for k in range(9)])
    assert [row.frame for row in beginnings(few)] == [0, 3]
    at_the_border = clip_of([TruthRow(0, (5.0, 80.0, 20.0))])
    assert [start.click for start in starts_of(at_the_border)] == [0, 1, 2, 3, 4, 6, 8]


def test_a_run_that_gives_nothing_counts_as_not_valid() -> None:
    clip = clip_of([TruthRow(k, CIRCLE) for k in range(4)])
    good = run_of(dict.fromkeys(range(4), CIRCLE))
    refused = run_of(dict.fromkeys(range(4)), refusal="refused: too gray")
    figures = {each.name: each.value for each in scores.distribution([(clip, good), (clip, refused)])}
    assert figures["mean valid"] == pytest.approx(50.0)
    assert figures["nothing"] == pytest.approx(50.0)
    assert figures["refused"] == 1


def test_the_goals_are_held_against_the_standard_click() -> None:
    clip = clip_of([TruthRow(k, CIRCLE) for k in range(4)] + [TruthRow(4, None)])
    runs = {"drawn": [run_of(dict.fromkeys(range(5), CIRCLE)), run_of({0: None}, click=1)]}
    together, alone = scores.standard_findings([clip], runs)
    assert together.figure("mean valid").value == pytest.approx(100.0)
    assert together.verdict == alone.verdict == "prize"
    assert alone.figure("far answers").value == 1
    assert scores.answers_on_absent(runs["drawn"][0], clip) == 1


def test_the_label_has_a_variance_of_its_own() -> None:
    clip = clip_of([TruthRow(0, CIRCLE)])
    offsets = scores.offsets_of(run_of({0: (101.0, 80.0, 20.5)}), clip)
    assert offsets.radius == pytest.approx([0.5])
    assert offsets.squares == pytest.approx([(1.0 + 0.25) / scores.LABEL_SIGMA**2])


def test_a_detection_is_right_on_the_ball_and_of_its_size() -> None:
    assert is_right((100.0, 80.0, 24.0), CIRCLE)
    assert not is_right((100.0, 80.0, 26.0), CIRCLE)
    assert is_right((100.0, 80.0, 120.0), (100.0, 80.0, 100.0))
    assert not is_right((103.0, 80.0, 2.0), (100.0, 80.0, 2.0))


def test_recall_is_the_mean_over_clips() -> None:
    clip = clip_of([TruthRow(0, CIRCLE)])
    other = Clip("other", clip.video, clip.truths, 200, 160)
    found = {"drawn": Detected(10, 10, 0, 2, 0), "other": Detected(4, 2, 1, 2, 1)}
    finding = detection_finding([clip, other], found)
    assert finding.figure("recall").value == pytest.approx(75.0)
    assert finding.figure("false").value == 1
    assert finding.verdict == "missed"


def test_a_rendered_clip_is_followed_and_searched(data: Path) -> None:
    clip = rendered(data)
    measured = measure(Task(clip, quick=True))
    assert len(measured.runs) == 3
    standard = scores.standard_of(measured.runs)
    valid = standard.score(clip).valid
    assert valid >= 0.8 * len(clip.tight)  # it leaves the picture at full speed and returns
    assert scores.answers_on_absent(standard, clip) == 0
    assert len(scores.offsets_of(standard, clip).squares) >= valid
    assert measured.detected.shown == len(clip.tight) - 1
    assert measured.detected.right >= 0.8 * measured.detected.shown
    assert measured.detected.absent > 0
    assert measured.detected.false == 0


def test_a_refused_click_is_lost_for_ever(data: Path) -> None:
    clip = rendered(data)
    follower = Follower(Start(0, 0, clip.tight[0].frame, -50.0, 3.0))
    (look, *_) = look_at(clip, follower, data)
    assert look.reason.startswith("refused: pick (-50.0, 3.0)")
    assert look.answer is None


def test_failures_are_drawn(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    failures.main("rendered", data, click=0, start=0, output=tmp_path, every=True)
    shown = capsys.readouterr().out
    assert "rendered: click 0" in shown
    assert "fit from the truth" in shown
    assert "here: yes; present: yes; none: yes" in shown
    assert len(list((tmp_path / "rendered_0_0").glob("*.png"))) == len(rendered(data).truths)


def test_the_place_of_the_ball_is_examined_even_where_nothing_is(data: Path) -> None:
    clip = rendered(data)
    image = np.full((clip.height, clip.width, 3), 90, np.uint8)
    lines = examine(image, ms.ColorModel.hsv((100, 80, 80), (120, 255, 255)), CIRCLE)
    assert "no edges of the target's color" in lines[1]
    assert lines[-1] == "none of 0 candidates is at the true place"
    assert is_near((105.0, 80.0, 15.0), CIRCLE)
    assert not is_near((105.0, 80.0, 8.0), CIRCLE)
    assert not is_near((115.0, 80.0, 20.0), CIRCLE)


def test_everybody_is_compared_over_all_clips_alike() -> None:
    truths = [TruthRow(k, CIRCLE) for k in range(4)]
    whole, half = score(dict.fromkeys(range(4), CIRCLE), truths), score({0: CIRCLE, 1: CIRCLE}, truths)
    nothing = score({}, truths)
    text = pooled_table([{"matchset": whole, "contour_moments": half}, {"matchset": whole, "contour_moments": nothing}])
    assert "**2 clips**, 8 rows" in text
    ours, theirs = (line for line in text.splitlines() if " px |" in line)
    assert ours == "| matchset | 0.000 px | 0.000 px | 100.00 % | 100.00 % | 0.00 % | 0 |"
    assert theirs.endswith("| 0.000 px | 0.000 px | 25.00 % | 0.00 % | 75.00 % | 0 |")


def test_colors_are_foreign_if_their_chroma_differs() -> None:
    color = ms.ColorModel.hsv((0, 80, 80), (10, 255, 255))
    balls = {
        "green": Ball((-0.1, 0.0), 130.0, color),
        "leaf": Ball((-0.3, 0.0), 125.0, color),
        "gray": Ball((0.0, 0.0), -170.0, color),
        "red": Ball((-0.1, 0.3), 40.0, color),
    }
    assert list(foreign_to("green", balls)) == ["red"]
    assert list(foreign_to("leaf", balls)) == ["gray", "red"]
    assert list(foreign_to("red", balls)) == ["green", "leaf", "gray"]
    assert not differ(Ball((0.0, 0.0), 175.0, color), Ball((1.0, 0.0), -175.0, color))


def test_the_color_of_a_disc_is_that_of_its_middle() -> None:
    image = np.full((160, 200, 3), 128, np.uint8)
    rows, columns = np.indices(image.shape[:2])
    image[np.hypot(columns - 100, rows - 80) < 13.0] = (0, 0, 255)
    ball = ball_of(image, CIRCLE, ms.ColorModel.hsv((0, 80, 80), (10, 255, 255)))
    assert ball.chroma == pytest.approx((-0.2516, 0.5901), abs=1e-3)
    assert ball.hue == pytest.approx(40.0, abs=1.0)


def test_as_many_frames_are_searched_as_are_wanted() -> None:
    assert frames_each([(100, 2), (10, 1)], 50) == 20
    assert frames_each([(100, 2), (10, 1)], 1_000) == 100
    assert frames_each([], 10) == 0


def test_a_foreign_color_is_not_found_and_the_own_one_is(data: Path, tmp_path: Path) -> None:
    clip = rendered(data)
    first = next(iter(ms.Video(clip.video)))
    assert clip.tight[0].circle is not None
    x, y, radius = clip.tight[0].circle
    own = ms.ColorModel.pick(first.image, x - 0.5 * radius, y)
    red = ms.ColorModel.hsv((175, 120, 120), (5, 255, 255))
    tallies = search(Hunt("rendered", clip.video, FRAMES, {"own": own, "red": red}, 8, tmp_path))
    assert [tally.searched for tally in tallies] == [8, 8]
    assert len(tallies[0].false) >= 3
    assert not tallies[1].false
    assert len(list(tmp_path.glob("own_in_rendered_*.png"))) == 3


def test_false_locks_are_counted_by_the_thousand() -> None:
    tallies = [Tally("red", "a", 400, []), Tally("red", "b", 600, [7, 8])]
    finding = foreign_finding(tallies)
    assert finding.figure("false per 1,000").value == pytest.approx(2.0)
    assert finding.verdict == "missed"
    assert "b 2 (first: 7)" in foreign_table(tallies)
    assert foreign_finding([]).verdict == "-"


def test_places_of_the_click_are_told_apart() -> None:
    clip = clip_of([TruthRow(k, CIRCLE) for k in range(4)])
    runs = [run_of(dict.fromkeys(range(4), CIRCLE)), run_of({0: CIRCLE}, click=4)]
    line = scores.places_table([clip], {"drawn": runs}).splitlines()[-1]
    assert line == "| drawn | 100 % | - | - | - | 25 % | - | - | - | - | 62 % | - | - |"
