"""What is closed where its `with` block ends: `Closing`; several of them, whatever happens: `close_all`."""

import abc
from collections.abc import Callable
from types import TracebackType
from typing import Self


class Closing(abc.ABC):
    """Files or devices that stay open until `close`; leaving the `with` block closes them, also after an error."""

    @abc.abstractmethod
    def close(self) -> None:
        """Close them."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def close_all(*closes: Callable[[], None]) -> None:
    """Call each in this order, also after one has failed; the first error is raised as the last one's context.

    Parameters
    ----------
    closes : callable
        Such as `Closing.close`.
    """
    if closes:
        try:
            closes[0]()
        finally:
            close_all(*closes[1:])
