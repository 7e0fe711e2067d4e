"""The bridge to PyVista, against VTK's own camera and its own rays. Runs where PyVista is installed; with BELVEDERE_REQUIRE_PYVISTA=1 it must be."""

from __future__ import annotations

import os
import warnings

import numpy as np
import pytest

import belvedere

if os.environ.get("BELVEDERE_REQUIRE_PYVISTA", "0") == "0":
    pv = pytest.importorskip("pyvista", reason="SKIPPED: the bridge to PyVista is not tried; pyvista is not installed")
else:
    import pyvista as pv

from belvedere import pyvista as bridge  # noqa: E402

SIZE = (320, 180)
BEND = {"kind": "spline_bend", "presets": "progressive"}
TURN = {"kind": "curved_rays", "turn": [{
    "viewpoint": [-400.0, 500.0, 900.0], "normal": [0.0, -1.0, 0.0],
    "t0": [1200.0, 700.0, 400.0], "t1": [1200.0, 900.0, 400.0], "t2": [1200.0, 1100.0, 400.0],
}]}  # fmt: skip


def ground(rows: int = 61, columns: int = 81) -> pv.StructuredGrid:
    """Hills with a ridge across the middle, 2400 x 1800 m."""
    x, y = np.meshgrid(np.linspace(0, 2400, columns), np.linspace(0, 1800, rows))
    z = 300 + 60 * np.sin(x / 270) * np.cos(y / 210) + 250 * np.exp(-(((y - 800) / 150) ** 2))
    grid = pv.StructuredGrid(x, y, z)
    grid["height"] = grid.points[:, 2]
    return grid


@pytest.fixture
def plotter() -> pv.Plotter:
    made = pv.Plotter(off_screen=True, window_size=SIZE)
    made.add_mesh(ground(), scalars="height", cmap="terrain", show_scalar_bar=False, name="ground")
    made.add_mesh(pv.Sphere(radius=60, center=(1200, 1200, 640)), color="red", name="ball")
    made.camera_position = [(1200, -1500, 900), (1200, 1000, 300), (0, 0, 1)]
    made.camera.view_angle = 40
    return made


def pixels_of_vtk(plotter: pv.Plotter, points: np.ndarray) -> np.ndarray:
    """Where the camera of VTK sees points, pixels from the top-left corner, by its own matrix."""
    width, height = plotter.window_size
    matrix = plotter.camera.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
    clip = np.c_[points, np.ones(len(points))] @ pv.array_from_vtkmatrix(matrix).T
    ndc = clip[:, :2] / clip[:, 3:]
    return np.c_[(ndc[:, 0] + 1) / 2 * width, (1 - ndc[:, 1]) / 2 * height]


@pytest.mark.parametrize("parallel", [False, True])
def test_vtk_sees_warped_points_where_our_picture_has_them(plotter: pv.Plotter, parallel: bool) -> None:
    if parallel:
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 900
    scene = bridge.scene_of(plotter, stages=[BEND])
    grid = ground()
    warped = bridge.warped(grid, scene)
    assert type(warped) is type(grid) and warped.dimensions == grid.dimensions and "height" in warped.point_data
    assert np.linalg.norm(warped["displacement"], axis=1).max() > 50
    ours = scene.project(grid.points, size=SIZE)
    other = pv.Plotter(off_screen=True, window_size=SIZE)
    bridge.place_camera(other, scene)
    off = np.linalg.norm(pixels_of_vtk(other, warped.points) - ours.pixel, axis=1)[ours.inside]
    assert len(off) > 1000 and off.max() < 0.1, off.max()
    # The plotter's own camera sees the undisplaced points where the straight picture has them.
    straight = scene.project(grid.points, size=SIZE, straight=True)
    off = np.linalg.norm(pixels_of_vtk(plotter, grid.points) - straight.pixel, axis=1)
    assert off.max() < 0.1, off.max()


