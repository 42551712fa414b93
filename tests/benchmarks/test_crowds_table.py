"""The table of crowds: rows are kept and judged rightly, peers are fed rightly, labels are whole."""

import csv
import io
import json
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.crowds import cases, labelled
from benchmarks.crowds.bars import FEW, PAIRS, bars, clear_balls
from benchmarks.crowds.cases import Case, watched
from benchmarks.crowds.followers import Many, absent, version
from benchmarks.crowds.labelled import LABELS, LabelledClip
from benchmarks.crowds.page import completed, page
from benchmarks.crowds.peers import process
from benchmarks.crowds.peers.client import FedPeer, PeerProcess
from benchmarks.crowds.peers.peer import PEERS, Detection, Named, Peer, Step, stored
from benchmarks.crowds.rows import Kept, Row
from benchmarks.crowds.score import Answer, Score

import matchset as ms


def row(case: Case, follower: str = "matchset", hota: float = 0.95, **other: float) -> Row:
    counts = {name: int(other.get(name, 0)) for name in ("switches", "names", "doubled")}
    return Row(
        case=case,
        follower=follower,
        version=version(follower),
        score=Score(mota=0.8, recall=0.9, renamed=1, close=0.5, hota=hota, idf1=0.9, missed=0.01, false=0.0, **counts),
        right=bool(other.get("right", 1)) if case.scene == "pair" else None,
        median_ms=2.0,
        most_ms=other.get("most_ms", 4.0),
        machine="here",
    )


def test_rows_are_kept_and_those_of_other_versions_are_not(tmp_path: Path) -> None:
    path = tmp_path / "crowds.kept"
    case, other = Case("swarm", 5, 10.0, 200), Case("swarm", 5, 10.0, 201)
    kept = Kept(path)
    kept.add(row(case))
    with path.open("ab") as file:
        file.write(b'{"case": {"scene"\n')
    old = row(other)
    Kept(path).add(
        Row(**{name: getattr(old, name) for name in old.__struct_fields__ if name != "version"}, version="x")
    )
    again = Kept(path)
    assert again.get(case, "matchset") == row(case)
    assert again.get(other, "matchset") is None
    assert again.get(case, "sort") is None


def test_the_best_hota_of_a_crowd_is_bold_and_pairs_have_a_table_of_their_own() -> None:
    rows = [row(Case("swarm", 5, 10.0, 200), key, hota) for key, hota in (("matchset", 0.9), ("sort", 0.8))]
    rows += [row(case, right=k % 2) for k, case in enumerate(PAIRS[:4])]
    text = page(rows, "Here.")
    assert "| swarm, 10 s | 5 | matchset `MultiTracker` | **0.800** | 90.0 | 1.0 | 50.0 | **0.900** |" in text
    assert "| swarm, 10 s | 5 | SORT (trackers 2.6) | **0.800** | 90.0 | 1.0 | 50.0 | 0.800 |" in text
    assert "| matchset `MultiTracker` | 2 of 4 |" in text


def test_real_pixels_come_first_and_rendered_ones_last() -> None:
    scenes = {"swarm": "## Rendered", "physics_box": "## Another renderer", "colloids": "## Real pixels"}
    rows = [row(Case(scene, 5, 0.0 if scene == "colloids" else 3.0, 0)) for scene in scenes]
    text = page(rows, "Here.")
    places = [text.index(title) for title in scenes.values()]
    assert places == sorted(places, reverse=True)
    assert "| colloids | 5 | matchset" in text[places[2] : places[1]]
    assert "## Rendered" not in page(rows[1:], "Here.")


def test_sections_that_are_not_reported_stay_in_the_page() -> None:
    swarm = row(Case("swarm", 5, 3.0, 200))
    colloids = row(Case("colloids", 5, 0.0, 0))
    old = page([swarm, colloids], "Then.", bars([swarm], None))
    new = page([row(Case("colloids", 5, 0.0, 0), hota=0.99)], "Now.")
    text = completed(new, old)
    assert text.startswith(new.rstrip()[: new.index("## ")])
    assert [line for line in text.splitlines() if line.startswith("## ")] == [
        "## Bars",
        "## Real pixels",
        "## Rendered",
    ]
    assert "Then. Seeds 200." in text[text.index("## Rendered") :]
    assert "Now." in text[text.index("## Real pixels") : text.index("## Rendered")]
    assert "0.990" in text
    assert completed(new, "") == new
    assert completed(old, old) == old


def test_crowds_that_report_are_of_seeds_that_are_not_tuned_on() -> None:
    assert {case.seed for case in cases.real() if case.scene.startswith("composed")} == {650, 651}
    assert {case.scene for case in cases.real()} == set(cases.REAL)
    assert {case.scene for case in cases.drawn_otherwise()} == {*cases.EVERY} - {*cases.REAL, *cases.RENDERED}


