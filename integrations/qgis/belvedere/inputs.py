"""Layers of the project as files that the program reads."""

import os
import re

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsMapRendererSequentialJob,
    QgsMapSettings,
    QgsProcessingException,
    QgsProviderRegistry,
    QgsRasterFileWriter,
    QgsRasterPipe,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

DEGREES = QgsCoordinateReferenceSystem("EPSG:4326")
READ_RASTERS = (".tif", ".tiff", ".hgt", ".asc")
READ_VECTORS = (".geojson", ".gpx", ".shp")


def place(point, height=None):
    """A point in degrees as the program reads places: 46.5N,11.3E, and +20 for 20 m above the ground."""
    x, y = point.x(), point.y()
    text = f"{abs(y):.8f}{'S' if y < 0 else 'N'},{abs(x):.8f}{'W' if x < 0 else 'E'}"
    return text if height is None else f"{text},{height:+.3f}"


def safe_name(layer, taken):
    """A file name without ending for a layer, unlike those that are taken."""
    base = re.sub(r"[^\w-]+", "_", layer.name()).strip("_") or "layer"
    name, count = base, 2
    while name.lower() in taken:
        name, count = f"{base}_{count}", count + 1
    taken.add(name.lower())
    return name


def _file(layer):
    """The file behind a layer, and the layer's name in it."""
    parts = QgsProviderRegistry.instance().decodeUri(layer.providerType(), layer.source())
    return parts.get("path") or "", parts.get("layerName") or ""


def _was_moved(layer):
    """Whether the user gave a layer another coordinate system than its file has."""
    return QgsVectorLayer(layer.source(), "as stored", layer.providerType()).crs() != layer.crs()


class Folder:
    """A folder for what has to be written, and the names that are taken in it."""

    def __init__(self, path, context):
        self.path = path
        self.context = context
        self.taken = set()

    def new(self, layer, ending):
        os.makedirs(self.path, exist_ok=True)
        return os.path.join(self.path, safe_name(layer, self.taken) + ending)

    def elevation(self, layer):
        """Arguments that name an elevation model: its file, or a GeoTIFF of its first band.

        A system that the user gave to the layer by hand counts before the one in the file.
        """
        path, _ = _file(layer)
        provider = layer.dataProvider()
        # What the user calls no data beside the file, or no longer, is known to QGIS alone.
        is_as_stored = provider.useSourceNoDataValue(1) and not provider.userNoDataValues(1)
        if layer.providerType() != "gdal" or not is_as_stored or not path.lower().endswith(READ_RASTERS) or not os.path.isfile(path):
            path = self._written_raster(layer)
        authority = layer.crs().authid()
        is_known = authority.upper().startswith("EPSG:") and not path.lower().endswith(".hgt")
        return [path, "--source-crs", authority.upper()] if is_known else [path]

    def _written_raster(self, layer):
        path = self.new(layer, ".tif")
        provider = layer.dataProvider()
        pipe = QgsRasterPipe()
        if not pipe.set(provider.clone()):
            raise QgsProcessingException(f"The elevation model {layer.name()} cannot be read.")
        writer = QgsRasterFileWriter(path)
        size = provider.xSize(), provider.ySize()
        if not all(size):
            raise QgsProcessingException(f"The elevation model {layer.name()} has no size in cells; save it as a GeoTIFF.")
        done = writer.writeRaster(pipe, *size, provider.extent(), layer.crs(), self.context.transformContext())
        if int(done) != 0:
            raise QgsProcessingException(f"The elevation model {layer.name()} could not be written to {path}.")
        return path

    def features(self, layer):
        """The file of a vector layer: its own where it holds nothing else, else GeoJSON in degrees."""
        path, name = _file(layer)
        is_whole = not layer.subsetString() and not layer.isEditable() and not name and not _was_moved(layer)
        if layer.providerType() == "ogr" and is_whole and path.lower().endswith(READ_VECTORS) and os.path.isfile(path):
            return path
        path = self.new(layer, ".geojson")
        options = QgsVectorFileWriter.SaveVectorOptions()
        options.driverName = "GeoJSON"
        options.fileEncoding = "UTF-8"
        options.layerOptions = ["COORDINATE_PRECISION=8", "RFC7946=YES"]
        options.ct = QgsCoordinateTransform(layer.crs(), DEGREES, self.context.transformContext())
        error, text, *_ = QgsVectorFileWriter.writeAsVectorFormatV3(
            layer, path, self.context.transformContext(), options
        )
        if int(error) != 0:
            raise QgsProcessingException(f"The layer {layer.name()} could not be written to {path}: {text}.")
        return path

    def map_picture(self, layers, over, longest):
        """The map of these layers, as it is styled, over the extent of a layer: a GeoTIFF-less PNG with a world file.

        * `longest`: the longer side in pixels.
        """
        extent, crs = over.extent(), over.crs()
        scale = longest / max(extent.width(), extent.height())
        size = QSize(max(1, round(extent.width() * scale)), max(1, round(extent.height() * scale)))
        settings = QgsMapSettings()
        settings.setLayers(layers)
        settings.setDestinationCrs(crs)
        settings.setTransformContext(self.context.transformContext())
        settings.setExtent(extent)
        settings.setOutputSize(size)
        settings.setBackgroundColor(QColor(255, 255, 255, 0))
        job = QgsMapRendererSequentialJob(settings)
        job.start()
        job.waitForFinished()
        path = self.new(over, "_map.png")
        if not job.renderedImage().save(path):
            raise QgsProcessingException(f"The map could not be written to {path}.")
        shown = settings.visibleExtent()
        step = shown.width() / size.width(), shown.height() / size.height()
        corner = shown.xMinimum() + step[0] / 2, shown.yMaximum() - step[1] / 2
        world = [step[0], 0.0, 0.0, -step[1], *corner]
        with open(path[:-4] + ".pgw", "w", encoding="ascii") as file:
            file.write("".join(f"{value:.12f}\n" for value in world))
        with open(path[:-4] + ".prj", "w", encoding="utf-8") as file:
            file.write(crs.toWkt(_gdal_wkt()))
        return path


def _gdal_wkt():
    try:
        return QgsCoordinateReferenceSystem.WktVariant.WKT1_GDAL
    except AttributeError:
        return QgsCoordinateReferenceSystem.WKT1_GDAL