@pytest.mark.parametrize("stage", [BEND, TURN], ids=["spline", "curved"])
def test_a_picture_of_vtk_shows_a_mark_at_our_pixel(plotter: pv.Plotter, stage: dict) -> None:
    scene = bridge.scene_of(plotter, stages=[stage])
    mark = np.array([[1300.0, 760.0, 640.0]])
    ours = scene.project(mark, size=SIZE)
    assert ours.inside[0]
    other = pv.Plotter(off_screen=True, window_size=SIZE, lighting="none")
    moved = bridge.warped(pv.PolyData(mark), scene)
    assert np.linalg.norm(moved["displacement"]) > 5
    other.add_mesh(pv.Sphere(radius=15, center=moved.points[0]), color="white", lighting=False)
    other.set_background("black")
    bridge.place_camera(other, scene)
    picture = other.screenshot(return_img=True)[..., 0].astype(float)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]] + 0.5
    centre = np.array([(x * picture).sum(), (y * picture).sum()]) / picture.sum()
    assert np.linalg.norm(centre - ours.pixel[0]) < 0.5, (centre, ours.pixel)


def test_cameras_come_back(plotter: pv.Plotter) -> None:
    plotter.camera.up = (0.1, 0.2, 1.0)
    ours = bridge.camera_of(plotter)
    assert ours.fov_y_deg == 40 and ours.ortho_height_m is None and ours.eye == (1200, -1500, 900)
    other = pv.Plotter(off_screen=True, window_size=SIZE)
    bridge.place_camera(other, bridge.scene_of(ground(), camera=ours))
    points = ground().points
    assert np.abs(pixels_of_vtk(other, points) - pixels_of_vtk(plotter, points)).max() < 0.01
    wide = bridge.camera_of(plotter)
    plotter.camera.SetUseHorizontalViewAngle(True)
    assert bridge.camera_of(plotter).fov_y_deg < wide.fov_y_deg
    plotter.camera.SetWindowCenter(0.2, 0.0)
    with pytest.raises(belvedere.InputError, match="middle of the picture"):
        bridge.camera_of(plotter)


def test_visibility_agrees_with_the_rays_of_vtk(plotter: pv.Plotter) -> None:
    plotter.remove_actor("ball")
    scene = bridge.scene_of(plotter, stages=[BEND], must_see=["ground"])
    seen = bridge.visibility(ground(), scene, size=(640, 360))
    surface = ground().extract_surface(algorithm="geometry").triangulate()
    eye = np.array(plotter.camera.position)
    inside = scene.project(seen.points, size=(640, 360), straight=True).inside
    some = np.flatnonzero(inside)[::7]
    free = []
    for point in seen.points[some]:
        # Until right before the surface on which the point lies.
        hits, _ = surface.ray_trace(eye, point + (eye - point) * 4e-3)
        free.append(len(hits) == 0)
    free = np.array(free)
    assert 0.1 < free.mean() < 0.95
    assert np.mean(seen["visible_straight"][some] == free) > 0.97
    assert not seen["visible_straight"][~inside].any()
    assert seen["visible_bent"].sum() > seen["visible_straight"].sum()


def test_colours_are_those_of_the_plotter(plotter: pv.Plotter) -> None:
    cells = pv.Plane(center=(300, 300, 700), i_size=300, j_size=300, i_resolution=1, j_resolution=2)
    cells.cell_data["RGB"] = np.array([[0, 0, 255], [0, 255, 0]], np.uint8)
    plotter.add_mesh(cells, scalars="RGB", rgb=True, name="cells")
    scene = bridge.scene_of(plotter)
    assert scene.layers == ["ground", "ball", "cells"]
    from belvedere._vtk import triangles_of

    ball = triangles_of(plotter.actors["ball"].mapper.dataset, width=1.0, actor=plotter.actors["ball"])
    assert (ball.colors == [255, 0, 0]).all()
    two = triangles_of(cells, width=1.0, actor=plotter.actors["cells"])
    assert len(two.faces) == 4 and {tuple(c) for c in two.colors} == {(0, 0, 255), (0, 255, 0)}
    alone = triangles_of(cells, width=1.0)
    assert (alone.colors == two.colors).all()
    slope = triangles_of(ground(), width=1.0, actor=plotter.actors["ground"])
    order = np.argsort(slope.points[:, 2])
    assert np.ptp(slope.colors, axis=0).max() > 100 and (slope.colors[order[0]] != slope.colors[order[-1]]).any()
    picture = bridge.render(plotter)
    assert picture.size == SIZE
    # Light and haze are ours.
    reds = picture.rgba[picture.id == 2].astype(int)
    more = reds[:, 0] - reds[:, 1]
    assert len(reds) > 20 and more.min() > -10 and more.mean() > 25


