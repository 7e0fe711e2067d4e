"""Which of the candidates become the things of a task: decided by what the views show of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from .program import Program
from .setting import CONDITIONS, Setting
from .things import COLOURS, KINDS, Thing
from .trying import Unsuitable

#: Pixels of a thing that is clearly seen, and of one that is as good as hidden, in a picture 640 pixels wide.
SEEN_PX = 34.0
HIDDEN_PX = 5.0
#: Things beside the ones that are sought or counted.
OTHERS = 12


@dataclass(frozen=True)
class Views:
    """Pixels of every thing: `[condition, view, thing]`, as if the picture were 640 pixels wide."""

    px: NDArray[Any]
    start: int

    def findable(self) -> NDArray[np.bool_]:
        """Things that some view of either condition shows clearly, so that the answer can be found in both."""
        found: NDArray[np.bool_] = (self.px.max(axis=1) >= SEEN_PX).all(axis=0)
        return found

    def hidden_at_start(self) -> NDArray[np.bool_]:
        """Things that the first straight picture hides."""
        hidden: NDArray[np.bool_] = self.px[0, self.start] <= HIDDEN_PX
        return hidden


def look(program: Program, setting: Setting, things: Sequence[Thing], name: str) -> Views:
    """Draws all views in both conditions and counts pixels."""
    px = np.zeros((len(CONDITIONS), setting.views, len(things)))
    for condition in range(len(CONDITIONS)):
        for view in range(setting.views):
            ids = program.ids(setting.scene(view, condition == 1, things), name)
            px[condition, view] = counts(ids, setting, len(things))
    return Views(px, setting.start)


def counts(ids: NDArray[Any], setting: Setting, things: int) -> NDArray[Any]:
    """Pixels of every thing in one picture, as if it were 640 pixels wide."""
    all_layers = np.bincount(ids.ravel(), minlength=setting.number(things))
    counted: NDArray[Any] = all_layers[setting.number(0) : setting.number(things)] * (640 / ids.shape[1]) ** 2
    return counted


def sought(rng: np.random.Generator, setting: Setting, views: Views, hidden: bool) -> list[Thing]:
    """The thing to find, first, and others, none of which has its colour. If `hidden`, the first straight picture does
    not show it."""
    suited = views.findable() & (views.hidden_at_start() if hidden else True)
    if not suited.any():
        raise Unsuitable("nothing to find")
    target = int(rng.choice(np.flatnonzero(suited)))
    colours = list(rng.permutation(list(COLOURS)))
    things = [replace(setting.candidates[target], colour=str(colours[0]))]
    return things + _others(rng, setting, [target], colours[1:])


def counted(rng: np.random.Generator, setting: Setting, views: Views, least: int, most: int) -> tuple[int, list[Thing]]:
    """How many there are to count, and things: first those, which alone have their colour and are all of one kind. A
    third of them, or more, is hidden in the first straight picture."""
    amount = int(rng.integers(least, most + 1))
    findable, hidden = views.findable(), views.hidden_at_start()
    for what in rng.permutation(KINDS[setting.kind]):
        kind = np.array([thing.what == what for thing in setting.candidates])
        covered, open_ = np.flatnonzero(findable & kind & hidden), np.flatnonzero(findable & kind & ~hidden)
        need = -(-amount // 3)
        if len(covered) < need or len(covered) + len(open_) < amount:
            continue
        chosen = list(rng.choice(covered, need, replace=False))
        rest = np.setdiff1d(np.concatenate([covered, open_]), chosen)
        chosen += list(rng.choice(rest, amount - need, replace=False))
        colours = list(rng.permutation(list(COLOURS)))
        things = [replace(setting.candidates[k], colour=str(colours[0])) for k in chosen]
        return amount, things + _others(rng, setting, chosen, colours[1:])
    raise Unsuitable(f"no {amount} to count")


def _others(rng: np.random.Generator, setting: Setting, taken: Sequence[int], colours: Sequence[str]) -> list[Thing]:
    free = np.setdiff1d(np.arange(len(setting.candidates)), taken)
    some = rng.permutation(free)[:OTHERS]
    return [replace(setting.candidates[k], colour=str(colours[n % len(colours)])) for n, k in enumerate(some)]
