"""Runs every algorithm through qgis_process, as a user's script does. Needs QGIS 3.22 or later and the program.

    BELVEDERE_PROGRAM=target/release/belvedere python3 -m unittest discover integrations/qgis/tests
"""

import json
import os
import shutil
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
# The wrapper script of Debian's package checks for a file that its package lacks.
QGIS = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
PROGRAM = os.environ.get("BELVEDERE_PROGRAM") or shutil.which("belvedere")
# A ridge between an eye in the south and a route in the north, in UTM metres.
CORNER, CELLS, CELL = (500_000.0, 5_100_000.0), 120, 50.0


def elevation(row, column):
    north = (CELLS - row) * CELL
    return 500.0 + max(0.0, 400.0 - abs(north - 3000.0)) + 20.0 * ((column // 7) % 3)


def write_inputs(folder):
    """An elevation model, a route behind its ridge, and a town in front of it."""
    dem = folder / "dem.asc"
    rows = [" ".join(f"{elevation(r, c):.1f}" for c in range(CELLS)) for r in range(CELLS)]
    head = f"ncols {CELLS}\nnrows {CELLS}\nxllcorner {CORNER[0]}\nyllcorner {CORNER[1]}\ncellsize {CELL}\nNODATA_value -9999\n"
    dem.write_text(head + "\n".join(rows) + "\n")
    (folder / "dem.prj").write_text(
        'PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
        'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]],PROJECTION["Transverse_Mercator"],'
        'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],'
        'PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],AUTHORITY["EPSG","32632"]]'
    )
    line = [[CORNER[0] + x, CORNER[1] + 3700.0] for x in range(1500, 4501, 100)]
    route = {
        "type": "FeatureCollection",
        "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}},
        "features": [{
            "type": "Feature",
            "properties": {"name": "Valley way"},
            "geometry": {"type": "LineString", "coordinates": line},
        }],
    }
    # A comma separated table: a layer that QGIS reads and the program does not, so that it has to be written.
    (folder / "town.csv").write_text(f'name,WKT\n"Town","POINT ({CORNER[0] + 3000} {CORNER[1] + 1500})"\n')
    (folder / "route.geojson").write_text(json.dumps(route))


@unittest.skipUnless(QGIS and PROGRAM, "SKIPPED: needs qgis_process and the belvedere program")
class Headless(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        write_inputs(cls.folder)
        plugins = cls.folder / "profiles/default/python/plugins"
        shutil.copytree(HERE.parent / "belvedere", plugins / "belvedere", ignore=shutil.ignore_patterns("__pycache__"))
        # An active virtual environment would hide QGIS's own Python modules.
        kept = {k: v for k, v in os.environ.items() if k not in ("VIRTUAL_ENV", "PYTHONHOME", "PYTHONPATH")}
        cls.environment = kept | {
            "QGIS_CUSTOM_CONFIG_PATH": str(cls.folder),
            "QT_QPA_PLATFORM": "offscreen",
            "BELVEDERE_PROGRAM": str(Path(PROGRAM).resolve()),
            "XDG_RUNTIME_DIR": str(cls.folder),
            "PATH": "/usr/bin:" + os.environ["PATH"],
        }
        cls.call("plugins", "enable", "belvedere")

    @classmethod
    def call(cls, *words):
        return subprocess.run([QGIS, *words], env=cls.environment, capture_output=True, text=True, timeout=300)

    def run_algorithm(self, name, **parameters):
        words = [f"--{key}={value}" for key, value in parameters.items()]
        return self.call("--json", "run", f"belvedere:{name}", *words)

    def results(self, name, **parameters):
        done = self.run_algorithm(name, **parameters)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        return json.loads(done.stdout[done.stdout.index("{"):])["results"]

    def path(self, name):
        return str(self.folder / name)

    def picture_size(self, path):
        data = Path(path).read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        return struct.unpack(">II", data[16:24])

    def points(self):
        x, y = CORNER
        return {"EYE": f"{x + 3000},{y + 500} [EPSG:32632]", "LOOK": f"{x + 3000},{y + 3700} [EPSG:32632]"}

    def test_the_provider_lists_its_algorithms(self):
        listed = self.call("list").stdout
        for name in ("reveal", "mapview", "disocclude", "measure", "render"):
            self.assertIn(f"belvedere:{name}", listed)

    def test_a_route_is_revealed_measured_and_rendered(self):
        done = self.results(
            "reveal", DEM=self.path("dem.asc"), FEATURES=self.path("route.geojson"), WIDTH=320, HEIGHT=180, EYE_HEIGHT=100,
            PICTURE=self.path("a.png"), SCENE=self.path("a.toml"), VIEW=self.path("view.gpkg"), PAGE=self.path("a.html"),
            DRAPE=self.path("route.geojson"), DRAPE_SIZE=256, LABELS="true", **self.points())
        self.assertEqual(self.picture_size(done["PICTURE"]), (320, 180))
        self.assertGreater(done["VISIBLE_BENT"], 0.9)
        self.assertLess(done["VISIBLE_STRAIGHT"], done["VISIBLE_BENT"])
        for name in ("a.png.json", "a.toml", "view.gpkg", "a.html"):
            self.assertTrue((self.folder / name).is_file(), name)
        self.assertTrue((self.folder / "a_data/dem_map.png").is_file(), "the draped map lies beside the scene")

        table = self.results("measure", SCENE=self.path("a.toml"), TABLE=self.path("shares.csv"), REPORT=self.path("m.json"))
        self.assertAlmostEqual(table["VISIBLE_BENT"], done["VISIBLE_BENT"], delta=1e-3)
        self.assertIn("Valley way", (self.folder / "shares.csv").read_text())

        self.results("render", SCENE=self.path("a.toml"), KIND=2, WIDTH=320, HEIGHT=180, PICTURE=self.path("pair.png"))
        self.assertGreaterEqual(self.picture_size(self.path("pair.png"))[0], 640)

    def test_ground_makes_way(self):
        done = self.results(
            "disocclude", DEM=self.path("dem.asc"), FEATURES=self.path("route.geojson"), EYE_HEIGHT=100, OUTPUT=self.path("out.tif"),
            DISPLACEMENT=self.path("moved.tif"), MOVED=self.path("moved.gpkg"), REPORT=self.path("report.json"), EXTRA="--show 100%",
            **self.points())
        self.assertLess(done["VISIBLE_STRAIGHT"], 0.5)
        self.assertGreater(done["VISIBLE_BENT"], 0.95)
        for name in ("out.tif", "moved.tif", "moved.gpkg", "report.json"):
            self.assertGreater((self.folder / name).stat().st_size, 100, name)

    def test_the_map_is_drawn_from_an_eye(self):
        self.results(
            "mapview", DEM=self.path("dem.asc"), DRAPE=self.path("route.geojson"), DRAPE_SIZE=256, EYE_HEIGHT=600, BEND=1, WIDTH=320, HEIGHT=180,
            PICTURE=self.path("map.png"), SCENE=self.path("map.json"), **self.points())
        self.assertEqual(self.picture_size(self.path("map.png")), (320, 180))
        self.assertEqual(json.loads((self.folder / "map.json").read_text())["stage"][0]["presets"], "progressive")

    def test_a_layer_that_the_program_does_not_read_is_written_for_it(self):
        town = "delimitedtext://file://" + self.path("town.csv") + "?delimiter=,&wktField=WKT&crs=EPSG:32632"
        done = self.results(
            "reveal", DEM=self.path("dem.asc"), FEATURES=town, WIDTH=160, HEIGHT=90, PICTURE=self.path("t.png"),
            SCENE=self.path("t.toml"), EYE_HEIGHT=100, **self.points())
        self.assertTrue(list((self.folder / "t_data").glob("*.geojson")))
        self.assertEqual(done["VISIBLE_BENT"], 1.0)

    def test_the_program_says_what_is_wrong(self):
        x, y = CORNER
        done = self.run_algorithm(
            "reveal", DEM=self.path("dem.asc"), FEATURES=self.path("route.geojson"), PICTURE=self.path("no.png"),
            EYE=f"{x + 90000},{y} [EPSG:32632]", LOOK=f"{x},{y} [EPSG:32632]", EYE_HEIGHT=10)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("outside the terrain", done.stderr + done.stdout)
        self.assertFalse((self.folder / "no.png").exists())


if __name__ == "__main__":
    unittest.main()
