"""Renders the picture of a run: input, Auto Diffusion Function with feature points, patches and form side by side."""

import math

import bpy
import numpy as np

LABELS = ("Input", "Auto Diffusion Function and feature points", "Patches", "Canonical form")
CLAY = (0.55, 0.55, 0.58, 1.0)


def render(body, path, width=1600, samples=24):
    """Render one object with its results to a .png; this changes the scene, so save the .blend file first."""
    keys = body.data.shape_keys.key_blocks
    colours = body.data.color_attributes
    rest, form = coordinates(keys[0]), coordinates(keys["Canonical Form"])
    features = [
        vertex.index
        for vertex in body.data.vertices
        if any(g.group == body.vertex_groups["Feature Points"].index for g in vertex.groups)
    ]
    world = np.array(body.matrix_world)
    rest, form = (shape @ world[:3, :3].T for shape in (rest, form))
    size = max(np.ptp(rest, axis=0).max(), np.ptp(form, axis=0).max())
    body.hide_render = True
    fields = {name: field(colours[name]) for name in ("Auto Diffusion Function", "Patches")}
    shown = [
        (rest, None),
        (rest, fields["Auto Diffusion Function"]),
        (rest, fields["Patches"]),
        (form, fields["Patches"]),
    ]
    for place, (shape, colour) in enumerate(shown):
        shift = np.array([(place - 1.5) * 1.12 * size, 0, 0])
        centred = shape - (shape.max(axis=0) + shape.min(axis=0)) / 2 + shift
        copy = body.data.copy()
        twin = bpy.data.objects.new("Shown", copy)
        twin.shape_key_clear()
        copy.vertices.foreach_set("co", centred.astype(np.float32).ravel())
        twin.hide_render = False
        bpy.context.scene.collection.objects.link(twin)
        copy.materials.clear()
        copy.materials.append(material(copy, colour))
        if place == 1:
            for feature in features:
                dot(centred[feature], 0.022 * size)
        caption(LABELS[place], shift - np.array([0, 0, 0.60 * size]), 0.05 * size)
    camera(size)
    light(size)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = width, round(width * 1.30 / 4.6)
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def coordinates(key):
    """Return the positions of a shape key."""
    flat = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def field(attribute):
    """Return the colours of an attribute."""
    flat = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", flat)
    return flat


def material(mesh, colours):
    """Create a material: clay, or the given colours of the vertices."""
    made = bpy.data.materials.new("Shown")
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.6
    if colours is None:
        shader.inputs["Base Color"].default_value = CLAY
        return made
    attribute = mesh.color_attributes.new(name="Shown", type="FLOAT_COLOR", domain="POINT")
    attribute.data.foreach_set("color", colours)
    node = made.node_tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = "Shown"
    made.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return made


def dot(place, radius):
    """Add a dark ball at a feature point."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=place, segments=24, ring_count=12)
    ball = bpy.context.object
    made = bpy.data.materials.new("Feature Point")
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.02, 0.02, 1.0)
    ball.data.materials.append(made)


def caption(text, place, height):
    """Add a line of text that faces the camera."""
    curve = bpy.data.curves.new("Caption", "FONT")
    curve.body, curve.size, curve.align_x = text, height, "CENTER"
    line = bpy.data.objects.new("Caption", curve)
    line.location, line.rotation_euler = place, (math.pi / 2, 0, 0)
    made = bpy.data.materials.new("Caption")
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.01, 0.01, 0.01, 1.0)
    curve.materials.append(made)
    bpy.context.scene.collection.objects.link(line)


def camera(size):
    """Add an orthographic camera along +y that shows all four positions."""
    eye = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    eye.data.type, eye.data.ortho_scale = "ORTHO", 4.6 * size
    eye.data.clip_end = 100 * size
    eye.location, eye.rotation_euler = (0, -10 * size, -0.04 * size), (math.pi / 2, 0, 0)
    bpy.context.scene.collection.objects.link(eye)
    bpy.context.scene.camera = eye


def light(size):
    """Add a sun from above the left shoulder and a dim sky, with a white background."""
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, 0.2
    sun.rotation_euler = (math.radians(50), math.radians(-30), math.radians(-25))
    bpy.context.scene.collection.objects.link(sun)
    world = bpy.context.scene.world or bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    links = world.node_tree.links
    path = world.node_tree.nodes.new("ShaderNodeLightPath")
    seen = world.node_tree.nodes.new("ShaderNodeMapRange")
    seen.inputs["To Min"].default_value, seen.inputs["To Max"].default_value = 0.3, 1.0
    links.new(path.outputs["Is Camera Ray"], seen.inputs["Value"])
    links.new(seen.outputs["Result"], background.inputs["Strength"])
