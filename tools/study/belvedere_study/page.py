"""Packs a kit into one page that works from a file, without a server or network."""

from __future__ import annotations

import html
import json
from importlib import resources
from pathlib import Path
from typing import Any

from . import order
from .pictures import data_uri
from .records import COLUMNS

#: Parts of the program of the page, in the order in which they are put together.
SCRIPTS = tuple(
    f"{part}.js" for part in ("base", "records", "codes", "plan", "picture", "tasks", "session", "teacher", "start")
)
#: Minutes of a session, as an honest guess: instructions and practice included.
MINUTES = {"A": {"full": 14, "short": 9}, "B": {"full": 5, "short": 3}, "AB": {"full": 19, "short": 12}}

Kit = dict[str, Any]


def write(folder: Path, kit: Kit, texts: dict[str, str]) -> Path:
    """Writes `folder/study.html` from the kit and its pictures; returns its path."""
    pictures = {
        file.name: data_uri(file.read_bytes(), file.suffix[1:])
        for file in sorted((folder / "pictures").iterdir())
        if file.name in set(_names(kit))
    }
    path = folder / "study.html"
    path.write_text(packed(kit, texts, pictures), encoding="utf-8")
    return path


def packed(kit: Kit, texts: dict[str, str], pictures: dict[str, str]) -> str:
    """The whole page."""
    data = {
        "kit": kit,
        "texts": texts,
        "order": order.of_kit(kit),
        "tasks": order.TASKS,
        "perspectives": order.PERSPECTIVES,
        "columns": list(COLUMNS),
        "minutes": MINUTES,
        "pictures": pictures,
    }
    # A `<` in a text must not end the element that holds the data.
    held = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    parts = {
        "LANGUAGE": html.escape(texts["language"]),
        "TITLE": html.escape(texts["title"]),
        "STYLE": _part("study.css"),
        "DATA": held,
        "SCRIPT": "\n".join(_part(name) for name in SCRIPTS),
    }
    page = _part("study.html")
    for name, part in parts.items():
        page = page.replace(f"<!--{name}-->", part, 1)
    return page


def _part(name: str) -> str:
    return (resources.files(__package__) / "web" / name).read_text(encoding="utf-8")


def _names(value: Any) -> list[str]:
    """Names of all pictures that a kit speaks of."""
    if isinstance(value, dict):
        own = [value["picture"]] if isinstance(value.get("picture"), str) else list(value.get("pictures", []))
        return own + [name for one in value.values() for name in _names(one)]
    if isinstance(value, list):
        return [name for one in value for name in _names(one)]
    return []
