"""How results look in the map."""

from qgis.core import (
    QgsColorRampShader,
    QgsFillSymbol,
    QgsHillshadeRenderer,
    QgsLineSymbol,
    QgsMarkerSymbol,
    QgsProcessingLayerPostProcessorInterface,
    QgsRasterBandStats,
    QgsRasterShader,
    QgsSimpleLineSymbolLayer,
    QgsSingleBandPseudoColorRenderer,
    QgsSingleSymbolRenderer,
    QgsWkbTypes,
)
from qgis.PyQt.QtGui import QColor

ROUTE = QColor("#d7301f")
RAISED, LOWERED = QColor("#b35806"), QColor("#542788")


def hillshade(layer):
    layer.setRenderer(QgsHillshadeRenderer(layer.dataProvider(), 1, 315.0, 45.0))


def displacement(layer):
    """Raised brown, lowered violet, unmoved invisible; both ends as far from zero."""
    provider = layer.dataProvider()
    stats = provider.bandStatistics(1, QgsRasterBandStats.All if hasattr(QgsRasterBandStats, "All") else _all_stats())
    reach = max(abs(stats.minimumValue), abs(stats.maximumValue)) or 1.0
    item = QgsColorRampShader.ColorRampItem
    none = QColor(255, 255, 255, 0)
    ramp = QgsColorRampShader(-reach, reach)
    ramp.setColorRampType(_interpolated())
    ramp.setColorRampItemList(
        [
            item(-reach, LOWERED, f"{-reach:.0f} m"),
            item(0.0, none, "0 m"),
            item(reach, RAISED, f"+{reach:.0f} m"),
        ]
    )
    shader = QgsRasterShader(-reach, reach)
    shader.setRasterShaderFunction(ramp)
    layer.setRenderer(QgsSingleBandPseudoColorRenderer(provider, 1, shader))


def _all_stats():
    from qgis.core import Qgis

    return Qgis.RasterBandStatistic.All


def _interpolated():
    try:
        from qgis.core import Qgis

        return Qgis.ShaderInterpolationMethod.Linear
    except AttributeError:
        return QgsColorRampShader.Interpolated


def route(layer):
    """Red over white, as in our pictures; areas and points in the same red."""
    kind = QgsWkbTypes.geometryType(layer.wkbType())
    if kind == QgsWkbTypes.LineGeometry:
        symbol = QgsLineSymbol.createSimple({"color": "white", "width": "1.2"})
        symbol.appendSymbolLayer(QgsSimpleLineSymbolLayer(ROUTE, 0.7))
    elif kind == QgsWkbTypes.PolygonGeometry:
        symbol = QgsFillSymbol.createSimple({"color": "215,48,31,40", "outline_color": ROUTE.name(), "outline_width": "0.5"})
    else:
        symbol = QgsMarkerSymbol.createSimple({"color": ROUTE.name(), "outline_color": "white", "size": "2.6"})
    layer.setRenderer(QgsSingleSymbolRenderer(symbol))


def wedge(layer):
    symbol = QgsFillSymbol.createSimple({"color": "91,127,149,60", "outline_color": "#34505f", "outline_width": "0.3"})
    layer.setRenderer(QgsSingleSymbolRenderer(symbol))


class _Styler(QgsProcessingLayerPostProcessorInterface):
    # QGIS keeps no reference to a post-processor; without one here Python would free it before it is called.
    alive = []

    def __init__(self, style):
        super().__init__()
        self.style = style
        _Styler.alive.append(self)

    def postProcessLayer(self, layer, context, feedback):
        self.style(layer)
        layer.triggerRepaint()
        _Styler.alive.remove(self)


def on_load(context, path, style):
    """Styles a result when it is loaded; does nothing where it is not loaded."""
    if path and context.willLoadLayerOnCompletion(path):
        context.layerToLoadOnCompletionDetails(path).setPostProcessor(_Styler(style))
