"""Exhaustive walks of state machines: every step from every situation that can be reached."""

from collections.abc import Callable, Iterable
from typing import Protocol, TypeVar

from matchset.numeric.jit import collection_paused

Situation = TypeVar("Situation")
Reached = TypeVar("Reached", covariant=True)
Happening = TypeVar("Happening")


class Step(Protocol[Reached]):
    """A step that was taken."""

    @property
    def after(self) -> Reached: ...


Taken = TypeVar("Taken", bound=Step[object])


def walk_all(
    begin: Situation, happenings: Iterable[Happening], step: Callable[[Situation, Happening], Taken]
) -> list[Taken]:
    """Take every step from a situation on, and from all situations to which steps lead."""
    every, taken, new, known = tuple(happenings), list[Taken](), [begin], {begin}
    with collection_paused():
        while new:
            before = new.pop()
            for happening in every:
                each = step(before, happening)
                taken.append(each)
                if each.after not in known:
                    known.add(each.after)  # type: ignore[arg-type]
                    new.append(each.after)  # type: ignore[arg-type]
    return taken
