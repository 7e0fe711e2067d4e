"""How a picture is drawn, as the engine takes it."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

from ._ask import number
from .errors import InputError


#: Buffers that every picture has in memory.
BUFFERS = ["depth", "id", "world"]
#: Options of pictures that change what a scene is opened as.
OF_SCENE = ("palette", "sky", "haze", "clouds", "contours", "edge", "plain", "landcover", "area_style", "no_sea", "representation", "color_by", "assembly", "model", "straighten", "radius", "side", "uncut",
            "panorama", "heading", "span", "pitch", "sphere")


def drawing(
    *,
    straight: bool = False,
    compare: bool = False,
    renderer: str = "auto",
    samples: int | None = None,
    lod_px: float | None = None,
    compositing: str | None = None,
    stylise: bool | tuple[float, float] = False,
    furniture: bool | str | Sequence[str] | None = None,
    title: str | None = None,
) -> dict[str, Any]:
    """How a picture or a frame is drawn, as the engine takes it."""
    asked = {
        "straight": bool(straight),
        "compare": bool(compare),
        "renderer": str(renderer),
        "samples": samples,
        "lod": None if lod_px is None else number("lod_px", lod_px),
        "compositing": compositing,
        "stylise": strengths_of(stylise),
        "furniture": furniture_of(furniture),
        "title": None if title is None else str(title),
    }
    return given(asked)


def given(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options without those that are left out."""
    return {name: value for name, value in options.items() if value is not None}


def picture(
    drawn: dict[str, Any],
    *,
    grid: bool | float = False,
    heatmap: bool = False,
    ghost: bool = False,
    highlight: Sequence[str] = (),
    mark: bool = True,
    overhead: bool = False,
    outside: bool | Sequence[Sequence[float]] = False,
    buffers: bool = False,
    **options: Any,
) -> dict[str, Any]:
    """How a picture is drawn, with what only pictures have."""
    spacing = grid if isinstance(grid, bool) else number("grid", grid)
    if not isinstance(spacing, bool) and spacing <= 0:
        raise InputError(f"grid={grid} is not a spacing; give scene units above 0, or True")
    asked = {
        **drawn,
        "grid": spacing or None,
        "heatmap": bool(heatmap),
        "ghost": bool(ghost),
        "highlight": [highlight] if isinstance(highlight, str) else list(highlight),
        "no_mark": not mark,
        "overhead": bool(overhead),
        "outside": outside if isinstance(outside, bool) else list(outside),
        "aux": BUFFERS if buffers else [],
    }
    return {**asked, **given(options)}


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
