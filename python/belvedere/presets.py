"""Preset documents of spline bends: listed, changed, checked, drawn.

A document is a dictionary; it goes into a scene by ``scene.add_stage("spline_bend", presets=document)``.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._folder import Folder
from ._json import text
from .reports import PresetCheck, PresetShape

T = TypeVar("T")
#: A built-in name, a file, or a document.
Preset = Union[str, "os.PathLike[str]", Mapping[str, Any]]


@dataclass(frozen=True)
class Listed:
    """A built-in document."""

    name: str
    aliases: tuple[str, ...]
    #: What it does.
    effect: str
    presets: tuple[PresetShape, ...]


def names() -> list[Listed]:
    """The built-in documents."""
    listed = json.loads(_native.preset_list())
    return [Listed(b["name"], tuple(b["aliases"]), b["effect"], tuple(map(PresetShape.of, b["presets"]))) for b in listed]


def load(preset: Preset) -> dict[str, Any]:
    """The document of a built-in name or file, checked."""
    document: dict[str, Any] = json.loads(_with_source(preset, _native.preset_text))
    return document


def check(preset: Preset) -> PresetCheck:
    """At which viewing angles a document is usable, from the horizon (0 degrees) to straight down (90)."""
    return PresetCheck.of(json.loads(_with_source(preset, _native.preset_check)))


def edit(preset: Preset, *operations: str) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The document after operations such as ``"low.phi=20"`` (see ``belvedere preset set --help``), all or none; and notes on values that were limited."""
    changed = json.loads(_with_source(preset, lambda source: _native.preset_set(source, list(operations))))
    return changed["document"], changed["limited"]


def plot(preset: Preset, *, phi_deg: float | None = None) -> NDArray[np.uint8]:
    """A drawing of the curves with eye, wedge of view and tag points, ``(rows, columns, 3)``; at one viewing angle, degrees, if that is given."""
    width, data = _with_source(preset, lambda source: _native.preset_plot(source, phi_deg))
    return np.frombuffer(data, np.uint8).reshape(-1, width, 3)


def _with_source(preset: Preset, call: Callable[[str], T]) -> T:
    if not isinstance(preset, Mapping):
        return call(os.fspath(preset))
    folder = Folder()
    path: Path = folder.file("preset.json")
    path.write_text(text("the preset document", preset), encoding="utf-8")
    return call(os.fspath(path))


__all__: Sequence[str] = ["Listed", "Preset", "names", "load", "check", "edit", "plot"]
