import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.app.track.rows import TrackRow
from matchset.app.track.score import (
    Circle3,
    Score,
    TruthRow,
    circles,
    error_px,
    print_score,
    score,
    score_lines,
    score_text,
)


def test_a_hand_worked_example() -> None:
    truths = [
        TruthRow(0, (10.0, 10.0, 5.0)),  # exact
        TruthRow(1, (10.0, 10.0, 5.0)),  # off by 1 in x
        TruthRow(2, (10.0, 10.0, 5.0)),  # off by 1 in x and 2 in r
        TruthRow(3, (10.0, 10.0, 5.0)),  # 6 px away: not valid, and a false lock
        TruthRow(4, (10.0, 10.0, 5.0)),  # lost
        TruthRow(5, (10.0, 10.0, 5.0), lowconf=True),  # lost, known badly
        TruthRow(6, None),  # answered: a false lock
        TruthRow(7, None),  # rightly silent
    ]
    answers: dict[int, Circle3 | None] = {
        0: (10.0, 10.0, 5.0),
        1: (11.0, 10.0, 5.0),
        2: (11.0, 10.0, 7.0),
        3: (10.0, 16.0, 5.0),
        4: None,
        6: (99.0, 99.0, 5.0),
    }
    result = score(answers, truths)
    assert (result.visible, result.tight, result.absent, result.answered) == (6, 5, 2, 4)
    assert result.mean_error_px == pytest.approx((0 + 1 + 3 + 6) / 4)
    assert result.median_error_px == pytest.approx(2.0)
    assert (result.valid, result.lost) == (3, 2)
    assert result.valid_percent == pytest.approx(60.0)
    assert result.lost_percent == pytest.approx(100 * 2 / 6)
    assert result.false_locks == 2
    # e: (0,0,0) (1,0,0) (1,0,2) (0,6,0): steps of 1, 2 and 1 + 6 + 2
    assert result.trembling_px == pytest.approx((1 + 2 + 9) / 3)
    # second differences: (-1,0,2) and (-1,6,-4)
    assert result.jitter_px == pytest.approx(math.sqrt((1 + 4 + 1 + 36 + 16) / 2))


def test_what_cannot_be_told_is_none() -> None:
    nothing = score({}, [])
    assert nothing.mean_error_px is nothing.valid_percent is nothing.lost_percent is nothing.trembling_px is None
    sparse = score(
        {0: (1.0, 1.0, 1.0), 9: (1.0, 1.0, 1.0)}, [TruthRow(0, (1.0, 1.0, 1.0)), TruthRow(9, (1.0, 1.0, 1.0))]
    )
    assert sparse.mean_error_px == 0.0
    assert sparse.trembling_px is sparse.jitter_px is None


def test_frames_before_the_start_do_not_count() -> None:
    truths = [TruthRow(0, (1.0, 1.0, 1.0)), TruthRow(60, (1.0, 1.0, 1.0))]
    result = score({60: (1.0, 1.0, 1.0)}, truths, start=60)
    assert (result.visible, result.lost, result.valid_percent) == (1, 0, 100.0)


def test_an_error_of_exactly_five_is_not_valid() -> None:
    assert score({0: (5.0, 0.0, 9.0)}, [TruthRow(0, (0.0, 0.0, 9.0))]).valid == 0


def test_rows_become_answers() -> None:
    rows = [TrackRow(0, 0.0, reason="gone"), TrackRow(1, 0.1, shape={"x": 1.0, "y": 2.0, "radius": 3.0})]
    assert circles(rows) == {0: None, 1: (1.0, 2.0, 3.0)}
    assert error_px((1.0, 2.0, 3.0), (2.0, 0.0, 3.5)) == pytest.approx(3.5)


small = st.integers(-3, 3).map(float)
truth_circles = st.none() | st.tuples(small, small, st.integers(1, 4).map(float))
tables = st.dictionaries(st.integers(0, 12), st.tuples(truth_circles, st.booleans(), truth_circles, st.booleans()))


