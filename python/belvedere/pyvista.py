"""PyVista and VTK: scenes of plotters and datasets, datasets that are bent or know what is visible, and cameras both ways.

Needs the package pyvista: ``pip install pyvista``. Points have the order of ``dataset.points``; that of a StructuredGrid runs down the first
axis fastest, unlike ``X.ravel()``. Rows of our pictures begin at the top, display coordinates of VTK at the bottom.
"""

from __future__ import annotations

import itertools
import re
import warnings
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

try:
    import pyvista as pv
except ImportError as _error:
    raise ImportError("belvedere.pyvista needs the package pyvista: pip install pyvista") from _error

from ._ask import Progress
from ._vtk import points_of, triangles_of
from .camera import Camera
from .errors import InputError
from .picture import Picture
from .scene import Scene

__all__ = ["camera_of", "place_camera", "scene_of", "render", "warped", "visibility"]


def camera_of(plotter: Any) -> Camera:
    """The camera of a plotter, or a camera of PyVista, as ours: eye, point looked at, upright direction, full vertical field of view (degrees) or
    height of a parallel picture (scene units), and the near plane.

    Raises :class:`belvedere.InputError` for cameras that are no pinhole in the middle of their picture.
    """
    camera = plotter.camera if isinstance(plotter, pv.BasePlotter) else plotter
    if not isinstance(camera, pv.Camera):
        raise InputError(f"{type(camera).__name__} is no camera; give a pyvista.Plotter or pyvista.Camera")
    if any(camera.GetWindowCenter()) or camera.GetUseOffAxisProjection() or camera.GetUseExplicitProjectionTransformMatrix():
        raise InputError("the camera of the plotter has its axis beside the middle of the picture; set its window centre to (0, 0)")
    fov = float(camera.view_angle)
    if camera.GetUseHorizontalViewAngle():
        size = plotter.window_size if isinstance(plotter, pv.BasePlotter) else None
        if size is None:
            raise InputError("the field of view of the camera is horizontal; give the plotter, whose window says how high that is")
        fov = float(np.degrees(2 * np.arctan(np.tan(np.radians(fov) / 2) * size[1] / size[0])))
    near = float(camera.clipping_range[0])
    return Camera(
        eye=tuple(float(v) for v in camera.position),
        look_at=tuple(float(v) for v in camera.focal_point),
        up=tuple(float(v) for v in camera.up),
        fov_y_deg=fov,
        near=max(near, 1e-6),
        ortho_height_m=2 * float(camera.parallel_scale) if camera.parallel_projection else None,
    )


def place_camera(plotter: Any, scene: Scene) -> None:
    """Places the camera of a plotter as that of a scene, without its bends: what :func:`warped` has moved is then seen where the scene's picture shows it,
    in a window of the proportions of the picture."""
    table = scene.resolved()["camera"]
    eye = np.asarray(table["eye"], float)
    camera = plotter.camera
    camera.SetUseHorizontalViewAngle(False)
    camera.SetWindowCenter(0.0, 0.0)
    camera.position, camera.up = tuple(eye), tuple(table.get("up", (0.0, 0.0, 1.0)))
    camera.focal_point = tuple(np.asarray(table["look_at"], float))
    height = table.get("ortho_height_m") if table.get("projection") == "orthographic" else None
    camera.parallel_projection = height is not None
    if height is not None:
        camera.parallel_scale = 0.5 * float(height)
    else:
        camera.view_angle = float(table["fov_y_deg"])
    camera.is_set = True
    plotter.renderer.ResetCameraClippingRange()


