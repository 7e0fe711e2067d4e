"""Pictures as they go into the page: WebP where Pillow is installed, else JPEG as the program writes it."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from pathlib import Path

#: Quality of WebP; at 82 edges of small things stay clean, and a picture takes some 25 kB.
QUALITY = 82
MIME = {"webp": "image/webp", "jpg": "image/jpeg", "png": "image/png"}


@dataclass(frozen=True)
class Picture:
    """The bytes of a picture and the ending of its file."""

    data: bytes
    ending: str


def drawn_as() -> str:
    """Ending of the file that the program is asked for."""
    return "png" if _has_pillow() else "jpg"


def encode(drawn: Path) -> Picture:
    """The drawn file, smaller if that can be."""
    if drawn.suffix != ".png":
        return Picture(drawn.read_bytes(), drawn.suffix[1:])
    from PIL import Image

    with Image.open(drawn) as opened:
        kept = io.BytesIO()
        opened.convert("RGB").save(kept, "WEBP", quality=QUALITY, method=5)
    return Picture(kept.getvalue(), "webp")


def data_uri(data: bytes, ending: str) -> str:
    """The picture as an address that holds it."""
    return f"data:{MIME[ending]};base64,{base64.b64encode(data).decode('ascii')}"


def _has_pillow() -> bool:
    try:
        from PIL import features
    except ImportError:
        return False
    return bool(features.check("webp"))