def test_whole_files_stand_beside_what_was_answered_live_and_are_no_rivals() -> None:
    ten = Case("swarm", 10, 10.0, 200)
    rows = [row(ten, hota=0.93), row(ten, "smooth", 0.97), row(ten, "sort", 0.9), row(PAIRS[0], "smooth", 0.99)]
    live, files = page(rows, "Here.").split("## Whole files")
    assert "smooth" not in live
    assert "| swarm, 10 s | 10 | matchset `MultiTracker` | **0.800** | 90.0 | 1.0 | 50.0 | 0.930 |" in files
    assert "| swarm, 10 s | 10 | the same, `smooth` | **0.800** | 90.0 | 1.0 | 50.0 | **0.970** |" in files
    assert "SORT" not in files
    found = {bar.what: bar for bar in bars(rows, None)}
    assert found["HOTA, 10 balls, swarm; rank"].measured == "0.930, rank 1 of 2"


def test_bars_are_judged() -> None:
    ten = Case("swarm", 10, 10.0, 200)
    rows = [row(ten, hota=0.93), row(ten, "sort", 0.94), row(FEW, switches=1, names=5)]
    rows += [row(case, right=k >= 10) for k, case in enumerate(PAIRS)]
    found = {bar.what: bar for bar in bars(rows, 1.29)}
    assert [bar.reached for bar in found.values()] == [False, True, None, None, True, True, True]
    assert "rank 2 of 2" in found["HOTA, 10 balls, swarm; rank"].measured
    assert not bars([row(ten, doubled=1)], None)[-2].reached
    assert [bar.reached for bar in bars([], None)] == [None] * 6
    assert "not measured" in bars([], None)[0].line()


def test_clear_balls_are_clear() -> None:
    crowd = clear_balls(10, 3)
    assert min(each.visible for k in range(20) for each in crowd.truth(k / 3.0)) > 0.98


def test_a_crowd_is_watched_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cases, "FOLDER", tmp_path / "crowds")
    case = Case("billiards", 2, 0.2, 200)
    first = watched(case)
    assert len(first.found) == len(first.truth) == len(first.seconds) == 6
    assert all(len(found) == 2 for found in first.found)
    monkeypatch.setattr(ms, "detect", None)
    assert watched(case) == first
    seen, said = first.judged([[] for _ in first.truth])
    assert [len(each) for each in seen] == [2] * 6
    assert said == [[]] * 6


def test_a_follower_of_many_answers_with_names() -> None:
    crowd = clear_balls(2, 3)
    color = cases.color_of(crowd)
    follower = Many(color)
    answers: list[Answer] = []
    for frame, _ in list(crowd)[:30]:
        answers = follower.update(frame)
    assert len({each.identity for each in answers}) == 2
    assert follower.seconds > 0.0


class Echo:
    """A process that names what it is fed with by its order."""

    def __init__(self) -> None:
        self.told: list[object] = []

    def ask(self, message: object) -> str:
        self.told.append(message)
        if not isinstance(message, list):
            return "\n"
        return json.dumps([0.25, [[k, *each[:3]] for k, each in enumerate(message)]])


def test_a_peer_is_fed_with_what_was_detected() -> None:
    echo = Echo()
    found: list[list[Detection]] = [[(1.0, 2.0, 3.0, 0.9)], []]
    fed = FedPeer(echo, {"a": 1}, found, [0.5, 0.1])  # type: ignore[arg-type]
    assert fed.answers(0) == [Answer(0, ms.Circle(1.0, 2.0, 3.0))]
    assert fed.seconds == pytest.approx(0.75)
    assert fed.update(ms.Frame(np.zeros((4, 4), np.uint8), 0.1, 1)) == []
    assert echo.told == [{"a": 1}, found[0], []]


