#!/usr/bin/env python3
"""places.py DATA PROGRAM OUT [NAME ...]: one sheet of 24 first pictures, each of one command without options, and their scores.

DATA is the folder of the data collection, PROGRAM the built program, OUT the folder of pictures and `places.png`. With names only those
places are drawn anew. Needs Pillow."""

import json
import subprocess
import sys
from pathlib import Path

from PIL import Image, ImageDraw

#: Verb and files of each place, and options where it is one of a season or of paper.
PLACES = {
    "gr11": ("reveal", "andorra/N42E001.hgt", "andorra/gr11_andorra_no_elevation.gpx"),
    "hrp": ("reveal", "andorra/N42E001.hgt", "andorra/hrp_andorra_no_elevation.gpx"),
    "water": ("reveal", "andorra/N42E001.hgt", "andorra/water.geojson"),
    "short walk": ("reveal", "andorra/N42E001.hgt", "andorra/andorra_for_map_matching.gpx"),
    "gr11 in winter": ("reveal", "andorra/N42E001.hgt", "andorra/gr11_andorra_no_elevation.gpx", "--palette", "winter"),
    "gr11 in autumn": ("reveal", "andorra/N42E001.hgt", "andorra/gr11_andorra_no_elevation.gpx", "--palette", "autumn"),
    "gr11, hazy dusk": ("reveal", "andorra/N42E001.hgt", "andorra/gr11_andorra_no_elevation.gpx", "--sky", "dusk", "--haze", "60"),
    "gr11, plain": ("reveal", "andorra/N42E001.hgt", "andorra/gr11_andorra_no_elevation.gpx", "--plain"),
    "pyrenees": ("render", "andorra/N42E001.hgt"),
    "divide": ("reveal", "rmnp/rmnp_dem.tif", "rmnp/continental-div-trail_clip.geojson"),
    "rockies": ("render", "rmnp/rmnp_dem.tif"),
    "canyon": ("reveal", "grand_canyon/grandcanyon_dem_3857.tif", "grand_canyon/colorado_river_line_derived.geojson"),
    "canyon alone": ("render", "grand_canyon/grandcanyon_dem_3857.tif"),
    "baltoro": ("reveal", "baltoro/baltoro_srtm.tif", "baltoro/glacier_centerlines.geojson"),
    "karakoram": ("render", "baltoro/baltoro_srtm.tif"),
    "langeberg": ("reveal", "swellendam/srtm_41_19_4326.tif", "swellendam/rivers.geojson"),
    "swellendam": ("render", "swellendam/srtm_41_19_4326.tif", "swellendam/buildings.geojson"),
    "cape": ("render", "swellendam/srtm_41_19_4326.tif"),
    "san gabriel": ("render", "bigtujunga/bigtujunga.tif"),
    "gotthard": ("render", "gotthard/N46E008.tif"),
    "short trail": ("reveal", "cases/first_picture/hills.tif", "cases/first_picture/short.gpx"),
    "trail at the rim": ("reveal", "cases/first_picture/hills.tif", "cases/first_picture/near_rim.gpx"),
    "trail and river": ("reveal", "cases/first_picture/hills.tif", "cases/first_picture/trail.geojson", "cases/first_picture/river.geojson"),
    "hills": ("render", "cases/first_picture/hills.tif"),
}
SIZE = (480, 270)
ACROSS = 4


def main():
    data, program, out = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    out.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[4:] or PLACES:
        verb, *given = PLACES[name]
        files = [str(data / part) if "/" in part else part for part in given]
        run = subprocess.run([program, verb, *files, "-o", str(picture(out, name)), "--overwrite"], capture_output=True, text=True)
        print(name, "drawn" if run.returncode == 0 else run.stderr.strip()[-300:], flush=True)
    sheet = Image.new("RGB", (ACROSS * SIZE[0], -(-len(PLACES) // ACROSS) * (SIZE[1] + 20)), "white")
    draw = ImageDraw.Draw(sheet)
    for i, name in enumerate(PLACES):
        at = (i % ACROSS * SIZE[0], i // ACROSS * (SIZE[1] + 20))
        if picture(out, name).exists():
            sheet.paste(Image.open(picture(out, name)).convert("RGB").resize(SIZE, Image.LANCZOS), at)
        draw.text((at[0] + 6, at[1] + SIZE[1] + 4), f"{name}: {score(out, name)}", fill="black")
    sheet.save(out / "places.png")


def picture(out, name):
    return out / f"{name.replace(' ', '_').replace(',', '')}.png"


def score(out, name):
    """Rules that hold, and those that do not."""
    record = Path(f"{picture(out, name)}.json")
    look = json.loads(record.read_text()).get("look") if record.exists() else None
    if not look:
        return "no score"
    short = {"range": "range", "deviation": "deviation", "L* of the darkest": "dark", "share burnt": "burnt", "saturation": "saturation",
             "spread": "hues", "change": "detail", "sky": "sky", "tilt": "tilt", "L* of the palest": "gradient", "subject": "subject", "share of the commonest": "one colour"}  # fmt: skip
    failed = [next(words for start, words in short.items() if rule["rule"].startswith(start)) for rule in look["rules"] if not rule["holds"]]
    return f"{look['held']} of {look['measured']}" + (f"; not: {', '.join(failed)}" if failed else "")


if __name__ == "__main__":
    main()
