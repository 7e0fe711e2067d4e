"""The map seen from an eye in the landscape."""

import json
import os

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterPoint,
    QgsProcessingParameterRasterLayer,
)

from ..inputs import DEGREES
from .base import Algorithm, number, page, read_json

BENDS = [
    ("None: straight", []),
    ("A map in front, a horizon behind (progressive)", ["progressive"]),
    ("A close view in front, a map of what lies ahead (degressive)", ["degressive"]),
    ("A map between a close view and a horizon (hybrid)", ["hybrid-flat-steep-flat"]),
    ("A close view between two maps (hybrid)", ["hybrid-steep-flat-steep"]),
]


class MapView(Algorithm):
    """A scene of an elevation model and the map on it, and `belvedere render`."""

    def name(self):
        return "mapview"

    def displayName(self):
        return "Draw the map from an eye"

    def shortHelpString(self):
        return (
            "Lays the map layers, as they are styled here, over an elevation model, and draws them from an eye: straight, "
            "or as a panorama whose foreground or background is tilted towards the reader. The scene file that is kept "
            "opens in the application of Belvedere."
        )

    def initAlgorithm(self, configuration=None):
        types = getattr(QgsProcessing, "SourceType", QgsProcessing)
        self.addParameter(QgsProcessingParameterRasterLayer("DEM", "Elevation model"))
        self.addParameter(QgsProcessingParameterMultipleLayers(
            "DRAPE", "Map layers to drape over the ground", types.TypeMapLayer, optional=True))
        self.addParameter(number("DRAPE_SIZE", "Longer side of the draped map, pixels", 4000, 64, 16384, whole=True))
        self.addParameter(QgsProcessingParameterPoint("EYE", "Eye"))
        self.addParameter(number("EYE_HEIGHT", "Height of the eye above the ground, metres", 300.0, 0.0, 100000.0))
        self.addParameter(QgsProcessingParameterPoint("LOOK", "Point to look at"))
        self.addParameter(number("FOV", "Vertical field of view, degrees", 45.0, 1.0, 170.0))
        self.addParameter(QgsProcessingParameterEnum(
            "BEND", "Bend", [words for words, _ in BENDS], defaultValue=0))
        self.addParameter(QgsProcessingParameterBoolean("CURVED_EARTH", "Curved earth", False))
        self.addSize()
        self.addExtra()
        self.addParameter(QgsProcessingParameterFileDestination("PICTURE", "Picture", "PNG (*.png)"))
        self.addParameter(QgsProcessingParameterFileDestination(
            "SCENE", "Scene file", "Scene (*.json)", optional=True, createByDefault=False))
        self.addParameter(QgsProcessingParameterFileDestination(
            "PAGE", "Page with the picture", "HTML (*.html)", optional=True))

    def prepareAlgorithm(self, parameters, context, feedback):
        self.given = {name: self.out(parameters, name, context) for name in ("PICTURE", "SCENE", "PAGE")}
        folder = self.folder(self.given["SCENE"], context)
        dem = self.parameterAsRasterLayer(parameters, "DEM", context)
        path, *system = folder.elevation(dem)
        ground = {"kind": "terrain", "id": "ground", "source": path}
        if system:
            ground["source_crs"] = system[1]
        draped = self.parameterAsLayerList(parameters, "DRAPE", context)
        if draped:
            ground["drape"] = folder.map_picture(draped, dem, self.parameterAsInt(parameters, "DRAPE_SIZE", context))
        camera = {
            "eye": self._point(parameters, "EYE", context, self.parameterAsDouble(parameters, "EYE_HEIGHT", context)),
            "look_at": self._point(parameters, "LOOK", context, 0.0),
            "fov_y_deg": self.parameterAsDouble(parameters, "FOV", context),
        }
        scene = {"format": 1, "title": "Map", "crs": "auto", "layer": [ground], "camera": camera}
        if self.parameterAsBool(parameters, "CURVED_EARTH", context):
            scene["earth"] = "curved"
        _, bend = BENDS[self.parameterAsEnum(parameters, "BEND", context)]
        scene["stage"] = [{"kind": "spline_bend", "presets": preset} for preset in bend]
        file = self.given["SCENE"] or os.path.join(folder.path, "scene.json")
        os.makedirs(os.path.dirname(os.path.abspath(file)), exist_ok=True)
        with open(file, "w", encoding="utf-8") as out:
            json.dump(scene, out, indent=1)
        roots = {os.path.dirname(os.path.abspath(one)) for one in (path, ground.get("drape")) if one}
        allowed = [word for root in sorted(roots) for word in ("--allow-root", root)]
        self.arguments = ["render", file, "-o", self.given["PICTURE"], *allowed, *self.size(parameters, context)]
        self.arguments += self.extra(parameters, context)
        return True

    def _point(self, parameters, name, context, above):
        point = self.parameterAsPoint(parameters, name, context, DEGREES)
        if point.isEmpty():
            raise QgsProcessingException(f"{name} is missing; click a point on the map.")
        return {"lon": point.x(), "lat": point.y(), "above_ground_m": above}

    def processAlgorithm(self, parameters, context, feedback):
        self.run_program(self.arguments, feedback)
        picture = self.given["PICTURE"]
        if self.given["PAGE"]:
            note = read_json(picture + ".json").get("note") or "straight view"
            page(self.given["PAGE"], "Map", [picture], [("View", note), ("Picture", picture)])
        return {name: path for name, path in self.given.items() if path}
