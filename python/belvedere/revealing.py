"""``reveal``: a picture in which routes, areas, points or one target are visible."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Sequence

from . import _native
from ._ask import Progress, asked, number
from ._data import sources_of
from ._drawing import furniture_of, given, strengths_of
from ._json import place, text
from ._json import size as size_of
from .errors import InputError
from .picture import Picture
from .reports import Note, RevealReport, notes_of
from .scene import Scene
from .viewing import View

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._native import NativeArrays, NativeReveal
    from ._requests import RevealOptions


class Revealed:
    """A picture in which something is visible, and how it was found. In a notebook it shows the picture."""

    def __init__(self, native: NativeReveal, arrays: NativeArrays, samples: int | None) -> None:
        self._native = native
        self._arrays = arrays
        self._drawn = given({"samples": samples, **(json.loads(native.paper()) or {})})

    @cached_property
    def picture(self) -> Picture:
        """The picture; its ``straight`` is the one without bends, unless nothing is bent."""
        scene = self._native.scene()
        return Picture(
            self._native.picture(), lambda changed, vectors: scene.render(text("render", {**self._drawn, **changed}), vectors, (0, None, None))
        )

    @cached_property
    def scene(self) -> Scene:
        """The scene in the view that was found."""
        return Scene._of_native(self._native.scene(), self._arrays)

    @cached_property
    def report(self) -> RevealReport:
        """Shares of the features in both pictures; ``raw`` holds the whole report."""
        return RevealReport.of(json.loads(self._native.report))

    @property
    def summary(self) -> str:
        """One sentence: what is visible in both pictures."""
        return self._native.summary()

    @property
    def missed(self) -> list[str]:
        """Goals that were missed, one sentence each."""
        return self._native.missed()

    @property
    def warnings(self) -> list[Note]:
        """Warnings of loading, searching and drawing."""
        return notes_of(self.report.raw["warnings"])

    def view(self, **options: Any) -> View:
        """The scene in the view that was found, as a page that can be moved in; options as of :func:`belvedere.view`."""
        return self.scene.view(**options)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        before: str | os.PathLike[str] | None = None,
        report: str | os.PathLike[str] | None = None,
        scene: str | os.PathLike[str] | None = None,
        overwrite: bool = False,
    ) -> list[Path]:
        """Writes the picture (PNG) with its record and, if it is bent, the pair beside it (``NAME.pair.png``); returns the paths.

        * ``before``: the straight picture. ``report``: figures, JSON. ``scene``: a scene file of the same picture, with its arrays as files beside
          it.
        """
        b, r, s = (None if name is None else os.fspath(name) for name in (before, report, scene))
        return [Path(name) for name in self._native.save(os.fspath(path), b, r, s, overwrite)]

    def __repr__(self) -> str:
        return f"<belvedere.Revealed: {self.summary}>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        return {"image/png": self.picture.png(), "text/plain": repr(self)}


def reveal(
    dem: object,
    routes: object = None,
    *,
    transform: object = None,
    spacing: object = None,
    origin: Sequence[float] | None = None,
    crs: object = None,
    nodata: object = None,
    features_crs: object = None,
    fill_voids: bool | None = None,
    eye: object = None,
    look_at: object = None,
    fov_y_deg: float | None = None,
    size: tuple[int, int] | None = None,
    scene_crs: str | None = None,
    see: str | None = None,
    fallback: Sequence[str] = (),
    light: Mapping[str, Any] | tuple[float, float] | None = None,
    stylise: bool | tuple[float, float] = False,
    mark: bool = True,
    furniture: bool | str | Sequence[str] | None = None,
    sea: bool = True,
    rivers: object = None,
    drape: object = None,
    fonts: Sequence[str | os.PathLike[str]] = (),
    seed: int | None = None,
    threads: int | None = None,
    progress: Progress = None,
    time_limit_s: float | None = None,
    **options: Unpack[RevealOptions],
) -> Revealed:
    """Draws terrain so that routes can be seen: chooses a view, unless one is given, and bends it as little as is needed.

    * ``dem``: heights as in :meth:`belvedere.Scene.add_terrain`, or a path (a file, a folder of tiles, ``builtin:massif``); or a path of a mesh,
      molecule, volume, city or scene file, with ``see``.
    * ``routes``: what must be seen: a path or several, arrays of x, y, GeoJSON, shapely, a GeoDataFrame. ``features_crs``: their system, unless
      they are files; by default what they state, else that of ``dem``.
    * ``transform``, ``spacing``, ``origin``, ``crs``, ``nodata``: as in :meth:`belvedere.Scene.add_terrain`.
    * ``fill_voids``: ``True`` fills all holes, ``False`` none; ``None``: those of files up to 3 % of the ground, as the command line does, none of arrays.
    * ``eye``, ``look_at``: ``(x, y[, z])`` in scene coordinates or degrees, or texts such as ``"46.5N,11.3E,+20"`` (20 m above the ground).
    * ``fov_y_deg``: full vertical field of view, degrees; 45 by default. ``size``: pixels; 1280 x 720 by default.
    * ``scene_crs``: coordinate system of the scene: ``auto``, ``EPSG:n`` or ``local``.
    * ``see``: a target in models or a city: id of a layer, atoms, a building, or x,y,z. ``fallback``: see ``belvedere reveal --help``.
    * ``light``: azimuth and altitude in degrees, or the keys of ``[light]`` in scene files. ``stylise``: ``True``, or strengths of edges and of
      depth unsharp masking.
    * ``furniture``: legend, compass and more, see :meth:`belvedere.Scene.render`.
    * ``rivers``: lines, given as ``routes`` are, that do not run uphill where the ground makes way (``technique`` ``terrain``, ``both`` or ``auto``).
    * ``drape``: a georeferenced picture that is laid over the ground, such as an aerial photograph, or several, later ones on top: paths.
    * ``fonts``: files of fonts for letters that the program's own lacks. ``seed``: of generated data.
    * ``threads``: number of threads; ``None``: one per core. The picture does not depend on it.
    * ``progress``: a callable of (name of the work, share done), ``True`` for a bar of tqdm, or a bar of tqdm. What it raises ends the work.
    * ``time_limit_s``: limit for solving, seconds; then the best so far is taken.
    * All other options of the command line by their names (``light_time``, ``palette``, ``technique``, ``paper`` ...):
      :class:`belvedere.RevealOptions` lists them, ``belvedere reveal --help`` says what they do.

    Raises :class:`belvedere.InputError`, :class:`belvedere.FileError`, :class:`belvedere.MemoryLimitError`. Ctrl-C ends the work within a second.

    >>> import belvedere
    >>> view = {"eye": (7972, -7337, 3780), "look_at": (-952, 1587, 221)}
    >>> found = belvedere.reveal("builtin:massif", "builtin:massif", size=(160, 90), **view)
    >>> found.report.bent.visible > found.report.straight.visible
    True
    """
    arrays = _native.NativeArrays()
    request = _request(
        dem, routes, arrays, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata, features_crs=features_crs,
        fill_voids=fill_voids, size=size, light=light, stylise=stylise, mark=mark, furniture=furniture, sea=sea, rivers=rivers, drape=drape,
        scene_crs=scene_crs, **options,
    )  # fmt: skip
    request.update(
        see=see,
        fallback=[fallback] if isinstance(fallback, str) else list(fallback),
        eye=place("eye", eye),
        look=place("look_at", look_at),
        fov=None if fov_y_deg is None else number("fov_y_deg", fov_y_deg),
    )
    with asked(threads, progress, time_limit_s) as ask:
        native = _native.reveal(text("reveal", request), opening(fonts, seed), arrays, ask)
        return Revealed(native, arrays, request.get("samples"))


def opening(fonts: Sequence[str | os.PathLike[str]] = (), seed: int | None = None) -> str:
    """How scenes are opened, as the engine takes it."""
    return text("options", {"fonts": [os.fspath(font) for font in fonts], "seed": seed})


def _request(
    dem: object,
    routes: object,
    arrays: NativeArrays,
    *,
    transform: object = None,
    spacing: object = None,
    origin: Sequence[float] | None = None,
    crs: object = None,
    nodata: object = None,
    features_crs: object = None,
    fill_voids: bool | None = None,
    size: tuple[int, int] | None = None,
    light: Mapping[str, Any] | tuple[float, float] | None = None,
    stylise: bool | tuple[float, float] = False,
    mark: bool = True,
    furniture: bool | str | Sequence[str] | None = None,
    sea: bool = True,
    rivers: object = None,
    drape: object = None,
    scene_crs: str | None = None,
    **options: Any,
) -> dict[str, Any]:
    """The request as the engine takes it, but for the view and a target."""
    if routes is None and not isinstance(dem, (str, os.PathLike)):
        raise InputError("routes are missing: nothing says what must be seen; give routes, areas or points")
    files = sources_of(
        dem, routes, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata, features_crs=features_crs,
        fill_voids=fill_voids, arrays=arrays, rivers=rivers, drape=drape,
    )  # fmt: skip
    return {
        **files,
        **({} if scene_crs is None else {"crs": scene_crs}),
        **options,
        **_light_of(light),
        "stylise": strengths_of(stylise),
        "no_mark": not mark,
        "furniture": furniture_of(furniture),
        "no_sea": not sea,
        "size": size_of(size),
    }


def _light_of(light: Mapping[str, Any] | tuple[float, float] | None) -> dict[str, Any]:
    """A light, as options have it: a direction, or the keys of ``[light]``."""
    if light is None:
        return {}
    if not isinstance(light, Mapping):
        return {"light": light}
    keys = dict(light)
    options = {"light_time" if key == "time" else key: keys.pop(key) for key in ("time", "shadows", "sky", "haze", "clouds") if key in keys}
    if "azimuth_deg" in keys or "altitude_deg" in keys:
        options["light"] = [keys.pop("azimuth_deg", 315.0), keys.pop("altitude_deg", 45.0)]
    if keys:
        raise InputError(f"light: unknown keys {', '.join(keys)}; give azimuth_deg, altitude_deg, time, shadows, sky, haze or clouds")
    return options
