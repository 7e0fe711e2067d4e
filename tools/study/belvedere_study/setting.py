"""What a task is set in: layers, the views that a participant steps through, and the bend of each view."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Sequence

from .frame import Point, camera, turn
from .program import Scene
from .things import Thing

#: The two conditions, by their number in the order tables.
CONDITIONS = ("straight", "bent")


@dataclass(frozen=True)
class Bend:
    """One turn of the rays, in lengths of the scene: see `frame.turn`."""

    aside: float
    lift: float
    depths: tuple[float, float, float]


@dataclass(frozen=True)
class Setting:
    """A place with room for things."""

    kind: str
    layers: list[dict[str, Any]]
    candidates: list[Thing]
    eyes: list[Point]
    look_at: Point
    fov_y_deg: float
    bend: Bend
    size: tuple[int, int]
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def views(self) -> int:
        """How many views there are, from left to right."""
        return len(self.eyes)

    @property
    def start(self) -> int:
        """The view that is shown first."""
        return self.views // 2

    def scene(self, view: int, bent: bool, things: Sequence[Thing] = ()) -> Scene:
        """The scene of one view, with things in it; they are the last layers, in their order."""
        eye = self.eyes[view]
        scene: Scene = {
            "format": 1,
            "crs": "local",
            "layer": self.layers + [thing.layer(k) for k, thing in enumerate(things)],
            "camera": camera(eye, self.look_at, self.fov_y_deg, self.size),
            **self.more,
        }
        if bent:
            scene["stage"] = [turn(eye, self.look_at, self.bend.aside, self.bend.lift, self.bend.depths)]
        return scene

    def number(self, thing: int) -> int:
        """Number of a thing in the buffer of layers."""
        return 1 + len(self.layers) + thing


def steps(views: int, half: float) -> list[float]:
    """Places of views from left to right, evenly from -half to half."""
    return [half * (2 * k / (views - 1) - 1) for k in range(views)] if views > 1 else [0.0]
