"""Batches: the same bytes as one process, whatever happens to workers."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import signal
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import belvedere
from belvedere import batch

SCENE = """
format = 1
crs = "local"
[camera]
eye = [6000.0, -5200.0, 3600.0]
look_at = [0.0, 0.0, 300.0]
image = [64, 36]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=65"
[[layer]]
kind = "line"
id = "trail"
source = "builtin:massif?seed=7&size=65"
must_see = true
"""
SPLINE = "[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n"
FILM = {"along": "trail", "frames": 9, "marker": True}


def scene_file(folder: Path, more: str = SPLINE) -> Path:
    path = folder / "scene.toml"
    path.write_text(SCENE + more)
    return path


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The film as one process draws it."""
    folder = tmp_path_factory.mktemp("whole")
    belvedere.animate(scene_file(folder), folder / "film", **FILM)
    return files(folder / "film")


class Killer:
    """Kills a worker when the first task is done."""

    def __init__(self) -> None:
        self.killed = 0

    def __call__(self, work: str, share: float) -> None:
        children = multiprocessing.active_children()
        if share > 0 and not self.killed and children:
            os.kill(children[0].pid, signal.SIGKILL)
            self.killed += 1


def test_a_film_by_two_processes_is_the_film_of_one(tmp_path: Path, whole: dict[str, bytes]) -> None:
    film, report = batch.film(scene_file(tmp_path), tmp_path / "film", on=batch.Local(2), frames_per_task=3, **FILM)
    assert files(tmp_path / "film") == whole
    assert (film.frames, report.tasks, report.pictures, report.retries) == (9, 3, 8, 0)
    assert not (tmp_path / "film.batch").exists()


def test_a_killed_worker_costs_time_alone(tmp_path: Path, whole: dict[str, bytes]) -> None:
    killer = Killer()
    on = batch.Local(2, retries=5)
    _, report = batch.film(scene_file(tmp_path), tmp_path / "film", on=on, frames_per_task=1, progress=killer, **FILM)
    assert killer.killed == 1
    assert files(tmp_path / "film") == whole
    assert report.tasks == 8


def test_an_interrupted_batch_goes_on(tmp_path: Path, whole: dict[str, bytes]) -> None:
    def interrupt(work: str, share: float) -> None:
        if share > 0:
            raise KeyboardInterrupt

    scene, out = scene_file(tmp_path), tmp_path / "film"
    with pytest.raises(KeyboardInterrupt):
        batch.film(scene, out, on=batch.Local(1), frames_per_task=2, progress=interrupt, **FILM)
    assert not [path for path in out.iterdir() if path.suffix == ".png" and path.stat().st_size == 0]
    _, report = batch.film(scene, out, on=batch.Local(1), frames_per_task=2, **FILM)
    assert report.kept >= 1 and report.kept < report.tasks
    assert files(out) == whole


def test_a_full_folder_ends_the_batch_with_one_error(tmp_path: Path) -> None:
    out = tmp_path / "pictures"
    out.mkdir()
    # A folder in the place of the picture: what cannot be written, for root too.
    (out / "b.png").mkdir()
    scene = scene_file(tmp_path)
    with pytest.raises(belvedere.Error, match="b.png"):
        batch.pictures({"a": scene, "b": scene}, out, on=batch.Local(1), size=(32, 18), overwrite=True)
    (out / "b.png").rmdir()
    report = batch.pictures({"a": scene, "b": scene}, out, on=batch.Local(1), size=(32, 18))
    assert report.kept == 1


def test_a_sweep_has_every_combination(tmp_path: Path) -> None:
    values = {"camera.fov_y_deg": np.arange(30, 50, 15), "stage.0.presets": ["progressive", "degressive"]}
    report = batch.sweep(scene_file(tmp_path), values, tmp_path / "out", on=batch.Local(1), size=(32, 18))
    index = json.loads((tmp_path / "out/sweep.json").read_text())
    assert report.tasks == report.pictures == len(index) == 4
    pictures = {(tmp_path / "out" / name).read_bytes() for name in index}
    assert len(pictures) == 4
    again = batch.sweep(scene_file(tmp_path), values, tmp_path / "out", on=batch.Local(1), size=(32, 18))
    assert (again.kept, again.pictures) == (4, 0)
    # Another scene under the same name is drawn anew.
    scene_file(tmp_path, SPLINE + "[light]\nazimuth_deg = 90.0\naltitude_deg = 30.0\n")
    assert batch.sweep(tmp_path / "scene.toml", values, tmp_path / "out", on=batch.Local(1), size=(32, 18)).kept == 0


