#!/usr/bin/env python3
"""molstar_pictures.py OUT FOLDER CHROMIUM: the molecules of the sheet in Mol*, in a browser without a window.

FOLDER is where the npm package molstar lies (it holds build/viewer/molstar.js)."""

import json
import pathlib
import sys

from rows import rows_of, run, why

PAGE = """<!DOCTYPE html><html><head><meta charset="utf-8">
<link rel="stylesheet" href="%(css)s"><style>html,body,#app{margin:0;width:%(w)dpx;height:%(h)dpx;overflow:hidden}
#app{position:absolute;left:0;top:0} .msp-viewport-controls,.msp-layout-static{border:0} .msp-viewport-controls{display:none}</style></head>
<body><div id="app"></div><script src="%(js)s"></script><script>
const text = %(text)s;
(async () => {
  const viewer = await molstar.Viewer.create("app", {layoutIsExpanded: false, layoutShowControls: false,
    layoutShowSequence: false, layoutShowLog: false, layoutShowLeftPanel: false, viewportShowExpand: false,
    viewportShowControls: false, viewportShowSettings: false, viewportShowSelectionMode: false,
    viewportShowAnimation: false, viewportShowTrajectoryControls: false, viewportShowReset: false,
    viewportShowScreenshotControls: false, viewportShowToggleFullscreen: false, viewportShowXR: "never",
    pixelScale: 1});
  await viewer.loadStructureFromData(text, "%(format)s");
  const canvas = viewer.plugin.canvas3d;
  canvas.setProps({camera: {mode: "perspective", helper: {axes: {name: "off", params: {}}}},
    postprocessing: {occlusion: canvas.props.postprocessing.occlusion}});
  canvas.requestCameraReset({durationMs: 0, snapshot: {position: %(eye)s, target: %(target)s, up: %(up)s,
    fov: %(fov)f, mode: "perspective", radius: 200, radiusMax: 400, fog: 0, clipFar: false}});
  canvas.commit(true);
})().catch(error => { document.title = "failed: " + error; document.body.append(String(error)); });
</script></body></html>
"""


def draw(row, package, browser):
    view = row["view"]
    path = pathlib.Path(row["files"]["molecule"])
    build = package / "build" / "viewer"
    aim = [e + 180.0 * f for e, f in zip(view["eye"], view["forward"])]
    page = row["folder"] / "molstar.html"
    page.write_text(PAGE % {
        "css": (build / "molstar.css").as_uri(), "js": (build / "molstar.js").as_uri(),
        "w": row["size"][0], "h": row["size"][1], "text": json.dumps(path.read_text()),
        "format": "pdb" if path.suffix == ".pdb" else "mmcif", "eye": view["eye"], "target": aim,
        "up": [-d for d in view["down"]], "fov": view["fov_y_deg"] * 3.141592653589793 / 180})
    out = row["folder"] / "molstar.png"
    done = run([browser, "--headless=new", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--allow-file-access-from-files",
                "--window-size=%d,%d" % (row["size"][0], row["size"][1] + 140), "--virtual-time-budget=60000", "--timeout=90000",
                f"--screenshot={out}", page.as_uri()], timeout=240)
    if not out.exists():
        why(row, "molstar", "the browser made no picture: " + done.stderr.strip()[-200:])


for one in rows_of(sys.argv[1]):
    if one["kind"] != "molecule":
        why(one, "molstar", "not asked: no molecule")
        continue
    try:
        draw(one, pathlib.Path(sys.argv[2]).resolve(), sys.argv[3])
    except Exception as error:
        why(one, "molstar", f"failed: {error}")
