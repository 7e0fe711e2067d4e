"""Datasets of VTK as triangles with colours."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.util.numpy_support import vtk_to_numpy

from .errors import InputError

#: Array that carries colours through filters of VTK.
_COLORS = "belvedere_colors"


@dataclass(frozen=True)
class Triangles:
    """Triangles of a dataset."""

    points: NDArray[np.float64]
    faces: NDArray[np.int64]
    #: One for each point.
    colors: NDArray[np.uint8]


def triangles_of(dataset: Any, *, width: float, actor: Any = None) -> Triangles | None:
    """The surface of a dataset; ``None`` if there is none. Lines become tubes and lone points balls, ``width`` wide, scene units.

    * ``actor``: that of a plotter, whose colours and place hold; else arrays ``RGB`` or ``RGBA`` of uint8, else grey.
    """
    if not dataset.n_points or not dataset.n_cells:
        return None
    data = pv.wrap(dataset).copy(deep=False)
    data.clear_data()
    colors, of_points = _colors_of(actor, dataset)
    (data.point_data if of_points else data.cell_data)[_COLORS] = colors
    if actor is not None:
        matrix = pv.array_from_vtkmatrix(actor.GetMatrix())
        if not np.array_equal(matrix, np.eye(4)):
            data = data.cast_to_structured_grid() if isinstance(data, (pv.ImageData, pv.RectilinearGrid)) else data.copy()
            data.points = data.points.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    surface = data if isinstance(data, pv.PolyData) else data.extract_surface(algorithm="geometry")
    parts = [_flat(part) for part in _solids(surface, width)]
    parts = [part for part in parts if len(part.faces)]
    if not parts:
        return None
    starts = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    return Triangles(
        np.vstack([part.points for part in parts]),
        np.vstack([part.faces + start for part, start in zip(parts, starts)]),
        np.vstack([part.colors for part in parts]),
    )


def _solids(surface: Any, width: float) -> list[Any]:
    """Faces, tubes around lines, balls around points."""
    solids = []
    faces = surface.n_cells - surface.n_lines - surface.n_verts
    if faces:
        solids.append(surface.triangulate())
    if surface.n_lines:
        lines = pv.PolyData(surface.points, lines=surface.lines)
        first = surface.n_verts
        if _COLORS in surface.point_data:
            lines.point_data[_COLORS] = surface.point_data[_COLORS]
        else:
            lines.cell_data[_COLORS] = surface.cell_data[_COLORS][first : first + surface.n_lines]
        # Repeated points make no tube.
        solids.append(lines.clean().tube(radius=0.5 * width, n_sides=12, capping=True).triangulate())
    if surface.n_verts and not faces and not surface.n_lines:
        ball = pv.Icosphere(radius=0.5 * width, nsub=1)
        at = surface.cell_centers() if _COLORS in surface.cell_data else pv.PolyData(surface.points)
        rgb = (surface.cell_data if _COLORS in surface.cell_data else surface.point_data)[_COLORS]
        count = ball.n_points
        points = (np.asarray(at.points, float)[:, None, :] + np.asarray(ball.points, float)).reshape(-1, 3)
        faces = (ball.regular_faces[None] + count * np.arange(at.n_points)[:, None, None]).reshape(-1, 3)
        balls = pv.PolyData.from_regular_faces(points, faces)
        balls.point_data[_COLORS] = np.repeat(rgb, count, axis=0)
        solids.append(balls)
    return solids


def _flat(part: Any) -> Triangles:
    """Points, faces and colours; where cells have the colours, each has points of its own."""
    points, faces = np.asarray(part.points, np.float64), np.asarray(part.regular_faces, np.int64)
    if _COLORS in part.point_data:
        return Triangles(points, faces, np.asarray(part.point_data[_COLORS], np.uint8)[:, :3])
    own = np.arange(faces.size).reshape(-1, 3)
    first = part.n_verts + part.n_lines
    rgb = np.asarray(part.cell_data[_COLORS], np.uint8)[first : first + len(faces), :3]
    return Triangles(points[faces.ravel()], own, np.repeat(rgb, 3, axis=0))


def _colors_of(actor: Any, dataset: Any) -> tuple[NDArray[np.uint8], bool]:
    """Colours of points or cells, and whether they are of points."""
    if actor is None:
        for name in ("RGB", "RGBA"):
            for of_points, arrays in ((True, dataset.point_data), (False, dataset.cell_data)):
                if name in arrays and arrays[name].dtype == np.uint8:
                    return np.asarray(arrays[name])[:, :3], of_points
        return np.full((dataset.n_points, 3), 200, np.uint8), True
    mapper = actor.mapper
    if mapper.GetScalarVisibility():
        in_cells = mutable(0)
        array = mapper.GetAbstractScalars(
            dataset, mapper.GetScalarMode(), mapper.GetArrayAccessMode(), mapper.GetArrayId(), mapper.GetArrayName() or "", in_cells
        )
        if array is not None:
            # A copy, for the mapper's range is set in its own table when it draws.
            table = mapper.GetLookupTable().NewInstance()
            table.DeepCopy(mapper.GetLookupTable())
            if not mapper.GetUseLookupTableScalarRange():
                table.SetRange(*mapper.GetScalarRange())
            table.Build()
            rgba = vtk_to_numpy(table.MapScalars(array, mapper.GetColorMode(), mapper.GetArrayComponent()))
            return np.ascontiguousarray(rgba[:, :3]), not int(in_cells)
    if actor.GetTexture() is not None:
        warnings.warn("a mesh has a texture, which is left out; give it colours", stacklevel=4)
    rgb = np.round(255 * np.asarray(actor.prop.color.float_rgb)).astype(np.uint8)
    return np.tile(rgb, (dataset.n_points, 1)), True


def points_of(dataset: Any) -> NDArray[np.float64]:
    """The points of a dataset, in the order of its arrays."""
    if not isinstance(dataset, pv.DataSet):
        raise InputError(f"{type(dataset).__name__} is no dataset of PyVista; give a pyvista.DataSet")
    return np.asarray(dataset.points, np.float64)
