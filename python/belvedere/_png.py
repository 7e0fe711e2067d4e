"""PNG files of arrays."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .errors import FileError


def rgb(pixels: NDArray[np.uint8]) -> bytes:
    """The file of colours ``(rows, columns, 3)``."""
    height, width, _ = pixels.shape
    # Each row begins with the number of its filter, 0: none.
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)
    parts = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows.tobytes())), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts
    )


def save(path: Path, data: bytes, overwrite: bool) -> Path:
    """Writes a file; returns its path."""
    try:
        with path.open("wb" if overwrite else "xb") as file:
            file.write(data)
    except FileExistsError:
        raise FileError(f"{path} exists; give overwrite=True, or another name") from None
    except OSError as error:
        raise FileError(f"{path}: {error.strerror or error}") from error
    return path
