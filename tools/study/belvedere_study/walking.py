"""Routes to remember, and routes in four perspectives to compare."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import city
from .frame import Frame, camera
from .program import Program, Scene, Visible
from .routes import Route, maps, places, route, write
from .setting import CONDITIONS, Bend, Setting, steps
from .store import Store
from .survey import Town
from .trying import Item, Unsuitable, first

#: The perspectives that are compared, and the ready-made bend of each.
PERSPECTIVES = {
    "straight": None,
    "progressive": "progressive",
    "degressive": "degressive",
    "hybrid": "hybrid-flat-steep-flat",
}


def memory(program: Program, store: Store, seed: list[int], name: str) -> Item:
    """A route to remember: its pictures pass by themselves, then the right map of four is chosen. The bent pictures
    show more of it, and all of it is within the frame of both."""

    def make(rng: np.random.Generator) -> Item:
        town = int(rng.integers(1, 10000))
        way, streets, frame = _route(program, rng, town, 3, (0, 5), name)
        setting = _walk(store, city.layers(town) + [_line(name, "cut")], way, streets, frame)
        # The middle view first: most routes that will not do are known by it.
        views = sorted(range(store.views), key=lambda view: abs(view - setting.start))
        seen: dict[int, Visible] = {}
        for view in views:
            seen[view] = program.visible(setting.scene(view, True), name)
            if not _shown(list(seen.values())):
                raise Unsuitable("the bend shows too little of the route")
        shares = {
            "straight": [seen[view].straight for view in range(store.views)],
            "bent": [seen[view].bent for view in range(store.views)],
        }
        item: Item = {"id": name, "kind": "city", "turns": way.turns(), "maps": maps(rng, way)}
        for condition in CONDITIONS:
            item[condition] = _drawn(program, store, setting, condition, name)
            item[condition]["visible"] = [round(one, 3) for one in shares[condition]]
        return item

    return first(seed, name, make)


def _shown(seen: list[Visible]) -> bool:
    """Whether the route is within all frames, the bent pictures show most of it, and the straight ones much less."""
    in_frame = min(min(one.in_frame_straight, one.in_frame_bent) for one in seen)
    straight, bent = max(one.straight for one in seen), max(one.bent for one in seen)
    return in_frame > 0.97 and bent > 0.58 and straight < 0.7 * bent


def comparison(program: Program, store: Store, seed: list[int], name: str) -> Item:
    """A route in four perspectives from the same camera, all of it in the frame of each."""

    def make(rng: np.random.Generator) -> Item:
        town = int(rng.integers(1, 10000))
        way, streets, frame = _route(program, rng, town, int(rng.integers(2, 4)), (1, 7), name)
        eye = frame.world(float(rng.uniform(-160, 160)), streets.near_m - 560, 380.0)
        seen_from = camera(eye, frame.world(0.0, -40.0, city.GROUND_M), 40.0, store.size)
        scene: Scene = {"format": 1, "crs": "local", "camera": seen_from, **city.LIGHT}
        scene["layer"] = city.layers(town) + [_line(name, "dash")]
        bent = {one: _bent(scene, preset) for one, preset in PERSPECTIVES.items()}
        seen = {one: program.visible(bent[one], name) for one in PERSPECTIVES}
        if min(one.in_frame_bent for one in seen.values()) < 0.99:
            raise Unsuitable("the route leaves a frame")
        item: Item = {"id": name, "kind": "city", "turns": way.turns()}
        for one in PERSPECTIVES:
            picture, _ = program.picture(bent[one], name)
            kept = store.keep(f"{name}-{one}", picture)
            item[one] = {"picture": kept, "visible": round(seen[one].bent, 3)}
        return item

    return first(seed, name, make)


def _route(
    program: Program, rng: np.random.Generator, town: int, legs: int, crossings: tuple[int, int], name: str
) -> tuple[Route, Town, Frame]:
    """A route between two crossing streets of a town, laid as a file beside the scene."""
    frame = Frame(int(rng.integers(4)))
    streets = city.plan(program, town, frame, name)
    way = route(rng, streets, legs, *crossings)
    write(program.folder / f"{name}.geojson", places(way, streets, frame))
    return way, streets, frame


def _walk(store: Store, layers: list[dict[str, Any]], way: Route, streets: Town, frame: Frame) -> Setting:
    """Views that pass by a route, over the front row of houses."""
    middle = float(np.mean([streets.leading[r] for r, _ in way.crossings()]))
    eyes = [frame.world(middle + aside, streets.near_m - 620, 210.0) for aside in steps(store.views, 130.0)]
    look_at = frame.world(middle, streets.near_m + 250, 105.0)
    bend = Bend(0.0, 720.0, (530.0, 760.0, 1030.0))
    return Setting("city", layers, [], eyes, look_at, 42.0, bend, store.size, city.LIGHT)


def _bent(scene: Scene, preset: str | None) -> Scene:
    return scene if preset is None else {**scene, "stage": [{"kind": "spline_bend", "presets": preset}]}


def _drawn(program: Program, store: Store, setting: Setting, condition: str, name: str) -> Item:
    names = []
    for view in range(setting.views):
        picture, _ = program.picture(setting.scene(view, condition == "bent"), name)
        names.append(store.keep(f"{name}-{condition}-{view}", picture))
    return {"pictures": names}


def _line(name: str, hidden: str) -> dict[str, Any]:
    style = {"color": "#d7301f", "width_px": 4.0, "hidden": hidden}
    return {"id": "route", "kind": "line", "source": f"{name}.geojson", "must_see": True, "style": style}
