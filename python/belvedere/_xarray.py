"""Heights of xarray objects as they are stored: unscaled, with the values that stand for no data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

#: Beginnings of the names of the dimensions along rows and along columns, and of their standard names in CF.
_COLUMNS = ("x", "lon", "east", "projection_x", "col")
_ROWS = ("y", "lat", "north", "projection_y", "row")


@dataclass(frozen=True)
class Stored:
    """Stored values and what their source says of them."""

    values: Any
    transform: Any = None
    crs: Any = None
    #: Stored values that stand for no data.
    nodata: tuple[object, ...] = ()
    #: A height is scale * value + offset.
    scale: float = 1.0
    offset: float = 0.0


def is_xarray(source: object) -> bool:
    """Whether it is a DataArray or a Dataset of xarray."""
    return hasattr(source, "dims") and hasattr(source, "coords") and hasattr(source, "values")


def of_xarray(source: Any, placed: bool) -> Stored:
    """Values of a DataArray, or of a Dataset of one variable; ``placed``: the caller says where they lie."""
    if not hasattr(source, "dtype"):
        names = list(source.data_vars)
        if len(names) != 1:
            raise InputError(f"the xarray dataset has {len(names)} variables; give one of them, such as dataset['height']")
        source = source[names[0]]
    source = source.squeeze(drop=True)
    if len(source.dims) != 2:
        raise InputError(f"the DataArray has the dimensions {tuple(source.dims)}; give two, rows and columns")
    rows, columns = source.dims
    along = [_along(source, dimension) for dimension in (rows, columns)]
    if along == ["columns", "rows"]:
        source = source.transpose(columns, rows)
        rows, columns = columns, rows
    elif along != ["rows", "columns"]:
        raise InputError(
            f"the DataArray has the dimensions {rows!r} and {columns!r}, which do not say which are rows and which are columns; "
            "rename them to y and x, as array.rename({...}) does"
        )
    transform = None
    if not placed:
        x, y = (np.asarray(source.coords[d].values, float) if d in source.coords else None for d in (columns, rows))
        if x is None or y is None:
            raise InputError(f"the DataArray has no coordinates along {columns} or {rows}; give transform=")
        (x0, dx), (y0, dy) = _steps(columns, x), _steps(rows, y)
        transform = (dx, 0.0, x0 - 0.5 * dx, 0.0, dy, y0 - 0.5 * dy)
    rio = getattr(source, "rio", None)
    crs = None if rio is None else rio.crs
    if crs is None and str(columns).lower().startswith("lon"):
        crs = 4326
    # Decoding moves these attributes into the encoding, so that what is left here is not applied yet.
    scale, offset = (_number(name, source.attrs.get(name, default)) for name, default in (("scale_factor", 1.0), ("add_offset", 0.0)))
    return Stored(source.values, transform, crs, _nodata(source.attrs, rio), scale, offset)


def _along(source: Any, dimension: Any) -> str | None:
    """Whether a dimension runs along ``"rows"`` (is the number of the row) or ``"columns"``; ``None``: it does not say."""
    attrs = getattr(source.coords[dimension], "attrs", {}) if dimension in source.coords else {}
    axis = {"X": "columns", "Y": "rows"}.get(str(attrs.get("axis", "")).upper())
    if axis is not None:
        return axis
    for name in (str(attrs.get("standard_name", "")).lower(), str(dimension).lower()):
        if name.startswith(_COLUMNS):
            return "columns"
        if name.startswith(_ROWS):
            return "rows"
    return None


def _nodata(attrs: Any, rio: Any) -> tuple[object, ...]:
    found = [] if rio is None or rio.nodata is None else [rio.nodata]
    for name in ("_FillValue", "missing_value", "nodatavals"):
        value = attrs.get(name)
        if value is not None:
            found.extend(v for v in np.ravel(np.asarray(value, object)) if v is not None)
    return tuple(found)


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"the attribute {name}={value!r} of the DataArray is not a number; correct it, or apply it and leave it out") from None


def _steps(name: str, values: NDArray[np.float64]) -> tuple[float, float]:
    if values.size < 2:
        raise InputError(f"the coordinate {name} has {values.size} values; a terrain needs at least 2 rows and columns")
    steps = np.diff(values)
    step = float(values[-1] - values[0]) / (values.size - 1)
    if step == 0 or not np.isfinite(step) or np.abs(steps - step).max() > 1e-3 * abs(step):
        raise InputError(f"the coordinate {name} is not evenly spaced (steps {steps.min():g} to {steps.max():g}); resample it")
    return float(values[0]), step
