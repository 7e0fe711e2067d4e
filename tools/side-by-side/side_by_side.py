#!/usr/bin/env python3
"""Draw eight of our pictures and what other programs make of the same data, and lay them out on one sheet.

A rival that is not installed is skipped: the script says so, and so does its column."""

import argparse
import json
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", help="folder of the data collection")
    parser.add_argument("program", help="the program belvedere")
    parser.add_argument("out", help="folder for the pictures and sheet.png; it is made")
    parser.add_argument("--blender-python", default=sys.executable, help="Python that has the module bpy")
    parser.add_argument("--vtk-python", default=sys.executable, help="Python that has the module vtk")
    parser.add_argument("--qgis-python", default="/usr/bin/python3", help="Python that has the module qgis")
    parser.add_argument("--pillow-python", default=sys.executable, help="Python that has Pillow")
    parser.add_argument("--molstar", default="node_modules/molstar", help="folder of the npm package molstar")
    parser.add_argument("--chromium", default="chromium", help="a browser of the family of Chromium")
    parser.add_argument("--only", help="draw these alone, separated by commas: ours, blender, qgis, vtk, molstar; the sheet is always laid out")
    given = parser.parse_args()
    out = pathlib.Path(given.out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    record = out / "skipped.json"
    skipped = json.loads(record.read_text()) if record.exists() else {}

    def wanted(name):
        return not given.only or name in given.only.split(",")

    def has(python, module):
        try:
            return subprocess.run([python, "-c", f"import {module}"], capture_output=True).returncode == 0
        except OSError:
            return False

    def rival(name, missing, command):
        if not wanted(name):
            return
        skipped.pop(name, None)
        for old in list(out.glob(f"*/{name}.png")) + list(out.glob(f"*/{name}.txt")):
            old.unlink()
        if missing:
            skipped[name] = f"SKIPPED: {missing}"
            print(f"\n*** {name} IS SKIPPED: {missing} ***\n", file=sys.stderr, flush=True)
        elif subprocess.run([str(c) for c in command]).returncode != 0:
            print(f"\n*** {name} failed: its missing pictures say so ***\n", file=sys.stderr, flush=True)

    if wanted("ours") and subprocess.run([sys.executable, HERE / "ours.py", given.data, given.program, out]).returncode != 0:
        sys.exit("Our own pictures were not drawn.")
    rival("vtk", "" if has(given.vtk_python, "vtk") else "the Python module vtk is not installed",
          [given.vtk_python, HERE / "vtk_pictures.py", out])
    rival("blender", "" if has(given.blender_python, "bpy") else "the Python module bpy is not installed",
          [given.blender_python, HERE / "blender_pictures.py", out])
    screen = [] if not shutil.which("xvfb-run") else ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24"]
    rival("qgis", "" if has(given.qgis_python, "qgis._3d") else "QGIS with its Python modules is not installed",
          [*screen, given.qgis_python, HERE / "qgis_pictures.py", out])
    viewer = pathlib.Path(given.molstar) / "build" / "viewer" / "molstar.js"
    rival("molstar", "the npm package molstar is not installed" if not viewer.exists()
          else "" if shutil.which(given.chromium) else "no browser was found",
          [sys.executable, HERE / "molstar_pictures.py", out, given.molstar, given.chromium])
    record.write_text(json.dumps(skipped, indent=1))
    sys.exit(subprocess.run([given.pillow_python, HERE / "sheet.py", out]).returncode)


if __name__ == "__main__":
    main()
