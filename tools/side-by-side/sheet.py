#!/usr/bin/env python3
"""sheet.py OUT [SHEET.png]: lay the pictures of the folder out side by side. It needs Pillow."""

import json
import pathlib
import sys

from PIL import Image, ImageDraw, ImageFont

from rows import ROWS, SIZE, rows_of

COLUMNS = [("straight", "Belvedere, straight"), ("bent", "Belvedere, bent"), ("blender", "Blender (Cycles)"),
           ("qgis", "QGIS 3D"), ("vtk", "VTK, as in ParaView"), ("molstar", "Mol*"), ("rayshader", "rayshader")]
GAP, CAPTION, HEAD = 12, 26, 44


def font(size):
    try:
        return ImageFont.truetype("DejaVuSans.ttf", size)
    except OSError:
        return ImageFont.load_default(size)


def share(row, name):
    value = row.get({"straight": "visible_straight", "bent": "visible_bent"}.get(name, ""))
    return "" if value is None else f": {100 * value:.0f} % of what matters visible"


def main(out, path):
    out = pathlib.Path(out)
    skipped = json.loads((out / "skipped.json").read_text()) if (out / "skipped.json").exists() else {}
    known = {row["id"]: row for row in rows_of(out)}
    rows = [known[r["id"]] for r in ROWS if r["id"] in known]
    wide, high = SIZE
    sheet = Image.new("RGB", (GAP + len(COLUMNS) * (wide + GAP), HEAD + len(rows) * (high + CAPTION + GAP)), "white")
    draw = ImageDraw.Draw(sheet)
    for column, (name, words) in enumerate(COLUMNS):
        x = GAP + column * (wide + GAP)
        draw.text((x, 10), words + (" - SKIPPED" if name in skipped else ""), "black", font(22))
        for number, row in enumerate(rows):
            y = HEAD + number * (high + CAPTION + GAP)
            picture = row["folder"] / f"{name}.png"
            if picture.exists() and name not in skipped:
                sheet.paste(Image.open(picture).convert("RGB").crop((0, 0, wide, high)), (x, y))
                draw.text((x, y + high + 4), row["title"] + share(row, name), "black", font(15))
            else:
                note = row["folder"] / f"{name}.txt"
                text = skipped.get(name) or (note.read_text().strip() if note.exists() else "no picture was made")
                draw.rectangle((x, y, x + wide - 1, y + high - 1), "#eeeeee", "#cccccc")
                lines = [text[i:i + 62] for i in range(0, len(text), 62)][:8]
                for i, line in enumerate(lines):
                    draw.text((x + 20, y + 150 + 24 * i), line, "#7a2020" if name in skipped else "#555555", font(16))
    sheet.save(path)
    print(f"{path}: {sheet.width} x {sheet.height}")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else str(pathlib.Path(sys.argv[1]) / "sheet.png"))
