"""What the algorithms share."""

import html
import json
import os
import shlex
import tempfile

from qgis.core import (
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
    QgsProcessingUtils,
)
from qgis.PyQt.QtGui import QIcon

from .. import inputs
from ..program import run

ICON = os.path.join(os.path.dirname(os.path.dirname(__file__)), "icon.svg")
EXTRA = "EXTRA"


def number(name, text, default=None, low=None, high=None, whole=False, optional=False):
    """A parameter that is a number."""
    kinds = QgsProcessingParameterNumber.Type
    one = QgsProcessingParameterNumber(name, text, kinds.Integer if whole else kinds.Double, default, optional)
    if low is not None:
        one.setMinimum(low)
    if high is not None:
        one.setMaximum(high)
    return one


class Algorithm(QgsProcessingAlgorithm):
    """An algorithm whose layers are read in the main thread and whose work is one run of the program."""

    def __init__(self):
        super().__init__()
        self.arguments = []
        self.given = {}

    def createInstance(self):
        return type(self)()

    def group(self):
        return ""

    def groupId(self):
        return ""

    def icon(self):
        return QIcon(ICON)

    def addSize(self):
        self.addParameter(number("WIDTH", "Width of the picture, pixels", 1600, 16, 16384, whole=True))
        self.addParameter(number("HEIGHT", "Height of the picture, pixels", 900, 16, 16384, whole=True))

    def addExtra(self):
        text = QgsProcessingParameterString(EXTRA, "More options of the program, as on its command line", "", optional=True)
        flags = getattr(QgsProcessingParameterDefinition, "Flag", QgsProcessingParameterDefinition)
        text.setFlags(text.flags() | flags.FlagAdvanced)
        self.addParameter(text)

    def size(self, parameters, context):
        width, height = (self.parameterAsInt(parameters, name, context) for name in ("WIDTH", "HEIGHT"))
        return ["--size", f"{width}x{height}"]

    def extra(self, parameters, context):
        text = self.parameterAsString(parameters, EXTRA, context)
        try:
            return shlex.split(text or "")
        except ValueError as error:
            raise QgsProcessingException(f"More options: {error}: {text}") from error

    def place(self, parameters, name, context, height=None):
        """A point parameter in the program's words; None if it is not given."""
        if parameters.get(name) in (None, ""):
            return None
        return inputs.place(self.parameterAsPoint(parameters, name, context, inputs.DEGREES), height)

    def folder(self, beside, context):
        """A folder for layers that have to be written: beside a kept result, else a temporary one."""
        if beside:
            return inputs.Folder(os.path.splitext(beside)[0] + "_data", context)
        return inputs.Folder(tempfile.mkdtemp(prefix="belvedere_", dir=QgsProcessingUtils.tempFolder()), context)

    def out(self, parameters, name, context):
        """Path of an optional output, with its folder made; None if it is not asked for."""
        if parameters.get(name) in (None, "") and name not in self._usual():
            return None
        path = self.parameterAsFileOutput(parameters, name, context)
        if path:
            os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
        return path or None

    def _usual(self):
        return [one.name() for one in self.parameterDefinitions() if one.isDestination() and one.createByDefault()]

    def run_program(self, arguments, feedback):
        return run(arguments, feedback)


def share(answer, name):
    """A share at the top of an answer, 0 to 1; None if there is none.

    * `name`: `visible_straight` or `visible_bent`.
    """
    value = answer.get(name)
    return None if value is None else float(value)


def percent(value):
    return "not measured" if value is None else f"{100 * value:.1f} %"


def page(path, title, pictures, rows):
    """An HTML page with pictures and a table, for the results viewer."""
    body = [f"<h2>{html.escape(title)}</h2>"]
    body += [f"<p><img src='{html.escape(os.path.basename(p) if os.path.dirname(p) == os.path.dirname(path) else 'file://' + p)}' width='100%'></p>" for p in pictures]
    body.append("<table>")
    body += [f"<tr><td>{html.escape(str(a))}</td><td>{html.escape(str(b))}</td></tr>" for a, b in rows]
    body.append("</table>")
    with open(path, "w", encoding="utf-8") as file:
        file.write("<!DOCTYPE html><meta charset='utf-8'>\n" + "\n".join(body) + "\n")


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)
