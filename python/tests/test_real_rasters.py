"""Heights by the packages themselves: rasterio, xarray, rioxarray; skipped where they are missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from belvedere import _rasters

rasterio = pytest.importorskip("rasterio")

#: Stored numbers, of which -32768 is no data, and their heights: half the number and 100 m.
STORED = np.array([[400, -32768, 200], [420, 600, 800], [10, 20, 30]], np.int16)
HEIGHTS = np.where(STORED == -32768, np.nan, 0.5 * STORED + 100.0)
PLACE = (10.0, 0.0, 400000.0, 0.0, -10.0, 4700000.0)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "heights.tif"
    keys = {"driver": "GTiff", "width": 3, "height": 3, "count": 1, "dtype": "int16", "crs": "EPSG:32631", "nodata": -32768}
    with rasterio.open(path, "w", transform=rasterio.Affine(*PLACE), **keys) as out:
        out.write(STORED, 1)
        out.scales, out.offsets = (0.5,), (100.0,)
    return path


def agrees(found: _rasters.Heights) -> None:
    np.testing.assert_allclose(found.values, HEIGHTS)
    np.testing.assert_allclose(found.transform, PLACE)
    assert str(found.crs) == "EPSG:32631"


def test_a_dataset_of_rasterio(file: Path) -> None:
    with rasterio.open(file) as dataset:
        agrees(_rasters.heights_of(dataset))
        assert np.isnan(_rasters.heights_of(dataset, nodata=400).values[0, 0]), "a stored value"


@pytest.mark.parametrize("keys", [{}, {"masked": True}, {"mask_and_scale": True}])
def test_an_array_of_rioxarray_decoded_or_not(file: Path, keys: dict[str, bool]) -> None:
    rioxarray = pytest.importorskip("rioxarray")
    with rioxarray.open_rasterio(file, **keys) as array:
        agrees(_rasters.heights_of(array))
        agrees(_rasters.heights_of(array.transpose("band", "x", "y")))


def test_an_array_of_xarray_decoded_or_not() -> None:
    xarray = pytest.importorskip("xarray")
    attrs = {"missing_value": -32768, "scale_factor": 0.5, "add_offset": 100.0}
    along = {"lat": [45.2, 45.1, 45.0], "lon": [7.0, 7.1, 7.2]}
    dataset = xarray.Dataset({"height": xarray.DataArray(STORED, along, ("lat", "lon"), attrs=attrs)})
    for given in (dataset, dataset["height"], dataset["height"].T, xarray.decode_cf(dataset)):
        found = _rasters.heights_of(given)
        np.testing.assert_allclose(found.values, HEIGHTS)
        assert str(found.crs) == "EPSG:4326" and found.transform[0] == pytest.approx(0.1)
