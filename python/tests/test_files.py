"""Scenes and pictures as files: what was read is never replaced, and what was written opens."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import belvedere
from conftest import CELL, ROUTE, hills

EYE, LOOK = (1200.0, -1500.0, 900.0), (1200.0, 1000.0, 300.0)


@pytest.fixture
def file(scene: belvedere.Scene, tmp_path: Path) -> Path:
    """The scene file a/scene.json with its files."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    return scene.save(tmp_path / "a" / "scene.json")


def test_arrays_are_added_to_a_document_of_another_folder(file: Path) -> None:
    opened = belvedere.Scene.open(file)
    # A file of the same name as that of the new layer lies there.
    shutil.copyfile(file.parent / "lines.geojson", file.parent / "more.geojson")
    changed = belvedere.Scene.from_document(opened.resolved(), folder=file.parent).add_points(np.array([[1200.0, 500.0]]), id="more")
    assert changed.layers == ["ground", "lines", "more"] and 3 in changed.render(size=(480, 270)).id
    again = belvedere.Scene.open(changed.save(file.parent.parent / "b" / "scene.json"), allow_roots=[file.parent])
    assert (again.render(size=(64, 36)).rgba == changed.render(size=(64, 36)).rgba).all()
    # Beside the files of the document, the new file keeps its name.
    shutil.copytree(file.parent, file.parent.parent / "c")
    (file.parent.parent / "c" / "more.geojson").unlink()
    beside = belvedere.Scene.from_document(opened.resolved(), folder=file.parent.parent / "c").add_points(np.array([[1200.0, 500.0]]), id="more")
    again = belvedere.Scene.open(beside.save(file.parent.parent / "c" / "other.json"))
    assert again.layers == ["ground", "lines", "more"]
    assert [layer["source"] for layer in json.loads((file.parent.parent / "c" / "other.json").read_text())["layer"]] == [
        "ground.tif", "lines.geojson", "more.geojson"]  # fmt: skip


def test_ground_alone_fills_pictures_of_every_size_under_a_sky(file: Path) -> None:
    ground = belvedere.Scene.open(file.parent / "ground.tif")
    assert ground.layers == ["ground", "edge"]
    wide, tall = ground.render(size=(160, 60)), ground.render(size=(60, 160))
    for picture in (wide, tall):
        seen = picture.id > 0
        assert not seen[0].any() and seen.mean() > 0.27
        assert max(np.ptp(np.nonzero(seen)[0]) / seen.shape[0], np.ptp(np.nonzero(seen)[1]) / seen.shape[1]) > 0.8
    # Whatever was drawn before: the same picture, and the scene that is saved draws it too.
    assert (belvedere.Scene.open(file.parent / "ground.tif").render(size=(60, 160)).rgba == tall.rgba).all()
    again = belvedere.Scene.open(ground.save(file.parent / "of_data.json"))
    assert (again.render().rgba == ground.render().rgba).all()


def test_an_opened_scene_is_saved_in_another_folder(file: Path) -> None:
    opened = belvedere.Scene.open(file)
    copied = opened.save(file.parent.parent / "b" / "scene.json")
    assert [layer["source"] for layer in json.loads(copied.read_text())["layer"]] == ["../a/ground.tif", "../a/lines.geojson"]
    again = belvedere.Scene.open(copied, allow_roots=[file.parent.parent])
    assert (again.render(size=(64, 36)).rgba == opened.render(size=(64, 36)).rgba).all()
    beside = belvedere.Scene.open(opened.save(file.parent / "other.json"))
    assert beside.layers == opened.layers


def test_a_document_without_keys_takes_arrays() -> None:
    scene = belvedere.Scene.from_document({"format": 1}).add_terrain(hills(), spacing=CELL).add_points([(1200.0, 500.0)])
    assert scene.crs == "local" and scene.layers == ["ground", "points"]


