"""Writes ``belvedere/_requests.py``, the options of requests as types, from their schema: python python/tests/request_options.py."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from belvedere import _native

FILE = Path(__file__).resolve().parents[1] / "belvedere" / "_requests.py"
#: Of each verb: its call, and the options that the call takes in a form of its own, by its name for them.
DRAWN = {"size": "size", "straight": "straight", "compare": "compare", "samples": "samples", "stylise": "stylise", "furniture": "furniture", "title": "title"}
OWN: dict[str, tuple[str, dict[str, str]]] = {
    "reveal": ("reveal", {
        "data": "dem", "features": "routes", "crs": "scene_crs", "nodata": "nodata", "keep_voids": "fill_voids", "fill_voids": "fill_voids",
        "eye": "eye", "look": "look_at", "fov": "fov_y_deg", "size": "size", "see": "see", "fallback": "fallback", "light": "light",
        "stylise": "stylise", "no_mark": "mark", "furniture": "furniture", "no_sea": "sea", "rivers": "rivers", "drape": "drape",
    }),
    "render": ("Scene.render", {
        **DRAWN, "lod": "lod_px", "renderer": "renderer", "compositing": "compositing", "paper": "paper", "dpi": "dpi", "margin_mm": "margin_mm",
        "aux": "buffers", "grid": "grid", "heatmap": "heatmap", "ghost": "ghost", "highlight": "highlight", "no_mark": "mark",
        "overhead": "overhead", "outside": "outside",
    }),
    "animate": ("animate", {
        **DRAWN, "frames": "frames", "fps": "fps", "along": "along", "speed": "speed_mps", "sweep": "sweep_deg", "turntable": "turntable_deg_per_s",
        "trajectory": "trajectory", "follow": "follow", "marker": "marker", "clock": "clock", "profile": "profile", "resume": "resume", "part": "part",
    }),
    "disocclude": ("disocclude", {
        "data": "dem", "features": "features", "rivers": "rivers", "eye": "eye", "look": "look_at", "fov": "fov_x_deg", "mode": "mode",
        "no_limits": "limits", "set": "parameters", "grid": "grid", "fill_voids": "fill_voids", "source_crs": "crs", "crs": "scene_crs",
        "nodata": "nodata",
    }),
    "measure": ("Scene.measure", {"spacing": "spacing_m", "size": "size", "renderer": "renderer", "picture": "picture"}),
    "generalise": ("generalise", {"city": "city", "roads": "roads", "margin": "margin_m", "keep": "keep"}),
}  # fmt: skip
#: Options of another call: of ``Scene.open`` and of ``Picture.save``.
ELSEWHERE = {
    "render": ["crs", "curved_earth", "source_crs", "nodata", "vertical_unit", "aux_format", "band_rows"],
    "animate": ["crs", "curved_earth", "source_crs", "nodata", "vertical_unit"],
}


def schema(verb: str) -> dict[str, Any]:
    """Of the request of a verb."""
    found: dict[str, Any] = json.loads(_native.request_schema(verb))
    return found


def kind(rule: dict[str, Any], definitions: dict[str, Any]) -> str:
    """The type of a value."""
    if "$ref" in rule:
        return kind(definitions[rule["$ref"].rsplit("/", 1)[1]], definitions)
    forms = rule.get("anyOf") or rule.get("oneOf")
    if forms:
        names = [f'"{form["const"]}"' for form in forms if "const" in form]
        others = [kind(form, definitions) for form in forms if "const" not in form and form.get("type") != "null"]
        texts = [f"Literal[{', '.join(names)}]"] if names else []
        return " | ".join(dict.fromkeys(texts + others))
    if "enum" in rule:
        return f"Literal[{', '.join(json.dumps(name) for name in rule['enum'])}]"
    stated = rule.get("type", "object")
    plain = [name for name in ([stated] if isinstance(stated, str) else stated) if name != "null"]
    word = {"string": "str", "boolean": "bool", "integer": "int", "number": "float", "array": "Sequence[Any]", "object": "Mapping[str, Any]"}
    return " | ".join(word[name] for name in plain)


def others(verb: str) -> list[str]:
    """Options of a verb that its call takes by their names."""
    own = OWN[verb][1]
    return [name for name in schema(verb)["properties"] if name not in own and name not in ELSEWHERE.get(verb, [])]


def of_verb(verb: str) -> list[str]:
    """The class of the options of a verb."""
    found, called = schema(verb), OWN[verb][0]
    kind_of_call = "meth" if "." in called else "func"
    lines = [
        "",
        "",
        f"class {verb.capitalize()}Options(TypedDict, total=False):",
        f'    """Options of :{kind_of_call}:`belvedere.{called}` beside those of its signature; each is that of the command line of this name."""',
    ]
    for name in others(verb):
        rule = found["properties"][name]
        says = " ".join(rule.get("description", "").split())
        none = " | None" if "null" in json.dumps(rule.get("type", rule.get("anyOf", ""))) else ""
        lines += ["", f"    #: {says}", f"    {name}: {kind(rule, found.get('$defs', {}))}{none}"]
    return lines


def text() -> str:
    """The module."""
    lines = [
        '"""Options of requests, made from their schema by python/tests/request_options.py."""',
        "",
        "from __future__ import annotations",
        "",
        "from typing import Any, Literal, Mapping, Sequence, TypedDict",
    ]
    for verb in OWN:
        if others(verb):
            lines += of_verb(verb)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
