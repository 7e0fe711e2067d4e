"""Things to find and to count, as layers of scenes: one layer each, so that the buffer of layers tells them apart."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .frame import Point

#: Saturated colours, of different lightness, which no house, meadow or helix has; without green, so that the
#: colour-blind can tell them apart.
COLOURS = {"red": "#e3120b", "yellow": "#ffd500", "blue": "#0b3cff", "pink": "#ff5fd7"}

#: Sizes of upright bodies in metres: blocks of (length, width, height, height of their foot), the length along the way.
_BODIES: dict[str, list[tuple[float, float, float, float]]] = {
    "car": [(10.0, 6.0, 3.0, 0.0), (5.0, 5.4, 2.4, 3.0)],
    "bus": [(22.0, 7.0, 8.0, 0.0)],
    "hut": [(380.0, 280.0, 190.0, -80.0)],
    "tower": [(140.0, 140.0, 440.0, -80.0)],
}
_ATOMS = {"ball": "1\n\nCs 0 0 0\n"}

#: Things by what they stand in.
KINDS = {"city": ("car", "bus"), "mountain": ("hut", "tower"), "molecule": ("ball",)}


@dataclass(frozen=True)
class Thing:
    """One thing at its place; its colour is chosen later."""

    what: str
    at: Point
    yaw_deg: float = 0.0
    colour: str = "red"

    def layer(self, number: int) -> dict[str, Any]:
        """The layer that shows it."""
        name, colour = f"thing-{number}", COLOURS[self.colour]
        if self.what in _ATOMS:
            style = {"representation": "space_filling", "color": colour}
            place = {"translate": self.at, "rotate_deg": (0.0, 0.0, self.yaw_deg)}
            return {"id": name, "kind": "molecule", "source": f"{self.what}.xyz", "style": style, "transform": place}
        boxes = [
            {
                "base": (self.at[0], self.at[1], self.at[2] + foot),
                "size": (length, width, height),
                "yaw_deg": self.yaw_deg,
                "color": colour,
            }
            for length, width, height, foot in _BODIES[self.what]
        ]
        return {"id": name, "kind": "boxes", "boxes": boxes}


def lay_atoms(folder: Path) -> None:
    """Writes the files that layers of atoms name."""
    for what, text in _ATOMS.items():
        (folder / f"{what}.xyz").write_text(text, encoding="utf-8")
