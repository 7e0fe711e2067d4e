"""The eye and what it sees, as a wedge on the map."""

import math

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsPointXY,
)
from qgis.PyQt.QtCore import QVariant

ARC = 24
DOUBLE = QVariant.Double


def fields():
    all_of_them = QgsFields()
    for name in ("eye_z", "azimuth_deg", "fov_x_deg", "pitch_deg"):
        all_of_them.append(QgsField(name, DOUBLE))
    return all_of_them


def crs_of(record):
    """System of a picture's record; None for local scenes."""
    crs = QgsCoordinateReferenceSystem(str(record.get("scene", {}).get("crs", "")))
    return crs if crs.isValid() else None


def wedge(record):
    """A feature: the wedge of view of a picture's record, as long as the way from the eye to the point looked at."""
    view, camera = record["view"], record["scene"]["camera"]
    eye, forward, image = view["eye"], view["forward"], view["image"]
    fov_x = 2 * math.atan(image[0] / image[1] * math.tan(math.radians(view["fov_y_deg"]) / 2))
    azimuth = math.atan2(forward[0], forward[1])
    looked = camera.get("look_at")
    is_place = isinstance(looked, list)
    length = math.dist(eye[:2], looked[:2]) if is_place else 10000.0
    ring = [QgsPointXY(eye[0], eye[1])]
    for step in range(ARC + 1):
        angle = azimuth + fov_x * (step / ARC - 0.5)
        ring.append(QgsPointXY(eye[0] + length * math.sin(angle), eye[1] + length * math.cos(angle)))
    feature = QgsFeature(fields())
    feature.setGeometry(QgsGeometry.fromPolygonXY([ring + ring[:1]]))
    pitch = -math.degrees(math.asin(max(-1.0, min(1.0, forward[2]))))
    feature.setAttributes([eye[2], math.degrees(azimuth) % 360.0, math.degrees(fov_x), pitch])
    return feature
