"""The camera of a scene."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Mapping, Sequence, Union

from .errors import InputError

#: ``(x, y, z)`` in scene coordinates, or ``{"lon": .., "lat": .., "above_ground_m": ..}``, or ``{"x": .., "y": .., "above_ground_m": ..}``.
Point = Union[Sequence[float], Mapping[str, float]]


@dataclass(frozen=True)
class Camera:
    """A pinhole: an eye, and either the point that it looks at or a direction."""

    #: Position of the eye.
    eye: Point
    #: Point on the optical axis.
    look_at: Point | None = None
    #: Direction instead of ``look_at``: degrees clockwise from north, and below the horizon.
    heading_deg: float | None = None
    pitch_deg: float | None = None
    #: Full vertical field of view, degrees, in (0, 180).
    fov_y_deg: float = 45.0
    #: Upright direction.
    up: Sequence[float] = (0.0, 0.0, 1.0)
    #: Nearest drawn depth, and farthest, scene units.
    near: float = 1.0
    far: float | None = None
    #: Height of an orthographic picture, scene units; ``None`` = perspective.
    ortho_height_m: float | None = None

    def document(self) -> dict[str, Any]:
        """The table ``[camera]`` of a scene file."""
        table = {key: value for key, value in asdict(self).items() if value is not None}
        if self.ortho_height_m is not None:
            table["projection"] = "orthographic"
        return table


def camera_document(camera: Camera | Mapping[str, Any]) -> dict[str, Any]:
    """The table of a camera."""
    if isinstance(camera, Camera):
        return camera.document()
    if isinstance(camera, Mapping):
        return dict(camera)
    raise InputError(f"camera={camera!r} is no camera; give belvedere.Camera(eye=.., look_at=..), or a dictionary of those keys")
