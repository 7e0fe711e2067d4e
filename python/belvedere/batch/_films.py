"""Films in parts."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Sequence

from .._ask import Progress
from ..errors import FileError, InputError
from ..film import animate
from ..reports import FilmReport
from ..scene import Scene
from ._adapters import Adapter, Local
from ._run import Report, forget, run
from ._task import Task, sha256_of


def film(
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    on: Adapter | None = None,
    frames_per_task: int | None = None,
    allow_roots: Sequence[str | os.PathLike[str]] = (),
    progress: Progress = None,
    **options: Any,
) -> tuple[FilmReport, Report]:
    """Draws a film by several workers; the frames, their record and the film are those of :func:`belvedere.animate`, byte for byte.

    * ``scene``: path of a scene file. ``out``: a film, or a folder of frames.
    * ``on``: where the parts are drawn, by default :class:`Local`.
    * ``frames_per_task``: frames of a part, by default about four parts for each worker, of 100 frames at most.
    * ``options``: those of :func:`belvedere.animate`; ``overwrite=True`` removes an earlier film with its frames first.

    The same call after an interruption draws what is missing. A film along a route has only one part where ground makes way or rays track a target: use :func:`belvedere.animate`.
    """
    on = Local() if on is None else on
    path = os.path.abspath(os.fspath(scene))
    roots = tuple(os.path.abspath(os.fspath(root)) for root in allow_roots)
    target = os.path.abspath(os.fspath(out))
    for word in ("part", "resume", "threads"):
        if word in options:
            raise InputError(f"{word} is not an option of a film in parts; leave it out")
    if options.pop("overwrite", False):
        _clear(target)
    if frames_per_task is not None and (isinstance(frames_per_task, bool) or frames_per_task < 1):
        raise InputError(f"frames_per_task={frames_per_task!r} is not a number of frames; give a whole number above 0")
    opened = Scene.open(path, allow_roots=roots)
    # The first frame is drawn here: it finds mistakes before any worker starts, counts the frames, and plans the lifts for all parts.
    first = animate(opened, target, part=(0, 0), **options)
    frames = first.frames
    each = frames_per_task or max(1, min(100, -(-frames // (4 * on.slots))))
    parts = [(begin, min(begin + each, frames) - 1) for begin in range(1, frames, each)]
    folder = os.fspath(first.raw["folder"])
    tasks = [Task("frames", path, sha256_of(path), target, options, part, allow_roots=roots) for part in parts]
    records = Path(folder + ".batch")
    report = run(tasks, records, on, progress, "frames")
    whole = animate(opened, target, resume=True, **options)
    forget(records)
    return whole, report


def _clear(target: str) -> None:
    """Removes a film with its frames and records, and nothing else of the folder."""
    path = Path(target)
    folder = path.with_suffix(".frames") if path.suffix.lower() == ".mp4" else path
    try:
        if folder != path:
            path.unlink(missing_ok=True)
        for pattern in ("frame_*.png", "animation.json", "animation.p*.json", "animation.names.json"):
            for file in folder.glob(pattern):
                file.unlink()
    except OSError as error:
        raise FileError(f"{error.filename or folder}: {error.strerror or error}") from error
    forget(Path(f"{folder}.batch"))
