"""Animations of results."""

from __future__ import annotations

import contextlib
import operator
import os
import pathlib
import tempfile
import warnings
from collections.abc import Iterable
from typing import Any

from . import _core

#: Options of the program and their names here.
OPTIONS = {"speed": "--speed", "fps": "--fps", "plays": "--loop", "hold_last": "--hold-last", "width": "--width"}


def animate(
    result: _core.Result,
    path: pathlib.Path,
    *,
    frames: Iterable[int] | None = None,
    speed: float | None = None,
    fps: float | None = None,
    plays: int | None = None,
    hold_last: float | None = None,
    width: int | None = None,
    overwrite: bool = False,
) -> None:
    """Makes an animation by the program's own command, of frames in a folder that is then removed."""
    numbers = list(range(_core._count(result))) if frames is None else sorted({operator.index(frame) for frame in frames})
    if not numbers:
        raise ValueError("`frames` is empty; expected the number of at least one frame")
    given = {"speed": speed, "fps": fps, "plays": plays, "hold_last": hold_last, "width": width}
    given = {name: value for name, value in given.items() if value is not None}
    words = [f"{OPTIONS[name]}={value}" for name, value in given.items()] + ["--overwrite"] * bool(overwrite)
    words += [f"--out={os.fspath(path)}", "--frames=" + ",".join(map(str, numbers))]
    called = f"result.animate({path.name!r}{''.join(f', {name}={value}' for name, value in given.items())})"
    _made(["localshape", ".", *words], called, None)
    with tempfile.TemporaryDirectory(prefix="localshape-") as folder, _bar(2 * len(numbers), path.name) as bar:
        for number in numbers:
            pathlib.Path(folder, f"frame_{number:05}.png").write_bytes(_core._frame(result, number).png())
            bar.update(1)
        _made(["localshape", folder, *words], called, lambda done: bar.update(round(len(numbers) * (1 + done)) - bar.n))


def _made(words: list[str], called: str, progress: Any) -> None:
    """Calls the program, whose messages get the names of arguments in Python."""
    try:
        _core._film(words, called, progress)
    except (ValueError, OSError) as error:
        message = str(error).replace(" with -o", "").replace("--overwrite", "overwrite=True")
        for name, option in OPTIONS.items():
            message = message.replace(option, name)
        raise type(error)(message) from None


@contextlib.contextmanager
def _bar(total: int, title: str) -> Any:
    """A progress bar, if tqdm is installed."""
    try:
        with warnings.catch_warnings():
            # Without widgets the bar is text.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except ImportError:
        yield _NoBar()
        return
    with tqdm(total=total, desc=title, unit="picture", leave=False) as bar:
        yield bar


class _NoBar:
    """Shows nothing."""

    n = 0

    def update(self, more: int) -> None:
        self.n += more