def test_a_picture_never_replaces_a_file_that_its_scene_reads(file: Path) -> None:
    belvedere.Scene.open(file).render(size=(64, 36), straight=True).save(file.parent / "drape.png")
    (file.parent / "drape.pgw").write_text(f"{CELL * 79 / 64}\n0\n0\n{-CELL * 59 / 36}\n0\n{CELL * 59}\n")
    document = json.loads(file.read_text())
    document["layer"][0]["drape"] = "drape.png"
    document["crs"] = "local"
    file.write_text(json.dumps(document))
    before = {path: path.read_bytes() for path in file.parent.iterdir()}
    picture = belvedere.Scene.open(file).render(size=(64, 36))
    with pytest.raises(belvedere.FileError, match="is an input"):
        picture.save(file.parent / "drape.png", overwrite=True)
    assert before == {path: path.read_bytes() for path in file.parent.iterdir()}
    assert [p.name for p in picture.save(file.parent / "other.png")] == ["other.png", "other.png.json"]


def test_a_revealed_picture_is_the_same_after_a_look_at_its_buffers(tmp_path: Path) -> None:
    heights = np.ma.array(hills(), mask=False)
    heights[50:52, 60:62] = np.ma.masked
    terrain = belvedere.reveal(heights, {"path": ROUTE}, spacing=CELL, eye=EYE, look_at=LOOK, size=(96, 54), samples=1, mark=False, stylise=True)
    wall = np.array([[-4.0, 0, 0], [4, 0, 0], [4, 0, 3], [-4, 0, 3]])
    model = belvedere.Scene(camera={"eye": [0.0, -12.0, 2.0], "look_at": [0.0, 0.0, 1.0]}, crs="local")
    model.add_mesh(wall, [[0, 1, 2], [0, 2, 3]], id="wall").add_mesh(np.eye(3) + [0, 3, 0.5], [[0, 1, 2]], id="hidden")
    target = belvedere.reveal(model.save(tmp_path / "model.json"), see="hidden", size=(96, 72))
    assert (target.picture.rgba != target.scene.render(compare=True).rgba).any(), "the target is marked in the picture"
    assert terrain.warnings, "of the hole"
    for found in (terrain, target):
        assert [w.text for w in found.warnings] == [w["text"] for w in found.report.raw["warnings"]]
        before, record, straight = found.picture.png(), found.picture.record, found.picture.straight
        assert np.isfinite(found.picture.depth).any() and np.isfinite(found.picture.world).any()
        found.picture.save(tmp_path / "a.png", buffers=["depth"], overwrite=True)
        assert found.picture.png() == before == (tmp_path / "a.png").read_bytes()
        again = belvedere.Picture(found.picture._native)
        assert again.record == record and (straight is None or (again.straight == straight).all())


def test_warnings_and_reports_are_those_of_the_command_line(scene: belvedere.Scene) -> None:
    measured = scene.measure(size=(160, 90))
    assert measured.raw["verb"] == "measure" and measured.raw["outputs"] == []
    assert [w.text for w in measured.warnings] == [w["text"] for w in measured.raw["warnings"]]
    # What measuring says beside what opening said.
    more = {"kind": "ignored", "text": "feature 0 of layer lines has no point to judge"}
    assert [w.text for w in belvedere.reports.MeasureReport.of({**measured.raw, "warnings": [more]}).warnings] == [more["text"]]


def test_a_name_of_several_points_is_one_feature_each(tmp_path: Path) -> None:
    scene = belvedere.Scene().add_terrain(hills(), spacing=CELL).add_points({"huts": [[300, 300], [600, 600]], "top": [900, 900]})
    scene.save(tmp_path / "scene.json")
    document = json.loads((tmp_path / "points.geojson").read_text())
    found = [(f["properties"]["name"], f["geometry"]["coordinates"]) for f in document["features"]]
    assert found == [("huts", [300, 300]), ("huts", [600, 600]), ("top", [900, 900])]
