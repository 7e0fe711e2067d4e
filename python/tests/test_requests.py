"""Every option of a request is an option in Python."""

import inspect
from pathlib import Path

import belvedere
import pytest
import request_options
from belvedere import _native, _requests


def test_the_options_are_those_of_the_schema() -> None:
    assert request_options.FILE.read_text(encoding="utf-8") == request_options.text(), "python python/tests/request_options.py writes them anew"
    for verb, (called, own) in request_options.OWN.items():
        call = belvedere.Scene if called.startswith("Scene.") else belvedere
        named = set(inspect.signature(getattr(call, called.rpartition(".")[2])).parameters)
        options = request_options.schema(verb)["properties"]
        assert set(own.values()) <= named and set(own) <= set(options), verb
        assert not request_options.others(verb) or request_options.others(verb) == list(
            getattr(_requests, f"{verb.capitalize()}Options").__annotations__
        ), verb
        assert set(request_options.ELSEWHERE.get(verb, [])) <= set(options), verb
    with pytest.raises(belvedere.InputError, match="no request"):
        _native.request_schema("nothing")


def test_an_unknown_option_is_told_with_the_nearest_one() -> None:
    with pytest.raises(belvedere.InputError, match='unknown option "palete"; did you mean "palette"'):
        belvedere.reveal("builtin:massif", "builtin:massif", palete="swiss")  # type: ignore[call-arg]
    with pytest.raises(belvedere.InputError, match="relief: "):
        belvedere.reveal("builtin:massif", "builtin:massif", relief="moon")  # type: ignore[arg-type]


def test_options_of_the_command_line_change_the_picture() -> None:
    view = {"eye": (7972, -7337, 3780), "look_at": (-952, 1587, 221), "size": (96, 54), "threads": 2}
    usual = belvedere.reveal("builtin:massif?size=65", "builtin:massif?size=65", **view)
    changes = {
        "shadows": True,
        "sky": "white",
        "haze": 5.0,
        "contours": 50.0,
        "edge": "plain",
    }
    for name, value in changes.items():
        changed = belvedere.reveal("builtin:massif?size=65", "builtin:massif?size=65", **view, **{name: value})
        assert (changed.picture.rgba != usual.picture.rgba).any(), name
    for name, value in {"transfer": "solid", "up": (0, 0, 1)}.items():
        with pytest.raises(belvedere.InputError, match=f"`{name}` is for a part of a model or city"):
            belvedere.reveal("builtin:massif?size=65", "builtin:massif?size=65", **view, **{name: value})
    with pytest.raises(belvedere.InputError, match="`representation` is for molecules, and there is none"):
        belvedere.reveal("builtin:massif?size=65", "builtin:massif?size=65", **view, representation="ribbon")
    paper = belvedere.reveal("builtin:massif?size=65", "builtin:massif?size=65", eye=view["eye"], look_at=view["look_at"], paper="60x40mm", dpi=50)
    assert paper.picture.rgba.shape[:2] == (79, 118)


def test_what_data_alone_do_not_say_is_said(tmp_path: Path) -> None:
    rows = "\n".join(" ".join(str(100 + 9 * (i % 7) * (j % 5)) for i in range(20)) for j in range(15))
    (tmp_path / "hills.asc").write_text("ncols 20\nnrows 15\nxllcorner 0\nyllcorner 0\ncellsize 30\n" + rows + "\n")
    said = belvedere.Scene.open(tmp_path / "hills.asc", crs="local", vertical_unit="ft", nodata=-1.0).document
    terrain = said["layer"][0]
    assert (said["crs"], terrain["vertical_unit"], terrain["nodata"]) == ("local", "ft", -1.0)
    with pytest.raises(belvedere.InputError, match="for data alone, and a scene file says it itself"):
        scene = belvedere.Scene.builtin("massif").save(tmp_path / "s.json")
        belvedere.Scene.open(scene, nodata=0.0).document


def test_options_of_render_change_the_picture() -> None:
    scene = belvedere.Scene.builtin("massif")
    usual = scene.render(size=(96, 54), threads=2).rgba
    changes = {"palette": "desert", "sky": "white", "haze": 1.0, "contours": 50.0, "edge": "block", "plain": True, "no_sea": None}
    for name, value in changes.items():
        drawn = scene.render(size=(96, 54), threads=2, **{name: value}).rgba
        assert (drawn != usual).any() == (value is not None), name
    assert (scene.render(size=(96, 54), threads=2).rgba == usual).all()
    with pytest.raises(belvedere.InputError, match='there is no renderer "exakt"; did you mean "exact"'):
        scene.render(size=(96, 54), renderer="exakt")
    with pytest.raises(belvedere.InputError, match='unknown option "palete"; did you mean "palette"'):
        scene.render(palete="desert")  # type: ignore[call-arg]
    with pytest.raises(belvedere.InputError, match="for molecules, and there is none"):
        scene.render(color_by="chain")
