"""What a caller or a source says of holes and places is never dropped in silence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import belvedere
from belvedere import _rasters
from conftest import CELL, hills

NORTH_UP = (CELL, 0.0, 400000.0, 0.0, -CELL, 4700000.0)
IN_HOLE, BESIDE = [400000.0 + CELL * 40.5, 4700000.0 - CELL * 25.5], [400000.0 + CELL * 10.5, 4700000.0 - CELL * 10.5]


def written(folder: Path) -> Path:
    """A file with 777 in a hole, which it does not call no data, nor does it state a system."""
    heights = hills()
    heights[20:30, 30:50] = 777.0
    belvedere.Scene().add_terrain(heights, transform=NORTH_UP, id="heights").save(folder / "scene.json")
    return folder / "heights.tif"


def test_no_data_and_system_that_are_given_with_a_file_are_kept(tmp_path: Path) -> None:
    path = written(tmp_path)
    scene = belvedere.Scene().add_terrain(path, nodata=777, crs=32631)
    assert scene.crs == "EPSG:32631"
    found = scene.ground_m([IN_HOLE, BESIDE])
    assert np.isnan(found[0]) and found[1] == pytest.approx(hills()[10, 10], abs=1.0)
    assert belvedere.Scene().add_terrain(path, crs=32631).ground_m([IN_HOLE])[0] == pytest.approx(777), "without nodata it is a height"


@pytest.mark.parametrize("keys", [{"transform": NORTH_UP}, {"spacing": CELL}, {"origin": (0.0, 0.0)}])
def test_a_place_that_is_given_with_a_file_is_refused(tmp_path: Path, keys: dict[str, Any]) -> None:
    with pytest.raises(belvedere.InputError, match="a file says itself where it lies"):
        belvedere.Scene().add_terrain(written(tmp_path), **keys)


def test_a_system_that_is_given_with_a_file_of_lines_is_refused() -> None:
    with pytest.raises(belvedere.InputError, match="states the system"):
        belvedere.Scene().add_lines("route.gpx", crs=4326)
    with pytest.raises(belvedere.InputError, match="states the system"):
        belvedere.reveal("builtin:massif", "route.gpx", features_crs=4326)


def rows(values: Any, masked: tuple[int, int]) -> list[Any]:
    array = np.ma.array(np.asarray(values, float), mask=False)
    array[masked] = np.ma.masked
    return list(array)


def test_lists_of_masked_rows_keep_their_masks() -> None:
    heights = hills()
    given = rows(np.where(heights == heights[25, 40], 8000.0, heights), (25, 40))
    scene = belvedere.Scene().add_terrain(given, spacing=CELL)
    at = [[CELL * 40, CELL * (59 - 25)], [CELL * 10, CELL * (59 - 10)]]
    np.testing.assert_allclose(scene.ground_m(at), [np.nan, heights[10, 10]], atol=1e-3)
    # Lists of lists, and rows of different lengths.
    nested = _rasters.heights_of(np.asanyarray(belvedere._masks.joined("heights", [[1, np.ma.masked], [3, 4]])), spacing=1.0)
    np.testing.assert_array_equal(nested.values, [[1, np.nan], [3, 4]])
    with pytest.raises(belvedere.InputError, match="different lengths"):
        belvedere.Scene().add_terrain([given[0], given[1][:7]], spacing=CELL)


def test_masked_rows_of_coordinates_are_refused() -> None:
    plane, space = rows([[300, 300], [600, 600], [900, 300]], (1, 0)), rows([[0, 0, 0], [1, 0, 0], [0, 1, 0]], (1, 2))
    scene = belvedere.Scene().add_terrain(hills(), spacing=CELL)
    for call in (
        lambda: scene.add_lines(plane),
        lambda: scene.add_lines({"path": plane}),
        lambda: scene.add_points(plane),
        lambda: scene.add_areas([plane]),
        lambda: scene.add_mesh(space, [[0, 1, 2]]),
        lambda: scene.add_mesh(np.eye(3), np.ma.array([[0, 1, 2]], mask=[[0, 0, 1]])),
        lambda: scene.add_atoms(["C", "C", "C"], space),
        lambda: scene.project(space),
        lambda: scene.ground_m(plane),
    ):
        with pytest.raises(belvedere.InputError, match="masked"):
            call()


class Scaled:
    """A rasterio dataset of whole numbers: a height is half the number and 100, and nothing states no data."""

    count, scales, offsets, nodata, crs, transform = 1, (0.5,), (100.0,), None, "EPSG:32631", NORTH_UP

    def read(self, band: int, masked: bool) -> Any:
        return np.ma.array([[400, 0, 200], [420, 600, 800]], dtype="int16")


def test_no_data_that_is_given_is_compared_before_scale_and_offset() -> None:
    found = _rasters.heights_of(Scaled(), nodata=0)
    np.testing.assert_allclose(found.values, [[300, np.nan, 200], [310, 400, 500]])
    # 200 is a stored value, and a height of another.
    found = _rasters.heights_of(Scaled(), nodata=200)
    np.testing.assert_allclose(found.values, [[300, 100, np.nan], [310, 400, 500]])


class Labelled:
    """A DataArray of xarray, as far as it is used, without rioxarray."""

    def __init__(self, dims: tuple[str, str], values: Any, along: dict[str, Any] | None = None, axes: dict[str, str] | None = None, **attrs: Any) -> None:
        self.dims, self.values, self.attrs = dims, np.asarray(values), attrs
        self.dtype = self.values.dtype
        one = lambda name, v: type("Coordinate", (), {"values": np.asarray(v), "attrs": {"axis": (axes or {}).get(name, "")}})()
        self.coords = {name: one(name, v) for name, v in (along or {}).items()}

    def squeeze(self, drop: bool) -> Labelled:
        return self

    def transpose(self, first: str, second: str) -> Labelled:
        turned = Labelled((first, second), self.values.T, **self.attrs)
        turned.coords = self.coords
        return turned


STORED = [[400, -9, 200], [420, 600, -7]]
PLACE = {"x": [0.0, 1.0, 2.0], "y": [1.0, 0.0]}


@pytest.mark.parametrize("attrs", [{"_FillValue": -9, "missing_value": -7}, {"missing_value": [-9, -7]}, {"nodatavals": (-9, -7)}])
def test_no_data_of_attributes_become_holes(attrs: dict[str, Any]) -> None:
    found = _rasters.heights_of(Labelled(("y", "x"), STORED, PLACE, **attrs))
    np.testing.assert_array_equal(found.values, [[400, np.nan, 200], [420, 600, np.nan]])


def test_scale_and_offset_that_are_still_attributes_are_applied_after_masking() -> None:
    found = _rasters.heights_of(Labelled(("y", "x"), STORED, PLACE, missing_value=-9, scale_factor=0.1, add_offset=10.0))
    np.testing.assert_allclose(found.values, [[50, np.nan, 30], [52, 70, 9.3]], rtol=1e-6)


def test_dimensions_say_which_are_columns_or_are_refused() -> None:
    wanted, turned = np.asarray(STORED, np.float32), np.asarray(STORED).T
    for columns, rows_, axes in (("longitude", "lat", {}), ("easting", "northing", {}), ("projection_x_coordinate", "projection_y_coordinate", {}),
                                 ("rlon", "rlat", {"rlon": "X", "rlat": "Y"}), ("X", "Y", {}), ("x_2", "y_2", {})):  # fmt: skip
        along = {columns: PLACE["x"], rows_: PLACE["y"]}
        found = _rasters.heights_of(Labelled((columns, rows_), turned, along, axes))
        np.testing.assert_array_equal(found.values, wanted)
    for dims in (("dim_0", "dim_1"), ("time", "x"), ("x", "x2"), ("rlat", "rlon")):
        with pytest.raises(belvedere.InputError, match="rename"):
            _rasters.heights_of(Labelled(dims, STORED), spacing=1.0)


def test_coordinates_may_be_missing_where_the_caller_places_the_array() -> None:
    bare = Labelled(("y", "x"), STORED)
    assert _rasters.heights_of(bare, spacing=2.0).transform[0] == 2.0
    assert _rasters.heights_of(bare, transform=NORTH_UP).transform == NORTH_UP
    with pytest.raises(belvedere.InputError, match="no coordinates along x or y; give transform="):
        _rasters.heights_of(bare)
