"""Draws the forms of a mesh in Blender and compares the pictures with our own: pictures.py FOLDER.

The folder has what xtask/src/forms.rs makes. The extension imports each form, and Cycles draws it. Nothing is turned by hand.
"""

import json
import math
import pathlib
import sys

import bpy
import numpy
from mathutils import Vector
from package import FOLDER as EXTENSION

sys.path.insert(0, str(EXTENSION))
import pcmvs_clips  # noqa: E402

FOLDER = pathlib.Path(sys.argv[1])
# Required overlap of the silhouettes.
OVERLAP = 0.97


def add_camera(view):
    """The camera of view.json, whose axes are those of glTF."""
    theta, phi = view["theta"], view["phi"]
    offset = (math.sin(phi) * math.sin(theta), math.cos(phi), math.sin(phi) * math.cos(theta))
    x, y, z = (at + view["radius"] * by for at, by in zip(view["target"], offset))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.angle = view["fov"]
    camera.location = (x, -z, y)
    camera.rotation_mode = "QUATERNION"
    camera.rotation_quaternion = Vector((offset[0], -offset[2], offset[1])).to_track_quat("Z", "Y")
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera


def draw(view, path):
    """Draws the scene in the colours that it has, on a transparent background."""
    scene = bpy.context.scene
    add_camera(view)
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    # The mean of a pixel's area.
    scene.cycles.samples = 16
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x = scene.render.resolution_y = view["size"]
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def read(path):
    """Colours from 0 to 255, and where there is a mesh."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    pixels = numpy.empty(len(image.pixels), dtype=numpy.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(*image.size, 4)
    return 255 * pixels[:, :, :3], pixels[:, :, 3] >= 0.5


def compare(seen, ours):
    """Intersection over union of the silhouettes, also of the flipped one, and PSNR without the outermost pixels."""

    def overlap(mask):
        return (mask & ours[1]).sum() / (mask | ours[1]).sum()

    inner = seen[1] & ours[1]
    for axis in (0, 1):
        inner = inner & numpy.roll(inner, 1, axis) & numpy.roll(inner, -1, axis)
    error = ((seen[0][inner] - ours[0][inner]) ** 2).mean()
    mirrored = max(overlap(seen[1][::-1]), overlap(seen[1][:, ::-1]))
    return overlap(seen[1]), mirrored, 10 * math.log10(255**2 / error)


def main():
    pcmvs_clips.register()
    view = json.loads((FOLDER / "view.json").read_bytes())
    measured = []
    for form in json.loads((FOLDER / "forms.json").read_bytes()):
        name = form["name"]
        bpy.ops.wm.read_factory_settings(use_empty=True)
        assert bpy.ops.import_scene.pcmvs(filepath=str(FOLDER / "forms" / name / "sequence.json")) == {"FINISHED"}
        path = FOLDER / f"blender-{name}.png"
        draw(view, path)
        overlap, mirrored, psnr = compare(read(path), read(FOLDER / "ours/forms" / f"{name}.png"))
        measured.append(f"{name}: overlap {overlap:.4f} (flipped at most {mirrored:.3f}), {psnr:.1f} dB")
        assert overlap >= OVERLAP > mirrored and psnr >= form["required"], measured
    print("\n".join(measured))


main()
