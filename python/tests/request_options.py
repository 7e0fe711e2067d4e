"""Writes ``belvedere/_requests.py``, the options of requests as types, from their schema: python python/tests/request_options.py."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from belvedere import _native

FILE = Path(__file__).resolve().parents[1] / "belvedere" / "_requests.py"
#: Options that ``reveal`` takes in a form of its own, by its name for them.
OWN = {
    "data": "dem", "features": "routes", "crs": "scene_crs", "nodata": "nodata", "keep_voids": "fill_voids", "fill_voids": "fill_voids",
    "eye": "eye", "look": "look_at", "fov": "fov_y_deg", "size": "size", "see": "see", "fallback": "fallback", "light": "light",
    "stylise": "stylise", "no_mark": "mark", "furniture": "furniture", "no_sea": "sea", "rivers": "rivers", "drape": "drape",
}  # fmt: skip


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


def text() -> str:
    """The module."""
    found = schema("reveal")
    lines = [
        '"""Options of requests, made from their schema by python/tests/request_options.py."""',
        "",
        "from __future__ import annotations",
        "",
        "from typing import Any, Literal, Mapping, Sequence, TypedDict",
        "",
        "",
        "class RevealOptions(TypedDict, total=False):",
        '    """Options of :func:`belvedere.reveal` beside those of its signature; each is that of the command line of this name."""',
    ]
    for name, rule in found["properties"].items():
        if name not in OWN:
            says = " ".join(rule.get("description", "").split())
            none = " | None" if "null" in json.dumps(rule.get("type", rule.get("anyOf", ""))) else ""
            lines += ["", f"    #: {says}", f"    {name}: {kind(rule, found.get('$defs', {}))}{none}"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
