#!/usr/bin/env python3
"""qgis_pictures.py OUT: the terrains of the sheet in QGIS 3D, drawn as a 3D map of a layout.

It needs a screen, or `xvfb-run`. The ground shows shaded heights (or the photographs) as the map would; routes are lines on it."""

import math
import os
import sys

from qgis._3d import (Qgs3D, Qgs3DMapSettings, QgsCameraPose, QgsDirectionalLightSettings, QgsLayoutItem3DMap)
from qgis.core import (Qgis, QgsApplication, QgsColorRampShader, QgsCoordinateReferenceSystem, QgsHillshadeRenderer,
                       QgsLayoutExporter, QgsLayoutPoint, QgsLayoutSize, QgsLineSymbol, QgsPrintLayout, QgsProject,
                       QgsRasterBandStats, QgsRasterDataProvider, QgsRasterLayer, QgsRasterShader, QgsReadWriteContext,
                       QgsSingleBandPseudoColorRenderer, QgsSingleSymbolRenderer, QgsUnitTypes, QgsVector3D,
                       QgsVectorLayer)
from qgis.PyQt.QtCore import QCoreApplication, Qt
from qgis.PyQt.QtGui import QColor, QPainter, QSurfaceFormat
from qgis.PyQt.QtXml import QDomDocument

from rows import rows_of, why

TINTS = ((0.0, "#7fa36b"), (0.3, "#b9c48a"), (0.55, "#d9c79a"), (0.8, "#b39a80"), (1.0, "#ffffff"))

# As the program QGIS itself does: without it Qt 3D draws nothing.
surface = QSurfaceFormat()
surface.setRenderableType(QSurfaceFormat.OpenGL)
surface.setVersion(4, 3)
surface.setProfile(QSurfaceFormat.CompatibilityProfile)
surface.setDepthBufferSize(24)
surface.setSamples(4)
surface.setStencilBufferSize(8)
QSurfaceFormat.setDefaultFormat(surface)
QCoreApplication.setAttribute(Qt.AA_ShareOpenGLContexts)

app = QgsApplication([a.encode() for a in sys.argv[:1]], True)
app.initQgis()
Qgs3D.initialize()


def smooth(layer):
    """Cubic interpolation between the samples: otherwise the shading shows their steps."""
    layer.setResamplingStage(Qgis.RasterResamplingStage.Provider)
    layer.dataProvider().enableProviderResampling(True)
    layer.dataProvider().setZoomedInResamplingMethod(QgsRasterDataProvider.ResamplingMethod.Cubic)


def ground_layers(row, terrain):
    photographs = [QgsRasterLayer(f, f"photograph {i}") for i, f in enumerate(row["files"].get("drape", []))]
    stats = terrain.dataProvider().bandStatistics(1, QgsRasterBandStats.Min | QgsRasterBandStats.Max)
    low, high = stats.minimumValue, stats.maximumValue
    ramp = QgsColorRampShader(low, high)
    ramp.setColorRampItemList([QgsColorRampShader.ColorRampItem(low + t * (high - low), QColor(c)) for t, c in TINTS])
    shader = QgsRasterShader()
    shader.setRasterShaderFunction(ramp)
    tint = QgsRasterLayer(row["files"]["terrain"], "tint")
    smooth(tint)
    tint.setRenderer(QgsSingleBandPseudoColorRenderer(tint.dataProvider(), 1, shader))
    shade = QgsRasterLayer(row["files"]["terrain"], "shade")
    smooth(shade)
    hill = QgsHillshadeRenderer(shade.dataProvider(), 1, 315, 45)
    hill.setMultiDirectional(True)
    # Files in degrees have steps of degrees and heights of metres.
    hill.setZFactor(1 / 90000.0 if shade.crs().isGeographic() else 1.0)
    shade.setRenderer(hill)
    shade.renderer().setOpacity(0.6)
    shade.setBlendMode(QPainter.CompositionMode_Multiply)
    return [*photographs, shade, tint]


