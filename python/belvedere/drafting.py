"""``drafts``: pictures from several sides, to choose from."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from . import _native, _png
from ._ask import Progress, asked
from ._json import text
from .errors import InputError
from .reports import Note, Shares, notes_of
from .revealing import _request, opening


@dataclass(frozen=True)
class Draft:
    """One view. ``belvedere.reveal(dem, routes, **draft.view)`` with the same options makes its picture."""

    #: Eye and point looked at, scene coordinates.
    eye: tuple[float, float, float]
    look_at: tuple[float, float, float]
    #: Full vertical field of view, degrees.
    fov_y_deg: float
    straight: Shares
    bent: Shares
    raw: Mapping[str, Any] = field(repr=False)

    @property
    def view(self) -> dict[str, Any]:
        """The view as arguments of :func:`belvedere.reveal`."""
        return {"eye": self.eye, "look_at": self.look_at, "fov_y_deg": self.fov_y_deg}


@dataclass(frozen=True)
class Drafts:
    """Views from several sides, that of :func:`belvedere.reveal` first. In a notebook they show themselves."""

    drafts: tuple[Draft, ...]
    #: All pictures with their numbers and shares, ``(rows, columns, 3)``.
    sheet: NDArray[np.uint8] = field(repr=False)
    warnings: tuple[Note, ...]

    def __len__(self) -> int:
        return len(self.drafts)

    def __getitem__(self, number: int) -> Draft:
        return self.drafts[number]

    def png(self) -> bytes:
        """The sheet as the bytes of a PNG file."""
        return _png.rgb(self.sheet)

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the sheet (PNG)."""
        return _png.save(Path(os.fspath(path)), self.png(), overwrite)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        return {"image/png": self.png(), "text/plain": repr(self)}


def drafts(
    dem: object,
    routes: object = None,
    *,
    count: int = 6,
    threads: int | None = None,
    progress: Progress = None,
    time_limit_s: float | None = None,
    **options: Any,
) -> Drafts:
    """Reveals routes, or a target (``see``), from up to ``count`` sides, 1 to 24.

    * ``options``: those of :func:`belvedere.reveal`, but for a view (``eye``, ``look_at``, ``fov_y_deg``).
    """
    for name in ("eye", "look_at", "fov_y_deg"):
        if name in options:
            raise TypeError(f"drafts() chooses views and takes no {name}")
    if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or not 1 <= count <= 24:
        raise InputError(f"count={count!r} is not a number of drafts; give 1 to 24")
    arrays = _native.NativeArrays()
    request = text("drafts", _request(dem, routes, arrays, **options))
    with asked(threads, progress, time_limit_s) as ask:
        numbers, width, colors = _native.drafts(request, opening(), arrays, int(count), ask)
    found = json.loads(numbers)
    return Drafts(tuple(map(_draft, found["drafts"])), np.frombuffer(colors, np.uint8).reshape(-1, width, 3), tuple(notes_of(found["warnings"])))


def _draft(raw: Mapping[str, Any]) -> Draft:
    straight, bent = (Shares(raw[f"visible_{kind}"], raw[f"in_frame_{kind}"]) for kind in ("straight", "bent"))
    (ex, ey, ez), (lx, ly, lz) = raw["eye"], raw["look"]
    return Draft((ex, ey, ez), (lx, ly, lz), raw["fov_y_deg"], straight, bent, raw)
