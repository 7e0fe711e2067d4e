"""Generated towns: cars and buses in streets that the front row of houses hides."""

from __future__ import annotations

from typing import Any

import numpy as np

from .frame import Frame
from .program import Program
from .setting import Bend, Setting, steps
from .survey import Town, survey, town
from .things import Thing

#: Half of the square that is surveyed; towns are less than 1000 m wide.
HALF_M = 560.0
GROUND_M = 12.0
LIGHT = {"light": {"azimuth_deg": 300, "altitude_deg": 48, "shadows": True}}
#: Number of the layer of houses in the buffer of layers.
TOWERS = 4


def layers(seed: int) -> list[dict[str, Any]]:
    """Ground, blocks, parks and houses of the built-in town."""
    source = f"builtin:street?seed={seed}"
    ground = {"palette": "plain", "relief": "none"}
    return [
        {"id": "ground", "kind": "terrain", "source": source, "style": ground},
        {"id": "blocks", "kind": "area", "source": f"{source}&layer=blocks", "style": _area("#ded9cf")},
        {"id": "parks", "kind": "area", "source": f"{source}&layer=parks", "style": _area("#92b278")},
        {"id": "towers", "kind": "boxes", "source": source},
    ]


def plan(program: Program, seed: int, frame: Frame, name: str) -> Town:
    """Streets of the town in the axes of a frame."""
    return town(survey(program, layers(seed), frame, HALF_M, name), TOWERS)


def setting(
    program: Program, rng: np.random.Generator, size: tuple[int, int], views: int, name: str
) -> Setting:
    """A town, with vehicles where they may stand, seen over its front row of houses."""
    seed, frame = int(rng.integers(1, 10000)), Frame(int(rng.integers(4)))
    streets = plan(program, seed, frame, name)
    middle = float(rng.uniform(-70, 70))
    eyes = [frame.world(middle + aside, streets.near_m - 235, 98.0) for aside in steps(views, 190.0)]
    look_at = frame.world(middle, streets.near_m + 205, 42.0)
    vehicles = _vehicles(rng, streets, frame, middle)
    bend = Bend(0.0, 390.0, (185.0, 370.0, 560.0))
    return Setting("city", layers(seed), vehicles, eyes, look_at, 38.0, bend, size, LIGHT)


def _vehicles(rng: np.random.Generator, streets: Town, frame: Frame, middle: float) -> list[Thing]:
    """Cars and buses along the streets of the near part, apart from each other, a lane from the middle."""
    kept: list[tuple[float, float]] = []
    vehicles: list[Thing] = []
    leading = [r for r in streets.leading if abs(r - middle) < 210]
    crossing = [f for f in streets.crossing if f < streets.near_m + 330]
    for _ in range(400):
        lane = float(rng.choice([-4.5, 4.5]))
        # Most stand in streets that cross the view: those that lead ahead hide little.
        along = bool(rng.random() < 0.3)
        if along:
            right, ahead = float(rng.choice(leading)) + lane, streets.near_m + float(rng.uniform(0, 330))
        else:
            right, ahead = middle + float(rng.uniform(-210, 210)), float(rng.choice(crossing)) + lane
        if all((right - r) ** 2 + (ahead - f) ** 2 > 30**2 for r, f in kept):
            kept.append((right, ahead))
            what = "bus" if rng.random() < 0.5 else "car"
            vehicles.append(Thing(what, frame.world(right, ahead, GROUND_M), frame.yaw_deg(along)))
        if len(vehicles) == 30:
            break
    return vehicles


def _area(colour: str) -> dict[str, Any]:
    return {"color": colour, "water": False}
