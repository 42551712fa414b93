"""The guard of real footage and of time: what is kept comes back, what is worse is said, nothing limits a clock."""

import math
import os
from pathlib import Path

import msgspec
import numpy as np
import pytest
from benchmarks.real.clips import Clip
from benchmarks.regression import footage, raised, run, times
from benchmarks.regression.clock import Clocked, Task, load, measure
from benchmarks.regression.figures import COUNT, ERROR, INFORMATION, KINDS, ROW, TAIL, Figure
from benchmarks.regression.footage import follow_nine, measure_nine, measure_standard, search_figures, seek
from benchmarks.regression.kept import KEPT, Kept, Origin, missing, read, unknown, worse, write
from benchmarks.regression.page import PAGE, by_subject, markdown
from benchmarks.regression.sections import SECTIONS, chosen
from rich.console import Console

import matchset as ms
from matchset.app.films.clip_export import write_clip
from matchset.app.track.score import read_truth
from matchset.sim.clips.clip import Clip as RenderedClip

WHERE = "standard click", "drawn"
ORIGIN = Origin("2026-11-26 22:00 UTC", "079a084", 'a "machine", 2 cores', 12.0)
FRAMES, AWAY = 24, (14, 20)


def figure(name: str, value: float | None) -> Figure:
    kind = {"valid, %": ROW, "mean error, px": ERROR, "wall 99 %, ms": TAIL, "lost pictures": INFORMATION}
    return Figure.of(WHERE, name, value, kind.get(name, COUNT), noise=2.5 if name == "valid, %" else None)


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Clip:
    folder = tmp_path_factory.mktemp("clip")
    made = RenderedClip(preset="clean", seed=3, width=320, height=240, radii=(10.0, 40.0), frames=FRAMES, away=(AWAY,))
    write_clip(made, folder / "a.avi", folder / "a.csv")
    return Clip("drawn", folder / "a.avi", read_truth(folder / "a.csv"), 320, 240)


@pytest.mark.parametrize(
    ("name", "kept", "good", "bad"),
    [
        ("valid, %", 95.0, 92.5, 92.4),
        ("mean error, px", 1.0, 1.15, 1.16),
        ("wall 99 %, ms", 10.0, 15.1, 15.2),
        ("lost", 3.0, 4.0, 5.0),
        ("lost pictures", 3.0, 300.0, math.nan),
    ],
)
def test_noise_passes_and_what_is_worse_does_not(name: str, kept: float, good: float, bad: float) -> None:
    before = figure(name, kept)
    assert before.passes(good)
    assert not before.passes(bad)


def test_slack_is_for_times_alone() -> None:
    assert figure("wall 99 %, ms", 10.0).passes(30.0, slack=2.0)
    assert not figure("mean error, px", 1.0).passes(1.3, slack=2.0)


def test_what_could_not_be_measured_is_worse_unless_it_never_could() -> None:
    assert not figure("mean error, px", 1.0).passes(math.nan)
    assert figure("mean error, px", None).passes(math.nan)


def test_what_is_kept_comes_back(tmp_path: Path) -> None:
    figures = [figure("valid, %", 97.5), figure("lost", 3.0), figure("lost pictures", 0.5)]
    kept = Kept({"standard": ORIGIN}, figures)
    write(kept, tmp_path / "kept.toml")
    assert read(tmp_path / "kept.toml") == kept
    assert read(tmp_path / "none.toml") == Kept({}, [])
    write(Kept({"standard": ORIGIN}, [figure("mean error, px", None)]), tmp_path / "kept.toml")
    assert math.isnan(read(tmp_path / "kept.toml").figure[0].value)


def test_worse_new_and_missing_figures_are_said() -> None:
    kept = Kept({"standard": ORIGIN}, [figure("valid, %", 97.5), figure("lost", 3.0)])
    assert worse([figure("valid, %", 96.0)], kept) == []
    (said,) = worse([figure("valid, %", 90.0)], kept)
    assert said == "standard click: drawn: valid, %: 90.000, kept 97.500, passes to 95.000"
    assert "is not kept" in worse([figure("mean error, px", 1.0)], kept)[0]
    assert missing([figure("valid, %", 96.0)], kept, ["standard click"]) == [
        "standard click: drawn: lost: is kept but was not measured"
    ]
    assert missing([], kept, ["detect"]) == []
    other = Figure.of(("detect", "drawn"), "false", 9, COUNT)
    assert worse([other], kept) == []
    assert "detect: nothing is kept of it yet" in unknown([other], kept)[0]


def test_a_section_is_replaced_as_a_whole() -> None:
    other = Figure.of(("detect", "drawn"), "false", 0, COUNT)
    kept = Kept({"standard": ORIGIN}, [figure("valid, %", 97.5), figure("lost", 3.0), other])
    new = kept.without("standard", ("standard click",)).replaced({"standard": ORIGIN}, [figure("valid, %", 99.0)])
    assert [each.key for each in new.figure] == [other.key, figure("valid, %", 99.0).key]


def test_the_page_is_that_of_what_is_kept() -> None:
    assert PAGE.read_text(encoding="utf-8") == markdown(read()), "`make bench-real ARGS=--store` writes both"
    keys = [each.key for each in read(KEPT).figure]
    assert len(keys) == len(set(keys))
    assert set(read(KEPT).sections) <= set(SECTIONS)


def test_a_table_has_a_row_for_each_clip() -> None:
    other = Figure.of(("standard click", "other"), "lost", 2, COUNT)
    lines = by_subject([figure("valid, %", 97.54), figure("lost", 3.0), other]).splitlines()
    assert lines[0] == "|  | valid, % | lost |"
    assert lines[2:] == ["| drawn | 97.5 | 3 |", "| other | - | 2 |"]


