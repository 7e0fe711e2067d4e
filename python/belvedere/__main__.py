"""``python -m belvedere`` and the program ``belvedere``."""

from __future__ import annotations

import os
import signal
import sys

from . import _native


def main() -> int:
    """Runs the command line; returns its exit code."""
    # `pack` looks beside the running program, which is the interpreter of Python.
    os.environ.setdefault("BELVEDERE_WEB_APP", os.path.join(os.path.dirname(os.path.abspath(__file__)), "web"))
    # Its own handler ends the work and tells what was written.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.command_line(["belvedere", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
