"""Imports clips into Blender with examples/blender/pcmvs_clips and checks what is there: check.py FOLDER FPS.

The folder has clips of `pcmvs reconstruct`: plain/, textured/ and compressed/, and upright/ with a frame of plain/. `pcmvs
pack` has made packed.glb of plain/, with FPS frames per second, and published/, which has plain/ as the quality full,
compressed/ as the quality compact, segments and a sound. All are of a scene with +z up, so that they are in Blender's axes as
in the scene's.
"""

import json
import os
import pathlib
import shutil
import struct
import sys
import time
from types import SimpleNamespace

import bpy
import numpy
from compressed import equals_rounded
from mathutils.kdtree import KDTree
from package import FOLDER as EXTENSION

sys.path.insert(0, str(EXTENSION))
import pcmvs_clips  # noqa: E402
from pcmvs_clips.glb import Glb  # noqa: E402

FOLDER = pathlib.Path(sys.argv[1])
PACKED_FPS = float(sys.argv[2])
# Some builds of Blender's package have no sound.
SOUND = bpy.app.build_options.audaspace


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


def imported(path, **options):
    """Imports a clip into an empty scene. Returns its object."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert bpy.ops.import_scene.pcmvs(filepath=str(path), **options) == {"FINISHED"}
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


def compressed_frames_are_the_plain_ones():
    """Returns the seconds of processor time that a frame takes, and its size."""
    start = time.process_time()
    clip = imported(FOLDER / "compressed/sequence.json")
    manifest = json.loads((FOLDER / "compressed/sequence.json").read_bytes())
    seconds = (time.process_time() - start) / len(manifest["frames"])
    for moment, frame in enumerate(manifest["frames"], 1):
        plain, packed = (Glb(FOLDER / name / frame["url"]) for name in ("plain", "compressed"))
        vertices, triangles = equals_rounded(packed, plain)
        bpy.context.scene.frame_set(moment)
        is_near(clip, plain)
    return seconds, f"{vertices} vertices and {triangles} triangles"


def is_near(clip, plain):
    """The mesh that is shown has vertices within a rounding step of those of a plain file, and encloses the same volume."""
    mesh = plain.mesh(*plain.frames()[0])
    seen = places(clip)
    corners = numpy.empty(3 * len(clip.data.polygons), dtype=numpy.int32)
    clip.data.polygons.foreach_get("vertices", corners)
    tree = KDTree(len(mesh.positions))
    for i, position in enumerate(mesh.positions):
        tree.insert(position, i)
    tree.balance()
    step = (mesh.positions.max(axis=0) - mesh.positions.min(axis=0)).max() / 16383
    assert max(tree.find(position)[2] for position in seen[::50]) < 2 * step
    ratio = volume(seen, corners) / volume(mesh.positions, mesh.corners)
    assert abs(ratio - 1) < 1e-3, ratio


def volume(positions, corners):
    """The volume that a closed mesh encloses, positive if its triangles are counter-clockwise from outside."""
    a, b, c = (positions[corners[k::3]] for k in range(3))
    return (a * numpy.cross(b, c)).sum() / 6


def the_published_clip_has_qualities_and_sound():
    path = FOLDER / "published/sequence.json"
    manifest = json.loads(path.read_bytes())
    assert len(manifest["qualities"][0]["segments"]) > 1, "there are segments to join"
    the_dialog_offers(path, ["full", "compact"])
    the_dialog_offers(FOLDER / "plain/sequence.json", [])
    # Nothing is chosen, and so it is the best quality.
    clip = imported(path)
    every_frame_shows_the_mesh_of_its_file(clip, FOLDER / "plain", manifest["fps"])
    if SOUND:
        the_sound_begins_with_the_clip()
    clip = imported(path, quality="compact", sound=False)
    assert not sounds()
    for moment, frame in enumerate(json.loads((FOLDER / "plain/sequence.json").read_bytes())["frames"], 1):
        bpy.context.scene.frame_set(moment)
        is_near(clip, Glb(FOLDER / "plain" / frame["url"]))

    # A sound that cannot be read does not lose the meshes.
    silent = FOLDER / "silent"
    shutil.copytree(FOLDER / "published", silent, dirs_exist_ok=True)
    (silent / "audio.wav").write_bytes(b"no sound")
    assert len(imported(silent / "sequence.json").pcmvs_clip.frames) > 1
    assert not sounds() and not bpy.data.sounds
    (silent / "audio.wav").unlink()
    assert len(imported(silent / "sequence.json").pcmvs_clip.frames) > 1
    assert not sounds() and not bpy.data.sounds


def the_dialog_offers(path, names):
    """What the import dialog lists under Quality, with the file browser and without."""
    browser = SimpleNamespace(directory=os.fsencode(path.parent), filename=path.name)
    for space in (None, SimpleNamespace(params=browser)):
        operator = SimpleNamespace(filepath=str(path) if space is None else "")
        assert pcmvs_clips.offer_qualities(operator, SimpleNamespace(space_data=space), "") == names


def the_sound_begins_with_the_clip():
    (strip,) = sounds()
    assert (strip.type, strip.frame_final_start) == ("SOUND", 1) and strip.frame_final_duration >= 1
    assert pathlib.Path(bpy.path.abspath(strip.sound.filepath)) == (FOLDER / "published/audio.wav").resolve()


def sounds():
    editor = bpy.context.scene.sequence_editor
    if editor is None:
        return []
    return list(editor.strips if hasattr(editor, "strips") else editor.sequences)


def what_cannot_be_read_leaves_nothing():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    damaged = FOLDER / "damaged"
    damaged.mkdir(exist_ok=True)
    for name in ("sequence.json", "frame_0000.glb", "frame_0001.glb"):
        (damaged / name).write_bytes((FOLDER / "textured" / name).read_bytes())
    data = bytearray((damaged / "frame_0001.glb").read_bytes())
    at = data.index(b'"count":') + 8
    data[at : at + 1] = b"9"
    (damaged / "frame_0001.glb").write_bytes(data)
    wrong = {
        "frame_0001.glb": {"filepath": str(damaged / "sequence.json")},
        "no quality other, but full, compact": {
            "filepath": str(FOLDER / "published/sequence.json"),
            "quality": "other",
        },
        "reads versions 1 and 2": {"filepath": str(FOLDER / "plain/report.json")},
    }
    for what, options in wrong.items():
        try:
            bpy.ops.import_scene.pcmvs(**options)
            raise AssertionError(f"{options} is not refused")
        except RuntimeError as error:
            assert what in str(error), error
        assert not any((bpy.data.meshes, bpy.data.objects, bpy.data.materials, bpy.data.images)), what


def blenders_own_importer_shows_the_person_upright():
    """Without the extension, and without a rotation by hand."""
    bounds = described(FOLDER / "plain/frame_0000.glb")[2]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(FOLDER / "upright/frame_0000.glb"))
    (person,) = (one for one in bpy.context.scene.objects if one.type == "MESH")
    seen = places(person)
    assert numpy.abs([seen.min(axis=0), seen.max(axis=0)] - numpy.array(bounds)).max() < 1e-5, (seen, bounds)


def main():
    pcmvs_clips.register()
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

    seconds, frames = compressed_frames_are_the_plain_ones()
    the_published_clip_has_qualities_and_sound()
    what_cannot_be_read_leaves_nothing()
    blenders_own_importer_shows_the_person_upright()
    pcmvs_clips.unregister()
    time_taken = f"{seconds:.2f} s of processor time to import a compressed frame of {frames}"
    print(f"Blender {bpy.app.version_string}, {count} frames; {time_taken}")


main()