def test_every_kind_of_noise_has_a_reason() -> None:
    assert all(kind.why and kind.factor >= 1.0 and kind.noise >= 0.0 for kind in KINDS)


def test_parts_are_chosen_by_name() -> None:
    assert chosen() == list(SECTIONS)
    assert "time" not in chosen("accuracy")
    assert chosen("time") == ["time"]
    assert chosen(quick=True) == ["standard", "small", "stills", "time"]
    assert chosen(quick=True, clips=False) == ["small"]
    assert chosen("videos,shapes", photographs=False) == ["shapes"]
    with pytest.raises(ValueError, match=r"choose accuracy, time or some of .*, got speed"):
        chosen("speed")


def test_the_environment_of_a_clock_limits_no_threads() -> None:
    limits = {"OMP_NUM_THREADS": "1", "OPENCV_FOR_THREADS_NUM": "1", "NUMBA_NUM_THREADS": "1"}
    assert times.unlimited(limits | {"PATH": "/bin"}) == {"PATH": "/bin"}


def test_the_least_time_of_each_picture_counts() -> None:
    runs = [[(5, 1, 1), (9, 2, 2)], [(7, 3, 3), (4, 1, 1)]]
    np.testing.assert_allclose(times.least(runs) * 1e6, [[5, 1, 1], [4, 1, 1]])


def test_a_quantile_is_a_time_that_was_measured() -> None:
    values = np.arange(1.0, 201.0)
    assert [times.quantile(values, share) for share in (0.5, 0.9, 0.99, 1.0)] == [101.0, 181.0, 199.0, 200.0]


def test_figures_of_a_clip_beside_busy_processes_do_not_hang_on_the_wall() -> None:
    found = Clocked([(4, 2, 2)], [[(10**6, 10**6, 2 * 10**6)] * 3], [10**5] * 3, 1)
    figures = {each.name: each for each in times.figures_of(WHERE, found, wall_decides=False)}
    assert figures["all threads / own"].value == pytest.approx(2.0)
    assert figures["wall worst, ms"].limit() == math.inf
    assert figures["thread 99 %, ms"].limit() == pytest.approx(1.6)
    assert figures["conversion, ms"].value == pytest.approx(0.1)


def test_busy_processes_end() -> None:
    with times.busy(1) as numbers:
        os.kill(numbers[0], 0)
    with pytest.raises(ProcessLookupError):
        os.kill(numbers[0], 0)


def test_a_ball_that_leaves_for_good_is_cut_from_a_clip(clip: Clip) -> None:
    task = times.gone(clip, runs=1)
    absent = {row.frame for row in clip.truths if row.circle is None}
    assert len(task.pictures) == times.PICTURES
    assert set(task.pictures[times.SHOWN :]) == absent
    with pytest.raises(ValueError, match="drawn has no row without the ball"):
        times.gone(Clip("drawn", clip.video, clip.tight, 320, 240))


def test_a_clip_is_clocked(clip: Clip) -> None:
    task = times.task_of(clip, runs=2)
    short = Task(task.video, [*task.pictures[:5], 17, 17], task.click, 2)
    assert msgspec.json.decode(msgspec.json.encode(short), type=Task) == short
    frames = load(short)
    assert [frame.index for frame in frames] == list(range(7))
    found = measure(short)
    assert np.shape(found.update) == (2, 7, 3)
    assert found.lost >= 1
    assert min(found.conversion) > 0


def test_a_clip_is_looked_at(clip: Clip, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(footage, "FOLLOWED", 4)
    figures = {each.key: each.value for each in (*measure_standard([clip]), *measure_nine([clip]))}
    assert figures["standard click", "drawn", "valid, %"] == 100.0
    assert figures["standard click", "all", "least valid, %"] == 100.0
    assert figures["nine clicks", "drawn", "mean valid, %"] > 80.0
    assert len(follow_nine(clip).scores) == 9
    seeker = seek(clip)
    searched = {each.name: each.value for each in search_figures("drawn", seeker.detected())}
    assert searched["right, %"] > 50.0
    assert searched["false"] == 0.0


def test_exceptions_are_counted_and_named(clip: Clip, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise IndexError("out of bounds")

    frame = load(times.task_of(clip, 1))[0]
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *times.task_of(clip).click))
    monkeypatch.setattr(ms.Tracker, "update", broken)
    with raised.counted() as found:
        assert isinstance(tracker.update(frame), ms.Lost)
        with pytest.raises(ValueError, match="does not lie in"):
            ms.ColorModel.pick(frame.image, -5.0, 1.0)  # a refusal
    assert [each.words.split(" (")[0] for each in found] == ["update: IndexError: out of bounds"]
    assert "in broken" in found[0].place
    with pytest.raises(IndexError):
        tracker.update(frame)


def test_without_clips_the_fast_part_says_so_and_measures_what_is_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured: list[str] = []

    def nothing(name: str, *_: object) -> tuple[list[Figure], Origin]:
        measured.append(name)
        return [], ORIGIN

    monkeypatch.setattr(run, "measure", nothing)
    console = Console(record=True, width=200)
    assert run.fast_part(console, tmp_path, 1.0) == 0
    assert f"real footage: not measured, no clips in {tmp_path}" in console.export_text()
    assert measured == ["small"]


def test_the_exit_code_says_whether_something_is_worse() -> None:
    console, kept = Console(record=True, width=200), Kept({"standard": ORIGIN}, [figure("valid, %", 97.5)])
    assert run.verdict(console, [figure("valid, %", 97.5)], kept, 1.0) == 0
    assert run.verdict(console, [figure("valid, %", 90.0)], kept, 1.0) == 1
    assert "passes to 95.000" in console.export_text()
