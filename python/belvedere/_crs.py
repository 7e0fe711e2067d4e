"""Coordinate systems by EPSG code."""

from __future__ import annotations

import numbers
from dataclasses import dataclass
from typing import Any

from .errors import InputError


@dataclass(frozen=True)
class Crs:
    """A coordinate system: an EPSG code, or a local one."""

    code: int | None

    def __str__(self) -> str:
        return "local" if self.code is None else f"EPSG:{self.code}"


def crs_of(value: Any) -> Crs:
    """A system of a code, ``"EPSG:n"``, ``"local"``, ``None`` (local), or an object of pyproj or rasterio."""
    if value is None or isinstance(value, Crs):
        return value or Crs(None)
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return Crs(int(value))
    if isinstance(value, str):
        text = value.strip().lower()
        if text == "local":
            return Crs(None)
        digits = text.rpartition(":")[2]
        if text.startswith(("epsg:", "urn:ogc:def:crs:epsg:")) and digits.isdigit():
            return Crs(int(digits))
    elif hasattr(value, "to_epsg"):
        code = value.to_epsg()
        if code:
            return Crs(int(code))
        raise InputError(f"the coordinate system {str(value)[:80]!r} has no EPSG code; give crs='EPSG:n', or reproject the data")
    raise InputError(f"crs={value!r} is not known; give 'EPSG:n', its number, or 'local'")
