import numpy as np
import pytest
from benchmarks.contest.accuracy import first_finding, scored, valid_finding, waits_of
from benchmarks.contest.search import loss_px
from benchmarks.contest.speed import rival_finding
from benchmarks.contest.tags import TagClip
from benchmarks.guard import read, too_much
from benchmarks.peers.tags import ARUCO
from benchmarks.tracking.stopwatch import Contender, Times, time_in_pairs
from benchmarks.tracking.trial import WHAT, Trial, sequence

import matchset as ms
from matchset.app.track.score import Circle3, TruthRow


def trial(answers: list[Circle3 | None], hidden: tuple[int, ...] = ()) -> Trial:
    truths = [TruthRow(k, None if k in hidden else (50.0, 50.0, 20.0)) for k in range(len(answers))]
    return Trial(0, truths, answers, [])


def off(error: float) -> Circle3:
    return 50.0 + error, 50.0, 20.0


def times(us: float) -> Times:
    return Times(np.full(3, int(us * 1e3)), np.arange(3), 0)


def test_a_loss_counts_what_is_not_answered_and_does_not_run_away() -> None:
    assert loss_px([trial([off(1.0), off(100.0), None])]) == pytest.approx((1.0 + 5.0 + 5.0) / 3.0)
    assert loss_px([trial([off(1.0), None], hidden=(1,))]) == pytest.approx(1.0)


def test_only_peers_that_always_answer_are_compared_in_accuracy() -> None:
    runs = {
        "matchset": trial([off(0.3)] * 4),
        "always": trial([off(0.2)] * 4),
        "sometimes": trial([off(0.0), None, off(0.0), off(0.0)]),
    }
    finding = first_finding(scored({"clean": [runs]}))
    assert finding.figure("difference").value == pytest.approx(0.1)
    assert finding.verdict == "missed"


def test_the_lead_in_valid_frames_is_the_least_of_three() -> None:
    ours, theirs = trial([off(0.1)] * 4), trial([off(0.1), off(0.1), off(0.1), None])
    results = {name: [{"matchset": ours, "other": theirs}] for name in ("occlusion", "clutter", "light")}
    assert valid_finding(scored(results)).verdict == "prize"
    results["light"] = [{"matchset": theirs, "other": ours}]
    finding = valid_finding(scored(results))
    assert finding.figure("lead").value == pytest.approx(-25.0)
    assert finding.verdict == "missed"


def test_the_worst_radius_decides_about_speed() -> None:
    races = {
        20: {"matchset": times(50.0), "region_bgr": times(45.0)},
        120: {"matchset": times(60.0), "region_bgr": times(240.0)},
    }
    finding = rival_finding(races, rival_valid=100.0)
    assert finding.figure("ratio").value == pytest.approx(0.9)
    assert finding.verdict == "missed"


def test_frames_until_found_again() -> None:
    run = trial([off(0.0), None, None, off(9.0), off(0.1), off(0.1)], hidden=(1, 2))
    assert waits_of(run, ((1, 3),)) == [2]
    assert waits_of(trial([off(0.0), None, None, None], hidden=(1, 2)), ((1, 3),)) == [None]


def test_everybody_meets_every_frame_in_changing_order() -> None:
    frames = [ms.Frame(np.full((16, 16, 3), k, np.uint8), float(k), k) for k in range(6)]
    seen: list[tuple[str, int]] = []

    def contender(name: str) -> Contender:
        return Contender(name=name, frames=frames, begin=lambda: lambda frame: seen.append((name, frame.index)))

    result = time_in_pairs([contender("a"), contender("b")], laps=20, warm_up=0)
    assert len(result["a"].ns) == 120
    assert [index for name, index in seen if name == "b"] == list(range(6)) * 20
    pairs = {(seen[k][0], seen[k + 1][0]) for k in range(0, len(seen), 2)}
    assert pairs == {("a", "b"), ("b", "a")}
    assert all(seen[k][1] == seen[k + 1][1] for k in range(0, len(seen), 2))
    assert result["a"].misses == 120  # None is no answer


def test_idle_time_does_not_count() -> None:
    clock = iter(range(0, 10**12, 10**9))
    frames = [ms.Frame(np.zeros((16, 16, 3), np.uint8), float(k), k) for k in range(2)]
    begin = lambda: lambda frame: frame  # noqa: E731
    slow = Contender(name="slow", frames=frames, begin=begin, idle=lambda: next(clock))
    assert time_in_pairs([slow], laps=1, warm_up=0)["slow"].ns.max() < 0


LIMITS = """
[times]
"a" = 0.1
[accuracy]
"b, px" = 0.2
"c, %" = 0.0
"""


def test_a_loss_of_more_than_a_quarter_is_too_much() -> None:
    limits = {limit.name: limit for limit in read(LIMITS)}
    assert limits["a"].most == pytest.approx(0.125)
    good = {"a": 0.124, "b, px": 0.249, "c, %": 0.4}
    assert too_much(good, limits) == []
    assert len(too_much({"a": 0.126, "b, px": 0.251, "c, %": 0.6}, limits)) == 3
    assert len(too_much(good | {"b, px": float("nan")}, limits)) == 1


def test_slack_is_for_times_only() -> None:
    limits = {limit.name: limit for limit in read(LIMITS, slack=2.0)}
    assert limits["a"].most == pytest.approx(0.25)
    assert limits["b, px"].most == pytest.approx(0.25)


def test_a_figure_without_a_limit_and_a_limit_without_a_figure_are_told() -> None:
    limits = {limit.name: limit for limit in read(LIMITS)}
    words = too_much({"a": 0.1, "new": 1.0}, limits)
    assert len(words) == 3
    assert any("new" in word for word in words)


def test_every_sequence_can_be_built() -> None:
    for name in WHAT:
        clip = sequence(name, 5, 130)
        assert len(clip) == 130
        assert clip.ball == (name != "empty")
    with pytest.raises(ValueError, match="nonsense"):
        sequence("nonsense", 0)


def test_a_card_lies_where_its_truth_says() -> None:
    clip = TagClip(sequence("clean", 4, 1, radii=(60.0, 60.0)), ARUCO)
    frame, truth = next(iter(clip))
    assert truth.circle is not None
    x, y, r = truth.circle.x, truth.circle.y, truth.circle.radius
    height, width = frame.image.shape[:2]
    rows, columns = np.mgrid[:height, :width]
    white = (frame.image.min(axis=2) > 225) & (np.hypot(columns - x, rows - y) < 1.5 * r)
    black = (frame.image.max(axis=2) < 30) & (np.hypot(columns - x, rows - y) < 1.5 * r)
    card = white | black
    assert columns[card].mean() == pytest.approx(x, abs=3.0)
    assert rows[card].mean() == pytest.approx(y, abs=3.0)
    assert np.count_nonzero(card) == pytest.approx(4.0 * r * r, rel=0.15)
