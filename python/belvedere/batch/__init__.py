"""Many pictures and long films, split into tasks that depend on nothing but their words, and run side by side.

A task names a scene file by its path and hash, and what is drawn of it; it writes whole files or none. So a killed worker, a lost machine, a full
disk or Ctrl-C leave nothing half-written, and the same call again does what is missing. Where the tasks run is one argument: :class:`Local`
processes, :class:`Dask` or :class:`Ray`; all of them need folders that every worker sees under the same path.
"""

from __future__ import annotations

from ._adapters import Adapter, Dask, Local, Ray
from ._films import film
from ._pictures import pictures, sweep, tiles
from ._run import Report

__all__ = ["Adapter", "Dask", "Local", "Ray", "Report", "film", "pictures", "sweep", "tiles"]
