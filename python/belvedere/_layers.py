"""Layers of a scene from arrays and files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Mapping, Sequence, TypeVar

import numpy as np

from . import _data, _models, _rasters, _vectors
from ._crs import Crs, crs_of
from ._masks import joined
from .errors import InputError

if TYPE_CHECKING:
    from ._native import NativeArrays

S = TypeVar("S", bound="Layers")


class Layers:
    """The part of :class:`belvedere.Scene` that adds layers."""

    _document: dict[str, Any]
    _arrays: NativeArrays
    _roots: list[str]
    _array_crs: Crs | None

    if TYPE_CHECKING:

        def _changed(self) -> dict[str, Any]: ...

    def add_terrain(
        self: S,
        heights: object,
        *,
        transform: object = None,
        spacing: object = None,
        origin: Sequence[float] | None = None,
        crs: object = None,
        nodata: object = None,
        id: str = "ground",
        style: Mapping[str, Any] | None = None,
        **keys: Any,
    ) -> S:
        """Adds ground.

        * ``heights``: metres; rows from north to south. An array of integers or floats of any byte order, a masked array, a rasterio dataset, an
          xarray object, or the path of a file. Masked samples, no-data, NaN and infinities are holes.
        * ``transform``: affine map from corners of pixels to coordinates, as rasterio writes it: ``Affine`` or ``(a, b, c, d, e, f)``;
        * or ``spacing``: distance between samples, coordinate units, one number or (along x, along y), and ``origin``: x, y of the first sample of
          the first row.
        * ``crs``: ``"EPSG:n"``, its number, an object of pyproj or rasterio; ``None`` = local, metres.
        * ``nodata``: stored value that stands for no data, before scale and offset of a dataset.
        * Files say themselves where they lie: of the five only ``crs`` and ``nodata`` go with a path, instead of what the file says.
        * ``fill_voids=True`` fills holes; other ``keys`` and ``style`` are those of scene files.
        """
        if not _rasters.is_raster(heights):
            if isinstance(heights, (str, os.PathLike)):
                stated = _data.stated_by_caller(transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata)
                return self._add("terrain", id, style, {**stated, **keys}, source=self._given(heights))
            heights = np.asanyarray(joined("heights", heights))
        found = _rasters.heights_of(heights, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata)
        name = self._new_array(id)
        _rasters.add_heights(self._arrays, name, found)
        if found.crs.code is None and self._document.get("crs", "auto") == "auto":
            self._document["crs"] = "local"
        self._array_crs = self._array_crs or found.crs
        return self._add("terrain", id, style, keys, source=f"array:{name}")

    def add_lines(self: S, lines: object, *, id: str = "lines", crs: object = None, must_see: bool = False,
                  style: Mapping[str, Any] | None = None, **keys: Any) -> S:  # fmt: skip
        """Adds lines on the ground.

        * ``lines``: an array ``(n, 2)`` of x, y, a list of them, a dictionary of them by name, GeoJSON, a geometry of shapely, a GeoDataFrame, or the
          path of a file (GPX, KML, GeoJSON, shapefile, GeoPackage). Heights are those of the ground.
        * ``crs``: system of the coordinates; by default what the data states, else that of the scene.
        * ``must_see``: whether it is a required feature, for constructors and measures.
        """
        return self._add_features("line", lines, id, crs, style, {"must_see": must_see, **keys})

    def add_areas(self: S, areas: object, *, id: str = "areas", crs: object = None, must_see: bool = False,
                  style: Mapping[str, Any] | None = None, **keys: Any) -> S:  # fmt: skip
        """Adds polygons on the ground: as :meth:`add_lines`, each array the outline of one."""
        return self._add_features("area", areas, id, crs, style, {"must_see": must_see, **keys})

    def add_points(self: S, points: object, *, id: str = "points", crs: object = None, must_see: bool = False,
                   style: Mapping[str, Any] | None = None, **keys: Any) -> S:  # fmt: skip
        """Adds points on the ground: as :meth:`add_lines`; an array ``(n, 2)`` is n points, a dictionary names them."""
        return self._add_features("point", points, id, crs, style, {"must_see": must_see, **keys})

    def add_mesh(self: S, vertices: object, faces: object = None, *, colors: object = None, id: str = "mesh", must_see: bool = False,
                 style: Mapping[str, Any] | None = None, **keys: Any) -> S:  # fmt: skip
        """Adds triangles.

        * ``vertices``: ``(n, 3)``, scene units; or the path of a file (OBJ, PLY, STL, glTF), without ``faces``.
        * ``faces``: ``(m, 3)`` indices of vertices, from 0.
        * ``colors``: ``(n, 3)`` of uint8, one for each vertex.
        """
        keys = {"must_see": must_see, **keys}
        if isinstance(vertices, (str, os.PathLike)):
            return self._add("mesh", id, style, keys, source=self._given(vertices))
        name = self._new_array(id)
        _models.add_triangles(self._arrays, name, vertices, faces, colors)
        return self._add("mesh", id, style, keys, source=f"array:{name}")

    def add_volume(self: S, values: object, *, spacing: object = 1.0, origin: object = 0.0, id: str = "volume", must_see: bool = False,
                   **keys: Any) -> S:  # fmt: skip
        """Adds voxels.

        * ``values``: ``(nz, ny, nx)``: x runs along the last axis; integers or floats of any byte order. Masked floats are NaN; masked integers are
          refused. Or the path of a file (VTK, NRRD, MetaImage, NIfTI, raw).
        * ``spacing``: distance between voxels along x, y, z, scene units; ``origin``: x, y, z of the first voxel.
        * ``transfer="ct-bone"`` and other ``keys`` are those of scene files.
        """
        keys = {"must_see": must_see, **keys}
        self._document.setdefault("unit", "voxel")
        if isinstance(values, (str, os.PathLike)):
            return self._add("volume", id, None, keys, source=self._given(values))
        name = self._new_array(id)
        _models.add_voxels(self._arrays, name, values, spacing, origin)
        return self._add("volume", id, None, keys, source=f"array:{name}")

    def add_atoms(self: S, elements: Sequence[str] | str | os.PathLike[str], positions: object = None, *, names: Sequence[str] | None = None,
                  residues: Sequence[str] | None = None, chains: Sequence[str] | None = None, numbers: Sequence[int] | None = None,
                  id: str = "atoms", must_see: bool = False, style: Mapping[str, Any] | None = None, **keys: Any) -> S:  # fmt: skip
        """Adds atoms; the scene is measured in angstrom.

        * ``elements``: symbols, one for each atom, and ``positions``: ``(n, 3)``, angstrom; or the path of a file (PDB, mmCIF, XYZ) alone.
        * ``names``, ``residues``, ``chains``, ``numbers`` (of residues): what selections such as ``select="chain B"`` mean.
        """
        keys = {"must_see": must_see, **keys}
        self._document.setdefault("unit", "angstrom")
        if isinstance(elements, (str, os.PathLike)):
            return self._add("molecule", id, style, keys, source=self._given(elements))
        name = self._new_array(id)
        _models.add_atoms(self._arrays, name, elements, positions, names, residues, chains, numbers)
        return self._add("molecule", id, style, keys, source=f"array:{name}")

    def add_layer(self: S, kind: str, *, id: str, **keys: Any) -> S:
        """Adds a layer of any kind by the keys of scene files, such as ``add_layer("boxes", id="houses", source="houses.csv")``."""
        return self._add(kind, id, None, keys)

    def add_stage(self: S, kind: str, **keys: Any) -> S:
        """Adds a stage that bends the view: ``terrain_disocclusion``, ``strip``, ``relief``, ``spline_bend`` or ``curved_rays``, with the keys of scene
        files, such as ``add_stage("spline_bend", presets="progressive")``."""
        self._changed().setdefault("stage", []).append({"kind": kind, **keys})
        return self

    def _add_features(self: S, kind: str, source: object, id: str, crs: object, style: Mapping[str, Any] | None, keys: dict[str, Any]) -> S:
        if isinstance(source, (str, os.PathLike)):
            if crs is not None:
                raise InputError("crs is that of arrays; a file states the system of its coordinates itself")
            return self._add(kind, id, style, keys, source=self._given(source))
        features, stated = _vectors.features_of(source, kind, crs)
        if stated is None and not (isinstance(source, Mapping) and "type" in source):
            stated = self._own_crs(kind)
        name = self._new_array(id)
        _vectors.add_features(self._arrays, name, features, stated)
        return self._add(kind, id, style, keys, source=f"array:{name}")

    def _own_crs(self, kind: str) -> Crs:
        stated = self._document.get("crs", "auto")
        if stated != "auto":
            return crs_of(stated)
        if self._array_crs is None:
            raise InputError(f"nothing says in which system the coordinates of the {kind} are; give crs='EPSG:n' (4326 for longitude and latitude), or add the terrain first")
        return self._array_crs

    def _add(self: S, kind: str, id: str, style: Mapping[str, Any] | None, keys: Mapping[str, Any], **more: Any) -> S:
        layer = {"kind": kind, "id": str(id), **more, **keys}
        if style:
            layer["style"] = dict(style)
        self._changed().setdefault("layer", []).append(layer)
        return self

    def _given(self, path: str | os.PathLike[str]) -> str:
        """A file that the caller names."""
        name = os.fspath(path)
        if name.startswith("builtin:"):
            return name
        name = os.path.realpath(name)
        self._roots.append(os.path.dirname(name))
        return name

    def _new_array(self, id: str) -> str:
        self._changed()
        name = "".join(c if c.isalnum() or c in "-_" else "_" for c in str(id)) or "layer"
        if name in self._arrays.names():
            raise InputError(f"there is a layer {id!r} already; give id= another name")
        return name