def test_data_beside_the_scene_is_known_again(tmp_path: Path) -> None:
    """Data in another folder counts as unchanged while it is, and as changed when it is changed."""
    data = tmp_path / "data"
    data.mkdir()
    rows = [" ".join(str(100 + x * y % 70) for x in range(30)) for y in range(30)]
    head = "ncols 30\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 30\n"
    ground = data / "ground.asc"
    ground.write_text(head + "\n".join(rows) + "\n")
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    scene = scenes / "s.toml"
    scene.write_text(
        "format = 1\ncrs = 'local'\n[camera]\neye = [450, -900, 700]\nlook_at = [450, 450, 100]\n"
        "[[layer]]\nkind = 'terrain'\nid = 'g'\nsource = '../data/ground.asc'\n")
    draw = lambda: batch.pictures({"a": scene}, tmp_path / "out", on=batch.Local(1), allow_roots=[data], size=(32, 18))
    assert (draw().kept, draw().kept) == (0, 1)
    ground.write_text(head + "\n".join(reversed(rows)) + "\n")
    again = draw()
    assert (again.kept, again.retries) == (0, 0)


def test_files_of_others_are_kept(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "a.png").write_text("theirs")
    scene = scene_file(tmp_path)
    draw = lambda **more: batch.pictures({"a": scene}, out, on=batch.Local(1), size=(32, 18), **more)
    with pytest.raises(belvedere.FileError, match="a.png exists"):
        draw()
    assert (out / "a.png").read_text() == "theirs"
    assert draw(overwrite=True).pictures == 1


def test_a_film_is_made_anew(tmp_path: Path, whole: dict[str, bytes]) -> None:
    out, on = tmp_path / "film", batch.Local(1)
    batch.film(scene_file(tmp_path, ""), out, on=on, frames_per_task=4, **{**FILM, "frames": 11})
    with pytest.raises(belvedere.Error):
        batch.film(scene_file(tmp_path), out, on=on, frames_per_task=4, **FILM)
    batch.film(scene_file(tmp_path), out, on=on, frames_per_task=4, overwrite=True, **FILM)
    assert files(out) == whole


def test_wrong_keys_and_scenes_are_named(tmp_path: Path) -> None:
    with pytest.raises(belvedere.InputError, match="stage.3"):
        batch.sweep(scene_file(tmp_path), {"stage.3.presets": ["map"]}, tmp_path / "out", on=batch.Local(1))
    with pytest.raises(belvedere.InputError, match="parallel projection"):
        batch.tiles(scene_file(tmp_path, ""), tmp_path / "tiles", size=(64, 64))
    with pytest.raises(belvedere.InputError, match="threads"):
        batch.pictures({"a": scene_file(tmp_path)}, tmp_path / "out", threads=1)
    with pytest.raises(belvedere.InputError, match="workers=0"):
        batch.Local(0)


def test_tiles_join(tmp_path: Path) -> None:
    plan = SCENE.replace("image = [64, 36]", "image = [96, 64]\nprojection = 'orthographic'\northo_height_m = 8000.0")
    path = tmp_path / "plan.toml"
    path.write_text(plan)
    batch.tiles(path, tmp_path / "tiles", size=(96, 64), tile_px=40, on=batch.Local(1), lod_px=0.0)
    places = json.loads((tmp_path / "tiles/tiles.json").read_text())["left_top_width_height"]
    assert len(places) == 6
    scene = belvedere.Scene.open(path)
    expected = scene.render(lod_px=0.0)
    from_tiles = np.zeros_like(expected.rgba)
    for name, (left, top, width, height) in places.items():
        from_tiles[top : top + height, left : left + width] = png_pixels(tmp_path / "tiles" / name)
    difference = np.abs(from_tiles.astype(int) - expected.rgba.astype(int))
    assert difference.mean() < 1.0, difference.mean()


