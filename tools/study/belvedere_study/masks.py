"""Where a click hits: pixels of a thing, as runs of rows that the page can test."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: A run: row, first column, column after the last.
Run = tuple[int, int, int]
#: How far beside a thing a click still counts, as a share of the picture's width.
REACH = 1 / 128


def target(ids: NDArray[Any], number: int, others: list[int]) -> list[Run]:
    """Runs of the pixels of a thing and of those close to it, but not of other things."""
    near = grown(ids == number, max(1, round(ids.shape[1] * REACH)))
    return runs(near & ~np.isin(ids, others))


def grown(mask: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """The mask with all pixels that are at most `reach` rows and columns away."""
    for axis in (0, 1):
        wider = mask.copy()
        for step in range(1, reach + 1):
            wider |= _shifted(mask, step, axis) | _shifted(mask, -step, axis)
        mask = wider
    return mask


def runs(mask: NDArray[np.bool_]) -> list[Run]:
    """The mask as runs, from top to bottom and left to right."""
    padded = np.pad(mask.astype(np.int8), ((0, 0), (1, 1)))
    rises, falls = np.argwhere(np.diff(padded, axis=1) == 1), np.argwhere(np.diff(padded, axis=1) == -1)
    return [(int(row), int(start), int(end)) for (row, start), (_, end) in zip(rises, falls)]


def hit(found: list[Run], x: float, y: float) -> bool:
    """Whether a place in the picture, pixels from its upper left corner, lies in the runs."""
    return any(row <= y < row + 1 and start <= x < end for row, start, end in found)


def _shifted(mask: NDArray[np.bool_], step: int, axis: int) -> NDArray[np.bool_]:
    moved = np.roll(mask, step, axis)
    # What was rolled in from the other side is no neighbour.
    rim = slice(None, step) if step > 0 else slice(step, None)
    moved[(rim, slice(None)) if axis == 0 else (slice(None), rim)] = False
    return moved
