"""Masks of arrays, which are never dropped in silence."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError


def joined(what: str, values: Any) -> Any:
    """Lists that hold masked arrays as one masked array, which NumPy would join without their masks; other values as they are."""
    if not _holds_masks(values):
        return values
    parts = [joined(what, part) for part in values]
    try:
        data, mask = np.array([data_of(part) for part in parts]), np.array([np.ma.getmaskarray(part) for part in parts])
    except ValueError:
        raise InputError(f"{what}: rows that lie in a list have different lengths; give rows of one length") from None
    return np.ma.array(data, mask=mask)


def _holds_masks(values: Any) -> bool:
    return isinstance(values, (list, tuple)) and any(np.ma.isMaskedArray(v) or _holds_masks(v) for v in values)


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
