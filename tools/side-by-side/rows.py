"""The eight rows of the sheet, and what the scripts of the sheet share. Standard library only."""

import json
import pathlib
import subprocess

SIZE = (640, 400)

# `scene`: a file of the folder scenes/; `reveal`: arguments of `belvedere reveal`, data first.
# `files`: what the rivals read of the same data. All names are relative to the folder of the collection.
ROWS = [
    {"id": "andorra", "title": "GR 11 through Andorra", "kind": "terrain", "scene": "andorra.toml",
     "files": {"terrain": "andorra/N42E001.hgt"}},
    {"id": "gotthard", "title": "Gotthard, August afternoon", "kind": "terrain", "scene": "gotthard.toml",
     "files": {"terrain": "gotthard/N46E008.tif"}},
    {"id": "canyon", "title": "Colorado in the Grand Canyon", "kind": "terrain", "scene": "grand_canyon.toml",
     "files": {"terrain": "grand_canyon/grandcanyon_dem_3857.tif"}},
    {"id": "swellendam", "title": "Rivers of Swellendam, photographs", "kind": "terrain", "scene": "swellendam.toml",
     "files": {"terrain": "swellendam/srtm_41_19_4326.tif",
               "drape": ["swellendam/aerial_3420B_2010_328_RGB.tif", "swellendam/aerial_3320D_2010_315_RGB.tif"]}},
    {"id": "delft", "title": "A house in Delft (CityJSON)", "kind": "town",
     "reveal": ["city_delft/delft.city.json", "--see", "b11267a1d-00ba-11e6-b420-2bdcc4ab5d7f",
                "--eye=84790,447420,30", "--look=84850,447530,5", "--fov", "40"],
     "files": {}},
    {"id": "nucleosome", "title": "A helix in a nucleosome (1kx5)", "kind": "molecule",
     "reveal": ["molecules/1kx5.pdb", "--see", "chain F and resi 60-90", "--representation", "ribbon",
                "--eye=-31,243,96", "--look=49,110,0", "--fov", "32"],
     "files": {"molecule": "molecules/1kx5.pdb"}},
    {"id": "engine", "title": "A point in an engine (CT)", "kind": "volume",
     "reveal": ["volumes/engine.vti", "--see", "150,150,40", "--transfer", "solid",
                "--eye=-200,-250,230", "--look=127,127,63", "--fov", "34"],
     "files": {"volume": "volumes/engine.vti", "transfer": "solid"}},
    {"id": "chest", "title": "A point in a chest (CT)", "kind": "volume",
     "reveal": ["volumes/LIDC2.vti", "--see", "180,240,160", "--transfer", "ct-bone",
                "--eye=180,-560,300", "--look=180,180,165", "--fov", "32"],
     "files": {"volume": "volumes/LIDC2.vti", "transfer": "bone"}},
]


def rows_of(out):
    """The rows that `ours.py` has drawn into the folder, each with its camera."""
    for path in sorted(pathlib.Path(out).resolve().glob("*/row.json")):
        row = json.loads(path.read_text())
        row["folder"] = path.parent
        yield row


def target(view):
    """A point in front of the eye, for programs that ask for one."""
    return [e + 1000.0 * f for e, f in zip(view["eye"], view["forward"])]


def why(row, rival, text):
    """Say in the cell of a rival why it holds no picture."""
    print(f"{row['id']}: {rival}: {text}", flush=True)
    (pathlib.Path(row["folder"]) / f"{rival}.txt").write_text(text + "\n")


def run(command, **more):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
