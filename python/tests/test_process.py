"""Threads, signals, forks, progress and panics."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import belvedere
from belvedere import _native
from conftest import CELL, ROUTE, hills


def test_a_panic_is_an_exception_and_the_next_call_works(scene: belvedere.Scene) -> None:
    with pytest.raises(belvedere.InternalError, match="asked for"):
        _native.panics()
    assert scene.render(size=(32, 24)).size == (32, 24)


def _in_child(scene: belvedere.Scene, queue: "multiprocessing.Queue[bytes]") -> None:
    queue.put(scene.render(size=(64, 48)).png())


def test_a_forked_process_draws(scene: belvedere.Scene) -> None:
    before = scene.render(size=(64, 48)).png()
    fork = multiprocessing.get_context("fork")
    queue = fork.Queue()
    child = fork.Process(target=_in_child, args=(scene, queue))
    child.start()
    assert queue.get(timeout=60) == before
    child.join(20)
    assert child.exitcode == 0
    # The files of the scene are still there.
    scene.add_points([[100.0, 100.0]])
    assert scene.render(size=(64, 48)).size == (64, 48)


def test_the_interpreter_is_free_while_drawing() -> None:
    scene = belvedere.Scene.builtin("massif")
    scene.layers
    ticks, stop = [0], threading.Event()

    def count() -> None:
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    began = time.perf_counter()
    scene.render(size=(1280, 720), samples=16)
    took = time.perf_counter() - began
    stop.set()
    counter.join()
    assert ticks[0] > 20 * took, f"{ticks[0]} ticks in {took:.2f} s"


# Background jobs of a shell begin with Ctrl-C ignored, and so would their children.
INTERRUPTED = """
import belvedere, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = belvedere.Scene.builtin("massif")
print("ready", flush=True)
try:
    scene.render(size=(4000, 3000), samples=4, renderer="exact")
except KeyboardInterrupt:
    print("interrupted", flush=True)
    assert scene.render(size=(32, 24)).size == (32, 24)
    sys.exit(7)
"""


def test_ctrl_c_ends_within_a_second() -> None:
    child = subprocess.Popen([sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None and child.stdout.readline() == "ready\n"
    time.sleep(0.7)
    began = time.perf_counter()
    child.send_signal(signal.SIGINT)
    assert child.stdout.readline() == "interrupted\n"
    took = time.perf_counter() - began
    assert child.wait(60) == 7 and took < 2.0, took


def test_progress_goes_to_a_callable_and_its_errors_end_the_work() -> None:
    told: list[tuple[str, float]] = []
    belvedere.reveal(hills(), ROUTE, spacing=CELL, size=(160, 90), progress=lambda work, share: told.append((work, share)))
    assert told and all(isinstance(w, str) and 0 <= s <= 1 for w, s in told)

    class Enough(Exception):
        pass

    def stop(work: str, share: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        belvedere.reveal(hills(), ROUTE, spacing=CELL, size=(160, 90), technique="terrain", progress=stop)

    class Bar:
        total, n, words, closed = 1.0, 0.0, "", False

        def __init__(self, **keys: object) -> None:
            bars.append(self)

        def update(self) -> None: ...

        def set_description_str(self, text: str, refresh: bool = True) -> None:
            self.words = text

        def refresh(self) -> None: ...

        def close(self) -> None:
            self.closed = True

    bars: list[Bar] = []
    belvedere.reveal(hills(), ROUTE, spacing=CELL, size=(160, 90), progress=Bar)
    assert bars[0].closed and bars[0].words
    with pytest.raises(belvedere.InputError, match="callable"):
        belvedere.reveal(hills(), ROUTE, spacing=CELL, progress=7)


def test_threads_are_an_argument_and_change_nothing(scene: belvedere.Scene) -> None:
    pictures = {scene.render(size=(64, 48), threads=n).png() for n in (None, 1, 2, 3)}
    assert len(pictures) == 1
    for threads in (-1, 1.5, True, "two", 10**9):
        with pytest.raises(belvedere.InputError, match="threads="):
            scene.render(threads=threads)  # type: ignore[arg-type]


def test_too_large_pictures_are_refused(scene: belvedere.Scene) -> None:
    belvedere.set_memory_limit(200 << 20)
    try:
        with pytest.raises(belvedere.MemoryLimitError, match="MiB"):
            scene.render(size=(20000, 20000))
    finally:
        belvedere.set_memory_limit(0)


def test_arrays_need_no_files(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise AssertionError("a temporary folder is made")

    monkeypatch.setattr(tempfile, "mkdtemp", refused)
    camera = belvedere.Camera((1200.0, -1500.0, 900.0), (1200.0, 1000.0, 300.0))
    scene = belvedere.Scene(camera=camera).add_terrain(hills(), spacing=CELL).add_lines(ROUTE)
    scene.add_mesh(np.eye(3) * 50 + [1200, 900, 500], [[0, 1, 2]])
    assert scene.render(size=(64, 36)).id.any()
    found = belvedere.reveal(hills(), ROUTE, spacing=CELL, eye=(1200.0, -1500.0, 900.0), look_at=(1200.0, 1000.0, 300.0), size=(64, 36))
    assert [i["path"] for i in found.picture.record["inputs"]] == ["array:terrain", "array:features1"]


def test_a_picture_of_an_array_takes_little_time() -> None:
    heights = np.tile(hills(), (8, 6))
    best = 9.0
    for _ in range(3):
        began = time.perf_counter()
        camera = belvedere.Camera((7000.0, -3000.0, 3000.0), (7000.0, 6000.0, 300.0))
        assert belvedere.Scene(camera=camera).add_terrain(heights, spacing=CELL).render(size=(640, 360)).rgba.any()
        best = min(best, time.perf_counter() - began)
    print(f"array of {heights.shape} to picture of 640 x 360: {best:.3f} s")
    assert best < 2.0


def test_mistakes_in_scenes_are_told_by_key(tmp_path: "os.PathLike[str]") -> None:
    scene = belvedere.Scene(camera={"eye": [0, 0, 9], "look_at": [0, 9, 0], "fov_deg": 30})
    with pytest.raises(belvedere.InputError, match="fov_y_deg"):
        scene.add_terrain(hills(), spacing=CELL).render()
    with pytest.raises(belvedere.FileError, match="nothing.toml"):
        belvedere.Scene.open("nothing.toml")
    with pytest.raises(belvedere.InputError, match="samples"):
        belvedere.Scene.builtin("massif").render(samples=3)


def test_pack_takes_the_application_of_the_package(tmp_path: Path) -> None:
    """Wheels of releases hold the application for browsers; those of tests do not, and say where it belongs."""
    web = Path(belvedere.__file__).parent / "web"
    env = {name: value for name, value in os.environ.items() if name != "BELVEDERE_WEB_APP"}
    done = subprocess.run(
        [sys.executable, "-m", "belvedere", "pack", "-o", tmp_path / "site"], capture_output=True, text=True, env=env)
    if web.is_dir():
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "site" / "belvedere_bg.wasm").stat().st_size == (web / "belvedere_bg.wasm").stat().st_size
    else:
        assert done.returncode == 2 and str(web) in done.stderr, done.stderr
