"""Arrays of any type become heights, with holes where they are masked."""

from __future__ import annotations

import numpy as np
import pytest

import belvedere
from conftest import CELL, hills

FROM_ABOVE = belvedere.Camera(eye=(1185.0, 885.0, 5000.0), look_at=(1185.0, 886.0, 0.0), fov_y_deg=30.0)


def drawn(heights: object, **keys: object) -> belvedere.Picture:
    scene = belvedere.Scene(camera=FROM_ABOVE).add_terrain(heights, **{"spacing": CELL, **keys})
    return scene.render(size=(96, 72))


@pytest.mark.parametrize("dtype", ["int16", "uint16", "int32", "int64", "float16", "float32", "float64", ">i2", ">f4", ">f8", "longdouble"])
def test_every_type_and_byte_order_gives_the_same_ground(dtype: str) -> None:
    heights = np.round(hills())
    given = heights.astype(dtype)
    scene = belvedere.Scene(camera=FROM_ABOVE).add_terrain(given, spacing=CELL)
    at = np.array([[CELL * c, CELL * (59 - r)] for r, c in [(0, 0), (7, 31), (33, 40), (59, 79)]])
    want = [float(given[r, c]) for r, c in [(0, 0), (7, 31), (33, 40), (59, 79)]]
    np.testing.assert_allclose(scene.ground_m(at), want, atol=1e-3)


@pytest.mark.parametrize("how", ["mask", "nan", "inf", "nodata", "int nodata", "mask over huge"])
def test_masks_and_no_data_are_holes_and_never_heights(how: str) -> None:
    heights, hole = hills(), np.zeros((60, 80), bool)
    hole[20:30, 30:50] = True
    keys: dict[str, object] = {}
    given: object
    if how == "mask":
        given = np.ma.array(heights, mask=hole)
    elif how in ("nan", "inf"):
        given = np.where(hole, np.nan if how == "nan" else np.inf, heights)
    elif how == "nodata":
        given, keys = np.where(hole, np.float32(-3.4028235e38), heights).astype(">f4"), {"nodata": -3.4028234663852886e38}
    elif how == "int nodata":
        given, keys = np.where(hole, 321, heights).astype("int16"), {"nodata": 321}
        hole |= heights.astype("int16") == 321
    else:
        given = np.ma.array(np.where(hole, 8000.0, heights), mask=hole)
    picture = drawn(given, **keys)
    # Columns and rows of the hole, seen from above.
    inside = picture.world[np.isfinite(picture.world[..., 0])]
    column, row = inside[:, 0] / CELL, 59 - inside[:, 1] / CELL
    in_hole = (column > 30) & (column < 49) & (row > 20) & (row < 29)
    assert not in_hole.any(), "ground is drawn in the hole"
    assert np.isfinite(picture.depth).mean() > 0.2, "the rest is drawn"
    assert inside[:, 2].max() < 700


def test_a_masked_hole_can_be_filled_and_a_record_says_so() -> None:
    given = np.ma.array(hills(), mask=np.zeros((60, 80), bool))
    given[20:24, 30:34] = np.ma.masked
    record = drawn(given, fill_voids=True).record
    assert record["terrain"]["filled_nodes"] == 16
    assert drawn(given).record["terrain"]["void_nodes"] == 16


@pytest.mark.parametrize(
    ("heights", "words"),
    [
        (hills().astype(complex), "complex128"),
        (hills().astype(str), "not numbers"),
        (hills() > 300, "bool"),
        (hills().astype(object), "object"),
        (np.zeros(7), "(7,)"),
        (np.zeros((2, 3, 4)), "(2, 3, 4)"),
        (np.zeros((1, 9)), "(1, 9)"),
        (np.full((4, 4), np.nan), "none of the 16 heights"),
        (np.where(hills() > 400, 3e38, hills()), "nodata="),
    ],
)
def test_other_arrays_are_refused_in_words(heights: np.ndarray, words: str) -> None:
    with pytest.raises(belvedere.InputError) as refusal:
        drawn(heights)
    assert words in str(refusal.value)


def test_rows_from_south_to_north_are_turned() -> None:
    heights = hills()
    north_up, south_up = (CELL, 0, 0, 0, -CELL, 60 * CELL), (CELL, 0, 0, 0, CELL, 0)
    one = drawn(heights, transform=north_up, spacing=None)
    other = drawn(heights[::-1], transform=south_up, spacing=None)
    assert (one.rgba == other.rgba).all() and one.rgba[..., :3].std() > 5


def test_nothing_says_where_the_heights_lie() -> None:
    with pytest.raises(belvedere.InputError, match="transform="):
        belvedere.Scene().add_terrain(hills())
    with pytest.raises(belvedere.InputError, match="give one of them"):
        belvedere.Scene().add_terrain(hills(), spacing=1.0, transform=(1, 0, 0, 0, -1, 0))
    with pytest.raises(belvedere.InputError, match="affine"):
        belvedere.Scene().add_terrain(hills(), transform=(0, 0, 0, 0, 0, 0))
    with pytest.raises(belvedere.InputError, match="spacing"):
        belvedere.Scene().add_terrain(hills(), spacing=-3)


class Dataset:
    """A rasterio dataset, as far as it is used: no need for rasterio."""

    count, scales, offsets, nodata, crs = 1, (0.5,), (100.0,), -9999, "EPSG:32631"
    transform = (CELL, 0, 400000.0, 0, -CELL, 4700000.0)

    def __init__(self, mask: np.ndarray) -> None:
        self.mask = mask

    def read(self, band: int, masked: bool) -> np.ndarray:
        assert band == 1 and masked
        return np.ma.array(np.round(2 * (hills() - 100)).astype("int16"), mask=self.mask)


def test_a_dataset_brings_scale_place_and_mask() -> None:
    mask = np.zeros((60, 80), bool)
    mask[10, 10] = True
    scene = belvedere.Scene().add_terrain(Dataset(mask))
    assert scene.crs == "EPSG:32631"
    at = np.array([[400000.0 + CELL * 20.5, 4700000.0 - CELL * 30.5], [400000.0 + CELL * 10.5, 4700000.0 - CELL * 10.5]])
    np.testing.assert_allclose(scene.ground_m(at), [hills()[30, 20], np.nan], atol=0.3)


class DataArray:
    """An xarray DataArray, as far as it is used."""

    dims, attrs = ("y", "x"), {"_FillValue": -1.0}

    def __init__(self) -> None:
        values = hills()[::-1].copy()
        values[3, 4] = -1.0
        self.values, self.dtype = values, values.dtype
        along = {"x": 5000.0 + CELL * np.arange(80), "y": 9000.0 + CELL * np.arange(60)}
        self.coords = {name: type("Coordinate", (), {"values": v})() for name, v in along.items()}
        self.rio = type("Rio", (), {"crs": type("C", (), {"to_epsg": lambda self: 25832})(), "nodata": None})()

    def squeeze(self, drop: bool) -> "DataArray":
        return self


def test_a_data_array_brings_coordinates_fill_value_and_system() -> None:
    scene = belvedere.Scene().add_terrain(DataArray())
    assert scene.crs == "EPSG:25832"
    at = [[5000.0 + CELL * 12, 9000.0 + CELL * 7], [5000.0 + CELL * 4, 9000.0 + CELL * 3]]
    np.testing.assert_allclose(scene.ground_m(at), [hills()[::-1][7, 12], np.nan], atol=1e-3)
