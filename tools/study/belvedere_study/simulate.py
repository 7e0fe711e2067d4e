"""Made-up populations with known effects, in the page's own order of trials: do intervals hold what they promise?"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Iterator

import numpy as np
from numpy.typing import NDArray

from . import order
from .analysis import analyse
from .records import COLUMNS, Records, Row
from .stimuli import FIND_LIMIT_S

#: Scenes of the kit that is played: those of a full kit.
SCENES = {"find": 8, "count": 6, "path": 6}
ROUTES = 10


@dataclass(frozen=True)
class Effects:
    """What is true of the population, on average over participants and scenes."""

    time_ratio: float = 0.65
    count: tuple[float, float] = (0.44, 0.90)
    path: tuple[float, float] = (0.667, 0.698)
    scores: tuple[float, ...] = (-0.30, 0.35, -0.25, 0.20)

    def known(self) -> dict[str, float]:
        """The values that the analysis should find, by the names of `estimates`."""
        known = {
            "time ratio": self.time_ratio,
            "counting": self.count[1] - self.count[0],
            "path memory": self.path[1] - self.path[0],
        }
        return known | {f"score {one}": score for one, score in zip(order.PERSPECTIVES, self.scores)}


def population(rng: np.random.Generator, table: order.Table, people: int, effects: Effects, length: str) -> Records:
    """The answers of so many participants, with the first numbers."""
    used = {task: min(n, order.SHORT_SCENES) if length == "short" else n for task, n in SCENES.items()}
    world = _World(rng, effects, used)
    rows = [row for number in range(1, people + 1) for row in _session(rng, table, number, world, length)]
    return Records(rows)


def estimates(report: dict[str, Any]) -> dict[str, dict[str, float]]:
    """All intervals of a report, by name."""
    named = {
        "time ratio": report["finding"]["ratio"],
        "counting": report["counting"]["difference"],
        "path memory": report["path_memory"]["difference"],
    }
    scores = report["preferences"]["scores"]
    return named | {f"score {one}": scores[one] for one in order.PERSPECTIVES}


def coverage(
    seed: int, populations: int, people: int, length: str = "full", effects: Effects = Effects()
) -> dict[str, dict[str, float]]:
    """In how many populations the intervals hold what is true, and the mean of the estimates. `together` are the
    intervals of a report, of which none should miss; `alone` those that would do for one statement."""
    table, known = order.table(SCENES, ROUTES), effects.known()
    count = {name: {"together": 0.0, "alone": 0.0, "mean": 0.0, "known": value} for name, value in known.items()}
    for k in range(populations):
        rng = np.random.default_rng([seed, k])
        found = estimates(analyse(population(rng, table, people, effects, length)))
        for name, value in known.items():
            one = found[name]
            count[name]["together"] += one["low"] <= value <= one["high"]
            count[name]["alone"] += one["alone_low"] <= value <= one["alone_high"]
            count[name]["mean"] += one["value"] / populations
    return count


class _World:
    """What holds for all participants: the scenes' own levels, and how much the bend helps in each."""

    def __init__(self, rng: np.random.Generator, effects: Effects, scenes: dict[str, int]) -> None:
        self.effects = effects
        self.time = math.log(9.0) + rng.normal(0, 0.35, scenes["find"])
        self.time_bent = math.log(effects.time_ratio) + _centred(rng, scenes["find"], 0.15)
        self.count = [_about(rng, p, scenes["count"], 0.10) for p in effects.count]
        self.path = [_about(rng, p, scenes["path"], 0.15) for p in effects.path]


def _session(rng: np.random.Generator, table: order.Table, number: int, world: _World, length: str) -> Iterator[Row]:
    row = table[length][(number - 1) % order.ROWS]
    speed, effect = rng.normal(0, 0.30), rng.normal(0, 0.15)
    # Bounded levels keep every chance between 0 and 1, so that the known effects hold exactly.
    skill = {"count": rng.uniform(-1, 1), "path": rng.uniform(-1, 1)}
    taste = _centred(rng, len(order.PERSPECTIVES), 0.25)
    for position, (task, scene, one, two) in enumerate(row["a"] + row["b"], start=1):
        common = {"participant": str(number), "position": str(position), "task": order.TASKS[task]}
        if task == 0:
            time = world.time[scene] + speed + rng.normal(0, 0.55) + one * (world.time_bent[scene] + effect)
            answer = _searched(math.exp(time))
        elif task == 3:
            answer = _preferred(rng, world, taste, one, two)
        else:
            name = order.TASKS[task]
            chances = (world.count if task == 1 else world.path)[one]
            room = 0.5 * min(chances[scene], 1 - chances[scene])
            answer = {"correct": str(int(rng.random() < chances[scene] + room * skill[name])), "time_ms": "8000"}
        scene_name = f"{order.TASKS[task]}-{scene + 1}"
        condition = "" if task == 3 else ("straight", "bent")[one]
        yield {**dict.fromkeys(COLUMNS, ""), **common, "scene": scene_name, "condition": condition, **answer}


def _searched(seconds: float) -> Row:
    """A time, cut off as the page does."""
    found = seconds < FIND_LIMIT_S
    return {"time_ms": f"{1000 * min(seconds, FIND_LIMIT_S):.0f}", "correct": str(int(found))}


def _preferred(rng: np.random.Generator, world: _World, taste: NDArray[Any], left: int, right: int) -> Row:
    """An answer of five steps whose mean is the difference of the scores, and a slight liking for the left side."""
    scores = np.array(world.effects.scores) + taste
    mean = float(np.clip(scores[right] - scores[left] - 0.08, -1.95, 1.95))
    answer = rng.binomial(4, (mean + 2) / 4) - 2
    sides = {"left": order.PERSPECTIVES[left], "right": order.PERSPECTIVES[right]}
    return {**sides, "answer": str(answer), "time_ms": "4000"}


def _centred(rng: np.random.Generator, n: int, spread: float) -> NDArray[Any]:
    values = rng.normal(0, spread, n)
    return np.asarray(values - values.mean())


def _about(rng: np.random.Generator, chance: float, n: int, spread: float) -> NDArray[Any]:
    """Chances of n scenes with the given mean, none outside 0.02 to 0.98."""
    values = _centred(rng, n, spread)
    room = min(chance, 1 - chance) - 0.02
    return np.asarray(chance + values * min(1.0, room / np.abs(values).max()))
