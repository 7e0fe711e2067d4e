"""The examples of the guide and of the documentation run."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest

import belvedere
from belvedere import revealing, scene

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "guide" / "python.md"


def test_the_blocks_of_the_guide(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 8
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, str(GUIDE), "exec"), names)
    assert (tmp_path / "path.png").is_file() and (tmp_path / "moved.tif").is_file()


def test_the_blocks_of_the_page_on_pyvista(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista", reason="SKIPPED: the page on PyVista is not tried; pyvista is not installed")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (GUIDE.parent / "pyvista.md").read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "pyvista.md", "exec"), names)
    assert len(blocks) == 3 and (tmp_path / "bent.png").is_file() and (tmp_path / "by-vtk.png").is_file()


@pytest.mark.parametrize("module", [scene, revealing])
def test_the_examples_of_docstrings(module: object) -> None:
    result = doctest.testmod(module)  # type: ignore[arg-type]
    assert result.attempted > 0 and result.failed == 0


def test_everything_public_is_documented() -> None:
    for name in belvedere.__all__:
        thing = getattr(belvedere, name)
        if isinstance(thing, type) or callable(thing):
            assert thing.__doc__, name
            for key, member in vars(thing).items() if isinstance(thing, type) else ():
                if not key.startswith("_") and (callable(member) or isinstance(member, (property, classmethod, staticmethod))):
                    assert getattr(thing, key).__doc__ or getattr(member, "__doc__", None), f"{name}.{key}"
