"""Generated mountains: huts and towers in valleys that ridges hide."""

from __future__ import annotations

from typing import Any

import numpy as np

from .frame import Frame
from .program import Program
from .setting import Bend, Setting, steps
from .survey import Plan, survey
from .things import Thing

#: Half of the built-in massif's square, a little less, so that nothing stands at its rim.
HALF_M = 7600.0
#: Steepest ground that carries a hut: rise over its reach of 200 m.
RISE_M = 190.0


def layers(seed: int) -> list[dict[str, Any]]:
    """Ground and lake of the built-in massif; tints without forests and snow, which would hide small things."""
    source = f"builtin:massif?seed={seed}&size=193"
    lake = {"color": "#8fb7c9", "outline": "#5f8799", "width_px": 1.0}
    return [
        {"id": "ground", "kind": "terrain", "source": source, "style": {"materials": False, "edge": "mat"}},
        {"id": "lake", "kind": "area", "source": source, "style": lake},
    ]


def setting(
    program: Program, rng: np.random.Generator, size: tuple[int, int], views: int, name: str
) -> Setting:
    """A massif, with huts and towers on its gentler ground, seen over the ridges in front."""
    seed, frame = int(rng.integers(1, 10000)), Frame(int(rng.integers(4)))
    plan = survey(program, layers(seed), frame, HALF_M, name)
    eyes = [frame.world(aside, -12800.0, 2700.0) for aside in steps(views, 3400.0)]
    look_at = frame.world(0.0, -2500.0, 1600.0)
    bend = Bend(0.0, 6000.0, (5300.0, 8500.0, 12000.0))
    return Setting("mountain", layers(seed), _huts(rng, plan, frame), eyes, look_at, 36.0, bend, size, {})


def _huts(rng: np.random.Generator, plan: Plan, frame: Frame) -> list[Thing]:
    kept: list[tuple[float, float]] = []
    huts: list[Thing] = []
    for _ in range(2000):
        right, ahead = float(rng.uniform(-3600, 3600)), float(rng.uniform(-6300, 1500))
        ground = plan.around(right, ahead, 200.0)
        # In valleys: lower than what is around.
        low = np.median(ground) < np.mean(plan.around(right, ahead, 1500.0)) - 60.0
        apart = all((right - r) ** 2 + (ahead - f) ** 2 > 700**2 for r, f in kept)
        if np.ptp(ground) > RISE_M or not low or not apart:
            continue
        kept.append((right, ahead))
        what = "hut" if rng.random() < 0.5 else "tower"
        huts.append(Thing(what, frame.world(right, ahead, float(np.median(ground))), float(rng.uniform(0, 90))))
        if len(huts) == 26:
            break
    return huts
