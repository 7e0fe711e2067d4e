"""Who does what, when: the order of trials for every participant number, as a table that the page holds.

The page makes no orders of its own: it looks rows up, so its order is this one.
"""

from __future__ import annotations

import math
import random
from typing import Any

#: Numbers of participants after which the table begins anew: by then all that is balanced is balanced exactly.
ROWS = 240
#: Tasks of experiment A, and the task of B, by their numbers in the table.
TASKS = ("find", "count", "path", "prefer")
#: Perspectives of experiment B, by their numbers in the table.
PERSPECTIVES = ("straight", "progressive", "degressive", "hybrid")
#: The six pairs of perspectives.
PAIRS = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
#: Pairs that one participant compares, in a full and in a short session.
PAIRS_EACH = {"full": 26, "short": 13}
#: Scenes of each task of A in a short session.
SHORT_SCENES = 4

#: A trial: task, scene, and for A the condition (0 straight, 1 bent) and the map that is shown first; for B the
#: perspectives on the left and on the right.
Trial = list[int]
Table = dict[str, list[dict[str, list[Trial]]]]


def table(scenes: dict[str, int], routes: int) -> Table:
    """Trials of A and B for every row and both lengths of a session; `scenes` says how many A's tasks have."""
    made: Table = {}
    for length, pairs in PAIRS_EACH.items():
        used = {task: min(n, SHORT_SCENES) if length == "short" else n for task, n in scenes.items()}
        made[length] = [
            {"a": first(row, used), "b": second(row, routes, min(pairs, len(PAIRS) * routes))} for row in range(ROWS)
        ]
    return made


def of_kit(kit: dict[str, Any]) -> Table:
    """The table of a kit."""
    return table({task: len(kit[task]) for task in TASKS[:3]}, len(kit["prefer"]))


def first(row: int, scenes: dict[str, int]) -> list[Trial]:
    """Experiment A: the three tasks one after the other, in an order that turns from row to row."""
    turned = TASKS[row % 3 : 3] + TASKS[: row % 3]
    return [trial for task in turned for trial in _block(row, TASKS.index(task), scenes[task])]


def _block(row: int, task: int, scenes: int) -> list[Trial]:
    """One task: scenes in the order of a balanced Latin square, conditions by their place in the block. Scenes meet
    every place and, after two runs through the square, every condition at every place once."""
    order = latin(scenes)[row % scenes]
    swapped = (row // scenes) % 2
    return [
        [task, scene, fold(place) ^ swapped, (row + place) % 4 if task == 2 else 0]
        for place, scene in enumerate(order)
    ]


def second(row: int, routes: int, pairs: int) -> list[Trial]:
    """Experiment B: a window of the cycle of all pairs, which goes on where that of the row before ended. So all pairs
    are shown equally often; every time a pair returns, left and right are changed."""
    cycle = compared(routes)
    trials = []
    for at in range(row * pairs, (row + 1) * pairs):
        turn, k = divmod(at, len(cycle))
        route, pair = cycle[k]
        sides = PAIRS[pair] if (turn + k // len(PAIRS) + pair) % 2 == 0 else PAIRS[pair][::-1]
        trials.append([3, route, *sides])
    shuffle(trials, row)
    return trials


def compared(routes: int) -> list[tuple[int, int]]:
    """All pairs of all routes, as (route, pair), so that every stretch has all pairs and all routes about equally."""
    # Route and pair come round together after `period` steps; a step aside then leads on to the combinations left.
    period = math.lcm(routes, len(PAIRS))
    return [((k + k // period) % routes, k % len(PAIRS)) for k in range(len(PAIRS) * routes)]


def latin(n: int) -> list[list[int]]:
    """A Latin square; for even n every scene also follows every other once (Williams)."""
    first_row = [0]
    for k in range(1, n):
        first_row.append((first_row[-1] + (k if k % 2 else -k)) % n)
    return [[(scene + row) % n for scene in first_row] for row in range(n)]


def fold(place: int) -> int:
    """0 1 1 0 1 0 0 1 ...: conditions by place, so that neither leads, and practice and tiredness favour none."""
    return place.bit_count() % 2


def shuffle(trials: list[Trial], seed: int) -> None:
    """Fisher and Yates, with numbers that are the same in all versions of Python."""
    dice = random.Random(seed)
    for k in range(len(trials) - 1, 0, -1):
        other = int(dice.random() * (k + 1))
        trials[k], trials[other] = trials[other], trials[k]
