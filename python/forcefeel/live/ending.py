"""The end of what runs in the background."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Self


class EndsWithBlock(ABC):
    """What runs in the background until it is ended, at the latest at the end of its ``with`` block."""

    @abstractmethod
    def end(self) -> None:
        """End it; further calls do nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()
