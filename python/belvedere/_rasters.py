"""Heights from arrays, rasterio datasets and xarray, with their holes, as GeoTIFF for the loader of the engine.

Masks and no-data become holes, never heights.
"""

from __future__ import annotations

import os
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._ask import number
from ._crs import Crs, crs_of
from ._masks import data_of, mask_of
from ._xarray import Stored, is_xarray, of_xarray
from .errors import FileError, InputError


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
    grid = data.astype(np.float64 if data.dtype.kind == "f" and data.dtype.itemsize == 8 else np.float32)
    holes = ~np.isfinite(grid) if mask is None else ~np.isfinite(grid) | mask
    for value in nodata:
        try:
            void = float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise InputError(f"nodata={value!r} is not a number; give the value that stands for no data") from None
        # Compared as stored: a float32 of -3.4028235e38 is that of a float64 only after both are rounded alike.
        holes |= data == (np.asarray(void).astype(data.dtype) if data.dtype.kind == "f" else void)
    if (stored.scale, stored.offset) != (1.0, 0.0):
        grid = grid.astype(np.float64) * stored.scale + stored.offset
    beyond = np.abs(np.where(holes, 0.0, grid)).max()
    if beyond > 1e30:
        raise InputError(f"a height is {beyond:g} m; if that stands for no data, give nodata=")
    if holes.all():
        raise InputError(f"none of the {holes.size} heights is a number that is not masked; check mask and nodata")
    out = grid.astype(np.float32)
    out[holes] = np.nan
    return out


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


_NODATA = -3.0e38
_DOUBLE, _SHORT, _LONG, _ASCII = 12, 3, 4, 2


def write_geotiff(path: Path, heights: Heights) -> None:
    """Writes heights as a GeoTIFF of one strip, uncompressed; the coordinate system is told beside it."""
    rows, columns = heights.values.shape
    samples = np.where(np.isnan(heights.values), np.float32(_NODATA), heights.values).astype("<f4", copy=False)
    a, b, c, d, e, f = heights.transform
    nodata = f"{np.float32(_NODATA)!s}\0".encode()
    entries: list[tuple[int, int, int, bytes]] = [
        (256, _LONG, 1, struct.pack("<I", columns)),
        (257, _LONG, 1, struct.pack("<I", rows)),
        (258, _SHORT, 1, struct.pack("<H", 32)),
        (259, _SHORT, 1, struct.pack("<H", 1)),
        (262, _SHORT, 1, struct.pack("<H", 1)),
        (273, _LONG, 1, b""),
        (277, _SHORT, 1, struct.pack("<H", 1)),
        (278, _LONG, 1, struct.pack("<I", rows)),
        (279, _LONG, 1, struct.pack("<I", samples.nbytes)),
        (339, _SHORT, 1, struct.pack("<H", 3)),
        (34264, _DOUBLE, 16, struct.pack("<16d", a, b, 0, c, d, e, 0, f, 0, 0, 0, 0, 0, 0, 0, 1)),
        (42113, _ASCII, len(nodata), nodata),
    ]
    if samples.nbytes > 0xF000_0000:
        raise InputError(f"{rows} x {columns} heights are more than a file of 4 GB holds; give them as files, in tiles")
    after = 8 + 2 + 12 * len(entries) + 4
    values = b"".join(value + b"\0" * (-len(value) % 8) for *_, value in entries if len(value) > 4)
    data_at = after + len(values) + (-(after + len(values)) % 16)
    directory, at = b"", after
    for tag, kind, count, value in entries:
        if tag == 273:
            value = struct.pack("<I", data_at)
        if len(value) > 4:
            directory += struct.pack("<HHII", tag, kind, count, at)
            at += len(value) + (-len(value) % 8)
        else:
            directory += struct.pack("<HHI", tag, kind, count) + value.ljust(4, b"\0")
    head = struct.pack("<2sHIH", b"II", 42, 8, len(entries)) + directory + struct.pack("<I", 0) + values
    try:
        with open(path, "wb") as out:
            out.write(head.ljust(data_at, b"\0"))
            out.write(samples.data)
    except OSError as error:
        raise FileError(f"{os.fspath(path)}: {error.strerror}") from error
