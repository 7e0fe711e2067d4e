"""How a call is done: threads, limit of time, progress."""

from __future__ import annotations

import contextlib
import numbers
from typing import Any, Callable, Iterator, Optional, Tuple, Union

from .errors import InputError

#: A callable of the name of the work and the share done, 0..=1; ``True`` or ``tqdm.tqdm`` for a bar of tqdm; a bar of tqdm; ``None``.
Progress = Union[None, bool, Callable[[str, float], object], Any]
Ask = Tuple[int, Optional[float], Optional[Callable[[str, float], object]]]

_MOST_THREADS = 1024


@contextlib.contextmanager
def asked(
    threads: int | None = None, progress: Progress = None, time_limit_s: float | None = None
) -> Iterator[Ask]:
    """The three as the engine takes them; a bar that is made here is closed here."""
    if threads is None:
        threads = 0
    if isinstance(threads, bool) or not isinstance(threads, numbers.Integral) or not 0 <= threads <= _MOST_THREADS:
        raise InputError(f"threads={threads!r} is not a number of threads; give 1 to {_MOST_THREADS}, or None for one per core")
    if time_limit_s is not None:
        time_limit_s = number("time_limit_s", time_limit_s)
    listener, close = _listener(progress)
    try:
        yield int(threads), time_limit_s, listener
    finally:
        close()


def number(what: str, value: object) -> float:
    """A finite number."""
    try:
        result = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InputError(f"{what}={value!r} is not a number") from None
    if result != result or result in (float("inf"), float("-inf")):
        raise InputError(f"{what}={result} is not finite; give a finite number")
    return result


def _listener(progress: Progress) -> tuple[Callable[[str, float], object] | None, Callable[[], object]]:
    nothing: Callable[[], object] = lambda: None
    if progress is None or progress is False:
        return None, nothing
    if progress is True:
        try:
            from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]
        except ImportError:
            raise InputError("progress=True needs tqdm, which is not installed; pip install tqdm, or give a callable") from None
        progress = tqdm
    if isinstance(progress, type) and hasattr(progress, "update"):
        bar = progress(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}")
        return _of_bar(bar), bar.close
    if hasattr(progress, "update") and hasattr(progress, "set_description_str"):
        return _of_bar(progress), nothing
    if not callable(progress):
        raise InputError(f"progress={progress!r} cannot be called; give a callable of (work, share), True, or None")
    return progress, nothing


def _of_bar(bar: Any) -> Callable[[str, float], object]:
    def tell(work: str, share: float) -> None:
        bar.set_description_str(work, refresh=False)
        bar.n = share * (bar.total or 1.0)
        bar.refresh()

    return tell