@given(tables)
def test_score_agrees_with_a_naive_twin(
    table: dict[int, tuple[Circle3 | None, bool, Circle3 | None, bool]],
) -> None:
    truths = [TruthRow(frame, circle, low) for frame, (circle, low, _, _) in table.items()]
    answers = {frame: answer for frame, (_, _, answer, present) in table.items() if present}
    _assert_like_the_naive_one(score(answers, truths), answers, truths)


def _assert_like_the_naive_one(result: Score, answers: dict[int, Circle3 | None], truths: list[TruthRow]) -> None:
    errors, offsets = [], {}
    valid = tight = visible = lost = locks = 0
    for truth in truths:
        answer, circle = answers.get(truth.frame), truth.circle
        if circle is None:
            locks += answer is not None
            continue
        visible += 1
        tight += not truth.lowconf
        if answer is None:
            lost += 1
            continue
        locks += math.sqrt((answer[0] - circle[0]) ** 2 + (answer[1] - circle[1]) ** 2) > circle[2]
        if truth.lowconf:
            continue
        offsets[truth.frame] = [a - c for a, c in zip(answer, circle, strict=True)]
        errors.append(sum(abs(d) for d in offsets[truth.frame]))
        valid += errors[-1] < 5
    steps = [
        sum(abs(b - a) for a, b in zip(offsets[f], offsets[f + 1], strict=True)) for f in offsets if f + 1 in offsets
    ]
    bends = [
        sum((a - 2 * b + c) ** 2 for a, b, c in zip(offsets[f], offsets[f + 1], offsets[f + 2], strict=True))
        for f in offsets
        if f + 1 in offsets and f + 2 in offsets
    ]
    assert (result.visible, result.tight, result.answered) == (visible, tight, len(errors))
    assert (result.valid, result.lost, result.false_locks) == (valid, lost, locks)
    assert result.mean_error_px == (pytest.approx(sum(errors) / len(errors)) if errors else None)
    assert result.trembling_px == (pytest.approx(sum(steps) / len(steps)) if steps else None)
    assert result.jitter_px == (pytest.approx(math.sqrt(sum(bends) / len(bends))) if bends else None)


EXACT: dict[int, Circle3 | None] = dict.fromkeys(range(300), (1.0, 1.0, 1.0))
WHOLE = score(EXACT, [TruthRow(frame, circle) for frame, circle in EXACT.items()])
EMPTY = score({}, [TruthRow(0, None)])
SPARSE = score(EXACT, [TruthRow(frame, (1.0, 1.0, 2.0)) for frame in (0, 5, 9)])


@pytest.mark.parametrize("result", [WHOLE, EMPTY, SPARSE], ids=["whole", "empty", "sparse"])
@pytest.mark.parametrize("width", [30, 40, 60, 80, 200])
def test_a_narrow_terminal_breaks_no_word(result: Score, width: int) -> None:
    lines = score_lines(result)
    text = [figure + rest for figure, rest in score_text(lines, width)]
    assert all(len(line) <= width for line in text)
    assert not [line for line in text if line != line.rstrip()]
    assert " ".join(text).split() == " ".join(" ".join(line) for line in lines).split()


def test_a_dash_says_why() -> None:
    words = {name: (value, why) for name, value, why in score_lines(SPARSE)}
    assert words["trembling"] == ("-", "needs two answered frames with truth in a row")
    assert words["jitter"] == ("-", "needs three answered frames with truth in a row")
    words = {name: (value, why) for name, value, why in score_lines(EMPTY)}
    assert words["mean error"] == ("-", "the truth has no exact circle")
    (_, _, why), *_ = score_lines(score({}, [TruthRow(0, (1.0, 1.0, 2.0))]))
    assert why == "none of 1 frames was answered"


def test_a_printed_score_has_no_blanks_at_its_ends(capsys: pytest.CaptureFixture[str]) -> None:
    print_score(WHOLE)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 8
    assert not [line for line in lines if line != line.rstrip()]
