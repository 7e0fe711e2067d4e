"""Runs the notebooks of docs/notebooks. As a program it stores their outputs: python python/tests/notebooks.py (needs nbclient and ipykernel)."""

from __future__ import annotations

import hashlib
import json
import re
import sys
import tempfile
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
        path.write_text(json.dumps(done, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"{path.name}: {path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
