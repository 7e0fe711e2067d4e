"""How a picture is drawn, as the engine takes it."""

from __future__ import annotations

from typing import Any, Sequence

from ._ask import number
from .errors import InputError


def drawing(
    *,
    straight: bool = False,
    compare: bool = False,
    renderer: str = "auto",
    samples: int | None = None,
    lod_px: float | None = None,
    compositing: str = "single",
    stylise: bool | tuple[float, float] = False,
    grid: bool | float = False,
    heatmap: bool = False,
    ghost: bool = False,
    highlight: Sequence[str] = (),
    mark: bool = True,
    furniture: bool | str | Sequence[str] | None = None,
    title: str | None = None,
    overhead: bool = False,
    outside: bool | Sequence[Sequence[float]] = False,
    buffers: bool = False,
) -> dict[str, Any]:
    """How a picture is drawn, as the engine takes it."""
    spacing = None if grid is False else 0.0 if grid is True else number("grid", grid)
    if spacing is not None and spacing < 0:
        raise InputError(f"grid={grid} is not a spacing; give scene units above 0, or True")
    return {
        "straight": bool(straight),
        "compare": bool(compare),
        "renderer": renderer,
        "samples": samples,
        "lod_px": None if lod_px is None else number("lod_px", lod_px),
        "compositing": compositing,
        "stylise": strengths_of(stylise),
        "grid": spacing,
        "heatmap": bool(heatmap),
        "ghost": bool(ghost),
        "highlight": [highlight] if isinstance(highlight, str) else list(highlight),
        "no_mark": not mark,
        "furniture": furniture_of(furniture),
        "title": None if title is None else str(title),
        "overhead": bool(overhead),
        "from_outside": outside is not False,
        "outside": None if isinstance(outside, bool) else outside,
        "buffers": bool(buffers),
    }


def furniture_of(wanted: bool | str | Sequence[str] | None) -> list[str] | None:
    """Names of furniture; ``None``: as the scene says."""
    if wanted is None:
        return None
    if isinstance(wanted, bool):
        return ["all" if wanted else "none"]
    return wanted.split(",") if isinstance(wanted, str) else [str(name) for name in wanted]


def strengths_of(stylise: bool | tuple[float, float]) -> dict[str, Any] | None:
    """Strengths of edges and of depth unsharp masking; ``None``: as the scene says."""
    if stylise is False:
        return None
    if stylise is True:
        return {"edges": True, "unsharp": True}
    edges, unsharp = stylise
    return {"edges": number("stylise", edges), "unsharp": number("stylise", unsharp)}
