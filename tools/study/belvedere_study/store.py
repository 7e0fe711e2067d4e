"""The pictures of a kit, as files beside the page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .pictures import Picture


@dataclass(frozen=True)
class Store:
    """Folder of pictures, their size, and the number of views that a participant steps through."""

    folder: Path
    size: tuple[int, int]
    views: int

    def keep(self, name: str, picture: Picture) -> str:
        """Writes a picture; returns the name of its file."""
        file = f"{name}.{picture.ending}"
        (self.folder / file).write_bytes(picture.data)
        return file
