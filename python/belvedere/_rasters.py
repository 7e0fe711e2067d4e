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
from .errors import FileError, InputError


@dataclass(frozen=True)
class Heights:
    """Heights with their place: float32, row 0 in the north, NaN in holes; the affine map is that of rasterio (corners of pixels)."""

    values: NDArray[np.float32]
    transform: tuple[float, float, float, float, float, float]
    crs: Crs


def is_raster(source: object) -> bool:
    """Whether it is an array, a rasterio dataset or an xarray object."""
    return isinstance(source, np.ndarray) or _is_dataset(source) or _is_xarray(source)


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
    values: Any = source
    if _is_dataset(source):
        values, found_transform, found_crs, found_nodata = _of_dataset(source)
    elif _is_xarray(source):
        values, found_transform, found_crs, found_nodata = _of_xarray(source)
    else:
        found_transform = found_crs = found_nodata = None
    if transform is None and spacing is None:
        transform = found_transform
    crs = found_crs if crs is None else crs
    nodata = found_nodata if nodata is None else nodata
    grid = _floats(values, nodata)
    affine = _affine(transform, spacing, origin, grid.shape)
    return _north_up(grid, affine, crs_of(crs))


def _is_dataset(source: object) -> bool:
    return all(hasattr(source, name) for name in ("read", "transform", "crs", "nodata", "count"))


def _is_xarray(source: object) -> bool:
    return hasattr(source, "dims") and hasattr(source, "coords") and hasattr(source, "values")


def _of_dataset(source: Any) -> tuple[Any, Any, Any, Any]:
    values = source.read(1, masked=True)
    scale, offset = (source.scales or (1.0,))[0], (source.offsets or (0.0,))[0]
    if (scale, offset) != (1.0, 0.0):
        values = values * scale + offset
    return values, source.transform, source.crs, None


def _of_xarray(source: Any) -> tuple[Any, Any, Any, Any]:
    if not hasattr(source, "dtype"):
        names = list(source.data_vars)
        if len(names) != 1:
            raise InputError(f"the xarray dataset has {len(names)} variables; give one of them, such as dataset['height']")
        source = source[names[0]]
    source = source.squeeze(drop=True)
    if len(source.dims) != 2:
        raise InputError(f"the DataArray has the dimensions {tuple(source.dims)}; give two, rows and columns")
    rows, columns = source.dims
    named = {"x", "lon", "longitude", "easting"}
    if rows.lower() in named:
        source = source.transpose(columns, rows)
        rows, columns = columns, rows
    x, y = (np.asarray(source.coords[d].values, float) if d in source.coords else None for d in (columns, rows))
    if x is None or y is None:
        raise InputError(f"the DataArray has no coordinates along {columns} or {rows}; give transform=")
    (x0, dx), (y0, dy) = _steps(columns, x), _steps(rows, y)
    crs = nodata = None
    rio = getattr(source, "rio", None)
    if rio is not None:
        crs, nodata = rio.crs, rio.nodata
    if nodata is None:
        nodata = source.attrs.get("_FillValue")
    if crs is None and columns.lower() in ("lon", "longitude"):
        crs = 4326
    return source.values, (dx, 0.0, x0 - 0.5 * dx, 0.0, dy, y0 - 0.5 * dy), crs, nodata


def _steps(name: str, values: NDArray[np.float64]) -> tuple[float, float]:
    if values.size < 2:
        raise InputError(f"the coordinate {name} has {values.size} values; a terrain needs at least 2 rows and columns")
    steps = np.diff(values)
    step = float(values[-1] - values[0]) / (values.size - 1)
    if step == 0 or not np.isfinite(step) or np.abs(steps - step).max() > 1e-3 * abs(step):
        raise InputError(f"the coordinate {name} is not evenly spaced (steps {steps.min():g} to {steps.max():g}); resample it")
    return float(values[0]), step


def _floats(values: Any, nodata: object) -> NDArray[np.float32]:
    """Float32 with NaN in holes."""
    mask, data = mask_of(values), data_of(values)
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
    if nodata is not None:
        try:
            void = float(nodata)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise InputError(f"nodata={nodata!r} is not a number; give the value that stands for no data") from None
        # Compared as stored: a float32 of -3.4028235e38 is that of a float64 only after both are rounded alike.
        holes |= data == (np.asarray(void).astype(data.dtype) if data.dtype.kind == "f" else void)
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
