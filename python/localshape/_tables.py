"""Diagnostics over time, and divergences."""

from __future__ import annotations

from typing import Any, Dict, NamedTuple

import numpy as np


class Divergence(NamedTuple):
    """Where and when a run diverged. This is a result, not an error."""

    time: float
    """End of the first step that was rejected (s)."""
    step: int
    """Number of that step, counted from 1."""
    body: str
    """Name of the body whose node was too fast; empty if it has none."""
    element: int | None
    """First element of that body with the node; `None` if it belongs to no element."""
    is_end: bool
    """Whether no node was too fast, but a recording ends here."""


class Diagnostics(Dict[str, Any]):
    """Diagnostics by their names in `diagnostics.csv`, with the numbers of frames as `frame` and the times (s) as `time`.

    Each is an array with a number for each time, or a row of three for a vector. `docs/files.md` has meanings and units.
    """

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` with the columns of `diagnostics.csv`: a vector has three, such as `momentum_x`."""
        import pandas  # type: ignore[import-untyped, unused-ignore]

        columns = {}
        for name, values in self.items():
            if np.ndim(values) == 1:
                columns[name] = values
            else:
                columns.update({f"{name}_{axis}": values[:, at] for at, axis in enumerate("xyz")})
        return pandas.DataFrame(columns)

    def _only_row(self) -> dict[str, Any]:
        """The only row, without its time."""
        return {name: values[0].copy() for name, values in self.items() if name not in ("frame", "time")}
