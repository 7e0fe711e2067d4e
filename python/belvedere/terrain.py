"""The terrain solver alone: ground on which features are visible from an eye."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._ask import Progress, asked, number
from ._data import sources_of
from ._drawing import given
from ._json import place, text
from .errors import InputError
from .reports import GroundReport, Note, notes_of
from .scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._native import NativeArrays, NativeGround
    from ._requests import DisoccludeOptions


class Ground:
    """Displaced heights, their displacement, and the report of the solver."""

    def __init__(self, native: NativeGround, arrays: NativeArrays) -> None:
        self._native = native
        self._arrays = arrays

    @cached_property
    def heights(self) -> NDArray[np.float64]:
        """Displaced heights on the written grid, metres, rows from north to south; NaN in holes."""
        return np.frombuffer(self._native.heights(), np.float64).reshape(self._native.shape)

    @cached_property
    def displacement(self) -> NDArray[np.float64]:
        """Displaced minus original heights, metres; NaN in holes."""
        return np.frombuffer(self._native.displacement(), np.float64).reshape(self._native.shape)

    @property
    def transform(self) -> tuple[float, float, float, float, float, float] | None:
        """Affine map from corners of pixels to coordinates: a, b, c, d, e, f of rasterio."""
        found = self._native.transform
        if found is None:
            return None
        a, b, c, d, e, f = found
        return a, b, c, d, e, f

    @property
    def crs(self) -> str:
        """Coordinate system of the written grid as the file states it."""
        return self._native.crs

    @cached_property
    def report(self) -> GroundReport:
        """Figures; ``raw`` holds the whole report."""
        return GroundReport.of(json.loads(self._native.report))

    @property
    def summary(self) -> str:
        """One sentence."""
        return self._native.summary()

    @property
    def missed(self) -> list[str]:
        """Goals that were missed, one sentence each."""
        return self._native.missed()

    @property
    def warnings(self) -> list[Note]:
        """Warnings."""
        return notes_of(json.loads(self._native.warnings()))

    @cached_property
    def scene(self) -> Scene:
        """Terrain and features in the view of the solver."""
        return Scene._of_native(self._native.scene(), self._arrays)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        report: str | os.PathLike[str] | None = None,
        displacement: str | os.PathLike[str] | None = None,
        features: str | os.PathLike[str] | None = None,
        picture: str | os.PathLike[str] | None = None,
        certificate: str | os.PathLike[str] | None = None,
        overwrite: bool = False,
    ) -> list[Path]:
        """Writes the displaced elevation model (GeoTIFF), and if named the report (JSON), the displacement (GeoTIFF), the features on the displaced
        ground (GeoJSON), the ground before and after (PNG), and the lines of sight by which what is shown can be checked (JSON); returns the paths."""
        others = (report, displacement, features, picture, certificate)
        r, d, f, p, c = (None if name is None else os.fspath(name) for name in others)
        return [Path(name) for name in self._native.save(os.fspath(path), r, d, f, p, c, overwrite)]

    def __repr__(self) -> str:
        return f"<belvedere.Ground: {self.summary}>"


def disocclude(
    dem: object,
    features: object,
    *,
    eye: object,
    look_at: object,
    fov_x_deg: float = 70.0,
    transform: object = None,
    spacing: object = None,
    origin: Sequence[float] | None = None,
    crs: object = None,
    nodata: object = None,
    features_crs: object = None,
    fill_voids: bool = False,
    mode: str | None = None,
    parameters: Mapping[str, Any] | None = None,
    limits: bool = True,
    grid: str = "input",
    rivers: object = None,
    scene_crs: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
    time_limit_s: float | None = None,
    **options: Unpack[DisoccludeOptions],
) -> Ground:
    """Moves ground up and down, as little and as smoothly as possible, until features are visible from an eye.

    * ``dem``, ``features`` and what says where they lie: as in :func:`belvedere.reveal`.
    * ``eye``: ``(x, y, z)``, x and y in the system of ``dem``, z in metres over its datum; ``look_at``: ``(x, y)`` likewise; or texts as there.
    * ``fov_x_deg``: full HORIZONTAL field of view, degrees, in (0, 180).
    * ``mode``: ``qp`` (default), ``paper`` or ``paper+qp``. ``parameters``: those of the stage ``terrain_disocclusion``, such as ``{"w": 0.6}``.
    * ``limits=False`` lifts the limits of depth and slope of the displaced ground.
    * ``grid``: ``input``, or ``scene``: the grid in metres that was solved on, on which guarantees hold at every node.
    * ``scene_crs``: coordinate system to solve in: ``auto``, ``EPSG:n`` or ``local``.
    * ``rivers``: lines that do not run uphill on the displaced ground, given as features are.
    * ``threads``, ``progress``, ``time_limit_s``: see :func:`belvedere.reveal`.
    * All other options of ``belvedere disocclude`` by their names: :class:`belvedere.DisoccludeOptions` lists them.
    """
    if grid not in ("input", "scene"):
        raise InputError(f"grid={grid!r} is no grid; give 'input' or 'scene'")
    arrays = _native.NativeArrays()
    files = sources_of(
        dem, features, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata, features_crs=features_crs,
        fill_voids=bool(fill_voids), arrays=arrays, rivers=rivers,
    )  # fmt: skip
    del files["keep_voids"]
    request = given(
        {
            **files,
            **({} if scene_crs is None else {"crs": scene_crs}),
            "eye": place("eye", eye),
            "look": place("look_at", look_at),
            "fov": number("fov_x_deg", fov_x_deg),
            "mode": mode,
            "no_limits": not limits,
            "set": [f"{key}={json.dumps(value)}" for key, value in (parameters or {}).items()],
            "grid": grid,
            **options,
        }
    )
    with asked(threads, progress, time_limit_s) as ask:
        return Ground(_native.disocclude(text("disocclude", request), arrays, ask), arrays)
