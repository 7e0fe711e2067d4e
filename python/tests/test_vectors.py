"""Vectors read by other programs: PDF by pypdf, SVG by the XML reader of Python."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pypdf
import pytest

import belvedere

NAMES = ["Piz Élan", "Hütte & Co"]


@pytest.fixture
def named(scene: belvedere.Scene) -> belvedere.Scene:
    """The hills with two points before the ridge, and their names."""
    points = {NAMES[0]: (900.0, 600.0), NAMES[1]: (1700.0, 500.0)}
    return scene.add_points(points, style={"labels": True})


def test_a_pdf_has_layers_and_text_that_is_copied(named: belvedere.Scene, tmp_path: Path) -> None:
    path = tmp_path / "map.pdf"
    named.render(size=(640, 400)).save(path)
    reader = pypdf.PdfReader(path, strict=True)
    (page,) = reader.pages
    # Pixels are 1/96 inch, points 1/72.
    assert [float(v) for v in page.mediabox] == [0, 0, 480, 300]
    assert all(name in page.extract_text() for name in NAMES)
    groups = reader.trailer["/Root"]["/OCProperties"]["/OCGs"]
    layers = [group.get_object()["/Name"] for group in groups]
    assert layers == ["surfaces", "lines", "points", "names", "mark"]
    # Every layer holds marks, each begun and ended.
    content = page.get_contents().get_data().decode("latin-1")
    begun = re.findall(r"/OC /(\w+) BDC", content)
    assert len(set(begun)) == len(layers)
    assert len(re.findall(r"\bB[DM]C\b", content)) == len(re.findall(r"\bEMC\b", content))


def test_an_svg_has_layers_and_live_text(named: belvedere.Scene, tmp_path: Path) -> None:
    path = tmp_path / "map.svg"
    named.render(size=(640, 400)).save(path)
    root = ElementTree.parse(path).getroot()
    label = "{http://www.inkscape.org/namespaces/inkscape}label"
    layers = [group.get(label) for group in root.iter("{http://www.w3.org/2000/svg}g") if group.get(label)]
    assert layers == ["surfaces", "lines", "points", "names", "mark"]
    text = ["".join(element.itertext()) for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert set(NAMES) <= set(text), text


def test_paper_gives_size_and_density_as_the_program_does(named: belvedere.Scene, tmp_path: Path) -> None:
    picture = named.render(paper="A6", dpi=100)
    assert picture.size == (583, 413)
    picture.save(tmp_path / "a.png")
    assert b"pHYs" in (tmp_path / "a.png").read_bytes()
    # A scene's own paper, which a size in pixels sets aside.
    path = named.save(tmp_path / "scene.json")
    path.write_text(json.dumps({**json.loads(path.read_text()), "print": {"paper": "A6", "dpi": 100}}))
    opened = belvedere.Scene.open(path)
    assert (opened.render().rgba == picture.rgba).all()
    assert opened.render(size=(320, 200)).size == (320, 200)
    with pytest.raises(belvedere.InputError, match="contradict"):
        named.render(size=(320, 200), paper="A6", dpi=100)
    with pytest.raises(belvedere.InputError, match=".svg or .pdf"):
        picture.save(tmp_path / "b.png", vectors_only=True)
    picture.save(tmp_path / "only.svg", vectors_only=True)
    assert "<image" not in (tmp_path / "only.svg").read_text()
