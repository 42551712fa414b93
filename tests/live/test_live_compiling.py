"""The page says when it waits for the compiler, and a click then is kept and answered after that."""

import sys
import time
from pathlib import Path

from matchset.live.compiling import CompilingPanel
from matchset.live.feed import Panel
from matchset.live.session import Session
from matchset.live.targets.clicks import Clicks
from matchset.live.targets.messages import Drop, Hold, Marker, Pick
from matchset.live.targets.panel import TargetsPanel
from matchset.live.wire.messages import Kernels

UNTIL = "import pathlib, time\nwhile not pathlib.Path({!r}).exists(): time.sleep(0.01)\n"  # what a process waits for


def test_kernels_are_counted_until_the_first_click_can_be_answered(tmp_path: Path) -> None:
    program = "print(1); print(2); print(3, flush=True)\n" + UNTIL.format(str(tmp_path / "go on"))
    command = (sys.executable, "-c", program)
    asked = list[object]()
    panel = CompilingPanel(command)
    session = Session((panel, TargetsPanel(asked.append)), refusal=panel.refusal)
    while panel.state().kernels < 3:
        time.sleep(0.01)
    assert not panel.state().done
    panel.ready = session.go_on
    session.take(Pick(1, 2.0, 3.0), "page")
    assert session.state().notes == [
        "the first click waits for the compiler, only once on this machine: it is answered after that"
    ]
    session.take(Drop(1), "page")
    assert asked == [Hold(1), Drop(1)]
    (tmp_path / "go on").touch()
    panel._thread.join(60.0)
    assert (panel.state().kernels, panel.state().done, panel.refusal()) == (3, True, "")
    session.take(Pick(2, 2.0, 3.0), "page")
    assert asked == [Hold(1), Drop(1), Pick(1, 2.0, 3.0), Pick(2, 2.0, 3.0)]


def test_other_shapes_and_markers_wait_longer_than_the_first_click(tmp_path: Path) -> None:
    program = "print(1); print('the first click', flush=True)\n" + UNTIL.format(str(tmp_path / "go on")) + "print(2)"
    asked, marker, box = list[object](), Marker(1, 1, 2.0, 3.0), Pick(1, 2.0, 3.0, shape="rectangle")
    panel = CompilingPanel((sys.executable, "-c", program))
    session = Session((panel, TargetsPanel(asked.append)), refusal=panel.refusal)
    while not panel.state().done:
        time.sleep(0.01)
    session.take(Pick(1, 2.0, 3.0), "page")
    panel.ready = session.go_on
    for message in (box, marker):
        session.take(message, "page")
    (note,) = session.state().notes
    assert note.startswith("other shapes and markers wait for the compiler")
    (tmp_path / "go on").touch()
    panel._thread.join(120.0)
    assert asked == [Pick(1, 2.0, 3.0), Hold(1), Hold(1), box, marker]
    assert panel.state().kernels == 1


def waiting_session(*panels: Panel) -> tuple[Session, list[str]]:
    """A session whose compiler is done as soon as the list is empty."""
    words = ["the compiler"]
    return Session(panels, refusal=lambda needs: words[0] if words and needs else ""), words


def test_of_many_clicks_that_wait_the_oldest_are_given_up() -> None:
    asked, clicks = list[object](), Clicks(lambda _: None)
    session, words = waiting_session(TargetsPanel(asked.append, clicks))
    picks = [Pick(number, 2.0, 3.0) for number in range(10)]
    for pick in picks:
        session.take(pick, "page")
    assert [each.sequence for each in clicks.state.answered] == [0, 1]
    words.clear()
    session.go_on()
    session.go_on()
    assert [each for each in asked if isinstance(each, Pick)] == picks[2:]


def test_a_click_that_waits_is_forgotten_with_its_pictures() -> None:
    asked = list[object]()
    session, words = waiting_session(TargetsPanel(asked.append))
    session.take(Pick(1, 2.0, 3.0), "page")
    session.show(None)
    words.clear()
    session.go_on()
    assert asked == [Hold(1)]


def test_what_is_kept_on_the_disk_is_no_reason_to_wait() -> None:
    panel = CompilingPanel((sys.executable, "-c", "pass"))
    assert panel.refusal(Kernels.ALL) == ""
    panel._thread.join(120.0)
    assert panel.state().done


def test_without_a_process_the_first_click_compiles() -> None:
    panel = CompilingPanel(("/no/such/program",))
    panel._thread.join(10.0)
    assert panel.state().done


def test_closed_it_neither_compiles_nor_loads_any_more() -> None:
    panel = CompilingPanel((sys.executable, "-c", "print(1, flush=True); import time; time.sleep(600)"))
    while panel.state().kernels < 1:
        time.sleep(0.01)
    panel.close()
    assert not panel._thread.is_alive()
    assert panel._process is not None
    assert panel._process.returncode is not None
    assert not panel.state().done
    panel.close()


def test_closed_at_once_nothing_is_begun_or_it_is_ended() -> None:
    with CompilingPanel((sys.executable, "-c", "import time; time.sleep(600)")) as panel:
        pass
    assert not panel._thread.is_alive()
