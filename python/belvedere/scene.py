"""Scenes: from files, documents and arrays; drawn, measured, asked for numbers."""

from __future__ import annotations

import copy
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Mapping, Sequence, cast

import numpy as np
from numpy.typing import NDArray

from . import _native, viewing
from ._ask import Ask, Progress, asked, number
from ._crs import Crs, crs_of
from ._drawing import OF_SCENE, drawing, given, picture
from ._layers import Layers
from ._masks import joined, masked_count
from ._json import size as _size
from ._json import text as _text
from .camera import Camera, camera_document
from .errors import FileError, InputError
from .picture import Picture
from .reports import MeasureReport, Note, Picked, notes_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._native import NativeArrays, NativePicture, NativeScene
    from ._requests import RenderOptions

__all__ = ["Scene", "Projected", "Displaced", "Rays", "MISSES"]

#: What the codes of ``miss`` mean.
MISSES = ("", "behind_eye", "outside_domain")


@dataclass(frozen=True)
class Projected:
    """Images of points, one entry for each, in their order."""

    #: Pixels ``(n, 2)``, origin at the outer corner of the top-left pixel; NaN for a miss.
    pixel: NDArray[np.float64]
    #: Forward distance of the displaced point, scene units.
    depth: NDArray[np.float64]
    #: Segment of the curved ray; -1 for a miss.
    segment: NDArray[np.int32]
    #: Whether the pixel lies in the picture.
    inside: NDArray[np.bool_]
    #: 0 = none, else an index of ``belvedere.MISSES``: 1 behind the eye, 2 outside the domain.
    miss: NDArray[np.uint8]


@dataclass(frozen=True)
class Displaced:
    """Displaced points, one entry for each, in their order."""

    #: Points ``(n, 3)`` after all stages, before the pinhole; NaN for a miss.
    point: NDArray[np.float64]
    #: Whether a stage folds space there.
    folded: NDArray[np.bool_]
    #: As that of :class:`Projected`.
    miss: NDArray[np.uint8]


@dataclass(frozen=True)
class Rays:
    """Samples along the rays of pixels."""

    #: World points ``(pixels, samples, 3)``; NaN where a ray leaves the domain of the stages.
    point: NDArray[np.float64]
    #: Depths ``(pixels, samples)`` at which the pixel sees them, scene units.
    depth: NDArray[np.float64]
    #: Segments ``(pixels, samples)``; -1 where there is no point.
    segment: NDArray[np.int32]


