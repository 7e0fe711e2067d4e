"""Sets of pictures: several scenes, one scene with many values of its keys, tiles of a large plan."""

from __future__ import annotations

import itertools
import json
import os
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .._ask import Progress
from .._json import text
from ..errors import FileError, InputError
from ..scene import Scene
from ._adapters import Adapter, Local
from ._run import Report, run
from ._task import Task, sha256_of, write_whole


def pictures(
    scenes: Mapping[str, str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    on: Adapter | None = None,
    allow_roots: Sequence[str | os.PathLike[str]] = (),
    overwrite: bool = False,
    progress: Progress = None,
    **options: Any,
) -> Report:
    """Draws several scene files into a folder, each as ``NAME.png`` with its record.

    * ``scenes``: names and paths of scene files.
    * ``overwrite``: replaces pictures that no batch drew there. ``options``: those of :meth:`belvedere.Scene.render`.
    """
    roots, folder, options = _roots(allow_roots), _folder(out), _options(options)
    tasks = []
    for name, scene in scenes.items():
        path = os.path.abspath(os.fspath(scene))
        tasks.append(Task("picture", path, _hash(path), _file(folder, name), options, allow_roots=roots))
    return run(tasks, _records(folder), on or Local(), progress, "pictures", overwrite)


def sweep(
    scene: str | os.PathLike[str],
    values: Mapping[str, Sequence[Any]],
    out: str | os.PathLike[str],
    *,
    on: Adapter | None = None,
    allow_roots: Sequence[str | os.PathLike[str]] = (),
    overwrite: bool = False,
    progress: Progress = None,
    **options: Any,
) -> Report:
    """Draws a scene with every combination of values of its keys; ``sweep.json`` in the folder says which picture has which.

    * ``values``: keys of the scene file and lists of values: ``{"camera.fov_y_deg": [30, 45], "stage.0.presets": ["progressive", "degressive"]}``;
      dots lead inwards, numbers count the entries of a list from 0.
    * ``overwrite``: replaces pictures that no batch drew there. ``options``: those of :meth:`belvedere.Scene.render`.
    """
    path, roots, folder, options = os.path.abspath(os.fspath(scene)), _roots(allow_roots), _folder(out), _options(options)
    empty = [key for key, choices in values.items() if not len(choices)]
    if empty or not values:
        raise InputError(f"{empty[0] if empty else 'values'} has no value; give a list of at least one")
    combinations = [dict(zip(values, chosen)) for chosen in itertools.product(*(_plain(list(choices)) for choices in values.values()))]
    digits = len(str(len(combinations) - 1))
    named = {f"picture_{index:0{digits}}": changes for index, changes in enumerate(combinations)}
    digest = _hash(path)
    tasks = [
        Task("picture", path, digest, _file(folder, name), options, changes=changes, allow_roots=roots)
        for name, changes in named.items()
    ]
    _write(folder / "sweep.json", {f"{name}.png": changes for name, changes in named.items()}, overwrite)
    return run(tasks, _records(folder), on or Local(), progress, "pictures", overwrite)


def tiles(
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    size: tuple[int, int],
    tile_px: int = 2048,
    on: Adapter | None = None,
    allow_roots: Sequence[str | os.PathLike[str]] = (),
    overwrite: bool = False,
    progress: Progress = None,
    **options: Any,
) -> Report:
    """Draws a large picture of a scene with a parallel projection as tiles ``tile_ROW_COLUMN.png``; ``tiles.json`` says where each lies.

    * ``size``: width and height of the whole picture, pixels. ``tile_px``: side of a tile, pixels; those at the right and lower edge are smaller.
    * ``options``: those of :meth:`belvedere.Scene.render`, but for ``size``.

    Only straight plans and plan obliques have tiles: where a stage bends the view, what a tile shows depends on its own camera. Names and marks are
    placed for each tile.
    """
    path, roots, folder, options = os.path.abspath(os.fspath(scene)), _roots(allow_roots), _folder(out), _options(options)
    opened = Scene.open(path, allow_roots=roots)
    document = opened.resolved()
    camera = document["camera"]
    if camera.get("projection") != "orthographic":
        raise InputError(f"{path}: tiles need a parallel projection; set camera.projection to orthographic")
    bends = [stage["kind"] for stage in document.get("stage", []) if stage["kind"] != "relief"]
    if bends and not options.get("straight"):
        raise InputError(f"{path}: tiles of a view that {bends[0]} bends would not join; give straight=True, or draw one picture")
    if document.get("earth") == "curved":
        raise InputError(f"{path}: tiles of a curved earth would not join; set earth to flat, or draw one picture")
    width, height = (int(side) for side in size)
    if min(width, height, tile_px) < 1:
        raise InputError(f"size={size}, tile_px={tile_px}: give whole numbers of pixels above 0")
    unit = camera["ortho_height_m"] / height
    eye, forward = np.array(camera["eye"], float), _forward(camera)
    right = np.cross(forward, np.array(camera.get("up", [0.0, 0.0, 1.0]), float))
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    digest, tasks, places = _hash(path), [], {}
    for row, top in enumerate(range(0, height, tile_px)):
        for column, left in enumerate(range(0, width, tile_px)):
            w, h = min(tile_px, width - left), min(tile_px, height - top)
            shift = unit * ((left + 0.5 * w - 0.5 * width) * right + (top + 0.5 * h - 0.5 * height) * down)
            changes = {
                "camera.eye": (eye + shift).tolist(),
                "camera.look_at": (eye + shift + forward).tolist(),
                "camera.heading_deg": None,
                "camera.pitch_deg": None,
                "camera.ortho_height_m": unit * h,
                "camera.image": [w, h],
            }
            name = f"tile_{row}_{column}"
            places[f"{name}.png"] = [left, top, w, h]
            tasks.append(Task("picture", path, digest, _file(folder, name), options, changes=changes, allow_roots=roots))
    _write(folder / "tiles.json", {"size": [width, height], "left_top_width_height": places}, overwrite)
    return run(tasks, _records(folder), on or Local(), progress, "tiles", overwrite)


def _roots(allow_roots: Sequence[str | os.PathLike[str]]) -> tuple[str, ...]:
    return tuple(os.path.abspath(os.fspath(root)) for root in allow_roots)


def _folder(out: str | os.PathLike[str]) -> Path:
    folder = Path(os.path.abspath(os.fspath(out)))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{folder}: {error.strerror or error}") from error
    return folder


def _records(folder: Path) -> Path:
    return folder / ".batch"


def _file(folder: Path, name: str) -> str:
    if name != os.path.basename(name) or name in ("", ".", ".."):
        raise InputError(f"{name!r} is not a name of a picture; leave out folders")
    return os.fspath(folder / f"{name}.png")


def _hash(path: str) -> str:
    try:
        return sha256_of(path)
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error


def _options(options: Mapping[str, Any]) -> dict[str, Any]:
    for word in ("threads", "progress"):
        if word in options:
            raise InputError(f"{word} is not an option of the pictures of a batch; give it to the adapter, such as batch.Local(threads=2)")
    plain: dict[str, Any] = _plain(options)
    return plain


def _plain(value: object) -> Any:
    """A value as JSON holds it: numbers and arrays of NumPy become those of Python."""
    return json.loads(text("the batch", value))


def _forward(camera: Mapping[str, Any]) -> NDArray[np.float64]:
    """Direction of view of a resolved camera, unit length."""
    if camera.get("look_at") is not None:
        way = np.array(camera["look_at"], float) - np.array(camera["eye"], float)
        unit: NDArray[np.float64] = way / np.linalg.norm(way)
        return unit
    heading, pitch = np.radians(float(camera["heading_deg"])), np.radians(float(camera["pitch_deg"]))
    return np.array([np.sin(heading) * np.cos(pitch), np.cos(heading) * np.cos(pitch), -np.sin(pitch)])


def _write(path: Path, value: object, overwrite: bool) -> None:
    if path.exists() and not overwrite and not _records(path.parent).exists():
        raise FileError(f"{path} exists; give overwrite=True, or another folder")
    try:
        write_whole(path, json.dumps(value, indent=1) + "\n")
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error
