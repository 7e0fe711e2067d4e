"""Terrain and features of a call as sources for the engine: files, and arrays by name."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np

from . import _rasters, _vectors
from ._ask import number
from ._crs import Crs, crs_of
from ._masks import joined
from .errors import InputError

if TYPE_CHECKING:
    from ._native import NativeArrays


def sources_of(
    dem: object,
    routes: object,
    *,
    transform: object,
    spacing: object,
    origin: Sequence[float] | None,
    crs: object,
    nodata: object,
    features_crs: object,
    fill_voids: bool | None,
    arrays: NativeArrays,
    rivers: object = None,
    drape: object = None,
) -> dict[str, Any]:
    """Sources of terrain and features, as the engine takes them; arrays are added to ``arrays``."""
    files: dict[str, Any] = {}
    terrain_crs: Crs | None = None
    if isinstance(dem, (str, os.PathLike)):
        files["data"] = os.fspath(dem)
        files.update(stated_by_caller(transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata))
    else:
        source = dem if _rasters.is_raster(dem) else np.asanyarray(joined("heights", dem))
        heights = _rasters.heights_of(source, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata)
        _rasters.add_heights(arrays, "terrain", heights)
        terrain_crs, files["data"] = heights.crs, "array:terrain"
        if terrain_crs.code is None:
            files["crs"] = "local"
        # Holes of an array are what the caller masked.
        fill_voids = bool(fill_voids)
    files["keep_voids"], files["fill_voids"] = fill_voids is False, fill_voids is True
    files["features"] = [_source_of("features", i, source, features_crs, terrain_crs, arrays) for i, source in enumerate(_several(routes))]
    files["rivers"] = [_source_of("rivers", i, source, features_crs, terrain_crs, arrays) for i, source in enumerate(_several(rivers))]
    if drape is not None:
        files["drape"] = [_path("drape", picture) for picture in _several(drape)]
    return files


def _path(what: str, value: object) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise InputError(f"{what} holds {type(value).__name__}; give paths of georeferenced pictures")
    return os.fspath(value)


def stated_by_caller(*, transform: object, spacing: object, origin: object, crs: object, nodata: object) -> dict[str, Any]:
    """What a caller says of a terrain file, as keys of its layer."""
    if transform is not None or spacing is not None or origin is not None:
        raise InputError("transform, spacing and origin are of arrays; a file says itself where it lies")
    stated: dict[str, Any] = {}
    if crs is not None:
        stated["source_crs"] = str(crs_of(crs))
    if nodata is not None:
        stated["nodata"] = number("nodata", nodata)
    return stated


def _several(routes: object) -> list[object]:
    if routes is None:
        return []
    if isinstance(routes, (list, tuple)) and routes and all(isinstance(r, (str, os.PathLike)) for r in routes):
        return list(routes)
    return [routes]


def _source_of(what: str, i: int, source: object, crs: object, terrain: Crs | None, arrays: NativeArrays) -> str:
    if isinstance(source, (str, os.PathLike)):
        if crs is not None and what == "features":
            raise InputError("features_crs is that of arrays; a file states the system of its coordinates itself")
        return os.fspath(source)
    features, stated = _vectors.features_of(source, "line", crs)
    if stated is None and not (isinstance(source, Mapping) and "type" in source):
        if terrain is None:
            raise InputError(f"nothing says in which system the coordinates of the {what} are; give features_crs='EPSG:n' (4326 for longitude and latitude)")
        stated = terrain
    name = f"{what}{i + 1}"
    _vectors.add_features(arrays, name, features, stated)
    return f"array:{name}"
