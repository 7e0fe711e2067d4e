#!/usr/bin/env python3
"""ours.py DATA PROGRAM OUT: draw the rows with Belvedere, straight and bent, and write the camera of each for the rivals."""

import json
import pathlib
import shutil
import sys

from rows import ROWS, SIZE, run

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"


def answer(command):
    done = run(command)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


def draw(row, data, program, out):
    folder = out / row["id"]
    folder.mkdir(parents=True, exist_ok=True)
    common = ["--allow-root", data, "--overwrite", "-q"]
    size = ["--size", "%dx%d" % SIZE]
    scene = folder / "scene.toml"
    if "scene" in row:
        text = (SCENES / row["scene"]).read_text()
        scene.write_text(text)
        shares = json.loads(answer([program, "measure", scene, "--json", *common])) if "must_see = true" in text else {}
    else:
        files = [data / row["reveal"][0], *row["reveal"][1:]]
        shares = json.loads(answer([program, "reveal", *files, "-o", folder / "reveal.png", "--scene", scene,
                                    "--time-limit", "60", "--json", *size, *common]))
    answer([program, "render", scene, "-o", folder / "straight.png", "--straight", *size, *common])
    answer([program, "render", scene, "-o", folder / "bent.png", *size, *common])
    if "reveal" in row:     # these pictures have the mark around what is to be seen
        shutil.copy(folder / "reveal.png", folder / "bent.png")
    record = json.loads((folder / "straight.png.json").read_text())
    known = {"id": row["id"], "title": row["title"], "kind": row["kind"], "size": SIZE,
             "view": record["view"], "visible_straight": shares.get("visible_straight"),
             "visible_bent": shares.get("visible_bent"),
             "files": {k: [str(data / f) for f in v] if isinstance(v, list) else str(data / v) if k != "transfer" else v
                       for k, v in row["files"].items()}}
    shown = answer([program, "show", scene, *common])
    known["crs"] = next((line.split('"')[1] for line in shown.splitlines() if line.startswith("crs")), "local")
    if row["kind"] in ("terrain", "town"):
        answer([program, "export", scene, "-o", folder / "straight.glb", "--straight", "--nodes", "600000", *size, *common])
        known["glb"] = str(folder / "straight.glb")
    if row["kind"] == "terrain":
        # The lines as they are, without the bend: the stages are what stands from the first [[stage]] on.
        straight = folder / "straight.toml"
        straight.write_text(shown.split("[[stage]]")[0])
        answer([program, "displace", straight, "-o", folder / "lines.geojson", *common])
        known["lines"] = str(folder / "lines.geojson")
    (folder / "row.json").write_text(json.dumps(known, indent=1))
    print(f"{row['id']}: {known['visible_straight']} -> {known['visible_bent']}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    for one in ROWS:
        draw(one, pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve())
