"""``python -m belvedere`` and the program ``belvedere``."""

from __future__ import annotations

import signal
import sys

from . import _native


def main() -> int:
    """Runs the command line; returns its exit code."""
    # Its own handler ends the work and tells what was written.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.command_line(["belvedere", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
