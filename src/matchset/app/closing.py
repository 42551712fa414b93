"""What is closed where its `with` block ends: `Closing`."""

import abc
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
