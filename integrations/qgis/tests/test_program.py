"""The program is run, heard and stopped; needs QGIS's Python modules and the program."""

import time
import unittest

import inside
from test_headless import PROGRAM


class Feedback:
    """What an algorithm tells, kept; cancels after some polls."""

    def __init__(self, cancel_after=None):
        self.told, self.polls, self.cancel_after = [], 0, cancel_after

    def isCanceled(self):
        self.polls += 1
        return self.cancel_after is not None and self.polls > self.cancel_after

    def note(self, text):
        self.told.append(str(text))

    pushCommandInfo = pushInfo = pushWarning = setProgressText = setProgress = note


@unittest.skipUnless(inside.IS_HERE and PROGRAM, "SKIPPED: needs QGIS's Python modules and the belvedere program")
class Program(unittest.TestCase):
    def setUp(self):
        inside.started()
        from belvedere import program

        self.run_program = program.run

    def test_an_answer_is_a_dict(self):
        self.assertEqual(self.run_program(["info", "builtin:massif?seed=7"], Feedback())["verb"], "info")

    def test_what_is_wrong_is_an_exception_with_the_programs_words(self):
        from qgis.core import QgsProcessingException

        with self.assertRaises(QgsProcessingException) as caught:
            self.run_program(["render", "no_such_scene.toml", "-o", "x.png"], Feedback())
        self.assertIn("no_such_scene.toml", str(caught.exception))

    def test_cancel_stops_the_program(self):
        from qgis.core import QgsProcessingException

        began = time.monotonic()
        with self.assertRaises(QgsProcessingException) as caught:
            self.run_program(["bench"], Feedback(cancel_after=3))
        self.assertIn("Cancelled", str(caught.exception))
        self.assertLess(time.monotonic() - began, 5.0)


if __name__ == "__main__":
    unittest.main()
