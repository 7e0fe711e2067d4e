"""A view's own axes on the ground: to the right, and forward."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Frame:
    """Axes that are turned from east and north by whole quarters, so that streets stay along them."""

    quarter: int

    @property
    def forward(self) -> tuple[float, float]:
        """Unit vector of what lies ahead."""
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[self.quarter % 4]

    def yaw_deg(self, leading: bool) -> float:
        """Turn of a box whose length lies along streets that lead ahead, or along those that cross, degrees
        counter-clockwise."""
        return (90.0 if leading else 0.0) - 90.0 * (self.quarter % 4)

    def world(self, right: float, ahead: float, up: float) -> Point:
        """Scene coordinates."""
        x, y = self.forward
        return (right * y + ahead * x, -right * x + ahead * y, up)


def camera(eye: Point, look_at: Point, fov_y_deg: float, size: tuple[int, int]) -> dict[str, Any]:
    """A camera of a scene."""
    return {"eye": eye, "look_at": look_at, "fov_y_deg": fov_y_deg, "image": size}


def turn(eye: Point, look_at: Point, aside: float, lift: float, depths: tuple[float, float, float]) -> dict[str, Any]:
    """Curved rays with one turn: up to the first depth they are the camera's own, from the last one on they come from
    a viewpoint that stands aside of the eye (to the right) and over it."""
    at, to = np.array(eye), np.array(look_at)
    ahead = (to - at) / np.linalg.norm(to - at)
    right = np.array([ahead[1], -ahead[0], 0.0]) / math.hypot(ahead[0], ahead[1])
    viewpoint = at + right * aside + np.array([0.0, 0.0, lift])
    places = {f"t{k}": (at + ahead * depth).tolist() for k, depth in enumerate(depths)}
    only = {"viewpoint": viewpoint.tolist(), **places, "normal": ahead.tolist()}
    return {"kind": "curved_rays", "turn": [only]}
