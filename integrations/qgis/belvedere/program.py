"""Finds the program, runs it, and reads its answer."""

import json
import os
import re
import shutil

from processing.core.ProcessingConfig import ProcessingConfig
from qgis.core import QgsProcessingException
from qgis.PyQt.QtCore import QProcess

SETTING = "BELVEDERE_PROGRAM"
PROGRESS = re.compile(r"^belvedere: (\d+) %: (.*)$")
PREFIX = "belvedere: "
POLL_MS = 100
PATIENCE_MS = 2000


def found():
    """Path of the program: the setting, the environment, the PATH, the places where installers put it."""
    asked = [ProcessingConfig.getSetting(SETTING), os.environ.get(SETTING)]
    for path in asked:
        if path:
            if os.path.isfile(path):
                return path
            raise QgsProcessingException(
                f"There is no program at {path}. Set it in Settings > Options > Processing > Providers > Belvedere."
            )
    usual = [os.path.expanduser("~/.cargo/bin/belvedere"), os.path.expanduser("~/.local/bin/belvedere")]
    for path in [shutil.which("belvedere"), *usual]:
        if path and os.path.isfile(path):
            return path
    raise QgsProcessingException(
        "The belvedere program was not found. Install it, or name it in Settings > Options > Processing > "
        "Providers > Belvedere."
    )


def _stopped():
    return getattr(QProcess, "ProcessState", QProcess).NotRunning


def _stop(process):
    """Ends the program, which leaves no half-written file."""
    process.terminate()
    if not process.waitForFinished(PATIENCE_MS):
        process.kill()
        process.waitForFinished(PATIENCE_MS)


class _Lines:
    """Cuts what the program writes into lines, whatever pieces it comes in."""

    def __init__(self, take):
        self.rest = b""
        self.take = take

    def feed(self, data):
        *lines, self.rest = (self.rest + bytes(data)).split(b"\n")
        for line in lines:
            self.take(line.decode("utf-8", "replace").rstrip("\r"))

    def end(self):
        if self.rest:
            self.take(self.rest.decode("utf-8", "replace"))


def run(arguments, feedback):
    """Runs the program with `--json` and returns its answer, a dict.

    Progress and warnings go to `feedback`, whose Cancel stops the program. Raises QgsProcessingException with the
    program's own words where it fails.
    """
    command = [found(), *arguments, "--json", "--overwrite"]
    feedback.pushCommandInfo(" ".join(command))
    out, told = [], []

    def heard(line):
        step = PROGRESS.match(line)
        if step:
            feedback.setProgress(float(step[1]))
            feedback.setProgressText(step[2])
        elif line.startswith(PREFIX + "warning: "):
            feedback.pushWarning(line[len(PREFIX + "warning: "):])
        elif line:
            told.append(line[len(PREFIX):] if line.startswith(PREFIX) else line)
            feedback.pushInfo(told[-1])

    errors = _Lines(heard)
    # Not QgsBlockingProcess: in QGIS 3.22 it calls its handlers in another thread without Python's lock.
    process = QProcess()
    process.start(command[0], command[1:])
    if not process.waitForStarted():
        raise QgsProcessingException(f"{command[0]} could not be started: {process.errorString()}.")
    while process.state() != _stopped():
        process.waitForFinished(POLL_MS)
        out.append(bytes(process.readAllStandardOutput()))
        errors.feed(process.readAllStandardError())
        if feedback.isCanceled():
            _stop(process)
    errors.end()
    code = process.exitCode()
    if feedback.isCanceled():
        raise QgsProcessingException("Cancelled.")
    if code != 0:
        raise QgsProcessingException(told[-1] if told else f"The belvedere program ended with code {code}.")
    try:
        return json.loads(b"".join(out).decode("utf-8"))
    except ValueError as error:
        raise QgsProcessingException(f"The answer of the belvedere program cannot be read: {error}.") from error
