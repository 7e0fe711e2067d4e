"""Files of `belvedere export` in Blender: its camera sees marks where our picture has them. Runs where bpy is installed (Blender from pip, 1 GB); it is not part of CI.

With BLENDER_PICTURES=FOLDER a picture of Cycles and ours of the same scene are written there, to look at.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import belvedere

bpy: Any = pytest.importorskip("bpy", reason="SKIPPED: the export is not tried in Blender; bpy is not installed")

MARKS = {"one": (-800.0, -900.0), "two": (400.0, 300.0), "three": (1500.0, 900.0)}


def scene_with_marks(name: str) -> belvedere.Scene:
    """A built-in scene on small ground, with three marks on it."""
    document = belvedere.Scene.builtin(name).document
    for layer in document["layer"]:
        if isinstance(layer.get("source"), str):
            layer["source"] = layer["source"].split("?")[0] + "?seed=7&size=65"
    for stage in document["stage"]:
        if stage["kind"] == "terrain_disocclusion":
            stage["solver_nodes"] = 33
    scene = belvedere.Scene.from_document(document)
    return scene.add_points(MARKS, id="marks", crs="local")


def in_blender(scene: belvedere.Scene, folder: Path) -> tuple[dict[str, Any], np.ndarray]:
    """Opens the exported scene in Blender; the custom properties, and the pixels at which Blender's camera sees the marks."""
    from bpy_extras.object_utils import world_to_camera_view

    command = [sys.executable, "-m", "belvedere", "export", scene.save(folder / "scene.json"), "-o", folder / "scene.glb", "-q"]
    subprocess.run(command, check=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(folder / "scene.glb"))
    opened = bpy.context.scene
    said: dict[str, Any] = opened["belvedere"].to_dict()
    opened.camera = next(o for o in opened.objects if o.type == "CAMERA")
    width, height = said["image"]
    opened.render.resolution_x, opened.render.resolution_y = width, height
    opened.render.resolution_percentage = 100
    opened.render.pixel_aspect_x = opened.render.pixel_aspect_y = 1
    bpy.context.view_layer.update()
    pixels = []
    for name in MARKS:
        x, y, _ = world_to_camera_view(opened, opened.camera, opened.objects[name].matrix_world.translation)
        pixels.append((x * width, (1 - y) * height))
    return said, np.array(pixels)


@pytest.mark.parametrize("name", ["massif", "massif_curved_rays", "massif_terrain"])
def test_the_camera_of_blender_sees_marks_where_our_picture_has_them(name: str, tmp_path: Path) -> None:
    scene = scene_with_marks(name)
    said, theirs = in_blender(scene, tmp_path)
    xy = np.array(list(MARKS.values()))
    # Points are drawn 1 m above the ground (lift_m).
    marks = np.c_[xy, scene.ground_m(xy) + 1.0]
    ours = scene.project(marks)
    assert ours.inside.all() and said["image"] == list(scene.render().size)
    off = np.linalg.norm(theirs - ours.pixel, axis=1)
    print(f"{name}: {off.max():.4f} pixels")
    assert off.max() < 0.05, off
    # The marks are moved, so that a straight camera of the scene as it is would not do.
    straight = scene.project(marks, straight=True)
    assert np.linalg.norm(straight.pixel - ours.pixel, axis=1).max() > 0.3
    folder = os.environ.get("BLENDER_PICTURES")
    if folder:
        draw(Path(folder) / f"{name}.cycles.png")
        scene.render().save(Path(folder) / f"{name}.png", overwrite=True)


def draw(path: Path) -> None:
    """The picture of Cycles, by the recipe of docs/guide/blender.md."""
    opened = bpy.context.scene
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3, (0.785, 0, 0.785)
    opened.collection.objects.link(sun)
    opened.view_settings.view_transform = "Standard"
    for material in bpy.data.materials:
        nodes, links = material.node_tree.nodes, material.node_tree.links
        surface = nodes.get("Principled BSDF")
        if surface and not surface.inputs["Base Color"].is_linked and material.name != "point":
            color = nodes.new("ShaderNodeVertexColor")
            links.new(color.outputs["Color"], surface.inputs["Base Color"])
    opened.render.engine = "CYCLES"
    opened.render.resolution_percentage = 50
    opened.cycles.samples, opened.cycles.device = 8, "CPU"
    opened.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
