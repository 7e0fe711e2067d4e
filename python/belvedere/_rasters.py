"""Heights from arrays, rasterio datasets and xarray, with their holes, for the engine.

Masks and no-data become holes, never heights.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._ask import number
from ._crs import Crs, crs_of
from ._masks import data_of, mask_of
from ._xarray import Stored, is_xarray, of_xarray
from .errors import InputError

if TYPE_CHECKING:
    from ._native import NativeArrays


@dataclass(frozen=True)
class Heights:
    """Heights with their place: float32, row 0 in the north, NaN in holes; the affine map is that of rasterio (corners of pixels)."""

    values: NDArray[np.float32]
    transform: tuple[float, float, float, float, float, float]
    crs: Crs


def is_raster(source: object) -> bool:
    """Whether it is an array, a rasterio dataset or an xarray object."""
    return isinstance(source, np.ndarray) or _is_dataset(source) or is_xarray(source)


def heights_of(
    source: object,
    *,
    transform: object = None,
    spacing: object = None,
    origin: Sequence[float] | None = None,
    crs: object = None,
    nodata: object = None,
) -> Heights:
    """Heights of an array or dataset; what is given overrides what the dataset says."""
    placed = transform is not None or spacing is not None
    if _is_dataset(source):
        found = _of_dataset(source)
    elif is_xarray(source):
        found = of_xarray(source, placed)
    else:
        found = Stored(source)
    crs = found.crs if crs is None else crs
    grid = _floats(found, found.nodata if nodata is None else (nodata,))
    affine = _affine(transform if placed else found.transform, spacing, origin, grid.shape)
    return _north_up(grid, affine, crs_of(crs))


def _is_dataset(source: object) -> bool:
    return all(hasattr(source, name) for name in ("read", "transform", "crs", "nodata", "count"))


def _of_dataset(source: Any) -> Stored:
    scale, offset = (source.scales or (1.0,))[0], (source.offsets or (0.0,))[0]
    return Stored(source.read(1, masked=True), source.transform, source.crs, (), float(scale), float(offset))


def _floats(stored: Stored, nodata: Sequence[object]) -> NDArray[np.float32]:
    """Float32 with NaN in holes."""
    mask, data = mask_of(stored.values), data_of(stored.values)
    if data.dtype.kind not in "iuf":
        raise InputError(f"heights of type {data.dtype} are not numbers with an order; give integers or floats, metres")
    if data.ndim == 3 and data.shape[0] == 1:
        data, mask = data[0], None if mask is None else mask[0]
    if data.ndim != 2 or min(data.shape) < 2:
        raise InputError(f"heights have the shape {data.shape}; give rows and columns, at least 2 x 2")
    if data.dtype.itemsize > 8:
        data = data.astype(np.float64)
    grid = data.astype(np.float64 if data.dtype.kind == "f" and data.dtype.itemsize == 8 else np.float32, copy=False)
    valid = np.isfinite(grid)
    if mask is not None:
        valid &= ~mask
    for value in nodata:
        try:
            void = float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise InputError(f"nodata={value!r} is not a number; give the value that stands for no data") from None
        # Compared as stored: a float32 of -3.4028235e38 is that of a float64 only after both are rounded alike.
        valid &= data != (np.asarray(void).astype(data.dtype) if data.dtype.kind == "f" else void)
    if (stored.scale, stored.offset) != (1.0, 0.0):
        grid = grid.astype(np.float64) * stored.scale + stored.offset
    beyond = max(grid.max(initial=0.0, where=valid), -grid.min(initial=0.0, where=valid))
    if beyond > 1e30:
        raise InputError(f"a height is {beyond:g} m; if that stands for no data, give nodata=")
    if valid.all():
        return grid.astype(np.float32, copy=False)
    if not valid.any():
        raise InputError(f"none of the {valid.size} heights is a number that is not masked; check mask and nodata")
    return np.where(valid, grid, np.nan).astype(np.float32, copy=False)


def _affine(transform: object, spacing: object, origin: Sequence[float] | None, shape: tuple[int, ...]) -> tuple[float, ...]:
    if spacing is not None:
        if transform is not None:
            raise InputError("transform and spacing both say where the samples lie; give one of them")
        steps = np.broadcast_to(np.asarray(spacing, float), (2,))
        if not (np.isfinite(steps).all() and (steps > 0).all()):
            raise InputError(f"spacing={spacing!r} is not a distance between samples; give a number above 0, or (along x, along y)")
        dx, dy = float(steps[0]), float(steps[1])
        x0, y0 = (0.0, dy * (shape[0] - 1)) if origin is None else (number("origin", v) for v in origin)
        return (dx, 0.0, x0 - 0.5 * dx, 0.0, -dy, y0 + 0.5 * dy)
    if transform is None:
        raise InputError("nothing says where the heights lie; give transform= (as rasterio writes it) or spacing=, metres between samples")
    values = tuple(getattr(transform, name) for name in "abcdef") if hasattr(transform, "f") else transform
    try:
        affine = tuple(float(v) for v in values)[:6]  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise InputError(f"transform={transform!r} is not an affine map; give the six numbers a, b, c, d, e, f of rasterio") from None
    if len(affine) != 6 or not np.isfinite(affine).all() or affine[0] * affine[4] == affine[1] * affine[3]:
        raise InputError(f"transform={affine} is not an affine map; give the six finite numbers a, b, c, d, e, f of rasterio")
    return affine


def _north_up(grid: NDArray[np.float32], affine: tuple[float, ...], crs: Crs) -> Heights:
    """Rows from north to south, columns from west to east, where the grid is not rotated."""
    a, b, c, d, e, f = affine
    if b == 0 and d == 0:
        rows, columns = grid.shape
        if e > 0:
            grid, e, f = grid[::-1], -e, f + rows * e
        if a < 0:
            grid, a, c = grid[:, ::-1], -a, c + columns * a
    return Heights(np.ascontiguousarray(grid), (a, b, c, d, e, f), crs)


def add_heights(arrays: NativeArrays, name: str, heights: Heights) -> None:
    """Hands heights over under a name."""
    rows, columns = heights.values.shape
    samples = heights.values.astype("<f4", copy=False).tobytes()
    arrays.add_heights(name, samples, columns, rows, heights.transform, heights.crs.code)
