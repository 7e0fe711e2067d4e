"""Where tasks run."""

from __future__ import annotations

import concurrent.futures as futures
import multiprocessing
import os
import uuid
from collections import deque
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Iterator, Protocol, Sequence

from ..errors import InputError, InternalError
from ._task import Done, Task, perform


class Adapter(Protocol):
    """Runs tasks; a task whose worker or machine is lost runs again."""

    #: Name in the report.
    name: str

    @property
    def slots(self) -> int:
        """Tasks that run at once."""
        ...

    def run(self, tasks: Sequence[Task], records: str) -> Iterator[Done]:
        """Yields what is done as it is done. An error of a task ends the batch; closing the iterator cancels the rest."""
        ...


class Local:
    """Processes on this machine.

    * ``workers``: their number, by default one per core. ``threads``: threads of each, by default the cores shared evenly.
    * ``retries``: how often a task begins again when its process was killed.

    A script that uses it does its work under ``if __name__ == "__main__":``, for each process reads the script again.
    """

    name = "local"

    def __init__(self, workers: int | None = None, *, threads: int | None = None, retries: int = 3) -> None:
        cores = _cores()
        self.slots = _count("workers", cores if workers is None else workers)
        self.threads = _count("threads", max(1, cores // self.slots) if threads is None else threads)
        self.retries = retries

    def run(self, tasks: Sequence[Task], records: str) -> Iterator[Done]:
        """See :class:`Adapter`."""
        waiting = deque((task, 0) for task in tasks)
        # Not forked: a fork would copy the pools of threads of this process without their threads.
        context = multiprocessing.get_context("spawn")
        while waiting:
            pool = futures.ProcessPoolExecutor(min(self.slots, len(waiting)), mp_context=context)
            running: dict[futures.Future[Done], tuple[Task, int]] = {}
            lost: list[tuple[Task, int]] = []
            try:
                while (waiting and not lost) or running:
                    # Few are handed out at once: those in hand begin again when a process is killed.
                    while waiting and not lost and len(running) < self.slots:
                        task, tries = waiting.popleft()
                        try:
                            running[pool.submit(perform, task, records, self.threads)] = (task, tries)
                        except BrokenProcessPool:
                            lost.append((task, tries))
                    if not running:
                        break
                    finished, _ = futures.wait(running, return_when=futures.FIRST_COMPLETED)
                    for future in finished:
                        task, tries = running.pop(future)
                        try:
                            yield future.result()
                        except BrokenProcessPool:
                            if tries >= self.retries:
                                raise InternalError(_lost(task, tries, records)) from None
                            lost.append((task, tries + 1))
                waiting.extendleft(reversed(lost))
            finally:
                stopped = not running and not lost
                _end(pool, kill=not stopped)


class Dask:
    """A cluster of Dask: ``dask.distributed``.

    * ``client``: a ``distributed.Client``. ``threads``: threads of each task; a worker runs as many tasks at once as it has threads of its own.

    Dask gives the task of a lost worker to another, as often as its ``allowed-failures`` say.
    """

    name = "dask"

    def __init__(self, client: Any, *, threads: int = 1) -> None:
        self.client, self.threads = client, _count("threads", threads)

    @property
    def slots(self) -> int:
        """See :class:`Adapter`."""
        return max(1, sum(int(threads) for threads in self.client.nthreads().values()))

    def run(self, tasks: Sequence[Task], records: str) -> Iterator[Done]:
        """See :class:`Adapter`."""
        from distributed import as_completed

        # No `retries`: they would repeat errors of ours, which fail each time. A key of its own: a result that somebody still holds would be
        # taken for this one.
        call = uuid.uuid4().hex
        work = [
            self.client.submit(perform, task, records, self.threads, key=f"belvedere-{task.key}-{call}", pure=False)
            for task in tasks
        ]
        try:
            for future in as_completed(work):
                yield future.result()
        finally:
            self.client.cancel([future for future in work if not future.done()])


class Ray:
    """A cluster of Ray. ``ray.init`` is called if it was not.

    * ``threads``: threads of each task, and the processors that Ray keeps for it; Ray does not set the engine's threads itself.
    * ``retries``: how often a task begins again when its worker or node is lost.
    """

    name = "ray"

    def __init__(self, *, threads: int = 1, retries: int = 5) -> None:
        self.threads, self.retries = _count("threads", threads), retries

    @property
    def slots(self) -> int:
        """See :class:`Adapter`."""
        import ray

        if not ray.is_initialized():
            ray.init()
        return max(1, int(ray.cluster_resources().get("CPU", 1)) // self.threads)

    def run(self, tasks: Sequence[Task], records: str) -> Iterator[Done]:
        """See :class:`Adapter`."""
        import ray

        if not ray.is_initialized():
            ray.init()
        remote = ray.remote(num_cpus=self.threads, max_retries=self.retries, retry_exceptions=False)(perform)
        waiting = [remote.remote(task, records, self.threads) for task in tasks]
        try:
            while waiting:
                finished, waiting = ray.wait(waiting)
                for one in finished:
                    try:
                        yield ray.get(one)
                    except ray.exceptions.RayTaskError as error:
                        # The error of ours that it carries, as the other adapters raise it.
                        raise (error.cause if isinstance(error.cause, Exception) else error) from None
        finally:
            for one in waiting:
                ray.cancel(one, force=True)


def _end(pool: futures.ProcessPoolExecutor, kill: bool) -> None:
    """Ends a pool; work that nobody waits for is killed, which leaves no half-written file."""
    processes = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=not kill, cancel_futures=True)
    if kill:
        for process in processes:
            process.terminate()
        for process in processes:
            process.join(5.0)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _count(what: str, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"{what}={value!r} is not a number of {what}; give a whole number above 0")
    return value


def _lost(task: Task, tries: int, records: str) -> str:
    if not os.path.exists(os.path.join(records, f"{task.key}.begun")):
        return (
            f"the process of a task ended {tries + 1} times before it began ({_words(task)}); in a script, call this under "
            'if __name__ == "__main__":'
        )
    return f"the process of a task was killed {tries + 1} times ({_words(task)}); give it more memory, or fewer workers"


def _words(task: Task) -> str:
    return f"frames {task.part[0]} to {task.part[1]}" if task.part else os.path.basename(task.out)
