"""Pictures: arrays, a record, and files."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._drawing import BUFFERS
from .errors import InputError
from .reports import Displacement, Note, notes_of

if TYPE_CHECKING:
    from ._native import NativePicture


class Picture:
    """A finished picture with the record of how it came about.

    In a notebook it shows itself. Arrays have row 0 on top; all of them are copies.
    """

    def __init__(self, native: NativePicture, again: Callable[[Mapping[str, Any], str | None], NativePicture] | None = None, exact: bool = False) -> None:
        self._native = native
        self._again = again
        self._exact = exact

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        width, height = self._native.size
        return width, height

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        width, height = self._native.size
        return height, width

    @cached_property
    def rgba(self) -> NDArray[np.uint8]:
        """Colours, sRGB, ``(rows, columns, 4)``; opaque. Of a compared pair this is the bent picture."""
        return self._array(self._native.rgba(), np.uint8, 4)

    @cached_property
    def straight(self) -> NDArray[np.uint8] | None:
        """Colours of the straight picture of a pair, likewise; ``None`` for a single picture."""
        data = self._native.straight_rgba()
        return None if data is None else self._array(data, np.uint8, 4)

    @cached_property
    def id(self) -> NDArray[np.uint32]:
        """Layer that is seen at the centre of each pixel: 1 + its number in ``scene.layers``, 0 where only sky is seen."""
        return self._array(self._native.id(), np.uint32)

    @cached_property
    def depth(self) -> NDArray[np.float32]:
        """Forward distance of the displaced surface at the centre of each pixel, scene units; infinite where only sky is seen.

        The first look at depth or world draws the picture once more, unless it was drawn with ``buffers=True``.
        """
        return self._array(self._with_buffers().depth(), np.float32)

    @cached_property
    def world(self) -> NDArray[np.float64]:
        """True (undisplaced) position of the surface at the centre of each pixel, ``(rows, columns, 3)``, scene coordinates; NaN where only
        sky is seen. See :attr:`depth` for its cost."""
        data = self._with_buffers().world()
        assert data is not None, "drawn with buffers"
        return self._array(data, np.float64, 3)

    @cached_property
    def record(self) -> dict[str, Any]:
        """The record that :meth:`save` writes beside the picture: view, displacement, inputs with their hashes, warnings."""
        record: dict[str, Any] = json.loads(self._native.record())
        return record

    @property
    def displacement(self) -> Displacement | None:
        """How far the points in the picture are displaced; ``None`` for a straight picture."""
        return Displacement.of(self.record["displacement"]) if self.record.get("displacement") else None

    @property
    def warnings(self) -> list[Note]:
        """Warnings of loading and drawing."""
        return notes_of(self.record["warnings"])

    @property
    def render_ms(self) -> float:
        """Wall time of drawing, milliseconds."""
        return self._native.render_ms

    def png(self) -> bytes:
        """The bytes of the PNG file, those that the command line writes too."""
        return self._native.png()

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        buffers: Sequence[str] = (),
        exr: bool = False,
        vectors_only: bool = False,
        overwrite: bool = False,
    ) -> list[Path]:
        """Writes the picture, its record beside it (``.json``), and buffers; returns the paths.

        The name's ending tells the format: PNG, TIFF, JPEG, WebP; or SVG and PDF, for which the scene is drawn again: lines, areas, points, names
        and legends are vectors there, over the raster of the surfaces.

        * ``vectors_only``: leaves the raster out of an SVG or PDF.
        * ``buffers``: of ``depth``, ``id``, ``world`` and ``displacement``, one ``.npy`` file each, or with ``exr`` all in one OpenEXR file.
        * ``overwrite``: replaces files.

        Raises :class:`belvedere.FileError`.
        """
        native = self._with_buffers() if buffers else self._native
        ending = Path(path).suffix.lower()
        if ending in (".svg", ".pdf"):
            if self._again is None:
                raise InputError(f"{path}: this picture has no scene to draw vectors of; write a PNG")
            native = self._again({"aux": BUFFERS if buffers else []}, "alone" if vectors_only else "over_raster")
        elif vectors_only:
            raise InputError(f"{path}: vectors_only needs a name that ends in .svg or .pdf")
        return [Path(p) for p in native.save(os.fspath(path), list(buffers), exr, overwrite)]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self.rgba if dtype is None else self.rgba.astype(dtype)

    def __repr__(self) -> str:
        width, height = self.size
        moved = self.displacement
        return f"<belvedere.Picture {width} x {height}, {'straight' if moved is None else f'displaced by up to {moved.max_m:.1f} m'}>"

    def _repr_png_(self) -> bytes:
        return self.png()

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        return {"image/png": self.png(), "text/plain": repr(self)}

    def _with_buffers(self) -> NativePicture:
        if not self._exact and self._again is not None:
            # Colours, ids and record stay those of the first drawing: a picture does not change when it is looked at.
            self._native, self._exact = self._native.with_buffers_of(self._again({"aux": BUFFERS}, None)), True
        return self._native

    def _array(self, data: bytearray, dtype: Any, channels: int = 0) -> NDArray[Any]:
        width, height = self._native.size
        shape = (height, width, channels) if channels else (height, width)
        return np.frombuffer(data, dtype).reshape(shape)


def set_memory_limit(limit_bytes: int) -> None:
    """Memory that loaders, solvers and renderers of this process may use together, bytes; 0: three quarters of the machine's, the default."""
    _native.set_memory_limit(limit_bytes)
