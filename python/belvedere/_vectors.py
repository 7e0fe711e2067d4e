"""Lines, areas and points from arrays, GeoJSON, shapely and GeoPandas for the engine."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ._crs import Crs, crs_of
from ._masks import joined, masked_count
from .errors import InputError

if TYPE_CHECKING:
    from ._native import NativeArrays

_LEAST = {"line": 2, "area": 3, "point": 1}


@dataclass(frozen=True)
class Features:
    """A GeoJSON collection, or names and positions of features of one kind: line, area or point."""

    kind: str
    collection: dict[str, Any] | None
    parts: Sequence[tuple[str, NDArray[np.float64]]] = ()


def features_of(source: object, kind: str, crs: object) -> tuple[Features, Crs | None]:
    """Features and the stated system; ``kind`` says what arrays are."""
    interface = source if isinstance(source, Mapping) and "type" in source else getattr(source, "__geo_interface__", None)
    stated = None if crs is None else crs_of(crs)
    if interface is not None:
        if stated is None and getattr(source, "crs", None) is not None:
            stated = crs_of(source.crs)  # type: ignore[attr-defined]
        return Features(kind, _collection(interface)), stated
    # Heights are those of the ground.
    parts = [(name, _points(f"{kind} {name!r}" if name else f"the {kind}", part, _LEAST[kind])[:, :2]) for name, part in _named(source, kind)]
    if not parts:
        raise InputError(f"there is no {kind}; give at least one")
    return Features(kind, None, parts), stated


def add_features(arrays: NativeArrays, name: str, features: Features, crs: Crs | None) -> None:
    """Hands features with their system over under a name."""
    if features.collection is None:
        positions = np.concatenate([part for _, part in features.parts]).astype("<f8", copy=False).tobytes()
        counts = [len(part) for _, part in features.parts]
        arrays.add_features(name, features.kind, positions, [n for n, _ in features.parts], counts, None if crs is None else crs.code)
        return
    collection = features.collection
    if crs is not None:
        system = "local" if crs.code is None else f"urn:ogc:def:crs:EPSG::{crs.code}"
        collection = {**collection, "crs": {"type": "name", "properties": {"name": system}}}
    try:
        text = json.dumps(collection, default=str, allow_nan=False)
    except ValueError:
        raise InputError("a coordinate is not finite; leave such points out") from None
    arrays.add_collection(name, text)


def _collection(interface: Mapping[str, Any]) -> dict[str, Any]:
    kind = interface.get("type")
    if kind == "FeatureCollection":
        features = [_clean(f) for f in interface["features"]]
    elif kind == "Feature":
        features = [_clean(interface)]
    else:
        features = [{"type": "Feature", "properties": {}, "geometry": _lists(interface)}]
    if not features:
        raise InputError("the features are empty; give at least one")
    return {"type": "FeatureCollection", "features": features}


def _clean(feature: Mapping[str, Any]) -> dict[str, Any]:
    properties = {str(k): _value(v) for k, v in (feature.get("properties") or {}).items()}
    return {"type": "Feature", "properties": properties, "geometry": _lists(feature.get("geometry"))}


def _value(value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _lists(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _lists(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_lists(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def _named(source: Any, kind: str) -> list[tuple[str, Any]]:
    if isinstance(source, Mapping):
        if kind == "point":
            return [(str(name), p[None, :]) for name, value in source.items() for p in _points(f"the points {str(name)!r}", value, 1)]
        return [(str(name), value) for name, value in source.items()]
    if kind == "point":
        points = _points("points", source, 1)
        return [("", p[None, :]) for p in points]
    if _is_one(source):
        return [("", source)]
    try:
        return [("", part) for part in source]
    except TypeError:
        raise InputError(f"{type(source).__name__} is no {kind}; give an array of x, y, a list of them, GeoJSON, or a GeoDataFrame") from None


def _is_one(source: Any) -> bool:
    """Whether it is one array of points rather than several."""
    if isinstance(source, np.ndarray):
        return source.ndim == 2
    try:
        return np.asarray(source, float).ndim == 2
    except (TypeError, ValueError):
        return False


def _points(what: str, source: Any, least: int) -> NDArray[np.float64]:
    source = joined(what, source)
    if masked_count(source):
        raise InputError(f"{what}: {masked_count(source)} coordinates are masked; leave such points out")
    try:
        points = np.asarray(source, np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{what}: coordinates are numbers; give an array of x, y or x, y, z") from None
    if points.ndim == 1 and points.size in (2, 3):
        points = points[None, :]
    if points.ndim != 2 or points.shape[1] not in (2, 3) or points.shape[0] < least:
        raise InputError(f"{what} has the shape {points.shape}; give at least {least} rows of x, y or x, y, z")
    bad = np.flatnonzero(~np.isfinite(points[:, :2]).all(axis=1))
    if bad.size:
        raise InputError(f"{what}: point {bad[0]} of {len(points)} is not finite; leave such points out")
    return points