def scene_of(
    what: Any,
    *,
    stages: Sequence[Mapping[str, Any]] = (),
    must_see: Sequence[str] = (),
    camera: Camera | Mapping[str, Any] | None = None,
    crs: object = "local",
    unit: str = "metre",
    line_width: float | None = None,
    title: str = "",
) -> Scene:
    """A scene of a plotter, a dataset, or a dictionary of datasets by name; each becomes a mesh layer, named as in the plotter, or ``mesh1``, ``mesh2`` ...

    * ``what``: of a plotter its visible actors, where they stand, with their colours, and its camera. Datasets have the colours of their arrays ``RGB`` or
      ``RGBA`` (uint8), else grey. Lines become tubes and lone points balls. Volumes, textures, texts and opacity are left out; a warning says so.
    * ``stages``: what bends the view, with the keys of scene files, such as ``[{"kind": "spline_bend", "presets": "progressive"}]``.
    * ``must_see``: names of meshes for constructors and ``measure``.
    * ``camera``: instead of the plotter's. ``crs``, ``unit``, ``title``: see :class:`belvedere.Scene`.
    * ``line_width``: width of tubes and balls, scene units; by default as wide as in the plotter's picture, or a 300th of the datasets.
    """
    meshes, own = _meshes_of(what, line_width)
    if not meshes:
        raise InputError("there is no mesh; add one to the plotter, or give datasets with faces, lines or points")
    missing = [name for name in must_see if name not in meshes]
    if missing:
        raise InputError(f"must_see names {missing[0]!r}, and the meshes are {', '.join(meshes)}")
    scene = Scene(camera=camera or own, crs=crs, unit=unit, title=title)
    for name, found in meshes.items():
        scene.add_mesh(found.points, found.faces, colors=found.colors, id=name, must_see=name in must_see)
    for stage in stages:
        scene.add_stage(**{str(key): value for key, value in stage.items()})
    return scene


def render(what: Any, *, stages: Sequence[Mapping[str, Any]] = (), size: tuple[int, int] | None = None, must_see: Sequence[str] = (), **drawing: Any) -> Picture:
    """The picture of :func:`scene_of`; of a plotter in the size of its window unless ``size`` is given. ``drawing``: as of :meth:`belvedere.Scene.render`."""
    if size is None and isinstance(what, pv.BasePlotter):
        size = (int(what.window_size[0]), int(what.window_size[1]))
    return scene_of(what, stages=stages, must_see=must_see).render(size, **drawing)


def warped(dataset: Any, scene: Scene, *, threads: int | None = None, progress: Progress = None) -> Any:
    """A copy of a dataset whose points stand where the stages of the scene put them, so that VTK with the scene's straight camera (:func:`place_camera`) draws
    what we draw.

    * Its arrays are kept, and ``displacement`` ``(n, 3)``, scene units, is added. Image data and rectilinear grids become structured grids.
    * Cells with a point that no ray reaches are left out, and the result is an unstructured grid then; a warning counts them.
    """
    points = points_of(dataset)
    moved: NDArray[np.float64] = scene.displace(points, threads=threads, progress=progress).point
    result = dataset.cast_to_structured_grid() if isinstance(dataset, (pv.ImageData, pv.RectilinearGrid)) else dataset.copy()
    lost: NDArray[np.bool_] = np.asarray(np.isnan(moved).any(axis=1))
    result.points = np.where(lost[:, None], points, moved)
    result.point_data["displacement"] = np.where(lost[:, None], 0.0, moved - points)
    for arrays in (result.point_data, result.cell_data):
        # Those of the surface as it was.
        arrays.pop("Normals", None)
    if lost.any():
        result.point_data["belvedere_lost"] = lost
        cells = result.point_data_to_cell_data().cell_data["belvedere_lost"] > 0
        warnings.warn(f"{int(lost.sum())} of {len(lost)} points are not displaced (behind the eye, or outside the domain); {int(np.sum(cells))} cells are left out", stacklevel=2)
        result = result.extract_cells(np.flatnonzero(~np.asarray(cells)))
        result.point_data.pop("belvedere_lost", None)
    return result


def visibility(
    dataset: Any, scene: Scene, *, size: tuple[int, int] | None = None, tolerance: float = 1e-3, threads: int | None = None, progress: Progress = None
) -> Any:
    """A copy of a dataset with the point arrays ``visible_straight`` and ``visible_bent``: whether the picture of the scene shows the point, without and with
    its bends. Points outside the picture are not visible.

    * ``size``: of the pictures whose depths decide, pixels; edges are right to within a pixel of it.
    * ``tolerance``: part of its depth by which a point may lie behind the surface that is drawn.
    """
    points = points_of(dataset)
    result = dataset.copy()
    for name, straight in (("visible_straight", True), ("visible_bent", False)):
        seen = scene.project(points, size=size, straight=straight, threads=threads, progress=progress)
        drawn = scene.render(size, straight=straight, buffers=True, samples=1, threads=threads, progress=progress)
        result.point_data[name] = _in_front(seen.pixel, seen.depth, seen.inside, drawn.depth, tolerance)
    return result


