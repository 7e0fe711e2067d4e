"""The picture of a scene file."""

from qgis.core import (
    QgsProcessingParameterEnum,
    QgsProcessingParameterFile,
    QgsProcessingParameterFileDestination,
)

from .base import Algorithm, page, read_json

KINDS = [[], ["--straight"], ["--compare"]]


class Render(Algorithm):
    """`belvedere render`."""

    def name(self):
        return "render"

    def displayName(self):
        return "Render a scene file"

    def shortHelpString(self):
        return "Draws a scene file of Belvedere: the bent picture, the straight one, or both side by side."

    def initAlgorithm(self, configuration=None):
        behaviours = getattr(QgsProcessingParameterFile, "Behavior", QgsProcessingParameterFile)
        self.addParameter(QgsProcessingParameterFile(
            "SCENE", "Scene file", behaviours.File, fileFilter="Scenes (*.toml *.json)"))
        self.addParameter(QgsProcessingParameterEnum(
            "KIND", "Picture", ["Bent", "Straight", "Side by side"], defaultValue=0))
        self.addSize()
        self.addExtra()
        self.addParameter(QgsProcessingParameterFileDestination("PICTURE", "Picture", "PNG (*.png)"))
        self.addParameter(QgsProcessingParameterFileDestination(
            "PAGE", "Page with picture and figures", "HTML (*.html)", optional=True))

    def prepareAlgorithm(self, parameters, context, feedback):
        self.given = {name: self.out(parameters, name, context) for name in ("PICTURE", "PAGE")}
        scene = self.parameterAsFile(parameters, "SCENE", context)
        kind = KINDS[self.parameterAsEnum(parameters, "KIND", context)]
        self.arguments = ["render", scene, "-o", self.given["PICTURE"], *kind, *self.size(parameters, context)]
        self.arguments += self.extra(parameters, context)
        return True

    def processAlgorithm(self, parameters, context, feedback):
        self.run_program(self.arguments, feedback)
        picture = self.given["PICTURE"]
        if self.given["PAGE"]:
            note = read_json(picture + ".json").get("note") or "straight view"
            page(self.given["PAGE"], "Picture", [picture], [("View", note), ("Picture", picture)])
        return {name: path for name, path in self.given.items() if path}
