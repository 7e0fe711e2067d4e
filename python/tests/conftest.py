"""Ground and routes that several tests draw."""

from __future__ import annotations

import numpy as np
import pytest

import belvedere


def hills(rows: int = 60, columns: int = 80) -> np.ndarray:
    """Waves of hills with a ridge across the middle, metres."""
    y, x = np.mgrid[0:rows, 0:columns].astype(float)
    return 300 + 60 * np.sin(x / 9) * np.cos(y / 7) + 250 * np.exp(-(((y - 0.55 * rows) / 5) ** 2))


#: Size of a cell of the hills, metres, and a route behind the ridge, seen from the south.
CELL = 30.0
ROUTE = np.array([[300.0, 1250.0], [1200.0, 1200.0], [2100.0, 1300.0]])


@pytest.fixture
def scene() -> belvedere.Scene:
    """Hills with a route behind a ridge, bent by a spline."""
    camera = belvedere.Camera(eye=(1200.0, -1500.0, 900.0), look_at=(1200.0, 1000.0, 300.0))
    made = belvedere.Scene(camera=camera, title="Hills").add_terrain(hills(), spacing=CELL)
    made.add_lines({"path": ROUTE}, must_see=True)
    return made.add_stage("spline_bend", presets="progressive")
