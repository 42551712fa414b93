"""The benchmark of batches: its model of many workers, and what it counts."""

import math

import msgspec
import numpy as np
import pytest
from benchmarks.batch.batches import Ran
from benchmarks.batch.kept import Kept
from benchmarks.batch.killed import Kill, Killed
from benchmarks.batch.overhead import Overhead, Pair
from benchmarks.batch.page import page
from benchmarks.batch.simulation.basis import Basis, basis_of, slowdown
from benchmarks.batch.simulation.many import Point, growth, knee, tails
from benchmarks.batch.simulation.predicted import predict
from benchmarks.batch.simulation.simulate import Cluster, Task, simulate
from benchmarks.batch.simulation.tables import simulation_part
from benchmarks.batch.speed import Round, Speed
from benchmarks.batch.split import Differences, Split, differences
from benchmarks.batch.tasks import Cost, Costs

ONE = [Task(1.0)] * 12


@pytest.mark.parametrize(("workers", "seconds"), [(1, 12.0), (2, 6.0), (5, 3.0), (12, 1.0), (20, 1.0)])
def test_processors_alone(workers: int, seconds: float) -> None:
    done = simulate(ONE, Cluster(workers))
    assert done.seconds == pytest.approx(seconds)
    assert done.computing == pytest.approx(12.0 / (workers * seconds))


def test_the_order_is_kept_and_the_last_one_is_waited_for() -> None:
    assert simulate([Task(1.0), Task(1.0), Task(10.0)], Cluster(2)).seconds == pytest.approx(11.0)
    assert simulate([Task(10.0), Task(1.0), Task(1.0)], Cluster(2)).seconds == pytest.approx(10.0)


def test_two_that_compute_side_by_side_are_slower() -> None:
    def rate(count: int) -> float:
        return 1.0 if count == 1 else 0.5

    assert simulate([Task(1.0), Task(3.0)], Cluster(2, rate=rate)).seconds == pytest.approx(2.0 + 2.0)


def test_the_scheduler_is_the_limit() -> None:
    done = simulate([Task(1.0)] * 1000, Cluster(100, cost=0.1))
    assert done.seconds == pytest.approx(100.0, rel=0.02)
    assert done.scheduler == pytest.approx(1.0, rel=0.02)


def test_a_task_ahead_hides_its_cost() -> None:
    waiting = simulate(ONE, Cluster(1, cost=0.25)).seconds
    ahead = simulate(ONE, Cluster(1, cost=0.25, ahead=2)).seconds
    assert waiting == pytest.approx(15.0)
    assert ahead == pytest.approx(12.25)


def test_the_store_is_the_limit_and_is_shared() -> None:
    tasks = [Task(0.0, read=10.0, written=2.0)] * 40
    done = simulate(tasks, Cluster(8, bandwidth=4.0))
    assert done.seconds == pytest.approx(40 * 12.0 / 4.0)
    assert done.store == pytest.approx(1.0)
    assert simulate(tasks, Cluster(8, bandwidth=1e9, link=2.0)).seconds == pytest.approx(5 * 12.0 / 2.0)


def test_reading_goes_on_while_others_compute() -> None:
    first, *others = Task(1.0), *[Task(1.0, read=1.0)] * 19
    done = simulate([first, *others], Cluster(2, bandwidth=1.0))
    assert done.seconds == pytest.approx(20.0)


def test_nothing_to_simulate() -> None:
    with pytest.raises(ValueError, match="no task"):
        simulate([], Cluster(1))


def test_the_knee_lies_between_two_points() -> None:
    points = [Point(machines, 1.0, share, "store") for machines, share in ((1, 1.0), (10, 0.95), (100, 0.85))]
    assert knee(points) == pytest.approx(10.0 * math.sqrt(10.0))
    assert knee(points[:2]) == math.inf
    assert knee([Point(1, 1.0, 0.5, "store"), Point(2, 1.0, 0.3, "store")]) == 0.0


@pytest.fixture
def basis() -> Basis:
    rng = np.random.default_rng(1)
    seconds = rng.uniform(0.2, 0.5, 24).tolist()
    return Basis("here", seconds, [1_000_000] * 24, 20_000.0, [10.0] * 24, {"2": 0.004, "16": 0.005})


