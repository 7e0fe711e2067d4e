"""Routes through the streets of a town, and maps of them, right and wrong."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .frame import Frame
from .survey import Town
from .trying import Unsuitable

#: Steps between crossings: to the right and ahead.
Step = tuple[int, int]
#: A map: corners in blocks, the first at (0, 0), what lies ahead upwards.
Map = list[tuple[int, int]]


@dataclass(frozen=True)
class Route:
    """A way from crossing to crossing: ahead, aside, ahead, aside, ..., ahead."""

    start: Step
    steps: list[Step]

    def crossings(self) -> list[Step]:
        """The corners of the way, as numbers of streets."""
        right, ahead = self.start
        corners = [(right, ahead)]
        for step in self.steps:
            right, ahead = right + step[0], ahead + step[1]
            corners.append((right, ahead))
        return corners

    def turns(self) -> str:
        """The turns in their order, L or R."""
        return "".join("LR"[(a[1] > 0) == (b[0] > 0) if a[1] else a[0] < 0] for a, b in zip(self.steps, self.steps[1:]))


def route(rng: np.random.Generator, streets: Town, legs: int, first: int, last: int) -> Route:
    """A way with so many legs aside, from the crossing street `first` to `last` or one before it."""
    for _ in range(1000):
        right, ahead = int(rng.integers(len(streets.leading))), first
        start, steps = (right, ahead), []
        for leg in range(2 * legs + 1):
            if leg % 2:
                step = (int(rng.choice([-2, -1, 1, 2])), 0)
            else:
                step = (0, 1 + int(rng.random() < 0.25))
            right, ahead = right + step[0], ahead + step[1]
            steps.append(step)
        found = Route(start, steps)
        aside = [corner[0] for corner in found.crossings()]
        if min(aside) >= 1 and max(aside) <= len(streets.leading) - 2 and ahead <= last:
            return found
    raise Unsuitable("no room for such a route")


def maps(rng: np.random.Generator, way: Route) -> list[Map]:
    """Four maps, the right one first. The others have one of two legs aside, or both, on the other side: so each of
    the four differs from the rest in the same way, and none can be told by comparing them."""
    aside = [k for k, step in enumerate(way.steps) if step[0]]
    one, two = (int(k) for k in rng.permutation(aside)[:2])
    return [_drawn(_flipped(way.steps, legs)) for legs in ((), (one,), (two,), (one, two))]


def places(way: Route, streets: Town, frame: Frame) -> list[tuple[float, float]]:
    """The way in scene coordinates, with its corners cut by a few metres."""
    corners = [np.array([streets.leading[r], streets.crossing[f]]) for r, f in way.crossings()]
    line = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:]):
        line += [corner + 6.0 * _unit(before - corner), corner + 6.0 * _unit(after - corner)]
    line.append(corners[-1])
    return [frame.world(float(r), float(f), 0.0)[:2] for r, f in line]


def write(file: Path, line: list[tuple[float, float]]) -> None:
    """A line as a file of a scene without georeference."""
    geometry = {"type": "LineString", "coordinates": line}
    feature = {"type": "Feature", "properties": {"name": "route"}, "geometry": geometry}
    system = {"type": "name", "properties": {"name": "local"}}
    collection = {"type": "FeatureCollection", "crs": system, "features": [feature]}
    file.write_text(json.dumps(collection), encoding="utf-8")


def _flipped(steps: list[Step], legs: tuple[int, ...]) -> list[Step]:
    return [(-step[0], step[1]) if k in legs else step for k, step in enumerate(steps)]


def _drawn(steps: list[Step]) -> Map:
    return Route((0, 0), steps).crossings()


def _unit(vector: np.ndarray) -> np.ndarray:
    length = float(np.hypot(*vector))
    return vector / length if length > 0 else vector
