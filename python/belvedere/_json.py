"""JSON between Python and the engine."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np

from ._masks import masked_count
from .errors import InputError


def text(what: str, value: object) -> str:
    """The JSON of options or a document; arrays become lists, paths become texts."""
    try:
        return json.dumps(_plain(what, value), allow_nan=False)
    except ValueError:
        raise InputError(f"{what} holds a number that is not finite; give finite numbers") from None
    except RecursionError:
        raise InputError(f"{what} holds itself; give plain lists and dictionaries") from None


def _plain(what: str, value: object) -> Any:
    if value is None or isinstance(value, (bool, str, int, float)):
        return value
    if masked_count(value):
        raise InputError(f"{what} holds a masked value; give plain numbers")
    if isinstance(value, np.ndarray):
        return _plain(what, value.tolist())
    if isinstance(value, np.generic):
        return _plain(what, value.item())
    if isinstance(value, dict):
        return {str(key): _plain(what, item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(what, item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise InputError(f"{what} holds {type(value).__name__}, which is no number, text, list or dictionary")


def size(value: object) -> list[int] | None:
    """Width and height in pixels."""
    if value is None:
        return None
    try:
        width, height = (int(v) for v in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise InputError(f"size={value!r} is not (width, height) in pixels; give two whole numbers, such as (1280, 720)") from None
    if not (1 <= width <= 65536 and 1 <= height <= 65536):
        raise InputError(f"size=({width}, {height}) is no size of a picture; give 1 to 65536 pixels each")
    return [width, height]


def place(what: str, value: object) -> str | None:
    """A place as text: numbers ``(x, y)`` or ``(x, y, z)``, or a text such as ``"46.5N,11.3E,+20"``."""
    if value is None or isinstance(value, str):
        return value
    try:
        numbers = [float(v) for v in value]  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise InputError(f"{what}={value!r} is not a place; give (x, y), (x, y, z), or a text such as '46.5N,11.3E,+20'") from None
    return ",".join(repr(v) for v in numbers)
