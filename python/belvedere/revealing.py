"""``reveal``: a picture in which routes, areas, points or one target are visible."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Sequence

from . import _native
from ._ask import Progress, asked, number
from ._data import files_of
from ._drawing import drawing
from ._folder import Folder, Named
from ._json import place, text
from ._json import size as size_of
from .errors import InputError
from .picture import Picture
from .reports import Note, RevealReport, notes_of
from .scene import Scene
from .viewing import View

if TYPE_CHECKING:
    from ._native import NativeReveal


class Revealed:
    """A picture in which something is visible, and how it was found. In a notebook it shows the picture."""

    def __init__(self, native: NativeReveal, folder: Folder, drawn: Mapping[str, Any]) -> None:
        self._native = native
        self._folder = folder
        self._drawn = drawn

    @cached_property
    def picture(self) -> Picture:
        """The picture; its ``straight`` is the one without bends, unless nothing is bent."""
        scene = self._native.scene()
        return Picture(self._native.picture(), lambda changed: scene.render(text("render", {**self._drawn, **changed}), (0, None, None)))

    @cached_property
    def scene(self) -> Scene:
        """The scene in the view that was found."""
        return Scene._of_native(self._native.scene(), self._folder)

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

        * ``before``: the straight picture. ``report``: figures, JSON. ``scene``: a scene file of the same picture (its arrays go with
          ``revealed.scene.save``).
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
    technique: str | None = None,
    see: str | None = None,
    fallback: Sequence[str] = (),
    transfer: str | None = None,
    curved_earth: bool = False,
    no_limits: bool = False,
    labels: bool = False,
    hidden: str | None = None,
    palette: str | None = None,
    relief: str | None = None,
    light: Mapping[str, Any] | None = None,
    stylise: bool | tuple[float, float] = False,
    exaggeration: float | None = None,
    mark: bool = True,
    furniture: bool | str | Sequence[str] | None = None,
    title: str | None = None,
    sea: bool = True,
    rivers: object = None,
    drape: object = None,
    samples: int | None = None,
    threads: int | None = None,
    progress: Progress = None,
    time_limit_s: float | None = None,
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
    * ``technique``: ``spline`` (default), ``terrain``, ``both``, ``curved_rays``, or ``auto``, which tries them.
    * ``see``: a target in models or a city: id of a layer, atoms, a building, or x,y,z. ``fallback``, ``transfer``: see ``belvedere reveal --help``.
    * ``hidden``: ``show``, ``fade``, ``dash`` or ``cut``. ``palette``, ``relief``, ``light``, ``stylise``, ``exaggeration``: how it looks.
    * ``furniture``, ``title``: legend, compass and more, see :meth:`belvedere.Scene.render`.
    * ``rivers``: lines, given as ``routes`` are, that do not run uphill where the ground makes way (``technique`` ``terrain``, ``both`` or ``auto``).
    * ``drape``: a georeferenced picture that is laid over the ground, such as an aerial photograph, or several, later ones on top: paths.
    * ``threads``: number of threads; ``None``: one per core. The picture does not depend on it.
    * ``progress``: a callable of (name of the work, share done), ``True`` for a bar of tqdm, or a bar of tqdm. What it raises ends the work.
    * ``time_limit_s``: limit for solving, seconds; then the best so far is taken.

    Raises :class:`belvedere.InputError`, :class:`belvedere.FileError`, :class:`belvedere.MemoryLimitError`. Ctrl-C ends the work within a second.

    >>> import belvedere
    >>> view = {"eye": (7972, -7337, 3780), "look_at": (-952, 1587, 221)}
    >>> found = belvedere.reveal("builtin:massif", "builtin:massif", size=(160, 90), **view)
    >>> found.report.bent.visible > found.report.straight.visible
    True
    """
    folder = Folder()
    request = _request(
        dem, routes, folder, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata, features_crs=features_crs,
        fill_voids=fill_voids, size=size, technique=technique, curved_earth=curved_earth, no_limits=no_limits, labels=labels, hidden=hidden,
        palette=palette, relief=relief, light=light, stylise=stylise, exaggeration=exaggeration, mark=mark, furniture=furniture,
        title=title, sea=sea, rivers=rivers, drape=drape, samples=samples,
    )  # fmt: skip
    if see is not None and (request["files"]["rivers"] or request["files"]["drape"]):
        raise InputError("rivers and drape are of terrain with routes; leave them out with see")
    request.update(
        see=see,
        fallback=[fallback] if isinstance(fallback, str) else list(fallback),
        transfer=transfer,
        eye=place("eye", eye),
        look_at=place("look_at", look_at),
        fov_y_deg=None if fov_y_deg is None else number("fov_y_deg", fov_y_deg),
        open={} if see is None else {"size": request["size"]},
    )
    with asked(threads, progress, time_limit_s) as ask, Named(os.fspath(folder.path)):
        return Revealed(_native.reveal(text("reveal", request), ask), folder, request["draw"])


def _request(
    dem: object,
    routes: object,
    folder: Folder,
    *,
    transform: object = None,
    spacing: object = None,
    origin: Sequence[float] | None = None,
    crs: object = None,
    nodata: object = None,
    features_crs: object = None,
    fill_voids: bool | None = None,
    size: tuple[int, int] | None = None,
    technique: str | None = None,
    curved_earth: bool = False,
    no_limits: bool = False,
    labels: bool = False,
    hidden: str | None = None,
    palette: str | None = None,
    relief: str | None = None,
    light: Mapping[str, Any] | None = None,
    stylise: bool | tuple[float, float] = False,
    exaggeration: float | None = None,
    mark: bool = True,
    furniture: bool | str | Sequence[str] | None = None,
    title: str | None = None,
    sea: bool = True,
    rivers: object = None,
    drape: object = None,
    samples: int | None = None,
) -> dict[str, Any]:
    """The request as the engine takes it, but for the view and a target."""
    if routes is None and not isinstance(dem, (str, os.PathLike)):
        raise InputError("routes are missing: nothing says what must be seen; give routes, areas or points")
    if rivers is not None and technique not in ("terrain", "both", "auto"):
        raise InputError("rivers are kept from running uphill where the ground moves; give technique='terrain', 'both' or 'auto'")
    files = files_of(
        dem, routes, transform=transform, spacing=spacing, origin=origin, crs=crs, nodata=nodata, features_crs=features_crs,
        fill_voids=fill_voids, folder=folder, rivers=rivers, drape=drape,
    )  # fmt: skip
    files.update(labels=bool(labels), hidden=hidden, palette=palette, no_sea=not sea)
    drawn = drawing(stylise=stylise, mark=mark, furniture=furniture, title=title, samples=samples)
    look = {
        "light": None if light is None else dict(light),
        "relief": relief,
        "stylise": drawn.pop("stylise"),
        "no_mark": drawn.pop("no_mark"),
        "furniture": drawn.pop("furniture"),
        "title": drawn.pop("title"),
        "exaggeration": None if exaggeration is None else number("exaggeration", exaggeration),
    }
    return {
        "files": files,
        "look": look,
        "size": size_of(size),
        "curved_earth": bool(curved_earth),
        "technique": technique,
        "no_limits": bool(no_limits),
        "draw": drawn,
    }
