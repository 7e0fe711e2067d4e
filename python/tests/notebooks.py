"""Runs the notebooks of docs/notebooks. As a program it stores their outputs: python python/tests/notebooks.py (needs nbclient and ipykernel)."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import struct
import sys
import tempfile
import zlib
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "notebooks"
ALL = sorted(FOLDER.glob("*.ipynb"))


def code_cells(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    """The cells that are run."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def digest(notebook: dict[str, Any]) -> str:
    """Of the code of all cells."""
    sources = ["".join(cell["source"]) for cell in code_cells(notebook)]
    return hashlib.sha256("\0".join(sources).encode()).hexdigest()


def texts(cell: dict[str, Any]) -> str:
    """What a cell says in words."""
    found = []
    for output in cell["outputs"]:
        said = output.get("text") or output.get("data", {}).get("text/plain") or ""
        found.append("".join(said))
    # A stream comes in one piece or in several.
    return "".join(found)


def run(path: Path, folder: Path) -> dict[str, Any]:
    """The notebook with the outputs of a fresh run in a folder. An error in a cell raises."""
    import nbclient
    import nbformat

    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(folder)}}).execute()
    result: dict[str, Any] = json.loads(nbformat.writes(notebook))
    return result


def small(text: str) -> str:
    """The text of a notebook with PNGs that are packed tightly and without the records of their scenes. Their pixels stay."""
    return re.sub(r"iVBORw0KGgo[A-Za-z0-9+/]+=*", lambda found: base64.b64encode(_packed(base64.b64decode(found[0]))).decode(), text)


def _packed(png: bytes) -> bytes:
    chunks, at, data = [], 8, b""
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        kind, body = png[at + 4 : at + 8], png[at + 8 : at + 8 + length]
        at += 12 + length
        if kind == b"IDAT":
            data += body
        elif kind not in (b"tEXt", b"zTXt", b"iTXt"):
            chunks.append((kind, body))
    packed = min(data, zlib.compress(zlib.decompress(data), 9), key=len)
    # The end stays last.
    chunks.insert(-1, (b"IDAT", packed))
    pieces = (struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)) for kind, body in chunks)
    return png[:8] + b"".join(pieces)


def main() -> None:
    """Stores the outputs."""
    chosen = [Path(name) for name in sys.argv[1:]] or ALL
    for path in chosen:
        with tempfile.TemporaryDirectory() as folder:
            done = run(path, Path(folder))
        for cell in code_cells(done):
            # Times of the run.
            cell["metadata"].pop("execution", None)
            # Pages that are gone; their pictures stay.
            for output in cell["outputs"]:
                page = output.get("data", {}).get("text/html")
                if page is not None:
                    output["data"]["text/html"] = re.sub(r"<object[^>]*>(.*)</object>", r"\1", "".join(page), flags=re.DOTALL)
        done["metadata"] = {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
            "belvedere": {"code_sha256": digest(done)},
        }
        path.write_text(small(json.dumps(done, indent=1, ensure_ascii=False) + "\n"), encoding="utf-8")
        print(f"{path.name}: {path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
