from pathlib import Path

import pytest
from benchmarks.real.clips import LABELS
from benchmarks.real.labels.agreement import HEADINGS, agreement, labellings, lines
from benchmarks.real.labels.consensus import LABELLINGS, consensus, merged, text

from matchset.app.track.score import TruthRow, read_truth

LABELLED = [
    TruthRow(0, (10.0, 20.0, 5.0)),
    TruthRow(1, (30.0, 20.0, 6.0)),
    TruthRow(2, (50.0, 20.0, 6.0), lowconf=True),
]


def test_rows_that_both_know_well_are_compared() -> None:
    blind = [TruthRow(0, (11.0, 18.0, 5.5)), TruthRow(1, (33.0, 22.0, 6.5)), TruthRow(2, (50.0, 20.0, 6.0))]
    found = agreement(LABELLED, blind)
    assert found is not None
    assert (found.rows, found.right) == (2, 0.5)
    assert found.medians == pytest.approx((2.0, 2.0, 0.5, 4.5))


def test_without_a_common_row_nothing_is_said(tmp_path: Path) -> None:
    assert agreement(LABELLED, [TruthRow(7, (1.0, 1.0, 1.0))]) is None
    assert agreement(LABELLED, [TruthRow(2, (1.0, 1.0, 1.0))]) is None
    assert lines("nothing", {"truth": LABELLED}, tmp_path) == []


HEADER = "video,frame,x,y,r,visible,method\n"


def test_a_line_has_a_cell_for_each_heading(tmp_path: Path) -> None:
    (tmp_path / "blind" / "again").mkdir(parents=True)
    (tmp_path / "blind" / "a.csv").write_text(f"{HEADER}a.mp4,0,11,20,5,1,blind\n")
    known = labellings("a", LABELLED, tmp_path)
    written = "| a | truth, blind | 1 | 100% | 1.0 | 0.0 | 0.0 | 1.0 |"
    assert lines("a", known, tmp_path) == [f"{written} - | - |"]
    (tmp_path / "blind" / "again" / "a.csv").write_text(f"{HEADER}a.mp4,0,11,22,5,1,blind\n")
    (line,) = lines("a", known, tmp_path)
    assert line == f"{written} 1 | 2.0 |"
    assert line.count("|") == len(HEADINGS) + 1


def test_two_labels_that_agree_make_a_row_tight_and_the_median_is_its_circle() -> None:
    first, near, far = TruthRow(0, (50.0, 50.0, 30.0)), TruthRow(0, (51.0, 52.0, 31.0)), TruthRow(0, (58.0, 50.0, 30.0))
    assert consensus([first, near]) == TruthRow(0, (50.5, 51.0, 30.5))
    assert consensus([first, near, far]) == TruthRow(0, (51.0, 50.0, 30.0))
    assert consensus([first, far]) == TruthRow(0, (50.0, 50.0, 30.0), lowconf=True)


def test_of_small_balls_labels_must_agree_to_a_quarter_of_a_radius() -> None:
    assert consensus([TruthRow(0, (50.0, 50.0, 8.0)), TruthRow(0, (51.9, 50.0, 8.0))]).tight
    assert consensus([TruthRow(0, (50.0, 50.0, 8.0)), TruthRow(0, (52.1, 50.0, 8.0))]).lowconf


def test_two_doubtful_labels_or_one_alone_make_no_tight_row() -> None:
    doubtful = TruthRow(0, (50.0, 50.0, 30.0), lowconf=True)
    assert consensus([doubtful, doubtful]) == doubtful
    assert consensus([doubtful, TruthRow(0, (50.0, 50.0, 30.0))]).tight
    assert consensus([TruthRow(0, (50.0, 50.0, 30.0))]).lowconf
    assert consensus([TruthRow(0, None), doubtful]) == TruthRow(0, None)


@pytest.mark.parametrize("path", sorted(LABELS.glob("*.csv")), ids=lambda path: path.stem)
def test_the_truth_is_the_consensus_of_its_labellings(path: Path) -> None:
    assert path.read_text() == text(path.stem)
    rows = merged(path.stem)
    assert sum(row.tight for row in rows) >= 5
    assert [row.frame for row in rows] == [row.frame for row in read_truth(LABELS / "fitted" / path.name)]


@pytest.mark.parametrize(
    "path",
    [path for kind in LABELLINGS[1:] for path in sorted((LABELS / kind).rglob("*.csv"))],
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)
def test_what_was_labelled_blind_is_a_truth_file_of_rows_that_are_labelled(path: Path) -> None:
    rows = read_truth(path)
    assert rows
    assert all(row.circle is not None for row in rows)
    labels = LABELS / "fitted" / path.name
    if labels.exists():
        visible = {row.frame for row in read_truth(labels) if row.circle is not None}
        assert {row.frame for row in rows} <= visible
