"""Points, pixels, rays, picks and measures."""

from __future__ import annotations

import time

import numpy as np
import pytest

import belvedere
from conftest import ROUTE


def test_points_and_pixels_lead_to_each_other(scene: belvedere.Scene) -> None:
    rays = scene.rays([[640.5, 500.5], [200.0, 600.0]], 5)
    assert rays.point.shape == (2, 5, 3) and (np.diff(rays.depth, axis=1) > 0).all()
    for i, pixel in enumerate([[640.5, 500.5], [200.0, 600.0]]):
        good = np.isfinite(rays.point[i, :, 0])
        back = scene.project(rays.point[i][good])
        np.testing.assert_allclose(back.pixel, np.broadcast_to(pixel, back.pixel.shape), atol=1e-6)
        np.testing.assert_allclose(back.depth, rays.depth[i][good], rtol=1e-9)


def test_misses_have_codes(scene: belvedere.Scene) -> None:
    found = scene.project([[1200.0, -9000.0, 900.0], [1200.0, 1000.0, 300.0]])
    assert belvedere.MISSES[found.miss[0]] == "behind_eye" and np.isnan(found.pixel[0]).all() and found.segment[0] == -1
    assert found.miss[1] == 0 and found.inside[1]
    assert scene.project(np.zeros((0, 3))).pixel.shape == (0, 2)


def test_displaced_points(scene: belvedere.Scene) -> None:
    points = np.array([[1200.0, y, 300.0] for y in (200.0, 1700.0)])
    moved = scene.displace(points)
    assert moved.point.shape == (2, 3) and np.linalg.norm(moved.point - points, axis=1).max() > 1 and not moved.folded.any()


def test_what_is_seen_at_a_pixel(scene: belvedere.Scene) -> None:
    picture = scene.render()
    row, column = np.argwhere(picture.id == 2)[0]
    on_line, sky = scene.pick([[column + 0.5, row + 0.5], [5.0, 5.0]])
    assert on_line is not None and (on_line.layer, on_line.feature) == ("lines", "path")
    assert sky is None
    assert on_line.raw["layer"] == "lines" and on_line.depth > 0


def test_measures(scene: belvedere.Scene) -> None:
    report = scene.measure(spacing_m=20.0)
    assert report.visible is not None and 0 < report.visible <= report.in_frame <= 1  # type: ignore[operator]
    assert report.stages == ("spline_bend",) and report.raw["visible"] == report.visible
    with pytest.raises(belvedere.InputError, match="spacing_m=0"):
        scene.measure(spacing_m=0.0)
    without = belvedere.Scene().add_terrain(np.ones((9, 9)), spacing=3.0)
    with pytest.raises(belvedere.InputError):
        without.measure()


def test_a_million_points_take_little_time(scene: belvedere.Scene) -> None:
    points = np.random.default_rng(7).uniform([0, 0, 200], [2400, 1800, 800], (1_000_000, 3))
    scene.project(points[:1])
    began = time.process_time()
    found = scene.project(points)
    took = time.process_time() - began
    assert found.inside.any() and took < 3.0, took
    print(f"1,000,000 points: {took:.2f} s of processor time")


@pytest.mark.parametrize("bad", ["abc", [[1.0, 2.0]], [[np.nan, 0, 0]], np.ma.masked_equal([[1.0, 2.0, 3.0]], 2.0), [[1j, 0, 0]]])
def test_bad_points_are_refused(scene: belvedere.Scene, bad: object) -> None:
    with pytest.raises(belvedere.InputError):
        scene.project(bad)


def test_geometry_comes_in_many_forms() -> None:
    ground = np.zeros((40, 60))
    line = {"type": "LineString", "coordinates": ROUTE.tolist()}

    class Shape:
        __geo_interface__ = line

    for lines in (ROUTE, [ROUTE], {"a": ROUTE}, line, Shape(), {"type": "Feature", "properties": {"n": float("nan")}, "geometry": line}):
        scene = belvedere.Scene(crs="local").add_terrain(ground, spacing=60.0).add_lines(lines, must_see=True)
        assert 2 in scene.render(size=(96, 54)).id, type(lines)
    area = np.array([[300.0, 300.0], [900.0, 300.0], [900.0, 900.0]])
    scene = belvedere.Scene().add_terrain(ground, spacing=60.0).add_areas(area).add_points({"here": (1500.0, 1000.0)})
    assert {2, 3} <= set(np.unique(scene.render(size=(192, 108)).id))
    with pytest.raises(belvedere.InputError, match="point 1 of 2 is not finite"):
        scene.add_lines([[0.0, 0.0], [1.0, np.nan]], id="l")
    with pytest.raises(belvedere.InputError, match="already"):
        scene.add_areas(area)
    with pytest.raises(belvedere.InputError, match="crs="):
        belvedere.Scene().add_terrain("builtin:massif").add_lines(ROUTE)


def test_small_local_coordinates_are_not_degrees() -> None:
    scene = belvedere.Scene().add_terrain(np.zeros((30, 30)), spacing=1.0).add_lines([[2.0, 3.0], [20.0, 22.0]])
    assert 2 in scene.render(size=(96, 54)).id
