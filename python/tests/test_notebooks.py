"""The notebooks of docs/notebooks: their stored outputs are those of their cells, and they run."""

from __future__ import annotations

import json
from pathlib import Path

import notebooks
import pytest

#: A page is shown where the application for browsers is there; elsewhere the cell says what brings it.
PAGE = "page"


def read(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def test_there_are_three_and_a_page_leads_to_them() -> None:
    assert len(notebooks.ALL) == 3
    page = (notebooks.FOLDER.parent / "guide" / "notebooks.md").read_text(encoding="utf-8")
    assert all(f"../notebooks/{path.name}" in page for path in notebooks.ALL)


@pytest.mark.parametrize("path", notebooks.ALL, ids=lambda p: p.stem)
def test_the_stored_outputs_are_of_these_cells(path: Path) -> None:
    notebook = read(path)
    cells = notebooks.code_cells(notebook)
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1)), "python python/tests/notebooks.py runs them in order"
    assert notebook["metadata"]["belvedere"]["code_sha256"] == notebooks.digest(notebook), "python python/tests/notebooks.py stores new outputs"
    kinds = [output["output_type"] for cell in cells for output in cell["outputs"]]
    assert "error" not in kinds and "stream" in kinds
    pictures = [output for cell in cells for output in cell["outputs"] if "image/png" in output.get("data", {})]
    assert len(pictures) >= 2
    assert path.stat().st_size < 512 << 10
    text = path.read_text(encoding="utf-8")
    assert "127.0.0.1" not in text and "data:image/png" in text
    assert "/tmp/" not in text and "/home/" not in text


@pytest.mark.parametrize("path", notebooks.ALL, ids=lambda p: p.stem)
def test_they_run_and_say_what_is_stored(path: Path, tmp_path: Path) -> None:
    for package in ("nbclient", "ipykernel"):
        pytest.importorskip(package, reason=f"SKIPPED: the notebooks are not run; {package} is not installed")
    fresh = notebooks.code_cells(notebooks.run(path, tmp_path))
    for cell, stored in zip(fresh, notebooks.code_cells(read(path)), strict=True):
        if PAGE not in cell["metadata"].get("tags", ()):
            assert notebooks.texts(cell) == notebooks.texts(stored)
