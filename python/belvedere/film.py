"""Films: numbered frames of a moving camera."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Sequence

from . import _native
from ._ask import Progress, asked, number
from ._drawing import drawing, given
from ._json import size as size_of
from ._json import text
from .errors import InputError
from .reports import FilmReport
from .scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._requests import AnimateOptions


def animate(
    scene: Scene | str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    along: str | None = None,
    sweep_deg: tuple[float, float, float] | bool | None = None,
    turntable_deg_per_s: float | bool | None = None,
    frames: int | None = None,
    fps: float | None = None,
    speed_mps: float | None = None,
    trajectory: str | os.PathLike[str] | None = None,
    follow: str | None = None,
    marker: bool | None = None,
    clock: bool | None = None,
    profile: bool | None = None,
    furniture: bool | str | Sequence[str] | None = None,
    title: str | None = None,
    size: tuple[int, int] | None = None,
    straight: bool = False,
    compare: bool = False,
    samples: int | None = None,
    stylise: bool | tuple[float, float] = False,
    resume: bool = False,
    overwrite: bool = False,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **options: Unpack[AnimateOptions],
) -> FilmReport:
    """Draws the frames of a film, PNG, and encodes them if ``out`` ends in ``.mp4`` and ffmpeg is installed.

    * ``scene``: a scene, or the path of a scene file. ``out``: a film, with its frames in the folder beside it, or a folder.
    * ``along``: id of a line layer that the camera follows; or ``sweep_deg``: viewing angles (first, last, step), ``True``: those of the presets; or
      ``turntable_deg_per_s``: a turn, ``True``: at the usual speed; or what the scene's ``[animation]`` says.
    * ``frames``: their number; ``fps``: frames per second, 25 by default; ``speed_mps``: ground speed, metres per second of film.
    * ``trajectory``: places of the atoms of the scene's molecule over time, XTC or DCD; ``follow``: id of a layer that moves, with which the camera
      moves.
    * ``marker``, ``clock``, ``profile``: what is drawn over a film along a route. ``furniture``, ``title``: see
      :meth:`belvedere.Scene.render`.
    * ``resume``: goes on with existing frames, to the same bytes as an uninterrupted film. Ctrl-C leaves whole frames.
    * ``part``: first and last frame, counted from 0: one of several processes that draw a film into one folder, see :mod:`belvedere.batch`; a call
      without it and with ``resume`` collects the parts.
    * All other options of ``belvedere animate`` by their names (``renderer``, ``lod``, ``paper`` ...): :class:`belvedere.AnimateOptions` lists
      them.

    Raises :class:`belvedere.FileError` where frames exist already.
    """
    if not isinstance(scene, Scene):
        scene = Scene.open(scene)
    if sweep_deg is None or sweep_deg is False:
        sweep = None
    else:
        sweep = [0.0, 0.0, 0.0] if sweep_deg is True else [number("sweep_deg", v) for v in sweep_deg]
    if turntable_deg_per_s is None or turntable_deg_per_s is False:
        turn = None
    else:
        turn = 0.0 if turntable_deg_per_s is True else number("turntable_deg_per_s", turntable_deg_per_s)
    if frames is not None and (isinstance(frames, bool) or not isinstance(frames, int) or not 0 < frames < 2**32):
        raise InputError(f"frames={frames!r} is not a number of frames; give a whole number above 0")
    request = given(
        {
            **drawing(straight=straight, compare=compare, samples=samples, stylise=stylise, furniture=furniture, title=title),
            "along": along,
            "follow": follow,
            "sweep": sweep,
            "turntable": turn,
            "frames": frames,
            "fps": None if fps is None else number("fps", fps),
            "speed": None if speed_mps is None else number("speed_mps", speed_mps),
            "marker": marker,
            "clock": clock,
            "profile": profile,
            "resume": bool(resume),
            "part": None if part is None else _part(part),
            **options,
        }
    )
    paper: dict[str, Any] = {name: request.pop(name) for name in ("paper", "dpi", "margin_mm") if name in request}
    with asked(threads, progress) as ask:
        sheet, pixels = scene._sheet(size_of(size), paper)
        # The ground is solved for every frame, not on opening.
        native = scene._open({"unsolved": True, "size": pixels, "trajectory": None if trajectory is None else os.fspath(trajectory)}, ask)
        answer = _native.animate(native, os.fspath(out), text("animate", {**request, **sheet}), bool(overwrite), ask)
    return FilmReport.of(json.loads(answer))


def _part(part: object) -> list[int]:
    ends = list(part) if isinstance(part, (tuple, list)) else []
    if len(ends) != 2 or any(isinstance(end, bool) or not isinstance(end, int) for end in ends) or not 0 <= ends[0] <= ends[1]:
        raise InputError(f"part={part!r} is not a part of a film; give the first and the last frame, counted from 0, such as (0, 249)")
    return ends
