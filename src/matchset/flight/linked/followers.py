"""Several pilots with links of their own, stepped, armed and landed at the same time: `LinkedFollowers`."""

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from matchset.control.safety import AIRBORNE
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.flight.linked.live_camera import LiveCamera
from matchset.media.closing import Closing, close_all

T = TypeVar("T")


class LinkedFollowers(Closing):
    """Pilots of real vehicles, each in a thread of its own: none hears nothing while another one waits.

    Parameters
    ----------
    pilots : sequence of Pilot

    Attributes
    ----------
    pilots : tuple of Pilot
    """

    def __init__(self, pilots: Sequence[Pilot]) -> None:
        self.pilots, self._closed = tuple(pilots), False
        count = len(self.pilots)
        self._threads = ThreadPoolExecutor(count, "matchset pilot")
        started = threading.Barrier(count)
        list(self._threads.map(lambda _: started.wait(), range(count)))  # now, not in the air

    @property
    def cameras(self) -> list[LiveCamera]:
        """The cameras that are live ones."""
        return [pilot.camera for pilot in self.pilots if isinstance(pilot.camera, LiveCamera)]

    @property
    def fault(self) -> str:
        """Why pictures of a camera are no more to be expected, in words; empty as long as they are."""
        return next((camera.fault for camera in self.cameras if camera.fault), "")

    @property
    def notes(self) -> list[str]:
        """What to know of the pictures, in words."""
        return [note for camera in self.cameras for note in camera.notes]

    def begin(self, start: float) -> None:
        """Let the clock of all cameras begin at a time, s, on the computer's own clock."""
        for camera in self.cameras:
            camera.begin(start)

    def step(self) -> tuple[PilotStep, ...]:
        """Take a step with everybody at once, at the rate of the slowest camera.

        Raises
        ------
        LinkError
            If a link is gone.
        """
        return tuple(self._each(lambda pilot: pilot.step(), self.pilots))

    def arm(self, pilots: Sequence[Pilot]) -> None:
        """Arm pilots; with the first ones the links of all, the motors off.

        To arm a link takes it a moment, and one that hears nothing meanwhile would stop its motors.

        Raises
        ------
        LinkError
            If a link refuses.
        """
        if pilots and not any(pilot.armed for pilot in self.pilots):
            self._each(lambda pilot: pilot.arm_link(), self.pilots)
        self._each(lambda pilot: pilot.arm(), pilots)

    def land_with(self, steps: Sequence[PilotStep]) -> None:
        """Let everybody land when one has come down: who flies on would follow him."""
        for number, step in enumerate(steps):
            if step.safety.phase == "cut" and not self.pilots[number].killed:
                for pilot in self.pilots[:number] + self.pilots[number + 1 :]:
                    if not pilot.landing:
                        pilot.land(f"vehicle {number + 1} came down")

    def fault_on_ground(self, steps: Sequence[PilotStep], patient: bool = False) -> str:
        """Why it makes no sense to go on, as `fault`; empty while a motor turns: safety brings that vehicle down.

        Parameters
        ----------
        steps : sequence of PilotStep
        patient : bool
            Whether a camera that is still being opened again is none.
        """
        if any(step.safety.phase in AIRBORNE for step in steps):
            return ""
        if patient and all(camera.may_return for camera in self.cameras if camera.fault):
            return ""
        return self.fault

    def close(self) -> None:
        """Land everybody at once, close the links, then the cameras; once more does no harm."""
        if self._closed:
            return
        self._closed = True
        landing = [self._threads.submit(pilot.link.close) for pilot in self.pilots]
        self._threads.shutdown()
        close_all(*(each.result for each in landing), *(camera.close for camera in self.cameras))

    def _each(self, do: Callable[[Pilot], T], pilots: Sequence[Pilot]) -> list[T]:
        """Do something with pilots; in the calling thread where there is one only, which may have a priority."""
        return [do(each) for each in pilots] if len(pilots) < 2 else list(self._threads.map(do, pilots))
