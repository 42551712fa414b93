"""Pictures that waited while a stream was opened are left out: the first one is of now."""

from matchset.image.streams.backlog import Backlog


def test_what_had_to_be_waited_for_is_of_now_and_so_is_what_follows() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.7)
    assert backlog.holds(10.001, 0.050, 30.0)  # the decoder begins
    assert backlog.holds(10.002, 0.001, 30.0)
    assert not backlog.holds(10.030, 0.028, 30.0)
    assert not backlog.holds(10.031, 0.001, 30.0)


def test_a_stream_that_is_never_waited_for_is_read_all_the_same() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.7)
    assert backlog.holds(10.69, 0.001, None)
    assert not backlog.holds(10.71, 0.001, None)


def test_nothing_waits_where_the_opening_took_no_time() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.01)
    assert not backlog.holds(10.0, 0.0, 30.0)