def test_the_process_of_a_peer_begins_anew_with_parameters(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    begun = []

    class Counting(Peer):
        def start(self, key: str, parameters: dict[str, object]) -> Step:
            begun.append((key, parameters))

            def step(found: list[Detection]) -> list[Named]:
                return [(len(begun), x, y, r) for x, y, r, _ in found]

            return step

    monkeypatch.setitem(PEERS, "counting", Counting("", "", "", {}))
    lines = [{"a": 1}, [[1.0, 2.0, 3.0, 0.5]], {"a": 2}, [[4.0, 5.0, 6.0, 0.5]]]
    monkeypatch.setattr(sys, "stdin", io.StringIO("".join(json.dumps(line) + "\n" for line in lines)))
    process.main("counting")
    said = capsys.readouterr().out.splitlines()
    assert begun == [("counting", {"a": 1}), ("counting", {"a": 2})]
    assert [said[0], said[2]] == ["", ""]
    assert [json.loads(said[k])[1] for k in (1, 3)] == [[[1, 1.0, 2.0, 3.0]], [[2, 4.0, 5.0, 6.0]]]
    monkeypatch.setattr(sys, "stdin", io.StringIO("[]\n"))
    with pytest.raises(ValueError, match="before parameters"):
        process.main("counting")


def test_parameters_that_are_stored_are_among_those_that_were_tried() -> None:
    for key, one in PEERS.items():
        assert stored(key).keys() == one.choices.keys()
        assert all(value in one.choices[name] for name, value in stored(key).items())


def test_a_peer_that_is_not_installed_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(PEERS, "sort", PEERS["sort"]._replace(environment="nowhere"))
    assert "make bench-crowds" in absent("sort")
    with pytest.raises(FileNotFoundError, match="nowhere"):
        PeerProcess("sort")


def test_a_peer_that_does_not_answer_is_killed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    program = tmp_path / "bin" / "python"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\nexec sleep 60\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setitem(PEERS, "sort", PEERS["sort"]._replace(environment=str(tmp_path)))
    one = PeerProcess("sort", patience=0.2)
    with pytest.raises(TimeoutError, match=r"SORT .* not answered for 0\.2 s"):
        one.ask({})
    one.close()


@pytest.mark.parametrize("key", PEERS)
def test_peers_keep_names_of_balls_that_fly_apart(key: str, request: pytest.FixtureRequest) -> None:
    if absent(key):
        pytest.skip(f"{PEERS[key].name}: {absent(key)}")
    one = PeerProcess(key)
    request.addfinalizer(one.close)
    found: list[list[Detection]] = [
        [(100.0 + 3 * k, 100.0, 20.0, 0.95), (400.0 - 3 * k, 300.0, 20.0, 0.95)] for k in range(9)
    ]
    fed = FedPeer(one, stored(key), found, [0.0] * 9)
    answers = [fed.answers(k) for k in range(9)]
    assert len(answers[-1]) == 2
    assert {each.identity for each in answers[-1]} == {each.identity for each in answers[5]}
    assert min(abs(each.circle.x - 124.0) for each in answers[-1]) < 3.0


@pytest.mark.parametrize("name", ["mire_lifted", "mire_turned"])
def test_labels_are_whole_and_move_little(name: str) -> None:
    with (LABELS / f"{name}.csv").open(encoding="utf-8") as file:
        rows = [
            (int(line["frame"]), int(line["identity"]), *map(float, list(line.values())[2:]))
            for line in csv.DictReader(file)
        ]
    frames = sorted({each[0] for each in rows})
    assert len(frames) > 15
    assert np.diff(frames).max() == 5
    at = np.array([[each[2:] for each in rows if each[0] == frame] for frame in frames])
    assert at.shape == (len(frames), 5, 3)
    assert [each[1] for each in rows] == [0, 1, 2, 3, 4] * len(frames)
    assert np.abs(np.diff(at, axis=0)).max() < 20.0
    assert (at[:, :4, 2].max(axis=1) < 1.6 * at[:, :4, 2].min(axis=1)).all()
    assert (at[:, 4, 2] > 2.0 * at[:, :4, 2].max(axis=1)).all()


def test_a_clip_is_read_with_its_labels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(labelled.VARIABLE, str(tmp_path))
    with pytest.raises(FileNotFoundError, match="visp-images-data"):
        LabelledClip("mire_turned")
    (tmp_path / labelled.SEQUENCE).mkdir()
    clip = LabelledClip("mire_turned")
    assert clip.seconds == pytest.approx(81 / 25)
    with pytest.raises(FileNotFoundError, match="0060"):
        next(iter(clip))
    picture = np.full((2, 3), 77, np.uint8)
    for number in (60, 61):
        (tmp_path / labelled.SEQUENCE / f"image.{number:04d}.pgm").write_bytes(b"P5 3 2 255\n" + picture.tobytes())
    read = iter(clip)
    frame, seen = next(read)
    assert np.array_equal(frame.image, picture)
    assert seen is not None
    assert [each.visible for each in seen] == [1.0, 1.0, 1.0, 1.0, 0.0]
    assert next(read)[1] is None


def test_colloids_are_one_crowd_of_gray_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MATCHSET_REAL_DATA", str(tmp_path))
    with pytest.raises(FileNotFoundError, match="MATCHSET_REAL_DATA"):
        LabelledClip("colloids")
    place = tmp_path / "colloids_brightfield"
    place.mkdir()
    clip = LabelledClip("colloids")
    assert clip.seconds == pytest.approx(36 / 25)
    cv2.imwrite(str(place / "bf_0000.png"), np.full((500, 500), 141, np.uint8))
    frame, seen = next(iter(clip))
    assert frame.image.shape == (500, 500)
    assert seen is not None
    assert [each.visible for each in seen] == [1.0] * 5
    assert cases.cases(["colloids"], [9], 3.0, (200, 201)) == [Case("colloids", 5, 0.0, 0)]
