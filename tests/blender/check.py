"""Imports clips into Blender with examples/blender/import_pcmvs.py and checks what is there: check.py FOLDER FPS.

The folder has plain/ and textured/ (clips of `pcmvs reconstruct`), packed.glb (`pcmvs pack` of the plain one, with FPS frames per
second) and compressed/. All are of a scene with +z up, so that they are in Blender's axes as they are in the scene's.
"""

import json
import pathlib
import struct
import sys

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "examples/blender"))
import import_pcmvs  # noqa: E402

FOLDER = pathlib.Path(sys.argv[1])
PACKED_FPS = float(sys.argv[2])


def described(path):
    """What a frame's file says about its mesh: numbers of vertices and corners, bounds, and its first colour."""
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20 : 20 + length])
    primitive = document["meshes"][0]["primitives"][0]
    positions = document["accessors"][primitive["attributes"]["POSITION"]]
    corners = document["accessors"][primitive["indices"]]
    colour = None
    if "COLOR_0" in primitive["attributes"]:
        view = document["bufferViews"][document["accessors"][primitive["attributes"]["COLOR_0"]]["bufferView"]]
        colour = struct.unpack_from("<3f", data, 28 + length + view["byteOffset"])
    return positions["count"], corners["count"], (positions["min"], positions["max"]), colour


def imported(path):
    """Imports a clip into an empty scene. Returns its object."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert bpy.ops.import_scene.pcmvs(filepath=str(path)) == {"FINISHED"}
    (clip,) = bpy.context.scene.objects
    return clip


def places(clip):
    """Positions of the mesh that is shown now, in the scene."""
    positions = numpy.empty(3 * len(clip.data.vertices), dtype=numpy.float32)
    clip.data.vertices.foreach_get("co", positions)
    matrix = numpy.array(clip.matrix_world)
    return positions.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def every_frame_shows_the_mesh_of_its_file(clip, folder, fps=None):
    scene = bpy.context.scene
    manifest = json.loads((folder / "sequence.json").read_bytes())
    frames = [folder / frame["url"] for frame in manifest["frames"]]
    assert abs(scene.render.fps / scene.render.fps_base - (fps or manifest["fps"])) < 1e-4, scene.render.fps
    assert (scene.frame_start, scene.frame_end) == (1, len(frames)) and len(frames) > 1
    # Before its first frame and after its last a clip stands still.
    moments = [(0, frames[0]), *enumerate(frames, 1), (len(frames) + 5, frames[-1])]
    for moment, path in moments:
        scene.frame_set(moment)
        vertices, corners, bounds, colour = described(path)
        assert (len(clip.data.vertices), 3 * len(clip.data.polygons)) == (vertices, corners), path
        seen = places(clip)
        assert numpy.abs([seen.min(axis=0), seen.max(axis=0)] - numpy.array(bounds)).max() < 1e-5, path
        assert not clip.data.validate(), f"Blender had to correct the mesh of {path}"
        if colour:
            first = clip.data.color_attributes["Color"].data[0].color
            assert numpy.abs(numpy.array(first)[:3] - colour).max() < 1e-6, (path, tuple(first), colour)
    return len(frames)


def the_material_shows(clip, node):
    (material,) = clip.data.materials
    (output,) = [found for found in material.node_tree.nodes if found.type == "OUTPUT_MATERIAL"]
    emission = output.inputs["Surface"].links[0].from_node
    colours = emission.inputs["Color"].links[0].from_node
    assert (emission.type, colours.type) == ("EMISSION", node), (emission.type, colours.type)
    return colours


def main():
    import_pcmvs.register()
    clip = imported(FOLDER / "plain/sequence.json")
    count = every_frame_shows_the_mesh_of_its_file(clip, FOLDER / "plain")
    assert the_material_shows(clip, "VERTEX_COLOR").layer_name == "Color"

    # A saved file plays when it is opened again.
    saved = str(FOLDER / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=saved)
    bpy.ops.wm.open_mainfile(filepath=saved)
    (clip,) = bpy.context.scene.objects
    every_frame_shows_the_mesh_of_its_file(clip, FOLDER / "plain")

    clip = imported(FOLDER / "packed.glb")
    every_frame_shows_the_mesh_of_its_file(clip, FOLDER / "plain", PACKED_FPS)

    clip = imported(FOLDER / "textured/sequence.json")
    every_frame_shows_the_mesh_of_its_file(clip, FOLDER / "textured")
    images = set()
    for frame in range(count):
        bpy.context.scene.frame_set(1 + frame)
        image = the_material_shows(clip, "TEX_IMAGE").image
        assert tuple(image.size) == (256, 256) and max(image.pixels[:4000]) > 0, image.name
        images.add(image.name)
    assert len(images) == count, images

    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        bpy.ops.import_scene.pcmvs(filepath=str(FOLDER / "compressed/sequence.json"))
        raise AssertionError("a compressed clip is not refused")
    except RuntimeError as error:
        assert "frame_0000.glb" in str(error) and "without --compress" in str(error), error
    assert not bpy.data.meshes and not bpy.data.objects
    import_pcmvs.unregister()
    print(f"Blender {bpy.app.version_string}, {count} frames")


main()
