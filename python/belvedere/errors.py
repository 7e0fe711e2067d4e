"""Exceptions of the package. Each text says what is wrong, the value, the limit, and what to do."""

from __future__ import annotations

__all__ = ["Error", "InputError", "FileError", "MemoryLimitError", "Cancelled", "InternalError"]


class Error(Exception):
    """Anything that ends a call without a result."""


class InputError(Error, ValueError):
    """A wrong argument, array, scene or preset."""


class FileError(Error, OSError):
    """A file that cannot be read or written."""


class MemoryLimitError(Error, MemoryError):
    """Work that needs more memory than is allowed, see :func:`belvedere.set_memory_limit`."""


class Cancelled(Error):
    """Work that was cancelled by other means than Ctrl-C, which raises :class:`KeyboardInterrupt`."""


class InternalError(Error, RuntimeError):
    """A fault of the engine; later calls work."""
