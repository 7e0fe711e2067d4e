"""Runs the tasks that are not done, and says what that cost."""

from __future__ import annotations

import json
import os
import shutil
import time
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Callable, Sequence

from .._ask import Progress, asked
from ..errors import FileError
from ._adapters import Adapter
from ._task import Done, Task, perform, sha256_of, write_whole


@dataclass(frozen=True)
class Report:
    """What a batch cost. It holds no coordinates and no names of files."""

    adapter: str
    #: Tasks that ran at once, and threads of each.
    slots: int
    threads: int
    tasks: int
    #: Tasks that earlier runs had done.
    kept: int
    #: Runs of tasks that began and did not end, for their worker or machine was lost.
    retries: int
    #: Pictures or frames that were drawn.
    pictures: int
    #: Wall time of the batch, time of all tasks together, seconds.
    seconds: float
    task_seconds: float
    #: Bytes of all files of the tasks.
    bytes: int

    @property
    def seconds_per_picture(self) -> float:
        """Time of the tasks for each picture that was drawn; 0 if none was."""
        return self.task_seconds / self.pictures if self.pictures else 0.0

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the report as JSON."""
        text = json.dumps({**asdict(self), "seconds_per_picture": self.seconds_per_picture}, indent=2) + "\n"
        _write(Path(path), text)


def _write(path: Path, text: str) -> None:
    try:
        write_whole(path, text)
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error


class _Kept:
    """Records of earlier runs, believed where scene, data and files are what they were."""

    def __init__(self, records: Path) -> None:
        self.records = records
        self.hashes: dict[str, str | None] = {}

    def of(self, task: Task) -> Done | None:
        try:
            done = Done(**json.loads((self.records / f"{task.key}.json").read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None
        if any(self._hash(path) != found for path, found in done.files.items()):
            return None
        return done if all(self._hash(path) == found for path, found in done.inputs.items()) else None

    def owns(self, task: Task) -> bool:
        """Whether the picture of a task is one that a batch in this folder drew."""
        return (self.records / f"{task.key}.begun").exists() or task.out in self.files

    @cached_property
    def files(self) -> set[str]:
        """Files of all records."""
        found: set[str] = set()
        for path in self.records.glob("*.json"):
            try:
                found.update(json.loads(path.read_text(encoding="utf-8"))["files"])
            except (OSError, ValueError, KeyError, TypeError):
                continue
        return found

    def _hash(self, path: str | os.PathLike[str]) -> str | None:
        name = os.fspath(path)
        if name not in self.hashes:
            try:
                self.hashes[name] = sha256_of(name)
            except OSError:
                self.hashes[name] = None
        return self.hashes[name]


def run(tasks: Sequence[Task], records: Path, on: Adapter, progress: Progress, words: str, overwrite: bool = False) -> Report:
    """Does the tasks whose records are missing. Pictures of others are replaced with ``overwrite`` alone.

    Ctrl-C and errors cancel what is not done; what is done stays, and the same call goes on from there.
    """
    started = time.monotonic()
    try:
        records.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{records}: {error.strerror or error}") from error
    kept = _Kept(records)
    done = {task.key: found for task in tasks if (found := kept.of(task)) is not None}
    missing = [task for task in tasks if task.key not in done]
    for task in missing:
        if task.kind == "picture" and not overwrite and os.path.exists(task.out) and not kept.owns(task):
            raise FileError(f"{task.out} exists; give overwrite=True, or another folder")
    before = len(done)
    fresh: list[Done] = []
    with asked(None, progress) as (_, _, listener):
        tell: Callable[[str, float], object] = listener or (lambda work, share: None)
        tell(words, before / max(1, len(tasks)))
        finished = on.run(missing, os.fspath(records)) if missing else iter(())
        try:
            for one in finished:
                fresh.append(one)
                tell(words, (before + len(fresh)) / len(tasks))
        finally:
            close = getattr(finished, "close", None)
            if close is not None:
                close()
    return Report(
        adapter=on.name,
        slots=on.slots,
        threads=getattr(on, "threads", 1),
        tasks=len(tasks),
        kept=before,
        retries=sum(one.begun - 1 for one in fresh),
        pictures=sum(one.pictures for one in fresh),
        seconds=time.monotonic() - started,
        task_seconds=sum(one.seconds for one in fresh),
        bytes=sum(one.bytes for one in [*done.values(), *fresh]),
    )


def forget(records: Path) -> None:
    """Removes the records of a batch that is whole."""
    shutil.rmtree(records, ignore_errors=True)


__all__ = ["Report", "forget", "perform", "run"]
