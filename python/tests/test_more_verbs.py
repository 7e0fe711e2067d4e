"""Drafts, drapes, rivers and levels of cities."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import CELL, ROUTE, hills

import belvedere
from belvedere import _png

VIEW = {"eye": (1200.0, -1500.0, 900.0), "look_at": (1200.0, 1000.0, 300.0)}


def test_drafts_are_views_that_reveal_draws(tmp_path: Path) -> None:
    found = belvedere.drafts(hills(), {"path": ROUTE}, count=3, spacing=CELL, size=(96, 54))
    assert 2 <= len(found) <= 3 and found.sheet.shape[1] > 96 and found.sheet.std() > 10
    assert len({tuple(np.round(d.eye)) for d in found.drafts}) == len(found)
    again = belvedere.reveal(hills(), {"path": ROUTE}, spacing=CELL, size=(96, 54), **found[1].view)
    assert again.report.bent.visible == pytest.approx(found[1].bent.visible, abs=1e-9)
    path = found.save(tmp_path / "sheet.png")
    assert path.read_bytes() == found._repr_mimebundle_()["image/png"]
    with pytest.raises(belvedere.FileError, match="overwrite"):
        found.save(path)
    with pytest.raises(belvedere.InputError, match="1 to 24"):
        belvedere.drafts(hills(), {"path": ROUTE}, count=25, spacing=CELL)
    with pytest.raises(TypeError, match="eye"):
        belvedere.drafts(hills(), {"path": ROUTE}, spacing=CELL, eye=(0, 0, 0))


def test_a_png_is_read_as_the_pixels_that_were_written() -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (5, 7, 3), np.uint8)
    data = _png.rgb(pixels)
    import struct
    import zlib

    assert data[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", data[16:24]) == (7, 5)
    length = struct.unpack(">I", data[33:37])[0]
    rows = np.frombuffer(zlib.decompress(data[41 : 41 + length]), np.uint8).reshape(5, 22)
    assert (rows[:, 0] == 0).all() and (rows[:, 1:].reshape(5, 7, 3) == pixels).all()


def geotiff(path: Path, rgb: tuple[int, int, int]) -> Path:
    """A picture of one colour over the hills, as three bands of a GeoTIFF."""
    rasterio = pytest.importorskip("rasterio", reason="SKIPPED: no drape is tried; rasterio is not installed")
    with rasterio.open(path, "w", driver="GTiff", width=80, height=60, count=3, dtype="uint8", crs="EPSG:32631",
                       transform=rasterio.Affine(CELL, 0, 400000, 0, -CELL, 4700000)) as file:  # fmt: skip
        for band, value in enumerate(rgb, 1):
            file.write(np.full((60, 80), value, np.uint8), band)
    return path


def test_a_picture_is_laid_over_the_ground(tmp_path: Path) -> None:
    drape = geotiff(tmp_path / "red.tif", (255, 0, 0))
    affine = (CELL, 0, 400000, 0, -CELL, 4700000)
    route = ROUTE + [400000, 4700000 - 1800]
    view = {"eye": (401200, 4696700, 900), "look_at": (401200, 4699200, 300)}
    plain, red = (
        belvedere.reveal(hills(), {"path": route}, transform=affine, crs="EPSG:32631", size=(96, 54), drape=picture, **view).picture
        for picture in (None, drape)
    )
    ground = (red.id == 1) & (plain.id == 1)
    more = [p.rgba[ground][:, 0].astype(int) - p.rgba[ground][:, 1] for p in (plain, red)]
    assert more[1].mean() > more[0].mean() + 40
    with pytest.raises(belvedere.InputError, match="paths"):
        belvedere.reveal(hills(), {"path": ROUTE}, spacing=CELL, drape=np.zeros((4, 4, 3), np.uint8))


def test_rivers_do_not_run_uphill_where_the_ground_moves() -> None:
    # A river along the crest of the ridge that hides the route, falling to the east.
    y, x = np.mgrid[0:30, 0:40].astype(float)
    ground = 300 + 250 * np.exp(-(((y - 16) / 2.5) ** 2)) - 3 * x
    crest = 29 * 60.0 - 16 * 60.0
    river = np.array([[100.0, crest], [1200.0, crest], [2300.0, crest]])
    asked = {"spacing": 60.0, "eye": (1200.0, -1500.0, 900.0), "look_at": (1200.0, 1000.0)}
    without, with_river = (belvedere.disocclude(ground, [ROUTE], rivers=rivers, **asked) for rivers in (None, [river]))
    rises = [np.diff(g.heights[16, 2:38]).max() for g in (without, with_river)]
    assert rises[0] > 1.0 and rises[1] < 0.1, rises
    with pytest.raises(belvedere.InputError, match="`technique` terrain"):
        belvedere.reveal(ground, [ROUTE], spacing=60.0, rivers=[river], **VIEW)
    shown = belvedere.reveal(ground, [ROUTE], spacing=60.0, rivers=[river], technique="terrain", size=(96, 54), **VIEW)
    assert shown.report.bent.visible >= shown.report.straight.visible


def town(folder: Path) -> tuple[Path, Path]:
    """A row of houses on both sides of each of three streets."""

    def square(x: float, y: float) -> list:
        return [[[x, y], [x + 12, y], [x + 12, y + 10], [x, y + 10], [x, y]]]

    def collection(features: list) -> dict:
        crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32631"}}
        return {"type": "FeatureCollection", "crs": crs, "features": features}

    houses = [
        {"type": "Feature", "properties": {"height": 8 + (i + j) % 5}, "geometry": {"type": "Polygon", "coordinates": square(400000 + 20 * i, 4700000 + 100 * j + side)}}
        for i in range(12) for j in range(3) for side in (-24, 14)
    ]  # fmt: skip
    streets = [
        {"type": "Feature", "properties": {"highway": "residential"}, "geometry": {"type": "LineString", "coordinates": line}}
        for line in [[[399980, 4700000 + 100 * j], [400260, 4700000 + 100 * j]] for j in range(3)] + [[[x, 4699950], [x, 4700250]] for x in (399980, 400260)]
    ]
    paths = folder / "houses.geojson", folder / "streets.geojson"
    for path, features in zip(paths, (houses, streets), strict=True):
        path.write_text(json.dumps(collection(features)))
    return paths


def test_a_city_in_levels(tmp_path: Path) -> None:
    houses, streets = town(tmp_path)
    found = belvedere.generalise(houses, streets, out=tmp_path / "levels")
    assert {"loa1.city.json", "loa2.city.json", "report.json"} <= {p.name for p in found.files} and all(p.is_file() for p in found.files)
    assert "72 buildings" in found.summary and found.raw["buildings"] == 72
    scene = belvedere.Scene(crs="EPSG:32631").add_layer("city", id="blocks", source=str(tmp_path / "levels" / "loa1.city.json"))
    scene._roots.append(str(tmp_path))
    assert scene.bounds is not None
    lower = belvedere.generalise(houses, streets, out=tmp_path / "lower", keep="volume")
    assert lower.raw["keep"] == "volume" and all(level["volume_kept"] for level in lower.raw["levels"]) and not lower.missed
    with pytest.raises(belvedere.FileError, match="exist"):
        belvedere.generalise(houses, streets, out=tmp_path / "levels")
    with pytest.raises(belvedere.FileError, match="none.geojson"):
        belvedere.generalise(tmp_path / "none.geojson", out=tmp_path / "other")
    with pytest.raises(belvedere.InputError, match="margin_m"):
        belvedere.generalise(houses, streets, out=tmp_path / "other", margin_m="wide")
