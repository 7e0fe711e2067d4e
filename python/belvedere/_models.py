"""Meshes, volumes and atoms from arrays as PLY, NRRD and mmCIF for the loaders of the engine."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._masks import data_of, joined, mask_of, masked_count
from .errors import FileError, InputError

#: Names of NRRD for the types of voxels.
_NRRD = {
    "int8": "int8", "uint8": "uint8", "int16": "int16", "uint16": "uint16",
    "int32": "int32", "uint32": "uint32", "float32": "float", "float64": "double",
}  # fmt: skip


def write_ply(path: Path, vertices: object, faces: object, colors: object = None) -> None:
    """Triangles as binary PLY."""
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
    fields: list[Any] = [("x", "<f8"), ("y", "<f8"), ("z", "<f8")]
    properties = "property double x\nproperty double y\nproperty double z\n"
    if colors is not None:
        fields += [("r", "u1"), ("g", "u1"), ("b", "u1")]
        properties += "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    table = np.zeros(len(points), fields)
    for i, name in enumerate("xyz"):
        table[name] = points[:, i]
    if colors is not None:
        colors = joined("colors", colors)
        if masked_count(colors):
            raise InputError("colors holds masked values; give a colour to each vertex")
        rgb = np.asarray(colors)
        if rgb.dtype != np.uint8 or rgb.ndim != 2 or rgb.shape[0] != len(points) or rgb.shape[1] not in (3, 4):
            raise InputError(f"colors of type {rgb.dtype} and shape {rgb.shape} do not suit; give uint8 of the shape ({len(points)}, 3)")
        for i, name in enumerate("rgb"):
            table[name] = rgb[:, i]
    triangles = np.zeros(len(indices), [("n", "u1"), ("v", "<i4", 3)])
    triangles["n"], triangles["v"] = 3, indices
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{properties}"
        f"element face {len(indices)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    _write(path, head.encode(), table.tobytes(), triangles.tobytes())


def write_nrrd(path: Path, values: object, spacing: object, origin: object) -> None:
    """Voxels as NRRD; ``values[k, j, i]``: x runs along the last axis."""
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
    name = _NRRD.get(data.dtype.newbyteorder("=").name)
    if name is None:
        raise InputError(f"voxels of type {data.dtype} are not numbers that are drawn; give integers or floats")
    if holes is not None and holes.any():
        if data.dtype.kind != "f":
            raise InputError(f"{int(holes.sum())} voxels of type {data.dtype} are masked, and integers have no hole; give values.filled(v) or floats")
        data = np.where(holes, np.nan, data)
    dx, dy, dz = _three("spacing", spacing)
    if min(dx, dy, dz) <= 0:
        raise InputError(f"spacing={spacing!r} is not a distance between voxels; give numbers above 0")
    x, y, z = _three("origin", origin)
    nz, ny, nx = data.shape
    head = (
        f"NRRD0004\ntype: {name}\ndimension: 3\nspace dimension: 3\nsizes: {nx} {ny} {nz}\n"
        f"space directions: ({dx!r},0,0) (0,{dy!r},0) (0,0,{dz!r})\nspace origin: ({x!r},{y!r},{z!r})\n"
        "endian: little\nencoding: raw\n\n"
    )
    _write(path, head.encode(), np.ascontiguousarray(data, data.dtype.newbyteorder("<")).tobytes())


def write_mmcif(
    path: Path,
    elements: Sequence[str],
    positions: object,
    names: Sequence[str] | None = None,
    residues: Sequence[str] | None = None,
    chains: Sequence[str] | None = None,
    numbers: Sequence[int] | None = None,
) -> None:
    """Atoms as mmCIF."""
    points = rows_of("positions", positions, 3)
    count = len(points)
    symbols = [str(e) for e in elements]
    columns = {
        "elements": symbols,
        "names": symbols if names is None else [str(v) for v in names],
        "residues": ["UNK"] * count if residues is None else [str(v) for v in residues],
        "chains": ["A"] * count if chains is None else [str(v) for v in chains],
        "numbers": ["1"] * count if numbers is None else [str(int(v)) for v in numbers],
    }
    for what, column in columns.items():
        if len(column) != count:
            raise InputError(f"{what} has {len(column)} entries for {count} positions; give one for each atom")
        for value in column:
            if not value or any(c.isspace() or c in "'\"#_;$[]" for c in value[:1]) or any(c.isspace() for c in value):
                raise InputError(f"{what} holds {value!r}; give words of letters and digits")
    keys = ["group_PDB", "id", "type_symbol", "label_atom_id", "label_comp_id", "label_asym_id", "label_seq_id", "Cartn_x", "Cartn_y", "Cartn_z"]
    lines = ["data_atoms", "loop_", *(f"_atom_site.{key}" for key in keys)]
    rows = zip(columns["elements"], columns["names"], columns["residues"], columns["chains"], columns["numbers"], points.tolist())
    lines += [f"ATOM {i + 1} {e} {n} {r} {c} {s} {x!r} {y!r} {z!r}" for i, (e, n, r, c, s, (x, y, z)) in enumerate(rows)]
    _write(path, ("\n".join(lines) + "\n#\n").encode())


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


def _write(path: Path, *parts: bytes) -> None:
    try:
        with open(path, "wb") as out:
            for part in parts:
                out.write(part)
    except OSError as error:
        raise FileError(f"{path}: {error.strerror}") from error
