"""Visible share of the features of a scene."""

import json

from qgis.core import (
    QgsFeature,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsProcessing,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFile,
    QgsProcessingParameterFileDestination,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QVariant

from .base import Algorithm, percent, share

COLUMNS = [
    ("layer", QVariant.String),
    ("feature", QVariant.Int),
    ("name", QVariant.String),
    ("amount", QVariant.Double),
    ("unit", QVariant.String),
    ("visible_straight", QVariant.Double),
    ("visible_bent", QVariant.Double),
    ("in_frame_bent", QVariant.Double),
    ("displaced_m", QVariant.Double),
]


def row(feature):
    """A feature of the answer of `measure` as values of the columns."""
    straight, bent = feature["straight"], feature["bent"]
    return [
        feature["layer"],
        feature["feature"],
        feature.get("name"),
        feature["total"],
        feature["unit"],
        straight["visible_share"],
        bent["visible_share"],
        bent["in_frame_share"],
        feature["displacement_max"],
    ]


class Measure(Algorithm):
    """`belvedere measure`."""

    def name(self):
        return "measure"

    def displayName(self):
        return "Measure visible shares of a scene"

    def shortHelpString(self):
        return (
            "A table of the required features of a scene file (as Reveal writes it): the share of each that the "
            "straight and the bent picture show, judged by lines of sight along the rays and by the drawn depths."
        )

    def initAlgorithm(self, configuration=None):
        types = getattr(QgsProcessing, "SourceType", QgsProcessing)
        behaviours = getattr(QgsProcessingParameterFile, "Behavior", QgsProcessingParameterFile)
        self.addParameter(QgsProcessingParameterFile(
            "SCENE", "Scene file", behaviours.File, fileFilter="Scenes (*.toml *.json)"))
        self.addExtra()
        self.addParameter(QgsProcessingParameterFeatureSink("TABLE", "Visible shares", types.TypeVector))
        self.addParameter(QgsProcessingParameterFileDestination(
            "REPORT", "Report", "JSON (*.json)", optional=True, createByDefault=False))
        self.addOutput(QgsProcessingOutputNumber("VISIBLE_STRAIGHT", "Visible share without bend"))
        self.addOutput(QgsProcessingOutputNumber("VISIBLE_BENT", "Visible share"))

    def prepareAlgorithm(self, parameters, context, feedback):
        self.given = {"REPORT": self.out(parameters, "REPORT", context)}
        scene = self.parameterAsFile(parameters, "SCENE", context)
        self.arguments = ["measure", scene, *self.extra(parameters, context)]
        return True

    def processAlgorithm(self, parameters, context, feedback):
        answer = self.run_program(self.arguments, feedback)
        fields = QgsFields()
        for name, kind in COLUMNS:
            fields.append(QgsField(name, kind))
        sink, table = self.parameterAsSink(parameters, "TABLE", context, fields, QgsWkbTypes.NoGeometry)
        flags = getattr(QgsFeatureSink, "Flag", QgsFeatureSink)
        for values in map(row, answer["features"]):
            feature = QgsFeature(fields)
            feature.setAttributes(values)
            sink.addFeature(feature, flags.FastInsert)
        del sink
        results = {"TABLE": table}
        if self.given["REPORT"]:
            with open(self.given["REPORT"], "w", encoding="utf-8") as file:
                json.dump(answer, file, indent=1)
            results["REPORT"] = self.given["REPORT"]
        shares = {name: share(answer, name) for name in ("visible_straight", "visible_bent")}
        feedback.pushInfo(
            f"Visible: {percent(shares['visible_straight'])} without bend, {percent(shares['visible_bent'])} with it.")
        return results | {"VISIBLE_STRAIGHT": shares["visible_straight"], "VISIBLE_BENT": shares["visible_bent"]}
