"""Meshes, volumes and atoms from arrays for the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._masks import data_of, joined, mask_of, masked_count
from .errors import InputError

if TYPE_CHECKING:
    from ._native import NativeArrays

#: Types of voxels that are drawn.
_NUMBERS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")


def add_triangles(arrays: NativeArrays, name: str, vertices: object, faces: object, colors: object = None) -> None:
    """Hands triangles over under a name."""
    points = rows_of("vertices", vertices, 3)
    faces = joined("faces", faces)
    if masked_count(faces):
        raise InputError("faces holds masked values; leave those rows out")
    indices = np.asarray(faces)
    if indices.dtype.kind not in "iu" or indices.ndim != 2 or indices.shape[1] != 3 or len(indices) == 0:
        raise InputError(f"faces of type {indices.dtype} and shape {indices.shape} are no triangles; give rows of three whole numbers")
    low, high = int(indices.min()), int(indices.max())
    if low < 0 or high >= len(points):
        wrong = low if low < 0 else high
        raise InputError(f"a face names vertex {wrong}, and there are {len(points)}, from 0; correct the faces")
    rgb = None
    if colors is not None:
        colors = joined("colors", colors)
        if masked_count(colors):
            raise InputError("colors holds masked values; give a colour to each vertex")
        rgb = np.asarray(colors)
        if rgb.dtype != np.uint8 or rgb.ndim != 2 or rgb.shape[0] != len(points) or rgb.shape[1] not in (3, 4):
            raise InputError(f"colors of type {rgb.dtype} and shape {rgb.shape} do not suit; give uint8 of the shape ({len(points)}, 3)")
    arrays.add_triangles(name, _bytes(points, "<f8"), _bytes(indices, "<u4"), None if rgb is None else rgb[:, :3].tobytes())


def add_voxels(arrays: NativeArrays, name: str, values: object, spacing: object, origin: object) -> None:
    """Hands voxels over under a name; ``values[k, j, i]``: x runs along the last axis."""
    values = joined("voxels", values)
    data, holes = data_of(values), mask_of(values)
    if data.ndim != 3 or min(data.shape) < 2:
        raise InputError(f"voxels have the shape {data.shape}; give three axes z, y, x of at least 2 each")
    if data.dtype == np.float16:
        data = data.astype(np.float32)
    if data.dtype.kind in "iu" and data.dtype.itemsize == 8:
        low, high = int(data.min()), int(data.max())
        if low < -(2**31) or high >= 2**31:
            raise InputError(f"voxels reach from {low} to {high}, more than 32 bits hold; give float64")
        data = data.astype(np.int32)
    number = data.dtype.newbyteorder("=").name
    if number not in _NUMBERS:
        raise InputError(f"voxels of type {data.dtype} are not numbers that are drawn; give integers or floats")
    if holes is not None and holes.any():
        if data.dtype.kind != "f":
            raise InputError(f"{int(holes.sum())} voxels of type {data.dtype} are masked, and integers have no hole; give values.filled(v) or floats")
        data = np.where(holes, np.nan, data)
    steps, start = _three("spacing", spacing), _three("origin", origin)
    if min(steps) <= 0:
        raise InputError(f"spacing={spacing!r} is not a distance between voxels; give numbers above 0")
    nz, ny, nx = data.shape
    arrays.add_voxels(name, _bytes(data, data.dtype.newbyteorder("<")), number, (nx, ny, nz), steps, start)


def add_atoms(
    arrays: NativeArrays,
    name: str,
    elements: Sequence[str],
    positions: object,
    names: Sequence[str] | None = None,
    residues: Sequence[str] | None = None,
    chains: Sequence[str] | None = None,
    numbers: Sequence[int] | None = None,
) -> None:
    """Hands atoms over under a name."""
    points = rows_of("positions", positions, 3)
    count = len(points)
    symbols = [str(e) for e in elements]
    words = (
        symbols,
        symbols if names is None else [str(v) for v in names],
        ["UNK"] * count if residues is None else [str(v) for v in residues],
        ["A"] * count if chains is None else [str(v) for v in chains],
    )
    of_residues = [1] * count if numbers is None else [int(v) for v in numbers]
    beyond = next((n for n in of_residues if not -(2**31) <= n < 2**31), None)
    if beyond is not None:
        raise InputError(f"numbers holds {beyond}, more than 32 bits hold; give numbers of residues")
    arrays.add_atoms(name, _bytes(points, "<f8"), words, of_residues)


def rows_of(what: str, values: object, columns: int) -> NDArray[np.float64]:
    """Finite rows of so many numbers."""
    values = joined(what, values)
    if masked_count(values):
        raise InputError(f"{what} holds masked values; leave those rows out")
    try:
        rows = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{what} are not numbers; give rows of {columns}") from None
    if rows.ndim == 1 and rows.size == columns:
        rows = rows[None, :]
    if rows.ndim != 2 or rows.shape[1] != columns or len(rows) == 0:
        raise InputError(f"{what} have the shape {rows.shape}; give rows of {columns} numbers, shape (n, {columns})")
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if bad.size:
        raise InputError(f"{what}: row {bad[0]} of {len(rows)} is not finite; leave such rows out")
    return rows


def _three(what: str, value: object) -> tuple[float, float, float]:
    try:
        x, y, z = (float(v) for v in np.broadcast_to(np.asarray(value, float), (3,)))
    except (TypeError, ValueError):
        raise InputError(f"{what}={value!r} is not (x, y, z); give three numbers") from None
    if not np.isfinite([x, y, z]).all():
        raise InputError(f"{what}={value!r} is not finite; give finite numbers")
    return x, y, z


def _bytes(array: NDArray[Any], dtype: Any) -> bytes:
    return array.astype(dtype, copy=False).tobytes()
