import doctest

from matchset.tracking import tracker


def test_the_example_of_the_tracker_runs() -> None:
    result = doctest.testmod(tracker)
    assert result.attempted >= 7
    assert result.failed == 0