def png_pixels(path: Path) -> np.ndarray:
    """An 8-bit picture without interlacing, decoded by hand."""
    import struct
    import zlib

    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    channels = {2: 3, 6: 4}[color]
    assert depth == 8
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels)
    pixels = np.zeros((height, width, channels), int)
    for y, row in enumerate(rows):
        line, above = row[1:].reshape(width, channels).astype(int), pixels[y - 1] if y else np.zeros((width, channels), int)
        for x in range(width):
            a = pixels[y, x - 1] if x else 0 * above[0]
            b, c = above[x], above[x - 1] if x else 0 * above[0]
            p = a + b - c
            nearest = np.where(
                (abs(p - a) <= abs(p - b)) & (abs(p - a) <= abs(p - c)), a, np.where(abs(p - b) <= abs(p - c), b, c))
            guess = [0 * a, a, b, (a + b) // 2, nearest][row[0]]
            pixels[y, x] = (line[x] + guess) % 256
    if channels == 3:
        pixels = np.concatenate([pixels, np.full((height, width, 1), 255)], axis=2)
    return pixels.astype(np.uint8)


@pytest.fixture(scope="module")
def dask() -> Any:
    """A client of two workers."""
    distributed = pytest.importorskip("distributed", reason="SKIPPED: the adapter of Dask is not tried; distributed is not installed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def test_dask(tmp_path: Path, whole: dict[str, bytes], dask: Any) -> None:
    killed: list[int] = []

    def kill(work: str, share: float) -> None:
        if share > 0 and not killed:
            killed.append(next(iter(dask.cluster.workers.values())).process.pid)
            os.kill(killed[0], signal.SIGKILL)

    _, report = batch.film(
        scene_file(tmp_path), tmp_path / "film", on=batch.Dask(dask), frames_per_task=1, progress=kill, **FILM)
    assert killed
    assert files(tmp_path / "film") == whole
    assert report.adapter == "dask"


def test_a_cancelled_run_of_dask_goes_on(tmp_path: Path, whole: dict[str, bytes], dask: Any) -> None:
    def interrupt(work: str, share: float) -> None:
        if share > 0.2:
            raise KeyboardInterrupt

    scene, out = scene_file(tmp_path), tmp_path / "film"
    with pytest.raises(KeyboardInterrupt):
        batch.film(scene, out, on=batch.Dask(dask), frames_per_task=1, progress=interrupt, **FILM)
    # Workers may have ended what they held.
    are_whole(out, whole, all_may_be_there=True)
    _, report = batch.film(scene, out, on=batch.Dask(dask), frames_per_task=1, **FILM)
    assert report.kept >= 2
    assert files(out) == whole


@pytest.mark.parametrize("where", ["local", "dask"])
def test_a_full_disk_ends_the_batch_and_room_lets_it_go_on(
    tmp_path: Path, whole: dict[str, bytes], where: str, request: pytest.FixtureRequest) -> None:
    on = batch.Local(2, threads=1) if where == "local" else batch.Dask(request.getfixturevalue("dask"))
    disk = tmp_path / "disk"
    disk.mkdir()
    pages = sum(-(-len(data) // 4096) for data in whole.values())
    mount = ["mount", "-t", "tmpfs", "-o", f"size={4096 * (pages * 2 // 3)}", "none", os.fspath(disk)]
    if not shutil.which("mount") or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("SKIPPED: a full disk is not tried; no small file system can be mounted")
    try:
        scene, out = scene_file(tmp_path), disk / "film"
        with pytest.raises(belvedere.FileError, match="disk is full|No space left"):
            batch.film(scene, out, on=on, frames_per_task=1, **FILM)
        are_whole(out, whole)
        subprocess.run(["mount", "-o", "remount,size=64m", os.fspath(disk)], check=True)
        _, report = batch.film(scene, out, on=on, frames_per_task=1, **FILM)
        assert 0 < report.kept < report.tasks
        assert files(out) == whole
    finally:
        # What a worker still writes ends first.
        subprocess.run(["umount", "-l", os.fspath(disk)], check=True)


def are_whole(folder: Path, whole: dict[str, bytes], all_may_be_there: bool = False) -> None:
    """Every frame that is there is that of the whole film; some are missing."""
    found = {path.name: path.read_bytes() for path in folder.glob("frame_*.png")}
    assert 0 < len(found) < 10 + all_may_be_there
    assert found == {name: whole[name] for name in found}