def test_actors_stand_where_the_plotter_has_them(plotter: pv.Plotter) -> None:
    actor = plotter.add_mesh(pv.Cube(), name="cube")
    actor.position, actor.scale = (100, 200, 900), (50, 50, 50)
    plotter.actors["ball"].SetVisibility(False)
    scene = bridge.scene_of(plotter)
    assert scene.layers == ["ground", "cube"] and scene.bounds[1][2] == pytest.approx(925)


def test_lines_and_points_are_tubes_and_balls(plotter: pv.Plotter) -> None:
    plotter.add_mesh(pv.Line((300, 1250, 600), (2100, 1300, 600)), color="blue", line_width=4, name="line")
    plotter.add_mesh(pv.PolyData(np.array([[800.0, 900, 700], [1500, 900, 700]])), color="lime", point_size=6, name="dots")
    picture = bridge.render(plotter)
    line = picture.id == 3
    assert 2.5 < line.sum(axis=0)[line.any(axis=0)].mean() < 6
    assert 15 < (picture.id == 4).sum() < 120
    assert (picture.rgba[picture.id == 4][:, 1] > 100).mean() > 0.5


def test_datasets_of_every_kind(plotter: pv.Plotter) -> None:
    image = pv.ImageData(dimensions=(5, 6, 7), spacing=(10, 10, 10))
    blocks = pv.MultiBlock({"box": image, "tetra": pv.Sphere().delaunay_3d()})
    scene = bridge.scene_of(blocks, stages=[BEND])
    assert scene.layers == ["box", "tetra"]
    bent = bridge.warped(image, scene)
    assert bent.n_points == image.n_points and np.allclose(bent.points - image.points, bent["displacement"])
    with pytest.raises(belvedere.InputError, match="no dataset"):
        bridge.scene_of([1, 2])
    with pytest.raises(belvedere.InputError, match="no mesh"):
        bridge.scene_of(pv.PolyData())
    with pytest.raises(belvedere.InputError, match="must_see"):
        bridge.scene_of(image, must_see=["other"])


def test_points_that_no_ray_reaches_take_their_cells_along() -> None:
    class Half:
        """A view that reaches what lies east of 1200 m, and lifts it."""

        def displace(self, points: np.ndarray, **_: object) -> belvedere.Displaced:
            moved = np.where(points[:, :1] > 1200, points + [0, 0, 10], np.nan)
            return belvedere.Displaced(moved, np.zeros(len(points), bool), np.isnan(moved[:, 0]).astype(np.uint8) * 2)

    grid = ground(4, 9)
    with pytest.warns(UserWarning, match="20 of 36 points .* 15 cells are left out"):
        rest = bridge.warped(grid, Half())
    assert rest.n_cells == 9 and rest.points[:, 0].min() > 1200 and "height" in rest.point_data
    assert np.allclose(rest.points[:, 2] - rest["height"], 10)


def test_what_is_no_mesh_is_told(plotter: pv.Plotter) -> None:
    plotter.add_mesh(pv.Cube(center=(0, 0, 800), x_length=100, y_length=100, z_length=100), opacity=0.5, name="glass")
    plotter.add_volume(pv.Wavelet(), name="wave")
    with pytest.warns(UserWarning) as told:
        bridge.scene_of(plotter)
    text = " ".join(str(w.message) for w in told)
    assert "opaque" in text and "Volume" in text
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plotter.remove_actor("glass")
        plotter.remove_actor("wave")
        bridge.scene_of(plotter)
