"""Two readings joined into segments, and segments linked: synthetic sightings, whose truth is known."""

import itertools

import numpy as np
import pytest

import matchset as ms
from matchset.tracking.many.linking import LinkingParameters
from matchset.tracking.many.motion_bank import ManyMotionParameters
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.many.smoothing.answers import FrameMoment, answers
from matchset.tracking.many.smoothing.chaining import Chaining, ChainingParameters, best_links
from matchset.tracking.many.smoothing.joining import JoiningParameters, Seen, Segment, segments
from matchset.tracking.many.smoothing.motion_odds import MotionOdds, MotionOddsParameters
from matchset.tracking.many.smoothing.sweep import OwnedSighting
from matchset.tracking.motion import Gate

RADIUS, FPS = 20.0, 30.0
Point = tuple[float, float]


def owned(
    place: Point, frame: int, owner: int, tracklet: int | None = None, certain: bool = True, support: float = 0.9
) -> OwnedSighting:
    """A ball that a reading takes for one of its targets."""
    x, y = place
    track = ms.Track(ms.Circle(x, y, RADIUS), np.eye(3) * 0.01, support, np.zeros((0, 2)), frame / FPS)
    sighting = Sighting(track, Gate(x, y, RADIUS), 1.0, "0")
    return OwnedSighting(sighting, owner, owner if tracklet is None else tracklet, certain)


def left(frame: int) -> Point:
    return 100.0 + 6.0 * frame, 200.0


def right(frame: int) -> Point:
    return 400.0 - 6.0 * frame, 205.0


def chained(parts: list[Segment], frames: int) -> list[list[Seen]]:
    times = [frame / FPS for frame in range(frames)]
    odds = MotionOdds(times, MotionOddsParameters(), ManyMotionParameters(), LinkingParameters())
    return Chaining(times, 2.0, ChainingParameters(), odds).chains(parts, 30)


def joined(forward: list[list[OwnedSighting]], backward: list[list[OwnedSighting]]) -> list[Segment]:
    return segments(forward, backward, JoiningParameters())


def test_what_both_readings_agree_on_is_one_segment_whatever_their_numbers() -> None:
    forward = [[owned(left(k), k, 3), owned(right(k), k, 1)] for k in range(20)]
    backward = [[owned(right(k), k, 0), owned(left(k), k, 5)] for k in range(20)]
    found = joined(forward, backward)
    assert [[each.owners for each in segment.seen] for segment in found] == [[(3, 5)] * 20, [(1, 0)] * 20]


def test_a_reading_that_begins_later_or_misses_some_frames_parts_nothing() -> None:
    forward = [[owned(left(k), k, 0)] if k > 6 else [] for k in range(20)]
    backward = [[owned(left(k), k, 0)] if k not in (10, 11, 15) else [] for k in range(20)]
    (segment,) = joined(forward, backward)
    assert [each.frame for each in segment.seen] == list(range(20))


def test_an_exchange_in_one_reading_parts_both_targets() -> None:
    forward = [[owned(left(k), k, int(k >= 25)), owned(right(k), k, int(k < 25))] for k in range(50)]
    backward = [[owned(left(k), k, 0), owned(right(k), k, 1)] for k in range(50)]
    assert sorted((each.begin, each.end) for each in joined(forward, backward)) == [
        (0, 24),
        (0, 24),
        (25, 49),
        (25, 49),
    ]


def test_of_two_fits_of_one_target_that_with_more_support_is_kept_and_a_far_one_is_another() -> None:
    """One reading has a bad fit, or is somewhere else, in a frame."""
    x, y = left(12)
    for beside in (0.8 * RADIUS, 5.0 * RADIUS):
        forward = [[owned(left(k), k, 0)] for k in range(25)]
        backward = [[owned(left(k) if k != 12 else (x, y + beside), k, 0, support=0.5)] for k in range(25)]
        parts = joined(forward, backward)
        assert len(parts) == (1 if beside < RADIUS else 4)
        (chain,) = chained(parts, 25)
        assert [each.sighting.place[:2] for each in chain] == [left(k) for k in range(25)]


def test_motion_undoes_an_exchange_of_two_that_cross() -> None:
    """Each reading exchanges both where they meet; nothing but how they move says so."""
    meeting = range(20, 30)

    def reading(swaps_at: int) -> list[list[OwnedSighting]]:
        frames = []
        for k in range(50):
            first, tracklet = int(k >= swaps_at), 2 * (k >= 30)
            seen = [owned(left(k), k, first, tracklet), owned(right(k), k, 1 - first, tracklet + 1)]
            frames.append([] if k in meeting else seen)
        return frames

    for forward, backward in ((reading(25), reading(60)), (reading(60), reading(25))):
        for chain in chained(joined(forward, backward), 50):
            side = left if chain[0].sighting.place.x < 250.0 else right
            assert len(chain) == 40
            assert all(each.sighting.place[:2] == side(each.frame) for each in chain)


