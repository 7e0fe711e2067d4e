"""Pictures to find something in, and to count something in: the same places, views and bends."""

from __future__ import annotations

import numpy as np

from . import city, masks, molecule, mountain
from .choosing import SEEN_PX, counted, counts, look, sought
from .program import Program
from .setting import CONDITIONS, Setting
from .store import Store
from .things import Thing
from .trying import Item, Unsuitable, first

PLACES = {"city": city.setting, "mountain": mountain.setting, "molecule": molecule.setting}


def finding(program: Program, store: Store, seed: list[int], name: str, kind: str, hidden: bool) -> Item:
    """One thing to find and click."""

    def make(rng: np.random.Generator) -> Item:
        setting = PLACES[kind](program, rng, store.size, store.views, name)
        things = sought(rng, setting, look(program, setting, setting.candidates, name), hidden)
        item = _item(name, setting, things[0])
        for condition in CONDITIONS:
            item[condition] = _drawn(program, store, setting, things, 1, condition, name)
        return item

    return first(seed, name, make)


def counting(program: Program, store: Store, seed: list[int], name: str, kind: str) -> Item:
    """Things to count."""

    def make(rng: np.random.Generator) -> Item:
        setting = PLACES[kind](program, rng, store.size, store.views, name)
        amount, things = counted(rng, setting, look(program, setting, setting.candidates, name), 4, 7)
        item = {**_item(name, setting, things[0]), "answer": amount}
        for condition in CONDITIONS:
            item[condition] = _drawn(program, store, setting, things, amount, condition, name)
            del item[condition]["targets"]
        return item

    return first(seed, name, make)


def _item(name: str, setting: Setting, asked: Thing) -> Item:
    return {"id": name, "kind": setting.kind, "what": asked.what, "colour": asked.colour, "start": setting.start}


def _drawn(
    program: Program, store: Store, setting: Setting, things: list[Thing], asked: int, condition: str, name: str
) -> Item:
    """The pictures of one condition, and what they show of the things that are asked for."""
    numbers = [setting.number(k) for k in range(len(things))]
    names, seen, targets = [], [], []
    for view in range(setting.views):
        scene = setting.scene(view, condition == "bent", things)
        picture, ids = program.picture(scene, name)
        names.append(store.keep(f"{name}-{condition}-{view}", picture))
        seen.append([round(float(px)) for px in counts(ids, setting, len(things))[:asked]])
        targets.append(masks.target(ids, numbers[0], numbers[1:]))
    # Things that were taken away hid nothing that must be seen, so this holds but for the softer rims of pixels.
    if min(max(view[k] for view in seen) for k in range(asked)) < 0.8 * SEEN_PX:
        raise Unsuitable("what is asked for is not seen")
    return {"pictures": names, "seen_px": seen, "targets": targets}