def _in_front(pixel: NDArray[Any], depth: NDArray[Any], inside: NDArray[Any], drawn: NDArray[Any], tolerance: float) -> NDArray[np.bool_]:
    """Whether points lie no deeper than what is drawn at their pixels or right beside."""
    rows, columns = drawn.shape
    wide = np.pad(drawn, 1, mode="edge")
    farthest = np.max([wide[i : i + rows, j : j + columns] for i in range(3) for j in range(3)], axis=0)
    column, row = (np.clip(np.nan_to_num(pixel[:, k]).astype(int), 0, limit - 1) for k, limit in ((0, columns), (1, rows)))
    return np.asarray(inside & (np.nan_to_num(depth) <= farthest[row, column] * (1 + tolerance)), np.bool_)


def _meshes_of(what: Any, line_width: float | None) -> tuple[dict[str, Any], Camera | None]:
    """Meshes by name, and the camera of a plotter."""
    if isinstance(what, pv.BasePlotter):
        return _meshes_of_plotter(what, line_width), camera_of(what)
    if isinstance(what, pv.MultiBlock):
        what = _blocks(what)
    named = dict(what) if isinstance(what, Mapping) else {"mesh1": what}
    meshes = {}
    for name, dataset in named.items():
        points = points_of(dataset)
        width = float(np.linalg.norm(np.ptp(points, axis=0))) / 300 if line_width is None and len(points) else line_width or 1.0
        found = triangles_of(dataset, width=width or 1.0)
        if found is not None:
            meshes[str(name)] = found
    return meshes, None


def _meshes_of_plotter(plotter: Any, line_width: float | None) -> dict[str, Any]:
    meshes: dict[str, Any] = {}
    left_out = []
    for name, actor in plotter.renderer.actors.items():
        if not actor.GetVisibility():
            continue
        if not isinstance(actor, pv.Actor):
            left_out += [type(actor).__name__] if isinstance(actor, pv.Volume) or hasattr(actor, "mapper") else []
            continue
        dataset = actor.mapper.dataset
        if isinstance(dataset, pv.MultiBlock):
            dataset = dataset.combine()
        if actor.prop.opacity < 1:
            warnings.warn(f"{name} is transparent; it is drawn opaque", stacklevel=4)
        pixels = actor.prop.point_size if dataset.n_cells == dataset.n_points else actor.prop.line_width
        width = line_width or float(pixels) * _pixel_at(plotter, np.asarray(actor.center))
        found = triangles_of(dataset, width=width, actor=actor)
        if found is not None:
            named = not re.search(r"\(Addr=", name) and name not in meshes
            meshes[name if named else _free_name(plotter, meshes)] = found
    if left_out:
        warnings.warn(f"left out, since they are no meshes: {', '.join(sorted(set(left_out)))}", stacklevel=4)
    return meshes


def _free_name(plotter: Any, meshes: Mapping[str, Any]) -> str:
    """A name that no mesh of the plotter has."""
    taken = {*meshes, *plotter.renderer.actors}
    return next(name for name in (f"mesh{i}" for i in itertools.count(len(meshes) + 1)) if name not in taken)


def _blocks(blocks: Any, prefix: str = "") -> dict[str, Any]:
    """The datasets of nested blocks by name; empty blocks are left out."""
    found: dict[str, Any] = {}
    for i, (name, block) in enumerate(zip(blocks.keys(), blocks)):
        label = f"{prefix}{name or f'mesh{i + 1}'}"
        if isinstance(block, pv.MultiBlock):
            found.update(_blocks(block, f"{label}/"))
        elif block is not None:
            found[label] = block
    return found


def _pixel_at(plotter: Any, point: NDArray[Any]) -> float:
    """Size of a pixel of the plotter's picture at a point, scene units."""
    camera, height = plotter.camera, plotter.window_size[1]
    if camera.parallel_projection:
        return float(2 * camera.parallel_scale / height)
    depth = abs(float(np.dot(point - np.asarray(camera.position), np.asarray(camera.direction)))) or 1.0
    return float(2 * depth * np.tan(np.radians(camera.view_angle) / 2) / height)
