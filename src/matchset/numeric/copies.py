"""How objects are copied and pickled: `Copied` for those that own a block of memory, `NotCopied` for devices.

`copy` and `pickle` take an array that is a view into a block for an array of its own. In the copy it would no longer
be part of that block: what compiled code writes there, Python would not read (decision 091).
"""

import copy
from typing import Any, ClassVar, NoReturn, Self


class Copied:
    """Base of a class whose copies are independent of it and give the same answers, bit for bit.

    What can be made again from the other attributes is made in `_derive`, and neither copied nor pickled: views into a
    block, compiled functions. Whatever `_derive` sets for the first time counts as such.
    """

    _derived: frozenset[str] = frozenset()

    def _derive(self) -> None:
        """Make what is made from the other attributes, and compile what is called later; nothing by default."""

    def _make_derived(self) -> None:
        """Call `_derive` and note what it made; to be called by the constructor."""
        before = set(vars(self))
        self._derive()
        self._derived = frozenset(vars(self).keys() - before)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in self._derived}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._make_derived()

    def __copy__(self) -> Self:
        """Copy, as independent as one by `copy.deepcopy`: half of a state is of no use."""
        return copy.deepcopy(self)


class NotCopied:
    """Base of a class that holds a device, a file or a thread: to copy or pickle it is a TypeError.

    Attributes
    ----------
    instead : str
        What to do instead, in words for the message.
    """

    instead: ClassVar[str] = "open another"

    def __reduce__(self) -> NoReturn:
        name = type(self).__name__
        raise TypeError(f"a {name} holds a device or an open file, which cannot be copied or pickled: {self.instead}")