def draw(row):
    view = row["view"]
    crs = QgsCoordinateReferenceSystem(row["crs"])
    project = QgsProject.instance()
    project.clear()
    project.setCrs(crs)
    terrain = QgsRasterLayer(row["files"]["terrain"], "heights")
    if not terrain.isValid():
        raise RuntimeError("the elevation model could not be read")
    layers = ground_layers(row, terrain)
    eye, forward = view["eye"], view["forward"]
    # The point on the axis of view at the height of the middle of the ground.
    stats = terrain.dataProvider().bandStatistics(1, QgsRasterBandStats.Mean)
    away = (stats.mean - eye[2]) / forward[2] if forward[2] < -0.02 else 20000.0
    point = [e + away * f for e, f in zip(eye, forward)]

    lines = QgsVectorLayer(row["lines"] + "|geometrytype=LineString", "lines")
    if lines.isValid():
        # About three pixels wide at the middle of the picture.
        line = QgsLineSymbol.createSimple({"color": "#d7301f", "width": str(3 * away / view["scale_px"]), "width_unit": "MapUnit"})
        lines.setRenderer(QgsSingleSymbolRenderer(line))
        layers.insert(0, lines)
    for layer in [terrain, *layers]:
        project.addMapLayer(layer)

    # The generator of the ground is set through XML: Python has no other way to it in QGIS 3.22.
    document = QDomDocument()
    document.setContent(f"""<qgis3d><origin x="{point[0]}" y="{point[1]}" z="0"/><camera field-of-view="{view['fov_y_deg']}"/>
      <terrain exaggeration="1" texture-size="1024" max-terrain-error="1" max-ground-error="1" terrain-rendering-enabled="1">
      <generator type="dem" layer="{terrain.id()}" resolution="64" skirt-height="10"/></terrain></qgis3d>""")
    element = document.documentElement()
    crs_element = document.createElement("crs")
    crs.writeXml(crs_element, document)
    element.appendChild(crs_element)
    settings = Qgs3DMapSettings()
    settings.setCrs(crs)
    settings.setTransformContext(project.transformContext())
    settings.readXml(element, QgsReadWriteContext())
    settings.setPathResolver(project.pathResolver())
    settings.setMapThemeCollection(project.mapThemeCollection())
    settings.setOrigin(QgsVector3D(point[0], point[1], 0))
    settings.setFieldOfView(view["fov_y_deg"])
    settings.setLayers(layers)
    settings.resolveReferences(project)
    light = QgsDirectionalLightSettings()
    light.setDirection(QgsVector3D(0.5, -0.7, 0.5))
    settings.setDirectionalLights([light])

    pose = QgsCameraPose()
    pose.setCenterPoint(QgsVector3D(0, point[2], 0))
    pose.setDistanceFromCenterPoint(abs(away))
    pose.setPitchAngle(90 + math.degrees(math.asin(forward[2])))
    pose.setHeadingAngle(-math.degrees(math.atan2(forward[0], forward[1])))     # QGIS turns against the clock

    layout = QgsPrintLayout(project)
    layout.initializeDefaults()
    layout.pageCollection().page(0).setPageSize(QgsLayoutSize(160, 100, QgsUnitTypes.LayoutMillimeters))
    item = QgsLayoutItem3DMap(layout)
    item.attemptMove(QgsLayoutPoint(0, 0))
    item.attemptResize(QgsLayoutSize(160, 100))
    item.setBackgroundColor(QColor("#c9dcef"))      # the sky, too
    item.setMapSettings(settings)
    item.setCameraPose(pose)
    layout.addLayoutItem(item)
    options = QgsLayoutExporter.ImageExportSettings()
    options.dpi = row["size"][0] / 160 * 25.4
    result = QgsLayoutExporter(layout).exportToImage(str(row["folder"] / "qgis.png"), options)
    if result != QgsLayoutExporter.Success:
        raise RuntimeError(f"the layout was not written ({result})")


for one in rows_of(sys.argv[1]):
    if one["kind"] != "terrain":
        why(one, "qgis", "not asked: no terrain" + (" (QGIS 3D reads CityJSON only with a plugin)" if one["kind"] == "town" else ""))
        continue
    try:
        draw(one)
        print(f"{one['id']}: drawn", flush=True)
    except Exception as error:
        why(one, "qgis", f"failed: {error}")
sys.stdout.flush()
os._exit(0)     # QGIS 3.22 may crash while it closes
