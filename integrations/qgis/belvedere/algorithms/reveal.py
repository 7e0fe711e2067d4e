"""A picture in which features can be seen."""

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeatureSink,
    QgsProcessing,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterPoint,
    QgsProcessingParameterRasterLayer,
    QgsWkbTypes,
)

from .. import styles, view_layer
from .base import Algorithm, number, page, percent, read_json, share

TECHNIQUES = ["spline", "terrain", "both", "curved_rays", "auto"]
TECHNIQUE_WORDS = [
    "Bend the view over the mean ground (spline)",
    "Move the ground as little as possible (terrain)",
    "Both",
    "Bend the rays around what hides most (curved rays)",
    "Try all, take the best",
]


class Reveal(Algorithm):
    """`belvedere reveal`."""

    def name(self):
        return "reveal"

    def displayName(self):
        return "Reveal features in a panorama"

    def shortHelpString(self):
        return (
            "Draws an elevation model so that routes, lakes or landmarks can be seen, by bending the view or moving the "
            "ground as little as possible. A view is chosen where no eye is given. The picture's record "
            "(PICTURE.json) says what was displaced and how far; the mark in the picture says so too.\n\n"
            "Map layers to drape: the map as it is styled here is laid over the ground.\n\n"
            "Visible shares are shares of the features' length, area or number."
        )

    def initAlgorithm(self, configuration=None):
        types = getattr(QgsProcessing, "SourceType", QgsProcessing)
        self.addParameter(QgsProcessingParameterRasterLayer("DEM", "Elevation model"))
        self.addParameter(QgsProcessingParameterMultipleLayers(
            "FEATURES", "Features that must be seen", types.TypeVectorAnyGeometry))
        self.addParameter(QgsProcessingParameterEnum("TECHNIQUE", "Technique", TECHNIQUE_WORDS, defaultValue=0))
        self.addParameter(QgsProcessingParameterPoint("EYE", "Eye (give both points, or neither: a view is chosen)", optional=True))
        self.addParameter(number("EYE_HEIGHT", "Height of the eye above the ground, metres", 300.0, 0.0, 100000.0))
        self.addParameter(QgsProcessingParameterPoint("LOOK", "Point to look at", optional=True))
        self.addSize()
        self.addParameter(QgsProcessingParameterMultipleLayers(
            "DRAPE", "Map layers to drape over the ground", types.TypeMapLayer, optional=True))
        self.addParameter(number("DRAPE_SIZE", "Longer side of the draped map, pixels", 4000, 64, 16384, whole=True))
        self.addParameter(QgsProcessingParameterBoolean("LABELS", "Write the names of lines and points", False))
        self.addExtra()
        self.addParameter(QgsProcessingParameterFileDestination("PICTURE", "Picture", "PNG (*.png)"))
        self.addParameter(QgsProcessingParameterFileDestination(
            "SCENE", "Scene file that draws the same picture", "Scene (*.toml)", optional=True, createByDefault=False))
        self.addParameter(QgsProcessingParameterFeatureSink(
            "VIEW", "Wedge of view", types.TypeVectorPolygon, optional=True, createByDefault=True))
        self.addParameter(QgsProcessingParameterFileDestination(
            "PAGE", "Page with picture and figures", "HTML (*.html)", optional=True))
        self.addOutput(QgsProcessingOutputNumber("VISIBLE_STRAIGHT", "Visible share without bend"))
        self.addOutput(QgsProcessingOutputNumber("VISIBLE_BENT", "Visible share"))

    def prepareAlgorithm(self, parameters, context, feedback):
        picture = self.out(parameters, "PICTURE", context)
        scene = self.out(parameters, "SCENE", context)
        folder = self.folder(scene, context)
        dem = self.parameterAsRasterLayer(parameters, "DEM", context)
        features = self.parameterAsLayerList(parameters, "FEATURES", context)
        path, *system = folder.elevation(dem)
        arguments = ["reveal", path, *(folder.features(layer) for layer in features), "-o", picture, *system]
        technique = TECHNIQUES[self.parameterAsEnum(parameters, "TECHNIQUE", context)]
        arguments += ["--technique", technique, *self.size(parameters, context)]
        height = self.parameterAsDouble(parameters, "EYE_HEIGHT", context)
        for option, text in (
            ("--eye", self.place(parameters, "EYE", context, height)),
            ("--look", self.place(parameters, "LOOK", context)),
            ("--scene", scene),
        ):
            arguments += [option, text] if text else []
        draped = self.parameterAsLayerList(parameters, "DRAPE", context)
        if draped:
            longest = self.parameterAsInt(parameters, "DRAPE_SIZE", context)
            arguments += ["--drape", folder.map_picture(draped, dem, longest)]
        if self.parameterAsBool(parameters, "LABELS", context):
            arguments.append("--labels")
        self.arguments = arguments + self.extra(parameters, context)
        self.given = {"PICTURE": picture, "SCENE": scene, "PAGE": self.out(parameters, "PAGE", context)}
        return True

    def processAlgorithm(self, parameters, context, feedback):
        answer = self.run_program(self.arguments, feedback)
        straight, bent = share(answer, "visible_straight"), share(answer, "visible_bent")
        results = {name: path for name, path in self.given.items() if path}
        results |= {"VISIBLE_STRAIGHT": straight, "VISIBLE_BENT": bent}
        picture = self.given["PICTURE"]
        record = read_json(picture + ".json")
        crs = view_layer.crs_of(record) or QgsCoordinateReferenceSystem()
        sink, view = self.parameterAsSink(
            parameters, "VIEW", context, view_layer.fields(), QgsWkbTypes.Polygon, crs)
        if sink is not None:
            flags = getattr(QgsFeatureSink, "Flag", QgsFeatureSink)
            sink.addFeature(view_layer.wedge(record), flags.FastInsert)
            del sink
            styles.on_load(context, view, styles.wedge)
            results["VIEW"] = view
        rows = [
            ("Visible without bend", percent(straight)),
            ("Visible", percent(bent)),
            ("View", record.get("note") or "straight: nothing is displaced"),
            ("Picture", picture),
        ]
        if self.given["PAGE"]:
            page(self.given["PAGE"], "Revealed", [picture], rows)
        feedback.pushInfo(f"Visible: {percent(straight)} without bend, {percent(bent)} with it.")
        return results
