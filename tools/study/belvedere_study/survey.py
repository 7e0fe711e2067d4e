"""What lies where, as seen from straight above: the ground plan of a town, the heights of mountains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from .frame import Frame
from .program import Program

#: Sides of the square that is drawn, pixels.
PIXELS = 600


@dataclass(frozen=True)
class Plan:
    """A square around the origin, in the axes of a frame: rows from near to far, columns from left to right."""

    half_m: float
    layer: NDArray[Any]
    height_m: NDArray[Any]

    def index(self, metres: float) -> int:
        """Row or column of a coordinate."""
        return int(np.clip((metres + self.half_m) / (2 * self.half_m) * PIXELS, 0, PIXELS - 1))

    def around(self, right: float, ahead: float, reach_m: float) -> NDArray[Any]:
        """Heights within a square around a place."""
        rows = slice(self.index(ahead - reach_m), self.index(ahead + reach_m) + 1)
        columns = slice(self.index(right - reach_m), self.index(right + reach_m) + 1)
        return self.height_m[rows, columns]


def survey(program: Program, layers: Sequence[dict[str, Any]], frame: Frame, half_m: float, name: str) -> Plan:
    """Draws the layers from straight above, in parallel rays, with what lies ahead at the top."""
    camera = {
        "eye": (0.0, 0.0, 9000.0),
        "look_at": (0.0, 0.0, 0.0),
        "up": (*frame.forward, 0.0),
        "projection": "orthographic",
        "ortho_height_m": 2 * half_m,
        "image": (PIXELS, PIXELS),
    }
    scene = {"format": 1, "crs": "local", "layer": list(layers), "camera": camera}
    layer, world = program.ids_and_places(scene, name)
    return Plan(half_m, layer[::-1], world[::-1, :, 2])


@dataclass(frozen=True)
class Town:
    """Streets of a town on a grid: middles of those that lead ahead (by their place to the right) and of those that
    cross the view (by their distance ahead), and the rim of the town."""

    leading: list[float]
    crossing: list[float]
    near_m: float
    far_m: float


def town(plan: Plan, towers: int) -> Town:
    """Streets are the columns and rows in which no tower stands; `towers` is the number of their layer."""
    built = plan.layer == towers
    columns, rows = built.any(axis=0), built.any(axis=1)
    metres = 2 * plan.half_m / PIXELS
    edges = np.flatnonzero(rows) * metres - plan.half_m
    return Town(_gaps(columns, plan.half_m), _gaps(rows, plan.half_m), float(edges[0]), float(edges[-1] + metres))


def _gaps(built: NDArray[Any], half_m: float) -> list[float]:
    """Middles of the free stretches between the first and the last built one; narrow ones are yards, not streets."""
    metres = 2 * half_m / PIXELS
    inside = np.flatnonzero(built)
    steps = np.flatnonzero(np.diff(inside) * metres > 15)
    return [float((inside[k] + inside[k + 1] + 1) / 2 * metres - half_m) for k in steps]
