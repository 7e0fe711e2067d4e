"""The provider: its algorithms and its one setting, the program."""

import os

from processing.core.ProcessingConfig import ProcessingConfig, Setting
from qgis.core import QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .algorithms.disocclude import Disocclude
from .algorithms.map_view import MapView
from .algorithms.measure import Measure
from .algorithms.render import Render
from .algorithms.reveal import Reveal
from .program import SETTING

ICON = os.path.join(os.path.dirname(__file__), "icon.svg")


class Provider(QgsProcessingProvider):
    """Belvedere in the Processing toolbox."""

    def id(self):
        return "belvedere"

    def name(self):
        return "Belvedere"

    def longName(self):
        return "Belvedere: pictures in which what matters is not hidden"

    def icon(self):
        return QIcon(ICON)

    def load(self):
        ProcessingConfig.settingIcons[self.name()] = self.icon()
        text = "The belvedere program (empty: found on the PATH)"
        ProcessingConfig.addSetting(Setting(self.name(), SETTING, text, "", valuetype=Setting.FILE))
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        ProcessingConfig.removeSetting(SETTING)

    def loadAlgorithms(self):
        for algorithm in (Reveal, MapView, Disocclude, Measure, Render):
            self.addAlgorithm(algorithm())