class Scene(Layers):
    """A scene: layers, a camera, and stages that bend what it sees. It is the document of a scene file, key by key.

    * ``camera``: see :class:`belvedere.Camera`; without one the scene is looked at from above its southern side, see :meth:`overview`.
    * ``crs``: ``"auto"`` (that of the terrain), ``"EPSG:n"`` or ``"local"``: the system of all coordinates that are given and returned.
    * ``unit``: ``"metre"``, ``"angstrom"`` or ``"voxel"``; by default what the first layer needs.
    * ``document``: further keys of a scene file, such as ``light={"azimuth_deg": 315, "altitude_deg": 30}`` or ``earth="curved"``.

    >>> import numpy as np, belvedere
    >>> y, x = np.mgrid[0:60, 0:80]
    >>> scene = belvedere.Scene(title="Hills").add_terrain(40 * np.sin(x / 9) * np.cos(y / 7), spacing=30.0)
    >>> scene.render(size=(64, 48)).rgba.shape
    (48, 64, 4)
    """

    def __init__(
        self,
        *,
        camera: Camera | Mapping[str, Any] | None = None,
        crs: object = "auto",
        title: str = "",
        unit: str | None = None,
        **document: Any,
    ) -> None:
        self._document: dict[str, Any] = {"format": 1, "title": str(title), **document}
        self._document["crs"] = "auto" if crs == "auto" else str(crs_of(crs))
        if unit is not None:
            self._document["unit"] = unit
        if camera is not None:
            self._document["camera"] = camera_document(camera)
        self._file: Path | None = None
        self._base: Path | None = None
        self._arrays: NativeArrays = _native.NativeArrays()
        self._roots: list[str] = []
        self._seed: int | None = None
        #: What is said of data that are opened without a scene file.
        self._said: dict[str, Any] = {}
        self._array_crs: Crs | None = None
        self._natives: dict[tuple[int, int] | None, NativeScene] = {}

    # Where scenes come from.

    @classmethod
    def open(
        cls,
        path: str | os.PathLike[str],
        *,
        allow_roots: Sequence[str | os.PathLike[str]] = (),
        seed: int | None = None,
        crs: str | None = None,
        curved_earth: bool = False,
        source_crs: object = None,
        nodata: float | None = None,
        vertical_unit: str | None = None,
        threads: int | None = None,
        progress: Progress = None,
        time_limit_s: float | None = None,
    ) -> Scene:
        """Opens a scene file, TOML or JSON; or data, seen from the south: ground fills the picture, others are shown whole.

        Data are an elevation model, a folder of its tiles, a city, a mesh, a molecule or a volume.

        * ``allow_roots``: folders beside its own from which the scene may read files.
        * ``seed``: seed of generated data instead of the scene's.
        * ``crs``, ``curved_earth``: of the picture of data alone. ``source_crs``, ``nodata``, ``vertical_unit`` (``m``, ``ft``, ``us-ft``): what
          their file does not say. Scene files say these themselves.
        * ``threads``, ``progress``, ``time_limit_s``: see :func:`belvedere.reveal`.

        Raises :class:`belvedere.InputError` with the line of a mistake, :class:`belvedere.FileError`.
        """
        scene = cls()
        scene._file = Path(os.fspath(path))
        scene._roots, scene._seed = [os.fspath(root) for root in allow_roots], seed
        scene._said = {
            "crs": crs,
            "curved_earth": bool(curved_earth),
            "source_crs": None if source_crs is None else str(crs_of(source_crs)),
            "nodata": nodata,
            "vertical_unit": vertical_unit,
        }
        with asked(threads, progress, time_limit_s) as ask:
            scene._opened(ask)
        return scene

    @classmethod
    def from_document(
        cls,
        document: Mapping[str, Any],
        *,
        folder: str | os.PathLike[str] = ".",
        allow_roots: Sequence[str | os.PathLike[str]] = (),
    ) -> Scene:
        """A scene of a document: the keys of a scene file as a dictionary. Its files are relative to ``folder``."""
        scene = cls()
        scene._document = copy.deepcopy(dict(document))
        scene._base = Path(os.path.abspath(os.fspath(folder)))
        scene._roots = [os.fspath(root) for root in allow_roots]
        return scene

    @classmethod
    def builtin(cls, name: str = "massif") -> Scene:
        """A built-in scene: generated, without files. ``Scene.builtin_names()`` lists them."""
        scene = cls()
        scene._document = json.loads(_native.builtin_scene(str(name)))
        return scene

    @staticmethod
    def builtin_names() -> list[str]:
        """Names of the built-in scenes."""
        return _native.builtin_names()

    @classmethod
    def _of_native(cls, native: NativeScene, arrays: NativeArrays) -> Scene:
        scene = cls()
        scene._document = json.loads(native.resolved(None) or "{}")
        scene._base = Path(os.path.abspath("."))
        # Those that were read may be read again.
        scene._arrays, scene._roots = arrays, sorted({os.path.dirname(os.path.realpath(p)) for p in native.input_paths})
        scene._natives = {None: native}
        return scene

    # Camera and document.

    @property
    def camera(self) -> dict[str, Any] | None:
        """The camera as in a scene file; ``None`` if none was given. It can be set."""
        camera = self.document.get("camera")
        return None if camera is None else dict(camera)

    @camera.setter
    def camera(self, camera: Camera | Mapping[str, Any] | None) -> None:
        document = self._changed()
        document.pop("camera", None)
        if camera is not None:
            document["camera"] = camera_document(camera)

    def overview(self, *, azimuth_deg: float = 200.0, altitude_deg: float = 30.0, fov_y_deg: float = 45.0) -> Scene:
        """Places the camera so that the whole scene is in the picture.

        * ``azimuth_deg``: compass direction in which the eye stands from the middle, degrees; 200 is south-south-west.
        * ``altitude_deg``: its height over the horizon, degrees, in (-90, 90).
        """
        azimuth, altitude, fov = (np.radians(number(n, v)) for n, v in (
            ("azimuth_deg", azimuth_deg), ("altitude_deg", altitude_deg), ("fov_y_deg", fov_y_deg)))  # fmt: skip
        if not (abs(altitude) < 0.5 * np.pi and 0 < fov < np.pi):
            raise InputError(f"altitude_deg={altitude_deg}, fov_y_deg={fov_y_deg}: give less than 90 degrees over the horizon, and more than 0 and less than 180 degrees of view")
        anywhere = {"eye": [0.0, 0.0, 0.0], "look_at": [0.0, 1.0, 0.0]}
        with asked() as ask:
            native = self._native_of(*self._text_of({**self._document, "camera": anywhere, "stage": []}), {"unsolved": True}, ask)
        bounds = native.bounds
        if bounds is None:
            raise InputError("the scene has no layer, so that there is nothing to look at; add a layer, or give camera=")
        low, high = np.array(bounds)
        middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
        toward = np.array([np.sin(azimuth) * np.cos(altitude), np.cos(azimuth) * np.cos(altitude), np.sin(altitude)])
        eye = middle + toward * max(0.9 * radius / np.sin(0.5 * fov), 1e-3)
        near = 1.0 if radius > 100.0 else max(0.01 * radius, 1e-4)
        self.camera = {"eye": eye.tolist(), "look_at": middle.tolist(), "fov_y_deg": float(fov_y_deg), "near": near}
        return self

    @property
    def document(self) -> dict[str, Any]:
        """The document of the scene as a dictionary; a copy. Of a scene file: with every default filled in."""
        return self.resolved() if self._file is not None else copy.deepcopy(self._document)

    def resolved(self) -> dict[str, Any]:
        """The document with every default filled in, and every position, name and rule replaced by its value."""
        with asked() as ask:
            document: dict[str, Any] = json.loads(self._opened(ask).resolved(None) or "{}")
        return document

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the scene as a scene file (``.json``), with its arrays as files in its folder, for the command line and for others. Files that were
        given by their paths, and those of an opened scene, stay where they are and are named from the new file's folder; where they lie outside
        it, the scene is opened with ``--allow-root`` or ``allow_roots``."""
        out = Path(os.fspath(path))
        if out.suffix.lower() != ".json":
            raise InputError(f"{out}: scenes are written as JSON; name the file .json")
        if self._file is None and "camera" not in self._document:
            self.overview()
        document = self._document_for(out)
        taken = [p for p in (out, *(out.parent / name for _, name in self._arrays.files())) if p.exists()]
        if taken and not overwrite:
            raise FileError(f"{taken[0]} exists; give overwrite=True, or another name")
        self._arrays.write(os.fspath(out.parent), overwrite)
        try:
            out.write_text(_text("the scene", document), encoding="utf-8")
        except OSError as error:
            raise FileError(f"{out}: {error.strerror or error}") from error
        return out

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Smallest and largest coordinates of all layers, ``(2, 3)``, scene coordinates; ``None`` for a scene without layers."""
        with asked() as ask:
            bounds = self._opened(ask).bounds
        return None if bounds is None else np.array(bounds)

    @property
    def layers(self) -> list[str]:
        """Ids of the layers; ``Picture.id`` holds 1 + an index of this list."""
        with asked() as ask:
            return self._opened(ask).layers

    @property
    def crs(self) -> str:
        """``"EPSG:n"`` or ``"local"``: the system of all coordinates."""
        with asked() as ask:
            return self._opened(ask).crs

    @property
    def warnings(self) -> list[Note]:
        """Warnings of loading the scene and resolving its view."""
        with asked() as ask:
            return notes_of(json.loads(self._opened(ask).warnings()))

    # Pictures and numbers.

    def render(
        self,
        size: tuple[int, int] | None = None,
        *,
        straight: bool = False,
        compare: bool = False,
        renderer: str = "auto",
        samples: int | None = None,
        lod_px: float | None = None,
        compositing: str | None = None,
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
        paper: str | None = None,
        dpi: float | None = None,
        margin_mm: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
        time_limit_s: float | None = None,
        **shown: Unpack[RenderOptions],
    ) -> Picture:
        """Draws the scene. The same scene gives the same bytes as ``belvedere render``, on any number of threads.

        * ``size``: width and height, pixels; by default that of the scene.
        * ``straight``: without bends. ``compare``: both, see ``Picture.straight``.
        * ``renderer``: ``auto``, ``cpu``, or ``exact``, the slow tracer without subdivision error.
        * ``samples``: coverage samples per pixel, 1, 4 or 16. ``lod_px``: error of far terrain, pixels; 0 draws every cell.
        * ``stylise``: dark edges and depth unsharp masking: ``True``, or strengths in 0..=1 and 0..=10.
        * ``grid``: a grid on the ground, ``True`` or its spacing, scene units. ``heatmap``, ``ghost``, ``highlight``: what the bend did.
        * ``mark``: the mark in the corner of bent pictures; the record says so in any case.
        * ``furniture``: any of ``title``, ``legend``, ``attribution``, ``source``, ``date``, ``compass``, ``scale``, ``distances``; ``True``: all,
          ``False``: none, ``None``: as the scene says. ``title``: its text, which is then drawn.
        * ``overhead``, ``outside``: draws the camera itself, from above, or from outside: ``True`` or (eye, target).
        * ``paper``: ``A0`` to ``A6`` (landscape where the scene's picture is wider than high), ``A3-portrait``, or a size such as ``420x297mm``;
          pixels, widths of lines and heights of letters follow from it. ``dpi``: pixels per inch, 300 on a paper without ``size``.
          ``margin_mm``: white margin of the paper. By default those of the scene, unless ``size`` is given.
        * ``buffers``: draws depth and world at once, see ``Picture.depth``.
        * ``threads``, ``progress``, ``time_limit_s``: see :func:`belvedere.reveal`.
        * All other options of ``belvedere render`` by their names (``palette``, ``sky``, ``edge`` ...): :class:`belvedere.RenderOptions` lists them.
          Those that show the scene otherwise than it says open it anew.
        """
        options = picture(
            drawing(
                straight=straight, compare=compare, renderer=renderer, samples=samples, lod_px=lod_px, compositing=compositing,
                stylise=stylise, furniture=furniture, title=title,
            ),
            grid=grid, heatmap=heatmap, ghost=ghost, highlight=highlight, mark=mark, overhead=overhead, outside=outside, buffers=buffers,
            **shown,
        )  # fmt: skip
        with asked(threads, progress, time_limit_s) as ask:
            sheet, pixels = self._sheet(_size(size), {"paper": paper, "dpi": dpi, "margin_mm": margin_mm})
            options.update(sheet)
            of_scene = {name: options[name] for name in OF_SCENE if name in options}
            native = self._open({"size": pixels, "shows": of_scene}, ask) if of_scene else self._sized(pixels, ask)
            drawn = native.render(_text("render", options), None, ask)
        silent: Ask = (ask[0], ask[1], None)
        again: Callable[[Mapping[str, Any], str | None], NativePicture]
        again = lambda changed, vectors: native.render(_text("render", {**options, **changed}), vectors, silent)
        return Picture(drawn, again, exact=buffers)

    def measure(
        self,
        *,
        spacing_m: float | None = None,
        size: tuple[int, int] | None = None,
        renderer: str = "auto",
        picture: bool = False,
        threads: int | None = None,
        progress: Progress = None,
        time_limit_s: float | None = None,
    ) -> MeasureReport:
        """Visible share of the required features (``must_see``), straight and bent, by two independent methods.

        * ``spacing_m``: largest distance between samples of a line, scene units; by default an eighth of the cell of the terrain.
        * ``picture``: draws the picture, too, and scores the look of its terrain: ``raw["look"]``.
        """
        with asked(threads, progress, time_limit_s) as ask:
            request = given({"spacing": None if spacing_m is None else number("spacing_m", spacing_m), "renderer": str(renderer), "picture": bool(picture)})
            return MeasureReport.of(json.loads(self._sized(_size(size), ask).measure(_text("measure", request), ask)))

    def project(self, points: object, *, size: tuple[int, int] | None = None, straight: bool = False, threads: int | None = None,
                progress: Progress = None) -> Projected:  # fmt: skip
        """Pixels and depths of points ``(n, 3)``, scene coordinates. A point outside the picture has its pixel too.
        ``size``: that of the picture, as of :meth:`render`. ``straight``: without bends."""
        data, count = _bytes("points", points, 3)
        with asked(threads, progress) as ask:
            pixel, depth, segment, inside, miss = _native.project(self._sized(_size(size), ask), data, bool(straight), ask)
        return Projected(
            np.frombuffer(pixel, np.float64).reshape(count, 2),
            np.frombuffer(depth, np.float64),
            np.frombuffer(segment, np.int32),
            np.frombuffer(inside, np.bool_),
            np.frombuffer(miss, np.uint8),
        )

    def displace(self, points: object, *, threads: int | None = None, progress: Progress = None) -> Displaced:
        """Points ``(n, 3)`` after all stages, before the pinhole, scene coordinates."""
        data, count = _bytes("points", points, 3)
        with asked(threads, progress) as ask:
            moved, folded, miss = _native.displace(self._opened(ask), data, ask)
        return Displaced(
            np.frombuffer(moved, np.float64).reshape(count, 3), np.frombuffer(folded, np.bool_), np.frombuffer(miss, np.uint8)
        )

    def rays(self, pixels: object, samples: int, *, far: float | None = None, size: tuple[int, int] | None = None, threads: int | None = None) -> Rays:
        """``samples`` world points of the ray of each pixel ``(n, 2)``, equidistant in depth from the camera's near depth to ``far``, scene units."""
        data, count = _bytes("pixels", pixels, 2)
        if isinstance(samples, bool) or not isinstance(samples, (int, np.integer)) or samples < 1:
            raise InputError(f"samples={samples!r} is not a number of samples; give a whole number above 0")
        with asked(threads) as ask:
            point, depth, segment = _native.rays(self._sized(_size(size), ask), data, int(samples), far, ask)
        shape = (count, int(samples))
        return Rays(
            np.frombuffer(point, np.float64).reshape(*shape, 3),
            np.frombuffer(depth, np.float64).reshape(shape),
            np.frombuffer(segment, np.int32).reshape(shape),
        )

    def pick(self, pixels: object, *, size: tuple[int, int] | None = None, threads: int | None = None, progress: Progress = None) -> list[Picked | None]:
        """What is seen at pixels ``(n, 2)``, origin at the outer corner of the top-left pixel; ``None`` where only sky is seen."""
        data, _ = _bytes("pixels", pixels, 2)
        with asked(threads, progress) as ask:
            found = json.loads(_native.pick(self._sized(_size(size), ask), data, ask))
        return [None if one is None else Picked.of(one) for one in found]

    def ground_m(self, xy: object) -> NDArray[np.float64]:
        """Heights of the undeformed ground under points ``(n, 2)``, metres; NaN where there is none."""
        data, _ = _bytes("xy", xy, 2)
        with asked() as ask:
            return np.frombuffer(_native.ground(self._opened(ask), data), np.float64)

    # In a browser; see :mod:`belvedere.viewing`.
    view = viewing.view
    pack = viewing.pack

    def __repr__(self) -> str:
        name = str(self._file) if self._file is not None else self._document.get("title") or "untitled"
        return f"<belvedere.Scene {name!r}>"

    # Inside.

    def _changed(self) -> dict[str, Any]:
        """The document, to be changed."""
        if self._file is not None:
            raise InputError("an opened scene file does not change; take Scene.from_document(scene.resolved(), allow_roots=[...]), and change that")
        self._natives.clear()
        return self._document

    def _document_for(self, out: Path) -> dict[str, Any]:
        """The document for a scene file at ``out``: files are named from its folder, arrays by the files that they are written as."""
        there = os.path.realpath(out.parent)
        if self._file is None and (self._base is None or os.path.realpath(self._base) == there):
            document = copy.deepcopy(self._document)
        else:
            with asked() as ask:
                document = json.loads(self._opened(ask).resolved(os.fspath(out)) or "{}")
        arrays = {f"array:{name}": file for name, file in self._arrays.files()}

        def named(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: named(item) for key, item in value.items()}
            if isinstance(value, list):
                return [named(item) for item in value]
            return arrays.get(value, value) if isinstance(value, str) else value

        return cast("dict[str, Any]", named(document))

    def _sheet(self, size: list[int] | None, asked: Mapping[str, Any]) -> tuple[dict[str, Any], list[int] | None]:
        """Options that tell the paper of a picture, if it has one, and the size of the picture."""
        asked = {key: value for key, value in asked.items() if value is not None}
        if not asked and (size is not None or (self._file is None and not self._document.get("print"))):
            return {}, size
        found = _native.sheet(*self._described(), _text("paper", asked), size)
        return ({}, size) if found is None else (given(json.loads(found[0])), found[1])

    def _sized(self, size: list[int] | None, ask: Ask) -> NativeScene:
        if size is None:
            return self._opened(ask)
        key = (size[0], size[1])
        if key not in self._natives:
            if None in self._natives and not self._natives[None].is_framed():
                native = self._natives[None].resized(size, ask)
            else:
                native = self._open({"size": size}, ask)
            # One other size is kept.
            self._natives = {k: v for k, v in self._natives.items() if k is None}
            self._natives[key] = native
        return self._natives[key]

    def _opened(self, ask: Ask) -> NativeScene:
        if None not in self._natives:
            self._natives[None] = self._open({}, ask)
        return self._natives[None]

    def _open(self, options: dict[str, Any], ask: Ask) -> NativeScene:
        return self._native_of(*self._described(), options, ask)

    def _described(self) -> tuple[str, str | None]:
        """The path of the scene file, and the text of a scene that is no file."""
        if self._file is not None:
            return os.fspath(self._file), None
        if "camera" not in self._document:
            self.overview()
        return self._text_of(self._document)

    def _text_of(self, document: Mapping[str, Any]) -> tuple[str, str]:
        """The path that a document would have as a scene file, and its text."""
        base = self._base or Path(os.path.abspath("."))
        return os.fspath(base / "scene.json"), _text("the scene", document)

    def _native_of(self, path: str, text: str | None, options: Mapping[str, Any], ask: Ask) -> NativeScene:
        opening = _text("options", {**options, "allow_roots": self._roots, "seed": self._seed, "data": self._said})
        if text is None:
            return _native.NativeScene.open(path, opening, self._arrays, ask)
        return _native.NativeScene.from_text(path, text, opening, self._arrays, ask)


def _bytes(what: str, values: object, columns: int) -> tuple[bytes, int]:
    array = np.asanyarray(joined(what, values))
    if array.size == 0 and array.ndim == 2 and array.shape[1] == columns:
        return b"", 0
    if masked_count(array):
        raise InputError(f"{what} holds masked values; leave those rows out")
    if array.dtype.kind not in "iuf":
        raise InputError(f"{what} of type {array.dtype} are not numbers; give rows of {columns}")
    if array.ndim == 1 and array.size == columns:
        array = array[None, :]
    if array.ndim != 2 or array.shape[1] != columns:
        raise InputError(f"{what} have the shape {array.shape}; give rows of {columns} numbers, shape (n, {columns})")
    if not np.isfinite(array).all():
        bad = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise InputError(f"{what}: row {bad} of {len(array)} is not finite; leave such rows out")
    return np.ascontiguousarray(array, np.float64).tobytes(), len(array)
