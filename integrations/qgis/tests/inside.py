"""QGIS inside this process, without a window; `IS_HERE` is false where its Python modules are missing."""

import os
import sys
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
try:
    from qgis.core import QgsApplication

    IS_HERE = True
except ImportError:
    IS_HERE = False

_application = None


def started():
    """The application; kept, since layers need it until the last test has ended."""
    global _application
    if _application is None:
        _application = QgsApplication([], False)
        _application.initQgis()
        sys.path[:0] = [str(Path(__file__).resolve().parent.parent)]
        sys.path.append(os.path.join(_application.pkgDataPath(), "python", "plugins"))
    return _application
