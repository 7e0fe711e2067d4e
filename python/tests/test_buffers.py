"""Arrays in memory: the pictures are those of the files that the arrays are saved as."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Callable

import numpy as np
import pytest

import belvedere
from conftest import CELL, ROUTE, hills

EYE, LOOK = (1200.0, -1500.0, 900.0), (1200.0, 1000.0, 300.0)


def ground() -> belvedere.Scene:
    heights = np.ma.array(hills() + 0.1234567, mask=np.zeros((60, 80), bool))
    heights[20:24, 30:34] = np.ma.masked
    scene = belvedere.Scene(camera=belvedere.Camera(EYE, LOOK)).add_terrain(heights, spacing=CELL)
    scene.add_lines({"path": ROUTE}, must_see=True).add_points({"hut": (900.0, 500.0)}, style={"labels": True})
    scene.add_areas({"lake": [(300, 300), (700, 300), (650, 620)]})
    scene.add_lines({"type": "LineString", "coordinates": [[300, 800], [1900, 700]]}, id="shape", crs="local")
    return scene.add_stage("spline_bend", presets="progressive")


def geographic() -> belvedere.Scene:
    transform = (1 / 3600, 0.0, 11.3, 0.0, -1 / 3600, 46.6)
    return belvedere.Scene().add_terrain(hills(), transform=transform, crs=4326).add_lines([(11.305, 46.59), (11.315, 46.588)], crs=4326)


def mesh() -> belvedere.Scene:
    points = np.random.default_rng(1).normal(0, 50, (30, 3))
    colors = np.random.default_rng(2).integers(0, 256, (30, 4)).astype(np.uint8)
    return belvedere.Scene(crs="local").add_mesh(points, np.arange(30).reshape(10, 3), colors=colors)


def volume() -> belvedere.Scene:
    z, y, x = np.mgrid[-1:1:24j, -1:1:28j, -1:1:32j]
    ball = 100.3 * np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, 1)
    ball[3, 3, 3] = np.nan
    return belvedere.Scene(crs="local").add_volume(ball, spacing=(1.0, 1.1, 0.9), origin=(-3.3, 0.1, 2.0), transfer="solid")


def atoms() -> belvedere.Scene:
    places = [[0.0, 0.0, 0.0], [1.5, 0.1, 0.0], [2.2, 1.3, 1 / 3]]
    return belvedere.Scene(crs="local").add_atoms(["C", "N", "O"], places, names=["CA", "N", "O"], chains=["A", "A", "B"], numbers=[1, 1, -7])


@pytest.mark.parametrize("made", [ground, geographic, mesh, volume, atoms])
def test_a_saved_scene_draws_the_same_bytes(made: Callable[[], belvedere.Scene], tmp_path: Path) -> None:
    scene = made()
    here = scene.render(size=(128, 80))
    assert here.id.any()
    saved = scene.save(tmp_path / "scene.json")
    assert "array:" not in saved.read_text()
    again = belvedere.Scene.open(saved)
    there = again.render(size=(128, 80))
    assert (here.rgba == there.rgba).all()
    np.testing.assert_array_equal(here.depth, there.depth)
    assert [w.kind for w in scene.warnings] == [w.kind for w in again.warnings]


def test_a_record_names_arrays_by_their_hash() -> None:
    values = np.arange(24, dtype=">i2").reshape(2, 3, 4)
    record = belvedere.Scene(crs="local").add_volume(values, id="my block", spacing=(1, 1, 2)).render(size=(16, 16)).record
    (entry,) = [i for i in record["inputs"] if i["path"].startswith("array:")]
    header = '{"array":"voxels","dims":[4,3,2],"origin":[0.0,0.0,0.0],"spacing":[1.0,1.0,2.0],"type":"int16"}\n'
    content = header.encode() + values.astype("<i2").tobytes()
    assert entry == {"path": "array:my_block", "bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def test_later_changes_of_an_array_do_not_change_the_scene() -> None:
    heights = hills().astype(np.float32)
    scene = belvedere.Scene(camera=belvedere.Camera(EYE, LOOK)).add_terrain(heights, spacing=CELL)
    before = scene.render(size=(64, 36))
    heights[:] = 0
    # Another camera is a scene that is opened anew.
    scene.camera = belvedere.Camera(EYE, LOOK)
    assert (scene.render(size=(64, 36)).rgba == before.rgba).all()


def test_a_document_alone_has_no_arrays() -> None:
    scene = belvedere.Scene().add_terrain(hills(), spacing=CELL)
    with pytest.raises(belvedere.Error, match="array:ground: there is no such array, none is in memory"):
        belvedere.Scene.from_document(scene.document).bounds
    with pytest.raises(belvedere.InputError, match="already"):
        scene.add_mesh(np.eye(3), [[0, 1, 2]], id="ground")


def test_a_revealed_scene_goes_with_its_arrays(tmp_path: Path) -> None:
    found = belvedere.reveal(hills(), {"path": ROUTE}, spacing=CELL, eye=EYE, look_at=LOOK, size=(96, 54), samples=1)
    written = found.save(tmp_path / "a.png", scene=tmp_path / "a.toml")
    assert {"terrain.tif", "features1.geojson", "a.toml"} <= {path.name for path in written}
    bare = found.scene.render(samples=1, mark=False)
    assert (belvedere.Scene.open(tmp_path / "a.toml").render(samples=1, mark=False).rgba == bare.rgba).all()
    with pytest.raises(belvedere.FileError, match="exists"):
        found.save(tmp_path / "b.png", scene=tmp_path / "b.toml")
    saved = found.scene.save(tmp_path / "c.json", overwrite=True)
    sources = [layer["source"] for layer in json.loads(saved.read_text())["layer"]]
    assert sources == ["terrain.tif", "features1.geojson"]
