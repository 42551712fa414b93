"""Shares what the page shows, and shows what others share: `SharedPage`, a listener and a panel in one."""

import math
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext

from matchset.live.feed import Feed, Panel, StreamPicture
from matchset.live.session import Session
from matchset.live.sharing.state import SharedTargetState, SharingPartnerState, SharingState
from matchset.live.targets.target_facts import free_name
from matchset.live.wire.state import TargetState
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.sharing.messages import LONGEST_NAME, MOST_TARGETS
from matchset.sharing.partner import PartnerState
from matchset.sharing.sent_targets import SentOutline, SentTarget
from matchset.sharing.share import Share
from matchset.sharing.shared_target import SharedTarget

AGE_STEP = 10  # format: ms; the page is not told more than a person reads
DIGITS = 4  # format: decimals of meters
SHARP_MS = 0.01  # format: ms, in steps of which the uncertainty of a clock is told


class SharedPage(Panel, Closing):
    """Implements `matchset.live.feed.Listener` and `Panel`. Nothing here waits for the network.

    Parameters
    ----------
    share : Share
        Closed with it.
    note : callable
        Told each line about partners.
    lasting : float
        Age of a picture, s, above which its stream is left out when one of another stream is shared. Less leaves out
        slow cameras, more shows longer what one saw that has ended. Chosen by hand: a camera of one picture a second.
    """

    name = "sharing"

    def __init__(self, share: Share, note: Callable[[str], None], lasting: float = 3.0) -> None:
        self._share, self._note, self._refused, self._lasting = share, note, False, lasting
        self._lock = threading.Lock()  # pictures come from a thread for each camera, another source from the server's
        self._seen: dict[int, tuple[float, list[SentTarget]]] = {}

    def hear(self, stream: int, seen: StreamPicture) -> None:
        """Publish the targets of a picture, with the newest of the other streams."""
        with self._lock:
            if seen.frame is None or self._seen.get(stream, (None,))[0] == seen.frame.time:
                return
            targets = [sent_target(each, stream, seen) for each in seen.state.targets if not each.pending]
            self._seen[stream] = seen.frame.time, targets
            try:
                self._publish(seen.frame.time + seen.state.age)
            except (ValueError, TypeError) as error:  # such as a number that is too large to be told: the page goes on
                if not self._refused:
                    self._note(f"not shared: {error}")
                self._refused = True

    def changed(self, feed: Feed | None) -> None:  # noqa: ARG002
        """Forget what was shown before."""
        with self._lock:
            self._seen.clear()

    def state(self) -> SharingState:
        """Return what the page shows, and tell what has happened."""
        for line in self._share.news():
            self._note(f"shared with {line}")
        others = self._share.others()
        partners = [
            _partner(each, [other for other in others if other.partner == each.name]) for each in self._share.partners()
        ]
        return SharingState(name=self._share.name, key=self._share.key, partners=partners)

    def close(self) -> None:
        """Share nothing more."""
        self._share.close()

    def _publish(self, now: float) -> None:
        """Publish the newest targets of all streams."""
        found, times = list[SentTarget](), dict[str, float]()
        for time, targets in self._seen.values():
            for each in targets if now - time <= self._lasting else ():
                name = each.name if each.name not in times else free_name(each.name[: LONGEST_NAME - 4], times)
                found.append(each._replace(name=name))
                times[name] = time
        self._share.publish(found[:MOST_TARGETS], times, now)


def shared_page(share: Share | None, session: Session) -> AbstractContextManager[object]:
    """Let a session share what it shows; returns what ends that. None: nothing is shared."""
    if share is None:
        return nullcontext()
    made = SharedPage(share, session.note)
    session.add(made)
    session.listen(made)
    return made


def sent_target(target: TargetState, stream: int, seen: StreamPicture) -> SentTarget:
    """Make what is shared of a target of the page."""
    name = (f"{target.name} {stream + 1}" if stream else target.name)[:LONGEST_NAME] or f"target {target.id}"
    pose = seen.poses.get(target.id)
    if not target.found:
        return SentTarget(name, target.id, None, None, target.reason or "lost")
    x, y = target.outline[::2], target.outline[1::2]
    box = (min(x), min(y), max(x), max(y)) if x else (0.0, 0.0, 0.0, 0.0)
    outline = SentOutline(target.shape.capitalize(), dict(target.values), target.support or 0.0, box)
    return SentTarget(name, target.id, outline, pose if isinstance(pose, Pose) else None, "")


def _partner(state: PartnerState, targets: Sequence[SharedTarget]) -> SharingPartnerState:
    offset = state.offset
    return SharingPartnerState(
        name=state.name,
        here=state.here,
        silent=state.silent,
        age_ms=None if state.age is None else AGE_STEP * round(1000.0 * state.age.seconds / AGE_STEP),
        offset=None if offset is None else round(offset.seconds, DIGITS),
        offset_uncertainty_ms=0.0 if offset is None else SHARP_MS * math.ceil(1000.0 * offset.uncertainty / SHARP_MS),
        received=state.received,
        missed=state.missed,
        targets=[_target(each) for each in targets],
    )


def _target(target: SharedTarget) -> SharedTargetState:
    if not isinstance(target.pose, Pose):
        return SharedTargetState(name=target.name, reason=target.reason)
    sigma = math.sqrt(max(*target.pose.covariance.diagonal()[:3].tolist(), 0.0))
    position = [round(each, DIGITS) for each in target.pose.position.tolist()]
    return SharedTargetState(name=target.name, position=position, sigma=round(sigma, DIGITS))
