"""Puts clips into Blender's scene."""

import pathlib

import bpy
import numpy
from mathutils import Matrix, Vector

from .clip import Clip
from .glb import Unreadable

# glTF has +y up, Blender has +z.
TO_BLENDER = Matrix(((1, 0, 0), (0, 0, -1), (0, 1, 0)))


def make_material(name, mesh):
    """Colours of the vertices or of the texture, not lit."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output, emission = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeEmission")
    links.new(emission.outputs["Emission"], output.inputs["Surface"])
    if mesh.picture:
        image = bpy.data.images.new(name, 8, 8)
        image.pack(data=mesh.picture, data_len=len(mesh.picture))
        image.source = "FILE"
        colours = nodes.new("ShaderNodeTexImage")
        colours.image = image
    else:
        colours = nodes.new("ShaderNodeVertexColor")
        colours.layer_name = "Color"
    links.new(colours.outputs["Color"], emission.inputs["Color"])
    return material


def make_mesh(name, source):
    """The mesh of a frame in Blender's axes."""
    positions = source.positions @ numpy.array(TO_BLENDER).T
    corners = source.corners
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(numpy.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(corners) // 3)
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, len(corners), 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(corners) // 3, dtype=bool))
    if source.colours is not None:
        colours = numpy.ones((len(positions), 4), dtype=numpy.float32)
        colours[:, :3] = source.colours
        mesh.color_attributes.new("Color", "FLOAT_COLOR", "POINT").data.foreach_set("color", colours.ravel())
    if source.uvs is not None:
        # glTF counts v from the top of the picture.
        uvs = source.uvs * (1, -1) + (0, 1)
        mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uvs[corners].astype(numpy.float32).ravel())
    mesh.update(calc_edges=True)
    return mesh


def import_clip(context, path, quality="", set_scene=True, sound=True):
    """Adds the clip at a path to the scene. Frame `frame_start` of the scene shows its first frame.

    Returns its object, and why its sound is missing, or nothing if it is not.
    """
    opened = Clip(path, quality)
    made, materials, up = [], [], None
    windows = context.window_manager
    windows.progress_begin(0, opened.count)
    try:
        for glb, source in opened.frames():
            name = f"{pathlib.Path(path).stem} {len(made)}"
            made.append(make_mesh(name, source))
            if source.picture or not materials:
                materials.append(make_material(name, source))
            made[-1].materials.append(materials[-1])
            up = up or glb.up()
            windows.progress_update(len(made))
    except Unreadable:
        images = [node.image for one in materials for node in one.node_tree.nodes if node.type == "TEX_IMAGE"]
        bpy.data.batch_remove([*made, *materials, *images])
        raise
    finally:
        windows.progress_end()
    clip = bpy.data.objects.new(pathlib.Path(path).resolve().parent.name, made[0])
    # The clip's upward direction becomes that of Blender.
    clip.rotation_mode = "QUATERNION"
    clip.rotation_quaternion = (TO_BLENDER @ Vector(up)).rotation_difference(Vector((0, 0, 1)))
    scene = context.scene
    clip.pcmvs_clip.start = scene.frame_start
    for mesh in made:
        clip.pcmvs_clip.frames.add().mesh = mesh
    scene.collection.objects.link(clip)
    if set_scene:
        scene.frame_end = scene.frame_start + len(made) - 1
        if opened.fps:
            # Blender's frame rate is an integer divided by a base.
            scene.render.fps = max(1, round(opened.fps))
            scene.render.fps_base = scene.render.fps / opened.fps
    show_frames(scene)
    return clip, add_sound(scene, opened.audio) if sound and opened.audio else None


def add_sound(scene, path):
    """Puts the sound of a clip below the scene's frames, in a channel that is free. Returns why this fails, if it does."""
    if not path.is_file():
        return f"{path}: is missing: copy the clip once more. The clip was imported without its sound"
    editor = scene.sequence_editor or scene.sequence_editor_create()
    # The name before Blender 4.4.
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    channel = 1 + max((strip.channel for strip in strips), default=0)
    try:
        strip = strips.new_sound(name=path.name, filepath=str(path), channel=channel, frame_start=scene.frame_start)
    except RuntimeError as error:
        return f"{path}: {str(error).strip()}. The clip was imported without its sound"
    sound = strip.sound
    if sound.channels == "INVALID":
        strips.remove(strip)
        bpy.data.sounds.remove(sound)
        return f"{path}: cannot be opened as sound. The clip was imported without it"
    # The sound goes on while frames are late, as in other players.
    scene.sync_mode = "AUDIO_SYNC"


def show_frames(scene):
    """Gives every clip the mesh of the scene's frame. Before its start it shows its first frame, after its end its last."""
    for shown in scene.objects:
        clip = shown.pcmvs_clip
        if clip.frames:
            i = min(max(scene.frame_current - clip.start, 0), len(clip.frames) - 1)
            shown.data = clip.frames[i].mesh
