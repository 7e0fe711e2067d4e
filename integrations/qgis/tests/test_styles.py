"""Styles of results, in a QGIS without a window."""

import tempfile
import unittest
from pathlib import Path

import inside
from test_headless import CORNER, PROGRAM, write_inputs


@unittest.skipUnless(inside.IS_HERE, "SKIPPED: needs the Python modules of QGIS")
class Styles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.application = inside.started()

    def raster(self, values):
        path = Path(tempfile.mkdtemp()) / "r.asc"
        head = "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
        path.write_text(head + " ".join(map(str, values)) + "\n")
        from qgis.core import QgsRasterLayer

        layer = QgsRasterLayer(str(path), "r")
        self.assertTrue(layer.isValid())
        return layer

    def test_displacement_is_as_far_from_zero_on_both_sides(self):
        from belvedere import styles

        layer = self.raster([-30.0, 0.0, 10.0])
        styles.displacement(layer)
        items = layer.renderer().shader().rasterShaderFunction().colorRampItemList()
        self.assertEqual([item.value for item in items], [-30.0, 0.0, 30.0])
        self.assertEqual(items[1].color.alpha(), 0)

    def test_ground_is_shaded(self):
        from belvedere import styles

        layer = self.raster([1.0, 2.0, 3.0])
        styles.hillshade(layer)
        self.assertEqual(layer.renderer().type(), "hillshade")

    def test_every_kind_of_feature_has_a_symbol(self):
        from qgis.core import QgsVectorLayer

        from belvedere import styles

        for kind in ("LineString", "Polygon", "Point", "MultiLineStringZ"):
            layer = QgsVectorLayer(f"{kind}?crs=EPSG:4326", "v", "memory")
            styles.route(layer)
            parts = layer.renderer().symbol().symbolLayers()
            colors = {color.name() for part in parts for color in (part.color(), part.fillColor(), part.strokeColor())}
            self.assertIn(styles.ROUTE.name(), colors, kind)

    @unittest.skipUnless(PROGRAM, "SKIPPED: needs the belvedere program")
    def test_results_are_loaded_with_their_styles(self):
        import processing
        from processing.core.Processing import Processing
        from qgis.core import QgsProject

        from belvedere.provider import Provider

        Processing.initialize()
        provider = Provider()
        self.application.processingRegistry().addProvider(provider)
        folder = Path(tempfile.mkdtemp())
        write_inputs(folder)
        x, y = CORNER
        done = processing.runAndLoadResults("belvedere:disocclude", {
            "DEM": str(folder / "dem.asc"), "FEATURES": [str(folder / "route.geojson")], "EYE_HEIGHT": 100,
            "EYE": f"{x + 3000},{y + 500} [EPSG:32632]", "LOOK": f"{x + 3000},{y + 3700} [EPSG:32632]",
            "OUTPUT": str(folder / "o.tif"), "DISPLACEMENT": str(folder / "d.tif"), "MOVED": str(folder / "m.gpkg"),
        })
        layers = {layer.source().split("|")[0]: layer.renderer().type() for layer in QgsProject.instance().mapLayers().values()}
        expected = {"OUTPUT": "hillshade", "DISPLACEMENT": "singlebandpseudocolor", "MOVED": "singleSymbol"}
        self.assertEqual({name: layers[done[name].split("|")[0]] for name in expected}, expected)
        self.application.processingRegistry().removeProvider(provider)


if __name__ == "__main__":
    unittest.main()
