"""Tasks: what a worker does, and the record that it leaves."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Iterator

import belvedere


def sha256_of(path: str | os.PathLike[str]) -> str:
    """Hash of a file, hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest() if hasattr(hashlib, "file_digest") else _digest(file)


def _digest(file: Any) -> str:
    digest = hashlib.sha256()
    for piece in iter(lambda: file.read(1 << 20), b""):
        digest.update(piece)
    return digest.hexdigest()


def write_whole(path: Path, text: str) -> None:
    """Writes a file as a whole or not at all."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


@dataclass(frozen=True)
class Task:
    """One piece of work. Its files are the same wherever and however often it runs."""

    #: ``frames`` of a film, or a ``picture``.
    kind: str
    #: Path of the scene file, and its hash when the batch began.
    scene: str
    sha256: str
    #: Folder of the frames, or file of the picture.
    out: str
    #: Arguments of :func:`belvedere.animate` or :meth:`belvedere.Scene.render`.
    options: dict[str, Any] = field(default_factory=dict)
    #: First and last frame.
    part: tuple[int, int] | None = None
    #: Keys of the scene, such as ``camera.fov_y_deg``, and their values.
    changes: dict[str, Any] = field(default_factory=dict)
    #: Folders beside the scene's own from which it may read.
    allow_roots: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """Name of the task: a hash of its words and of the program's version."""
        words = json.dumps([belvedere.__version__, asdict(self)], sort_keys=True)
        return hashlib.sha256(words.encode()).hexdigest()[:32]


@dataclass(frozen=True)
class Done:
    """What a finished task left."""

    key: str
    #: Pictures that it drew, time of the task in seconds.
    pictures: int
    seconds: float
    #: Files with their hashes, and bytes together.
    files: dict[str, str]
    bytes: int
    #: Data files that were read, with their hashes; an empty path for one whose place is not known.
    inputs: dict[str, str]
    #: Runs of the task that began.
    begun: int = 1


def perform(task: Task, records: str, threads: int) -> Done:
    """Does a task and writes its record; what workers call. Errors of files are :class:`belvedere.FileError`."""
    try:
        return _performed(task, Path(records), threads)
    except belvedere.Error:
        raise
    except OSError as error:
        raise belvedere.FileError(f"{error.filename or records}: {error.strerror or error}") from error


def _performed(task: Task, folder: Path, threads: int) -> Done:
    # A byte for each run that begins: what was retried, whoever retried it.
    mark = folder / f"{task.key}.begun"
    with open(mark, "ab") as file:
        file.write(b".")
    started = time.monotonic()
    try:
        if sha256_of(task.scene) != task.sha256:
            raise belvedere.InputError(f"{task.scene} has changed since the batch began; begin it anew")
        drawn = {"frames": _frames, "picture": _picture}[task.kind](task, threads)
    except belvedere.Error:
        mark.unlink(missing_ok=True)
        raise
    try:
        begun = mark.stat().st_size
    except FileNotFoundError:
        # The same task of a batch that was given up may have ended meanwhile.
        begun = 1
    files = {path: sha256_of(path) for path in drawn[1]}
    size = sum(os.stat(path).st_size for path in files)
    done = Done(task.key, drawn[0], time.monotonic() - started, files, size, drawn[2], begun)
    write_whole(folder / f"{task.key}.json", json.dumps(asdict(done), sort_keys=True))
    mark.unlink(missing_ok=True)
    return done


def _frames(task: Task, threads: int) -> tuple[int, list[str], dict[str, str]]:
    scene = belvedere.Scene.open(task.scene, allow_roots=task.allow_roots, threads=threads)
    made = belvedere.animate(scene, task.out, part=task.part, threads=threads, **task.options)
    first, last = task.part or (0, made.frames - 1)
    records = made.raw["manifest"]["frames"][first : last + 1]
    files = [os.path.join(made.raw["folder"], record["file"]) for record in records]
    return made.drawn, files, _data(made.raw["manifest"]["inputs"], task, scene)


def _picture(task: Task, threads: int) -> tuple[int, list[str], dict[str, str]]:
    scene = belvedere.Scene.open(task.scene, allow_roots=task.allow_roots, threads=threads)
    if task.changes:
        document = scene.document
        for key, value in task.changes.items():
            change(document, key, value)
        folder = os.path.dirname(os.path.abspath(task.scene))
        scene = belvedere.Scene.from_document(document, folder=folder, allow_roots=task.allow_roots)
    picture = scene.render(threads=threads, **task.options)
    files = [os.fspath(path) for path in picture.save(task.out, overwrite=True)]
    return 1, files, _data(picture.record["inputs"], task, scene)


def _data(inputs: list[dict[str, str]], task: Task, scene: belvedere.Scene) -> dict[str, str]:
    """Places and hashes of data files, which records name without their folders. The first entry is the scene, whose hash the task holds."""
    base = Path(task.scene).parent
    named = [base / text for text in _texts(scene.document) if "\0" not in text and len(text) < 4096]
    folders = dict.fromkeys([base, *(path.parent for path in named), *named, *map(Path, task.allow_roots)])
    found: dict[str, str] = {}
    for entry in inputs[1:]:
        places = (folder / entry["path"] for folder in folders)
        place = next((p for p in places if p.is_file() and sha256_of(p) == entry["sha256"]), None)
        found["" if place is None else os.path.abspath(place)] = entry["sha256"]
    return found


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (list, dict)):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from _texts(inner)


def change(document: dict[str, Any], key: str, value: Any) -> None:
    """Sets a key of a document; dots lead inwards, numbers count the entries of a list from 0."""
    *way, last = key.split(".")
    place: Any = document
    for step in way:
        place = _inner(place, step, key)
    if isinstance(place, list):
        _inner(place, last, key)
        place[int(last)] = value
    else:
        place[last] = value


def _inner(place: Any, step: str, key: str) -> Any:
    if isinstance(place, list):
        if not step.isdigit() or int(step) >= len(place):
            raise belvedere.InputError(f"{key}: there is no entry {step}; the list has {len(place)}, counted from 0")
        return place[int(step)]
    if not isinstance(place, dict) or (step not in place):
        raise belvedere.InputError(f"{key}: the scene has no {step}")
    return place[step]
