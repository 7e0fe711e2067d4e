"""Generated double helices: balls behind one that stands upright."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .frame import Point
from .program import Program
from .setting import Bend, Setting, steps
from .things import Thing

#: Where the helix that lies behind everything is, angstrom.
BEHIND_Y = 66.0
#: Middle of the whole, about which the views go round, and the distance of the eye.
MIDDLE: Point = (0.0, 14.0, 0.0)
DISTANCE = 126.0


def layers(rng: np.random.Generator) -> list[dict[str, Any]]:
    """An upright helix, and one that lies behind it, in two greys."""
    standing = {"rotate_deg": (0.0, 0.0, float(rng.uniform(0, 360)))}
    lying = {"rotate_deg": (float(rng.uniform(0, 360)), 90.0, 0.0), "translate": (0.0, BEHIND_Y, 0.0)}
    return [
        _helix("front", 19, int(rng.integers(1, 10000)), "#b4b8bf", standing),
        _helix("behind", 30, int(rng.integers(1, 10000)), "#8f95a0", lying),
    ]


def setting(
    program: Program, rng: np.random.Generator, size: tuple[int, int], views: int, name: str
) -> Setting:
    """Helices with balls between them, seen past the front one."""
    angles = [math.radians(angle) for angle in steps(views, 30.0)]
    eyes = [
        (MIDDLE[0] + DISTANCE * math.sin(a), MIDDLE[1] - DISTANCE * math.cos(a), MIDDLE[2] + 8.0) for a in angles
    ]
    side = float(rng.choice([-1.0, 1.0]))
    bend = Bend(side * 150.0, 30.0, (126.0, 136.0, 146.0))
    more = {"unit": "angstrom"}
    return Setting("molecule", layers(rng), _balls(rng), eyes, MIDDLE, 34.0, bend, size, more)


def _balls(rng: np.random.Generator) -> list[Thing]:
    kept: list[tuple[float, float, float]] = []
    balls: list[Thing] = []
    for _ in range(800):
        place = (float(rng.uniform(-17, 17)), float(rng.uniform(17, 48)), float(rng.uniform(-27, 27)))
        if all(math.dist(place, other) > 9.5 for other in kept):
            kept.append(place)
            balls.append(Thing("ball", place))
        if len(balls) == 20:
            break
    return balls


def _helix(name: str, pairs: int, seed: int, colour: str, place: dict[str, Any]) -> dict[str, Any]:
    return {
        "id": name,
        "kind": "molecule",
        "source": f"builtin:dna?pairs={pairs}&seed={seed}",
        "style": {"representation": "space_filling", "color": colour, "detail": 2},
        "transform": place,
    }
