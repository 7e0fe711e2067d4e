#!/usr/bin/env python3
"""blender_pictures.py OUT: the terrains and the town of the sheet in Blender (the module bpy), drawn by Cycles.

Ground and town are the GLB files that `belvedere export --straight` wrote, with the tints of the map as colours of
vertices and the routes as tubes. Light, shadows, sky and shading are Blender's."""

import math
import sys

import bpy

from rows import rows_of, why


def draw(row):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=row["glb"])
    scene = bpy.context.scene
    scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 24
    scene.cycles.use_denoising = True
    scene.render.threads_mode, scene.render.threads = "FIXED", 2
    scene.render.resolution_x, scene.render.resolution_y = row["size"]
    scene.render.resolution_percentage = 100
    scene.camera.data.clip_end = 1e6
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, math.radians(1.0)
    sun.rotation_euler = (math.radians(55), 0, math.radians(45))      # from the north-west, 35 degrees high
    scene.collection.objects.link(sun)
    world = bpy.data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    light = nodes["Background"]
    light.inputs[0].default_value = (0.55, 0.72, 0.95, 1)
    light.inputs[1].default_value = 0.35
    # The sky that the camera sees is brighter than the light it gives, as over a landscape that is lit by the sun.
    seen, mix, path = (nodes.new(kind) for kind in ("ShaderNodeBackground", "ShaderNodeMixShader", "ShaderNodeLightPath"))
    seen.inputs[0].default_value = (0.45, 0.63, 0.87, 1)
    links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    links.new(light.outputs[0], mix.inputs[1])
    links.new(seen.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], nodes["World Output"].inputs["Surface"])
    scene.view_settings.view_transform = "Standard"
    for material in bpy.data.materials:
        if not material.node_tree:
            continue
        nodes, links = material.node_tree.nodes, material.node_tree.links
        surface = nodes.get("Principled BSDF")
        if surface:
            surface.inputs["Roughness"].default_value = 1.0
            if not surface.inputs["Base Color"].is_linked and material.name != "point":
                color = nodes.new("ShaderNodeVertexColor")
                links.new(color.outputs["Color"], surface.inputs["Base Color"])
    scene.render.filepath = str(row["folder"] / "blender.png")
    bpy.ops.render.render(write_still=True)


for one in rows_of(sys.argv[1]):
    if "glb" not in one:
        why(one, "blender", "Blender does not read this file by itself.")
        continue
    try:
        draw(one)
    except Exception as error:
        why(one, "blender", f"failed: {error}")
