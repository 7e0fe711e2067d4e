"""Pictures in which what matters is not hidden.

``reveal`` draws terrain so that routes can be seen; ``Scene`` holds everything that the command line and scene files know. Lengths are metres in
scenes with terrain, angstrom in those with atoms; angles are degrees where a name ends in ``_deg``; the first row of an array is the northernmost,
or the top of a picture.
"""

from __future__ import annotations

from . import presets, reports
from ._native import version as _version
from ._requests import AnimateOptions, DisoccludeOptions, RenderOptions, RevealOptions
from .camera import Camera
from .drafting import Draft, Drafts, drafts
from .errors import Cancelled, Error, FileError, InputError, InternalError, MemoryLimitError
from .film import animate
from .generalising import Generalised, generalise
from .picture import Picture, set_memory_limit
from .revealing import Revealed, reveal
from .scene import MISSES, Displaced, Projected, Rays, Scene
from .terrain import Ground, disocclude
from .viewing import View, pack, view

__version__ = _version()

__all__ = [
    "MISSES",
    "Camera",
    "Cancelled",
    "Displaced",
    "Draft",
    "Drafts",
    "Error",
    "FileError",
    "Generalised",
    "Ground",
    "InputError",
    "InternalError",
    "MemoryLimitError",
    "Picture",
    "Projected",
    "Rays",
    "AnimateOptions",
    "DisoccludeOptions",
    "RenderOptions",
    "RevealOptions",
    "Revealed",
    "Scene",
    "View",
    "animate",
    "disocclude",
    "drafts",
    "generalise",
    "pack",
    "presets",
    "reports",
    "reveal",
    "set_memory_limit",
    "view",
]
