"""Exceptions of `Tracker.update`, `detect` and `ColorModel.pick`, counted instead of raised: `counted`."""

import contextlib
import functools
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from unittest.mock import patch

import msgspec

import matchset as ms

PACKAGE = Path(ms.__file__).resolve().parent


class Raised(msgspec.Struct, frozen=True):
    """An exception, what raised it, and the line of the code.

    Parameters
    ----------
    call : str
        "update", "detect" or "pick".
    what : str
        Type and text of the exception.
    place : str
        File, line and function that raised it.
    """

    call: str
    what: str
    place: str

    @classmethod
    def of(cls, call: str, error: Exception) -> "Raised":
        """Describe an exception."""
        last = _last(error)
        return cls(call, f"{type(error).__name__}: {error}", f"{last.filename}:{last.lineno} in {last.name}")

    @property
    def words(self) -> str:
        """All of it, for people."""
        return f"{self.call}: {self.what} ({self.place})"


@contextlib.contextmanager
def counted() -> Iterator[list[Raised]]:
    """Note exceptions in a list; instead, `update` answers `Lost`, `detect` nothing, and `pick` refuses.

    `pick` refuses a click with a `ValueError` of the package, which is an answer and not counted.
    It works in this process only.

    Yields
    ------
    list of Raised
        It grows.
    """
    found: list[Raised] = []
    update, detect, pick = ms.Tracker.update, ms.detect, ms.ColorModel.pick

    @functools.wraps(update)
    def safe_update(self: Any, frame: Any, *more: Any, **named: Any) -> Any:
        lost = ms.Lost[Any]("raised", getattr(frame, "time", 0.0))
        return _safe(found, "update", lambda: update(self, frame, *more, **named), lambda: lost)

    def safe_detect(*arguments: Any, **named: Any) -> Any:
        return _safe(found, "detect", lambda: detect(*arguments, **named), list)

    def safe_pick(*arguments: Any, **named: Any) -> Any:
        try:
            return pick(*arguments, **named)
        except Exception as error:
            if isinstance(error, ValueError) and PACKAGE in Path(_last(error).filename).parents:
                raise
            found.append(Raised.of("pick", error))
            raise ValueError(f"raised {error}") from error

    with (
        patch.object(ms.Tracker, "update", safe_update),
        patch.object(ms, "detect", safe_detect),
        patch.object(ms.ColorModel, "pick", safe_pick),
    ):
        yield found


def _last(error: Exception) -> traceback.FrameSummary:
    return traceback.extract_tb(error.__traceback__)[-1]


def _safe(found: list[Raised], call: str, do: Callable[[], Any], instead: Callable[[], Any]) -> Any:
    try:
        return do()
    except Exception as error:
        found.append(Raised.of(call, error))
        return instead()
