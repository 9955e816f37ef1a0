"""The exceptions of the package."""

from __future__ import annotations

from typing import Any, NamedTuple


class Mistake(NamedTuple):
    """A mistake in a scene, or a warning."""

    place: str
    """The key or entry, such as `run[0].model.stiffness`; empty where there is none."""
    message: str
    """What was found and what was expected."""
    remedy: str | None = None
    """What to do, unless the message says it."""
    line: int | None = None
    """Line in the scene file, counted from 1; `None` if there is no file."""
    column: int | None = None
    """Column in characters, counted from 1."""

    @property
    def found(self) -> str:
        """What was found."""
        return self.message.partition("; expected ")[0]

    @property
    def expected(self) -> str | None:
        """What was expected, if the message says it."""
        return self.message.partition("; expected ")[2] or None


def mistakes(found: list[dict[str, Any]]) -> list[Mistake]:
    """Mistakes from dicts."""
    return [Mistake(**one) for one in found]


class SceneError(ValueError):
    """A scene, a setting or an array with mistakes. Its text tells all of them.

    `place`, `found`, `expected`, `remedy`, `line` and `column` are those of the first mistake.
    """

    mistakes: list[Mistake]
    """All mistakes, in the order of the file."""

    def __init__(self, message: str, found: list[dict[str, Any]] | None = None) -> None:
        super().__init__(message, found or [])
        self.mistakes = mistakes(found or [])
        first = self.mistakes[0] if self.mistakes else Mistake("", message)
        self.place: str = first.place
        self.found: str = first.found
        self.expected: str | None = first.expected
        self.remedy: str | None = first.remedy
        self.line: int | None = first.line
        self.column: int | None = first.column

    def __str__(self) -> str:
        return str(self.args[0])


class DeviceError(RuntimeError):
    """No graphics device can be used, or it failed. Its text tells what to install."""