def test_growth_ends_at_the_bandwidth_of_the_store(basis: Basis, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.batch.simulation.many.MACHINES", (1, 2, 5))
    points = growth(basis, 60.0, 20e6, cost=0.0)
    assert [point.limit for point in points] == ["store"] * 3
    assert [point.rate for point in points] == pytest.approx([20e6] * 3, rel=0.12)
    free = growth(basis, 60.0, math.inf, cost=0.0)
    assert [point.share for point in free] == pytest.approx([1.0] * 3, abs=0.1)
    assert free[-1].rate == pytest.approx(5.0 * free[0].rate, rel=0.05)


def test_split_shortens_the_end(basis: Basis) -> None:
    (tail,) = tails(basis, 600.0, machines=(10,), seed=3)
    assert tail.ideal < tail.split < tail.whole
    assert 0.0 < tail.extra < 0.02


def test_cost_of_a_scheduler_with_many_workers(basis: Basis) -> None:
    assert basis.cost(2) == pytest.approx(0.004)
    assert basis.cost(30) == pytest.approx(0.006)


def row(frame: int, x: float, found: int = 1) -> dict[str, str]:
    shape = {"x": str(x), "y": "2", "radius": "5", "x_std": "0.05", "y_std": "0.05", "radius_std": "0.05"}
    return {"frame": str(frame), "time": str(frame), "found": str(found), **shape}


def test_rows_that_differ() -> None:
    one = [row(0, 1.0), row(1, 1.0), row(2, 1.0), row(3, 1.0), row(4, 1.0)]
    other = [row(0, 1.0), row(1, 1.01), row(2, 1.07), row(3, 1.2), row(4, 1.0, found=0)]
    found = differences(one, other)
    assert msgspec.structs.replace(found, most=0.0) == Differences(5, 4, 1, 2, 1, 0.0)
    assert found.most == pytest.approx(0.2)


def measured() -> Kept:
    tasks = [1.0, 2.0, 1.5, 0.5] * 4
    one, two = Ran(sum(tasks) + 0.1, 0.0, tasks, 1), Ran(0.5 * 1.25 * sum(tasks), 0.0, tasks, 2)
    speed = Speed([Round((20.0, 12.5), (one, two))] * 3, 16, 160, 0.1, 100.0)
    overhead = Overhead([Pair(1.1, 1.0, (1.02, 1.0), 10, 20, 5, 4)] * 4, None, 9.0)
    empty = Ran(1.0, 0.5, [0.0] * 100, 1)
    names = ("1 processes", 1), ("2 processes", 2), ("Dask", 2), ("Dask", 16)
    costs = Costs([Cost(name, workers, 1000, empty) for name, workers in names], 0.0, 4.0)
    split = Split(
        60.0, 600.0, "joined of 6 stretches", 100.0, 60.0, 110.0, Differences(1000, 9, 0, 2, 1, 0.3), 0.1, 9.0
    )
    kills = [Kill("a worker", 40), Kill("the scheduler", 90), Kill("all", 140)]
    killed = Killed(200, kills, 3, [3, -9, 0], 200, 200, 200, 0, 0, 60.0, 30.0, 0.1, 90.0)
    return Kept(speed=speed, overhead=overhead, tasks=costs, split=split, killed=killed, where={"speed": "here"})


def test_two_workers_are_predicted_from_one() -> None:
    kept = measured()
    assert slowdown(kept) == pytest.approx(1.25)
    found = predict(kept)
    assert abs(found.error) < 5.0
    assert found.low < np.median(found.simulated) < found.high
    with pytest.raises(ValueError, match="measure speed"):
        predict(Kept())


def test_the_page_says_what_is_reached(basis: Basis) -> None:
    kept = measured()
    text = page(kept)
    assert "| one to two workers, of the machine's own | 0.95 | 0.98 | 1.0" in text
    assert "| 3 % | 1 % | 2.0 % | bar |" in text
    assert "| 1 | 0 | 2.00 | **missed** |" in text
    assert "200 the same, 200 noted, 0 again | prize |" in text
    assert "Killed with -9: a worker after 40" in text
    again = msgspec.json.decode(msgspec.json.encode(kept), type=Kept)
    assert page(again) == text
    assert page(Kept()).startswith("# Batches")


def test_the_basis_has_times_with_both_processors_busy(monkeypatch: pytest.MonkeyPatch) -> None:
    found = basis_of(measured(), [10] * 16, [4.0] * 16)
    assert found.seconds[:2] == [1.25, 2.5]
    assert found.costs == {"2": 0.001, "16": 0.001}
    assert found.seconds_a_second == pytest.approx(1.25 * 1.25 / 4.0)
    monkeypatch.setattr("benchmarks.batch.simulation.many.MACHINES", (1, 2))
    monkeypatch.setattr("benchmarks.batch.simulation.many.TURNS", 2)
    monkeypatch.setattr("benchmarks.batch.simulation.tables.tails", lambda *_: [])
    words = simulation_part(found, predict(measured()))
    assert "machines that keep 90 %" in words
    with pytest.raises(ValueError, match="measure speed, overhead and tasks"):
        basis_of(Kept(), [], [])
