"""Temporary folders, such as those of pages."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from pathlib import Path

from .errors import Error, FileError


def _remove(path: str, owner: int) -> None:
    # A forked process shares the folder with its parent, which goes on to use it.
    if os.getpid() == owner:
        shutil.rmtree(path, ignore_errors=True)


class Folder:
    """A temporary folder, removed with this object by the process that made it."""

    def __init__(self) -> None:
        try:
            name = os.path.realpath(tempfile.mkdtemp(prefix="belvedere-"))
        except OSError as error:
            raise FileError(f"no temporary folder can be made: {error}; set TMPDIR to a folder with room") from error
        self.path = Path(name)
        self._finalizer = weakref.finalize(self, _remove, name, os.getpid())

    def close(self) -> None:
        """Removes the folder at once."""
        self._finalizer()

    def file(self, name: str) -> Path:
        """A file of this name."""
        return self.path / name


class Named:
    """Takes the temporary folder out of the texts of errors."""

    def __init__(self, folder: str | None) -> None:
        self._folder = folder

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if self._folder is not None and isinstance(error, Error) and self._folder in str(error):
            raise type(error)(str(error).replace(self._folder + os.sep, "")) from None
