#!/usr/bin/env python3
"""sheet.py OUT [SHEET.png]: lay the pictures of the folder out side by side. It needs Pillow."""

import json
import pathlib
import sys
import textwrap

from PIL import Image, ImageDraw, ImageFont

from rows import ROWS, SIZE, rows_of

NAMES = {"straight": "Belvedere, straight", "bent": "Belvedere, bent", "blender": "Blender (Cycles)", "qgis": "QGIS 3D",
         "vtk": "VTK, as in ParaView", "molstar": "Mol*"}
# Two blocks: each has the rivals that are made for what it shows.
BLOCKS = [(("terrain",), ("straight", "bent", "blender", "qgis")),
          (("town", "molecule", "volume"), ("straight", "bent", "blender", "vtk", "molstar"))]
GAP, CAPTION, HEAD = 12, 26, 44


def font(size):
    try:
        return ImageFont.truetype("DejaVuSans.ttf", size)
    except OSError:
        return ImageFont.load_default(size)


def share(row, name):
    value = row.get({"straight": "visible_straight", "bent": "visible_bent"}.get(name, ""))
    return "" if value is None else f": {100 * value:.0f} % of what matters visible"


def cell(sheet, draw, row, name, at, skipped):
    (x, y), (wide, high) = at, SIZE
    picture = row["folder"] / f"{name}.png"
    if picture.exists() and name not in skipped:
        sheet.paste(Image.open(picture).convert("RGB").crop((0, 0, wide, high)), (x, y))
        draw.text((x, y + high + 4), row["title"] + share(row, name), "black", font(15))
        return
    note = row["folder"] / f"{name}.txt"
    text = skipped.get(name) or (note.read_text().strip() if note.exists() else "no picture was made")
    draw.rectangle((x, y, x + wide - 1, y + high - 1), "#eeeeee", "#cccccc")
    for i, line in enumerate(textwrap.wrap(text, 62)[:8]):
        draw.text((x + 20, y + 150 + 24 * i), line, "#7a2020" if name in skipped else "#555555", font(16))


def main(out, path):
    out = pathlib.Path(out)
    skipped = json.loads((out / "skipped.json").read_text()) if (out / "skipped.json").exists() else {}
    known = {row["id"]: row for row in rows_of(out)}
    blocks = [([known[r["id"]] for r in ROWS if r["id"] in known and known[r["id"]]["kind"] in kinds], columns)
              for kinds, columns in BLOCKS]
    wide, high = SIZE
    across = max(len(columns) for _, columns in blocks)
    down = sum(HEAD + len(rows) * (high + CAPTION + GAP) for rows, _ in blocks)
    sheet = Image.new("RGB", (GAP + across * (wide + GAP), down), "white")
    draw = ImageDraw.Draw(sheet)
    top = 0
    for rows, columns in blocks:
        for column, name in enumerate(columns):
            x = GAP + column * (wide + GAP)
            draw.text((x, top + 10), NAMES[name] + (" - SKIPPED" if name in skipped else ""), "black", font(22))
            for number, row in enumerate(rows):
                cell(sheet, draw, row, name, (x, top + HEAD + number * (high + CAPTION + GAP)), skipped)
        top += HEAD + len(rows) * (high + CAPTION + GAP)
    sheet.save(path)
    print(f"{path}: {sheet.width} x {sheet.height}")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else str(pathlib.Path(sys.argv[1]) / "sheet.png"))
