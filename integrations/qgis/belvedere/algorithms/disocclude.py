"""An elevation model on which features are visible."""

import json
import os
import tempfile

from qgis.core import (
    QgsField,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterPoint,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterVectorDestination,
    QgsProcessingUtils,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QVariant

from .. import styles
from .base import Algorithm, number, percent, share

MODES = ["qp", "paper", "paper+qp"]
GRIDS = ["input", "scene"]
LISTS = (QVariant.List, QVariant.StringList, QVariant.Map)


class Disocclude(Algorithm):
    """`belvedere disocclude`."""

    def name(self):
        return "disocclude"

    def displayName(self):
        return "Disocclude features of an elevation model"

    def shortHelpString(self):
        return (
            "Writes an elevation model that is moved as little as possible so that features are visible from an eye; "
            "the displacement, and the features on the moved ground with their true positions as attributes. The "
            "report names what stays hidden, and why. What would change the landscape too much is given up; the further option "
            "--show 100% shows all, whatever it costs."
        )

    def initAlgorithm(self, configuration=None):
        types = getattr(QgsProcessing, "SourceType", QgsProcessing)
        self.addParameter(QgsProcessingParameterRasterLayer("DEM", "Elevation model"))
        self.addParameter(QgsProcessingParameterMultipleLayers(
            "FEATURES", "Features that must be visible", types.TypeVectorAnyGeometry))
        self.addParameter(QgsProcessingParameterPoint("EYE", "Eye"))
        self.addParameter(number("EYE_HEIGHT", "Height of the eye above the ground, metres", 300.0, 0.0, 100000.0))
        self.addParameter(QgsProcessingParameterPoint("LOOK", "Point to look at"))
        self.addParameter(number("FOV", "Horizontal field of view, degrees", 70.0, 1.0, 179.0))
        self.addParameter(QgsProcessingParameterEnum(
            "MODE", "Solver", ["Quadratic program: guarantees visibility", "The paper's two passes", "Both"], defaultValue=0))
        self.addParameter(QgsProcessingParameterEnum(
            "GRID", "Grid of the result", ["That of the elevation model", "That of the solver: the guarantee holds exactly"],
            defaultValue=0))
        self.addExtra()
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Displaced elevation model"))
        self.addParameter(QgsProcessingParameterRasterDestination("DISPLACEMENT", "Displacement", optional=True))
        self.addParameter(QgsProcessingParameterVectorDestination(
            "MOVED", "Features on the moved ground", optional=True))
        self.addParameter(QgsProcessingParameterFileDestination(
            "REPORT", "Report", "JSON (*.json)", optional=True, createByDefault=False))
        self.addOutput(QgsProcessingOutputNumber("VISIBLE_STRAIGHT", "Visible share before"))
        self.addOutput(QgsProcessingOutputNumber("VISIBLE_BENT", "Visible share after"))

    def prepareAlgorithm(self, parameters, context, feedback):
        folder = self.folder(None, context)
        path, *system = folder.elevation(self.parameterAsRasterLayer(parameters, "DEM", context))
        features = self.parameterAsLayerList(parameters, "FEATURES", context)
        eye = self.place(parameters, "EYE", context, self.parameterAsDouble(parameters, "EYE_HEIGHT", context))
        self.given = {
            "OUTPUT": self.parameterAsOutputLayer(parameters, "OUTPUT", context),
            "DISPLACEMENT": self._layer(parameters, "DISPLACEMENT", context),
            "MOVED": self._layer(parameters, "MOVED", context),
            "REPORT": self.out(parameters, "REPORT", context),
        }
        self.arguments = [
            "disocclude", path, *(folder.features(layer) for layer in features), *system,
            "--eye", eye, "--look", self.place(parameters, "LOOK", context),
            "--fov", str(self.parameterAsDouble(parameters, "FOV", context)),
            "--mode", MODES[self.parameterAsEnum(parameters, "MODE", context)],
            "--grid", GRIDS[self.parameterAsEnum(parameters, "GRID", context)],
            *self.extra(parameters, context),
        ]
        return True

    def _layer(self, parameters, name, context):
        return self.parameterAsOutputLayer(parameters, name, context) if parameters.get(name) else None

    def processAlgorithm(self, parameters, context, feedback):
        given = self.given
        arguments = [*self.arguments, "-o", given["OUTPUT"]]
        for option, name in (("--displacement", "DISPLACEMENT"), ("--report", "REPORT")):
            arguments += [option, given[name]] if given[name] else []
        geojson = given["MOVED"]
        if geojson and not geojson.lower().endswith(".geojson"):
            # The program writes GeoJSON; QGIS chose another format, which it writes itself below.
            made = tempfile.mkdtemp(prefix="belvedere_", dir=QgsProcessingUtils.tempFolder())
            geojson = os.path.join(made, "moved.geojson")
        arguments += ["--features-out", geojson] if geojson else []
        answer = self.run_program(arguments, feedback)
        if geojson and geojson != given["MOVED"]:
            _convert(geojson, given["MOVED"], context)
        for name, style in (
            ("OUTPUT", styles.hillshade), ("DISPLACEMENT", styles.displacement), ("MOVED", styles.route)
        ):
            styles.on_load(context, given[name], style)
        straight, bent = share(answer, "visible_straight"), share(answer, "visible_bent")
        feedback.pushInfo(f"Visible: {percent(straight)} before, {percent(bent)} after.")
        results = {name: path for name, path in given.items() if path}
        return results | {"VISIBLE_STRAIGHT": straight, "VISIBLE_BENT": bent}


class _ListsAsText(QgsVectorFileWriter.FieldValueConverter):
    """True positions are lists of lists, which most formats have no field for: JSON text."""

    def __init__(self, fields):
        super().__init__()
        self.fields = fields

    def clone(self):
        return _ListsAsText(self.fields)

    def fieldDefinition(self, field):
        return QgsField(field.name(), QVariant.String) if field.type() in LISTS else QgsField(field)

    def convert(self, index, value):
        return json.dumps(value) if isinstance(value, (list, dict)) else value


def _convert(geojson, path, context):
    layer = QgsVectorLayer(geojson, "moved", "ogr")
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName = QgsVectorFileWriter.driverForExtension(os.path.splitext(path)[1])
    converter = _ListsAsText(layer.fields())
    options.fieldValueConverter = converter
    error, text, *_ = QgsVectorFileWriter.writeAsVectorFormatV3(layer, path, context.transformContext(), options)
    if int(error) != 0:
        raise QgsProcessingException(f"The features could not be written to {path}: {text}.")