def test_what_one_reading_alone_saw_for_a_moment_fills_a_gap_or_is_left_out() -> None:
    gap = range(20, 26)
    forward = [[] if k in gap else [owned(left(k), k, int(k > 25))] for k in range(50)]
    backward = [[] if k in gap else [owned(left(k), k, 0)] for k in range(50)]
    backward[22] = [owned(left(22), 22, 7)]
    backward[30].append(owned((600.0, 30.0), 30, 8))
    (chain,) = chained(joined(forward, backward), 50)
    assert [each.frame for each in chain] == [k for k in range(50) if k not in gap or k == 22]


def test_a_target_of_another_color_is_never_a_continuation() -> None:
    first = Segment([seen(left(k), k) for k in range(10)])
    other = [seen(left(k), k) for k in range(12, 22)]
    red = Segment([each._replace(sighting=each.sighting._replace(label="red")) for each in other])
    assert len(chained([first, Segment(other)], 30)) == 1
    assert len(chained([first, red], 30)) == 2


def test_nothing_is_linked_over_more_than_the_memory() -> None:
    first = Segment([seen((100.0, 100.0), k) for k in range(10)])
    for begin, count in ((60, 1), (80, 2)):
        later = Segment([seen((100.0, 100.0), k) for k in range(begin, begin + 10)])
        assert len(chained([first, later], 100)) == count


def seen(place: Point, frame: int, owners: tuple[int, int] = (0, 0)) -> Seen:
    return Seen(frame, owned(place, frame, 0).sighting, owners, owners, True)


@pytest.mark.parametrize("seed", range(8))
def test_links_have_the_largest_sum_that_there_is(seed: int) -> None:
    random = np.random.default_rng(seed)
    count = 4
    links = [
        (a, b, float(random.uniform(0.1, 9.0)))
        for a, b in itertools.combinations(range(count), 2)
        if random.random() < 0.8
    ]
    chosen = best_links(count, links)
    odds = {(a, b): value for a, b, value in links}
    best = 0.0
    for size in range(len(links) + 1):
        for taken in itertools.combinations(links, size):
            begins, ends = [each[0] for each in taken], [each[1] for each in taken]
            if len(set(begins)) == len(begins) and len(set(ends)) == len(ends):
                best = max(best, sum(each[2] for each in taken))
    assert sum(odds[pair] for pair in chosen.items()) == pytest.approx(best)
    assert best_links(3, []) == {}


def test_names_are_those_that_were_given_first_and_none_is_given_twice() -> None:
    moments = [FrameMoment(10 + k, k / FPS) for k in range(6)]
    late = [seen((50.0, 50.0), k, (-1, 0)) for k in range(6)]
    swapped = [seen((150.0, 50.0), k, (int(k >= 3), 1)) for k in range(6)]
    other = [seen((250.0, 50.0), k, (int(k < 3), 2)) for k in range(1, 6)]
    found = answers(moments, [late, swapped, other], [4, 2])
    assert [each.index for each in found] == list(range(10, 16))
    tracks = [[target.track for target in each.targets] for each in found[1:]]
    assert [[round(track.shape.x) for track in each if isinstance(track, ms.Track)] for each in tracks] == [
        [250, 150, 50]
    ] * 5
    assert [[target.identity for target in each.targets] for each in found] == [[4, 5]] + [[2, 4, 5]] * 5
    assert found[0].targets[0].since == 0.0


def test_between_two_sightings_a_target_is_lost_on_the_way_from_one_to_the_other() -> None:
    moments = [FrameMoment(k, k / FPS) for k in range(8)]
    found = answers(moments, [[seen(left(k), k) for k in (1, 2, 6)]], [0])
    assert [len(each.targets) for each in found] == [0, 1, 1, 1, 1, 1, 1, 0]
    for k in (3, 4, 5):
        lost = found[k].targets[0].track
        assert isinstance(lost, ms.Lost)
        assert lost.time == k / FPS
        assert lost.reason == "not seen from 0.07 to 0.20 s"
        assert lost.predicted is not None
        assert (lost.predicted.x, lost.predicted.y) == pytest.approx(left(k))
