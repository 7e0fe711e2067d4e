"""reveal, disocclude, animate, presets."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import belvedere
from conftest import CELL, ROUTE, hills

EYE, LOOK = (1200.0, -1500.0, 900.0), (1200.0, 1000.0, 300.0)


def test_reveal_of_arrays(tmp_path: Path) -> None:
    found = belvedere.reveal(hills(), {"path": ROUTE}, spacing=CELL, eye=EYE, look_at=LOOK, size=(160, 90))
    assert 0 <= found.report.straight.visible < found.report.bent.visible <= 1
    assert found.report.technique == "spline" and found.report.raw["visible_bent"] == found.report.bent.visible
    assert "visible" in found.summary and isinstance(found.missed, list)
    assert found.picture.straight is not None and found.picture.size == (160, 90)
    assert np.isfinite(found.picture.depth).any()
    written = found.save(tmp_path / "a.png", report=tmp_path / "a.report.json", before=tmp_path / "before.png")
    assert {p.name for p in written} == {"a.png", "a.png.json", "a.pair.png", "a.report.json", "before.png"}
    report = json.loads((tmp_path / "a.report.json").read_text())
    assert len(report["outputs"]) == 5 and {**report, "outputs": []} == found.report.raw
    assert found.scene.project([LOOK]).inside.all()
    # The scene that was found is one like others: it is drawn, changed, and written for the command line.
    wanted = found.scene.render(size=(64, 36))
    (tmp_path / "found").mkdir()
    again = belvedere.Scene.open(found.scene.save(tmp_path / "found" / "scene.json"))
    assert (again.render(size=(64, 36)).rgba == wanted.rgba).all()
    changed = found.scene.add_points([(1200.0, 500.0)], id="more")
    assert changed.layers[-1] == "more" and 3 in changed.render(size=(480, 270)).id


def test_holes_of_arrays_stay_and_those_of_files_are_filled_as_by_the_program(tmp_path: Path) -> None:
    heights = np.ma.array(hills(), mask=np.zeros((60, 80), bool))
    heights[50:52, 60:62] = np.ma.masked
    keys = {"eye": EYE, "look_at": LOOK, "size": (64, 36)}
    found = belvedere.reveal(heights, ROUTE, spacing=CELL, **keys)
    assert found.picture.record["terrain"]["void_nodes"] == 4 and found.picture.record["terrain"]["filled_nodes"] == 0
    filled = belvedere.reveal(heights, ROUTE, spacing=CELL, fill_voids=True, **keys)
    assert filled.picture.record["terrain"]["filled_nodes"] == 4


def test_reveal_refuses_in_words() -> None:
    for call, words in (
        (lambda: belvedere.reveal(hills(), spacing=CELL), "routes"),
        (lambda: belvedere.reveal(hills(), ROUTE), "transform="),
        (lambda: belvedere.reveal(hills(), ROUTE, spacing=CELL, eye=EYE), "given without `look_at`"),
        (lambda: belvedere.reveal(hills(), ROUTE, spacing=CELL, technique="lens"), "lens"),
        (lambda: belvedere.reveal(hills(), ROUTE, spacing=CELL, fov_y_deg=400.0), "400"),
        (lambda: belvedere.reveal(hills(), ROUTE, spacing=CELL, size=(0, 9)), "(0, 9)"),
        (lambda: belvedere.reveal("no such.tif", "no.gpx"), "no such.tif"),
        (lambda: belvedere.reveal("builtin:massif", ROUTE), "features_crs="),
        (lambda: belvedere.reveal(hills(), ROUTE + 1e7, spacing=CELL), ""),
    ):
        with pytest.raises(belvedere.Error) as refusal:
            call()
        assert words in str(refusal.value) and "\n" not in str(refusal.value), str(refusal.value)
        assert "/belvedere-" not in str(refusal.value), "temporary names stay inside"


def test_a_target_in_a_scene_of_models_is_revealed(tmp_path: Path) -> None:
    scene = belvedere.Scene.builtin("dna")
    file = scene.save(tmp_path / "dna.json")
    found = belvedere.reveal(file, see=scene.layers[0], size=(96, 72))
    assert 0 <= found.report.straight.visible <= found.report.bent.visible <= 1
    assert found.picture.size == (96, 72)


def test_the_terrain_solver_alone(tmp_path: Path) -> None:
    found = belvedere.disocclude(hills(), ROUTE, spacing=CELL, eye=EYE, look_at=LOOK[:2], fov_x_deg=70.0)
    assert found.heights.shape == (60, 80) and np.abs(found.displacement).max() > 1
    np.testing.assert_allclose(found.heights - found.displacement, hills(), atol=1e-2)
    report = found.report
    assert report.visible > report.visible_before and report.max_m == report.raw["max_m"]
    assert found.transform is not None and found.transform[0] == pytest.approx(CELL)
    written = found.save(tmp_path / "a.tif", report=tmp_path / "a.json", displacement=tmp_path / "d.tif", features=tmp_path / "f.geojson")
    assert [p.name for p in written] == ["a.tif", "d.tif", "f.geojson", "a.json"]
    again = belvedere.Scene(camera=belvedere.Camera(EYE, LOOK)).add_terrain(tmp_path / "a.tif")
    assert again.ground_m([[CELL * 40, CELL * 20]])[0] == pytest.approx(found.heights[39, 40], abs=0.01)
    with pytest.raises(belvedere.InputError, match=".tif"):
        found.save(tmp_path / "a.png")
    with pytest.raises(belvedere.InputError, match="widht|did you mean|key"):
        belvedere.disocclude(hills(), ROUTE, spacing=CELL, eye=EYE, look_at=LOOK[:2], parameters={"widht": 3})


def test_a_film_is_frames_and_goes_on(scene: belvedere.Scene, tmp_path: Path) -> None:
    film = belvedere.animate(scene, tmp_path / "film", turntable_deg_per_s=20.0, frames=3, size=(64, 36), samples=1)
    assert (film.frames, film.drawn) == (3, 3) and len(list((tmp_path / "film").glob("*.png"))) == 3
    with pytest.raises(belvedere.FileError):
        belvedere.animate(scene, tmp_path / "film", turntable_deg_per_s=20.0, frames=3, size=(64, 36), samples=1)
    again = belvedere.animate(scene, tmp_path / "film", turntable_deg_per_s=20.0, frames=3, size=(64, 36), samples=1, resume=True)
    assert again.drawn == 0
    with pytest.raises(belvedere.InputError, match="frames=0"):
        belvedere.animate(scene, tmp_path / "other", turntable_deg_per_s=True, frames=0)


def test_presets() -> None:
    listed = {one.name for one in belvedere.presets.names()}
    assert "demo" in listed
    document = belvedere.presets.load("demo")
    assert document["version"] == 1
    assert belvedere.presets.check(document).verdict in ("valid", "usable-in-part")
    name = document["presets"][0]["name"]
    changed, limited = belvedere.presets.edit(document, f"{name}.phi=21")
    assert changed["presets"][0]["phi"] == 21 and limited == []
    assert belvedere.presets.plot(changed).ndim == 3
    with pytest.raises(belvedere.InputError):
        belvedere.presets.edit(document, "nothing")
    with pytest.raises(belvedere.InputError, match="progressive|possible"):
        belvedere.presets.load("progresive")
