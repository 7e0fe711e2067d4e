"""Draws all pictures of a kit and writes `stimuli.json`: what is asked, what is right, and where it is seen."""

from __future__ import annotations

import hashlib
import json
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable

from .program import Program
from .searching import counting, finding
from .store import Store
from .things import lay_atoms
from .trying import Item
from .walking import comparison, memory

#: Seconds after which a search ends, for which things to count are shown, and for which each view of a route is.
FIND_LIMIT_S, COUNT_LIMIT_S, VIEW_S = 90, 45, 1.8

Kit = dict[str, Any]
Job = Callable[[Program, Store, list[int]], Item]


@dataclass(frozen=True)
class Extent:
    """How much is drawn. The places of the first four tasks are those of short sessions, so kinds alternate."""

    find: tuple[str, ...] = ("city", "mountain", "molecule", "city", "city", "molecule", "mountain", "city")
    count: tuple[str, ...] = ("city", "molecule", "mountain", "city", "molecule", "mountain")
    path: int = 6
    prefer: int = 10
    views: int = 5


FULL = Extent()
#: A small kit for tries.
QUICK = Extent(("city", "molecule"), ("city", "molecule"), 2, 2, 3)


def make(folder: Path, program_path: str | None, seed: int, size: tuple[int, int], extent: Extent, jobs: int) -> Kit:
    """Draws into `folder/pictures` and writes `folder/stimuli.json`; returns what it holds."""
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    store = Store(folder / "pictures", size, extent.views)
    with tempfile.TemporaryDirectory(prefix="belvedere-study-") as work:
        program = Program.find(program_path, Path(work))
        lay_atoms(program.folder)
        kit = _drawn(program, store, seed, extent, jobs)
        about = {"format": 1, "seed": seed, "size": list(size), "views": extent.views, "program": program.version()}
        kit = {**about, **kit}
    kit["limits_s"] = {"find": FIND_LIMIT_S, "count": COUNT_LIMIT_S, "view": VIEW_S}
    kit["kit"] = hashlib.sha256(json.dumps(kit, sort_keys=True).encode()).hexdigest()[:8]
    (folder / "stimuli.json").write_text(json.dumps(kit, separators=(",", ":")) + "\n", encoding="utf-8")
    return kit


def _drawn(program: Program, store: Store, seed: int, extent: Extent, jobs: int) -> Kit:
    with ThreadPoolExecutor(max_workers=max(1, jobs)) as pool:
        futures = {
            name: pool.submit(job, program, store, [seed, k]) for k, (name, job) in enumerate(_jobs(extent).items())
        }
        items = {name: future.result() for name, future in futures.items()}
    kit: Kit = {"practice": {}}
    for name, item in items.items():
        *practice, task, _ = name.split("-")
        (kit["practice"] if practice else kit).setdefault(task, []).append(item)
    return kit


def _jobs(extent: Extent) -> dict[str, Job]:
    """All tasks by name. In every other search the first straight picture hides what is sought; elsewhere chance
    decides."""
    jobs: dict[str, Job] = {}
    for k, kind in enumerate(extent.find):
        jobs[f"find-{k + 1}"] = _find(f"find-{k + 1}", kind, k % 2 == 0)
    for k, kind in enumerate(extent.count):
        jobs[f"count-{k + 1}"] = _count(f"count-{k + 1}", kind)
    for k in range(extent.path):
        jobs[f"path-{k + 1}"] = _memory(f"path-{k + 1}")
    for k in range(extent.prefer):
        jobs[f"prefer-{k + 1}"] = _comparison(f"prefer-{k + 1}")
    jobs["practice-find-1"] = _find("practice-find-1", "city", False)
    jobs["practice-count-1"] = _count("practice-count-1", "city")
    jobs["practice-path-1"] = _memory("practice-path-1")
    jobs["practice-prefer-1"] = _comparison("practice-prefer-1")
    return jobs


def _find(name: str, kind: str, hidden: bool) -> Job:
    return lambda program, store, seed: finding(program, store, seed, name, kind, hidden)


def _count(name: str, kind: str) -> Job:
    return lambda program, store, seed: counting(program, store, seed, name, kind)


def _memory(name: str) -> Job:
    return lambda program, store, seed: memory(program, store, seed, name)


def _comparison(name: str) -> Job:
    return lambda program, store, seed: comparison(program, store, seed, name)
