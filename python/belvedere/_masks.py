"""Masks of arrays, which are never dropped in silence."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def mask_of(values: Any) -> NDArray[np.bool_] | None:
    """The mask of a masked array, of its shape; ``None`` for other values."""
    if not np.ma.isMaskedArray(values):
        return None
    mask: NDArray[np.bool_] = np.ma.getmaskarray(values)
    return mask


def masked_count(values: Any) -> int:
    """Number of masked values."""
    mask = mask_of(values)
    return 0 if mask is None else int(mask.sum())


def data_of(values: Any) -> NDArray[Any]:
    """The values below the mask."""
    data: NDArray[Any] = np.asarray(np.ma.getdata(values) if np.ma.isMaskedArray(values) else values)
    return data
