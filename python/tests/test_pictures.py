"""Pictures: arrays, files, the same bytes as the command line."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import belvedere
from conftest import CELL


def program(*words: str) -> subprocess.CompletedProcess[str]:
    installed = shutil.which("belvedere", path=str(Path(sys.executable).parent))
    assert installed, "the wheel installs the program"
    return subprocess.run([installed, *words], capture_output=True, text=True, timeout=300)


def test_a_picture_is_arrays(scene: belvedere.Scene) -> None:
    picture = scene.render(size=(160, 90))
    assert picture.size == (160, 90) and picture.shape == (90, 160)
    assert picture.rgba.shape == (90, 160, 4) and picture.rgba.dtype == np.uint8 and (picture.rgba[..., 3] == 255).all()
    assert np.asarray(picture).shape == (90, 160, 4)
    seen = picture.id > 0
    assert scene.layers[:2] == ["ground", "lines"] and set(np.unique(picture.id)) >= {0, 1, 2}
    assert (np.isfinite(picture.depth) == np.isfinite(picture.world[..., 0])).all()
    assert np.isfinite(picture.depth[seen]).mean() > 0.9
    # The ground that is seen is the ground that was given.
    ground = (picture.id == 1) & np.isfinite(picture.depth)
    world = picture.world[ground]
    np.testing.assert_allclose(scene.ground_m(world[:, :2]), world[:, 2], atol=0.5)
    # And projecting it leads back to the pixels.
    back = scene.project(world, size=(160, 90))
    rows, columns = np.nonzero(ground)
    assert np.abs(back.pixel - np.stack([columns + 0.5, rows + 0.5], axis=1)).max() < 0.5
    assert picture.displacement is not None and picture.displacement.max_m > 1
    assert scene.render(size=(160, 90), straight=True).displacement is None


def test_buffers_at_once_and_later_are_the_same(scene: belvedere.Scene) -> None:
    at_once, later = scene.render(size=(64, 48), buffers=True), scene.render(size=(64, 48))
    assert (later.rgba == at_once.rgba).all()
    np.testing.assert_array_equal(later.depth, at_once.depth)
    np.testing.assert_array_equal(later.world, at_once.world)


def test_a_notebook_shows_it(scene: belvedere.Scene) -> None:
    picture = scene.render(size=(32, 24))
    bundle = picture._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG") and picture._repr_png_() == bundle["image/png"]
    assert "32 x 24" in bundle["text/plain"]


def test_it_is_saved_with_its_record_and_buffers(scene: belvedere.Scene, tmp_path: Path) -> None:
    picture = scene.render(size=(64, 48))
    written = picture.save(tmp_path / "a.png", buffers=["depth", "id", "world"])
    assert [p.name for p in written] == ["a.png", "a.png.json", "a.depth.npy", "a.id.npy", "a.world.npy"]
    assert (tmp_path / "a.png").read_bytes() == picture.png()
    record = json.loads((tmp_path / "a.png.json").read_text())
    assert record["displacement"] == picture.record["displacement"] and record["stages"] == ["spline_bend"]
    np.testing.assert_array_equal(np.load(tmp_path / "a.depth.npy"), picture.depth)
    with pytest.raises(belvedere.FileError, match="exists"):
        picture.save(tmp_path / "a.png")
    picture.save(tmp_path / "a.png", overwrite=True)
    with pytest.raises(belvedere.InputError, match="colour"):
        picture.save(tmp_path / "b.png", buffers=["colour"])


def test_python_and_the_command_line_write_the_same_bytes(scene: belvedere.Scene, tmp_path: Path) -> None:
    file = scene.save(tmp_path / "scene.json")
    ran = program("render", str(file), "--size", "160x90", "-o", str(tmp_path / "by_program.png"))
    assert ran.returncode == 0, ran.stderr
    wanted = (tmp_path / "by_program.png").read_bytes()
    opened = belvedere.Scene.open(file).render(size=(160, 90))
    assert opened.png() == wanted
    # A scene of arrays draws the same pixels; its record names arrays as its inputs in place of files.
    of_arrays = scene.render(size=(160, 90))
    assert (of_arrays.rgba == opened.rgba).all() and b"array:ground" in of_arrays.png()
    # Also when the size changes after a picture was drawn, and on another number of threads.
    again = belvedere.Scene.open(file)
    again.render(size=(32, 24))
    assert again.render(size=(160, 90), threads=1).png() == wanted


def test_a_built_in_scene_is_that_of_the_command_line(tmp_path: Path) -> None:
    scene = belvedere.Scene.builtin("massif")
    ran = program("render", str(scene.save(tmp_path / "scene.json")), "--size", "96x54", "-o", str(tmp_path / "a.png"))
    assert ran.returncode == 0, ran.stderr
    assert scene.render(size=(96, 54)).png() == (tmp_path / "a.png").read_bytes()
    with pytest.raises(belvedere.InputError, match="massif"):
        belvedere.Scene.builtin("masif")


def test_furniture_is_that_of_the_program(scene: belvedere.Scene, tmp_path: Path) -> None:
    words = ("--size", "480x270", "--title", "Over the hills", "--furniture", "compass,legend")
    file = scene.save(tmp_path / "scene.json")
    ran = program("render", str(file), *words, "-o", str(tmp_path / "a.png"))
    assert ran.returncode == 0, ran.stderr
    opened, of_arrays = (
        drawn.render(size=(480, 270), furniture=["compass", "legend"], title="Over the hills")
        for drawn in (belvedere.Scene.open(file), scene)
    )
    assert of_arrays.record["furniture"]["title"] == "Over the hills"
    assert of_arrays.record["furniture"]["compass"] is not None
    assert opened.png() == (tmp_path / "a.png").read_bytes()
    assert (of_arrays.rgba == opened.rgba).all()
    assert (scene.render(size=(480, 270)).rgba != of_arrays.rgba).any()
    with pytest.raises(belvedere.InputError, match="no furniture; possible: title"):
        scene.render(size=(48, 27), furniture="north arrow")


def test_the_program_is_installed() -> None:
    ran = program("--version")
    assert ran.returncode == 0 and belvedere.__version__ in ran.stdout
    ran = program("rendre")
    assert ran.returncode == 2 and ran.stderr.count("\n") == 1 and "rendre" in ran.stderr
    assert subprocess.run([sys.executable, "-m", "belvedere", "--version"], capture_output=True).returncode == 0


def test_pairs_and_pictures_of_the_camera(scene: belvedere.Scene) -> None:
    pair = scene.render(size=(96, 54), compare=True)
    assert pair.straight is not None and pair.straight.shape == (54, 96, 4) and (pair.straight != pair.rgba).any()
    assert (scene.render(size=(96, 54), overhead=True).rgba != pair.rgba).any()
    assert scene.render(size=(96, 54), outside=True).size == (96, 54)
    with pytest.raises(belvedere.InputError, match="one of them"):
        scene.render(overhead=True, outside=True)


def test_a_scene_without_a_camera_is_seen_whole() -> None:
    scene = belvedere.Scene().add_terrain(np.zeros((20, 30)), spacing=CELL)
    corners = [[0.0, 0.0, 0.0], [29 * CELL, 0.0, 0.0], [0.0, 19 * CELL, 0.0], [29 * CELL, 19 * CELL, 0.0]]
    assert scene.project(corners).inside.all()
    assert (scene.render(size=(64, 36)).id == 1).mean() > 0.1
