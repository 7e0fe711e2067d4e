"""``generalise``: a city in levels of abstraction, and a map of it."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Mapping, Sequence

from . import _native
from ._ask import Progress, asked, number
from ._drawing import given
from ._json import text
from .errors import InputError
from .reports import Note, notes_of


@dataclass(frozen=True)
class Generalised:
    """Levels of a city, as they were written."""

    #: The levels (CityJSON), the map, plan drawings and the report.
    files: tuple[Path, ...]
    #: One line per level.
    summary: str
    #: Levels that do not keep the volume, one sentence each.
    missed: tuple[str, ...]
    warnings: tuple[Note, ...]
    #: The report, as the command line writes it.
    raw: Mapping[str, Any] = field(repr=False)


def generalise(
    city: str | os.PathLike[str],
    roads: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    *,
    out: str | os.PathLike[str],
    margin_m: float | None = None,
    keep: Literal["height", "volume"] = "height",
    overwrite: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Generalised:
    """Writes two levels of abstraction of a city (blocks between streets, districts), a map with plan drawings, and a report into a folder.

    * ``city``: buildings with their heights or storeys: the path of CityJSON, CityGML, OSM PBF, or footprints (GeoJSON, shapefile).
    * ``roads``: streets, railways, rivers and land cover, if the city file has none: paths.
    * ``out``: the folder. ``margin_m``: distance from buildings up to which ground counts as built-up, metres.
    * ``keep``: what blocks keep of their buildings: the mean height, or the volume, for which they are lower.

    Raises :class:`belvedere.FileError`, :class:`belvedere.InputError`.
    """
    if not isinstance(city, (str, os.PathLike)):
        raise InputError(f"city={type(city).__name__} is no path; give the path of a city file")
    several = [roads] if isinstance(roads, (str, os.PathLike)) else list(roads)
    margin = None if margin_m is None else number("margin_m", margin_m)
    with asked(threads, progress) as ask:
        request = given({"city": os.fspath(city), "roads": [os.fspath(r) for r in several], "margin": margin, "keep": keep})
        answer = json.loads(_native.generalise(text("generalise", request), os.fspath(out), bool(overwrite), ask))
    return Generalised(
        tuple(Path(p) for p in answer["files"]), answer["summary"], tuple(answer["missed"]), tuple(notes_of(answer["warnings"])), answer["report"]
    )
