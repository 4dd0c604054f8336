"""Blender add-on: imports a clip of pcmvs as one object whose mesh changes from frame to frame.

Install this file by Edit > Preferences > Add-ons > Install from Disk, then use File > Import > pcmvs clip. It opens
sequence.json with the frames beside it, and clips of `pcmvs pack`. Blender must have the add-on whenever the clip is to play,
also where it is rendered.

The mesh is exchanged whenever the scene's frame changes, so that moving or scaling the object moves all frames. Colours are
those of the photographs and are not lit again; with the view transform "Standard" they look as in other players. Compressed
files cannot be read: reconstruct without --compress.
"""

import json
import pathlib
import struct

import bpy
import numpy
from bpy.app.handlers import persistent
from bpy_extras.io_utils import ImportHelper
from mathutils import Matrix, Quaternion, Vector

bl_info = {
    "name": "pcmvs clips",
    "description": "Imports clips of pcmvs, which have a mesh per frame",
    "version": (1, 0, 0),
    "blender": (4, 2, 0),
    "location": "File > Import > pcmvs clip",
    "category": "Import-Export",
}

# glTF has +y up, Blender has +z.
TO_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
# glTF's types of components and numbers of components.
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
READABLE = {"KHR_mesh_quantization"}


class Unreadable(Exception):
    """What is wrong with a file, for the user."""


class Glb:
    """A GLB file. Its binary data is read when it is used."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        try:
            data = numpy.memmap(self.path, dtype=numpy.uint8, mode="r")
            magic, version, length, json_length, json_kind = struct.unpack("<4sIII4s", data[:20].tobytes())
            if (magic, version, length, json_kind) != (b"glTF", 2, len(data), b"JSON"):
                raise Unreadable(f"{path}: is no complete GLB file")
            self.json = json.loads(data[20 : 20 + json_length].tobytes())
        except (OSError, ValueError, struct.error) as error:
            raise Unreadable(f"{path}: cannot be read ({error})") from error
        self.binary = data[28 + json_length :]
        unknown = set(self.json.get("extensionsRequired", [])) - READABLE
        if unknown:
            names = ", ".join(sorted(unknown))
            raise Unreadable(f"{path}: needs {names}: reconstruct without --compress")

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.binary[start : start + view["byteLength"]], view.get("byteStride")

    def accessor(self, index):
        """An array with a row per item. Normalised integers become fractions."""
        accessor = self.json["accessors"][index]
        kind, columns = numpy.dtype(COMPONENTS[accessor["componentType"]]), COUNTS[accessor["type"]]
        data, stride = self.view(accessor["bufferView"])
        data = data[accessor.get("byteOffset", 0) :]
        strides = (stride or kind.itemsize * columns, kind.itemsize)
        values = numpy.ndarray((accessor["count"], columns), kind, data.tobytes(), strides=strides)
        return values / numpy.iinfo(kind).max if accessor.get("normalized") else values

    def frames(self):
        """The frames' meshes, each with its place: one per child of a packed clip's root, otherwise the only mesh."""
        root = self.json["nodes"][self.json["scenes"][0]["nodes"][0]]
        return [self.place(child, True) for child in root["children"]] if "children" in root else [self.place(root)]

    def place(self, node, is_frame=False):
        """The mesh of a node or below it. A frame's own scale is animated, and is 1 while the frame is shown."""
        if isinstance(node, int):
            node = self.json["nodes"][node]
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        scale = (1, 1, 1) if is_frame else node.get("scale", (1, 1, 1))
        matrix = Matrix.LocRotScale(Vector(node.get("translation", (0, 0, 0))), Quaternion((w, x, y, z)), Vector(scale))
        if "mesh" in node:
            return self.json["meshes"][node["mesh"]]["primitives"][0], matrix
        primitive, below = self.place(node["children"][0])
        return primitive, matrix @ below

    def duration(self):
        """Seconds of a packed clip's animation."""
        inputs = [sampler["input"] for sampler in self.json["animations"][0]["samplers"]]
        return max(self.json["accessors"][accessor]["max"][0] for accessor in inputs)

    def up(self):
        return self.json["scenes"][0].get("extras", {}).get("up", (0, 1, 0))


def open_clip(path):
    """Frames per second, and a function per frame that opens its file and returns it with the mesh and its place."""
    path = pathlib.Path(path)
    if path.suffix.lower() == ".glb":
        glb = Glb(path)
        frames = glb.frames()
        fps = len(frames) / glb.duration() if glb.json.get("animations") else None
        return fps, [lambda frame=frame: (glb, *frame) for frame in frames]
    try:
        manifest = json.loads(path.read_bytes())
        urls = [frame["url"] for frame in manifest["frames"]]
        fps = manifest["fps"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise Unreadable(f"{path}: is no sequence.json of pcmvs ({error!r})") from error
    if not urls:
        raise Unreadable(f"{path}: lists no frames: run pcmvs reconstruct")

    def opened(url):
        glb = Glb(path.parent / url)
        return glb, *glb.frames()[0]

    return fps, [lambda url=url: opened(url) for url in urls]


def make_material(name, glb, primitive):
    """Colours of the vertices or of the texture, not lit."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output, emission = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeEmission")
    links.new(emission.outputs["Emission"], output.inputs["Surface"])
    texture = glb.json["materials"][primitive["material"]]["pbrMetallicRoughness"].get("baseColorTexture")
    if texture:
        source = glb.json["images"][glb.json["textures"][texture["index"]]["source"]]
        data = glb.view(source["bufferView"])[0].tobytes()
        image = bpy.data.images.new(name, 8, 8)
        image.pack(data=data, data_len=len(data))
        image.source = "FILE"
        colours = nodes.new("ShaderNodeTexImage")
        colours.image = image
    else:
        colours = nodes.new("ShaderNodeVertexColor")
        colours.layer_name = "Color"
    links.new(colours.outputs["Color"], emission.inputs["Color"])
    return material


def make_mesh(name, glb, primitive, matrix):
    """The mesh of a frame in Blender's axes."""
    attributes = primitive["attributes"]
    place = numpy.array(TO_BLENDER @ matrix)
    positions = glb.accessor(attributes["POSITION"]) @ place[:3, :3].T + place[:3, 3]
    corners = glb.accessor(primitive["indices"]).ravel().astype(numpy.int32)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(numpy.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(corners) // 3)
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, len(corners), 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(corners) // 3, dtype=bool))
    if "COLOR_0" in attributes:
        colours = numpy.ones((len(positions), 4), dtype=numpy.float32)
        colours[:, :3] = glb.accessor(attributes["COLOR_0"])[:, :3]
        mesh.color_attributes.new("Color", "FLOAT_COLOR", "POINT").data.foreach_set("color", colours.ravel())
    if "TEXCOORD_0" in attributes:
        # glTF counts v from the top of the picture.
        uvs = glb.accessor(attributes["TEXCOORD_0"]) * (1, -1) + (0, 1)
        mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uvs[corners].astype(numpy.float32).ravel())
    mesh.update(calc_edges=True)
    return mesh


def import_clip(context, path, set_scene=True):
    """Adds the clip at a path to the scene. Returns its object. Frame `frame_start` of the scene shows its first frame."""
    fps, frames = open_clip(path)
    made, shared = [], None
    try:
        for i, opened in enumerate(frames):
            glb, primitive, matrix = opened()
            name = f"{pathlib.Path(path).stem} {i}"
            mesh = make_mesh(name, glb, primitive, matrix)
            made.append(mesh)
            if "TEXCOORD_0" in primitive["attributes"] or shared is None:
                shared = make_material(name, glb, primitive)
            mesh.materials.append(shared)
    except Unreadable:
        bpy.data.batch_remove(made)
        raise
    clip = bpy.data.objects.new(pathlib.Path(path).resolve().parent.name, made[0])
    # The clip's upward direction becomes that of Blender.
    up = TO_BLENDER.to_3x3() @ Vector(glb.up())
    clip.rotation_mode = "QUATERNION"
    clip.rotation_quaternion = up.rotation_difference(Vector((0, 0, 1)))
    scene = context.scene
    clip.pcmvs_clip.start = scene.frame_start
    for mesh in made:
        clip.pcmvs_clip.frames.add().mesh = mesh
    scene.collection.objects.link(clip)
    if set_scene:
        scene.frame_end = scene.frame_start + len(made) - 1
        if fps:
            # Blender's frame rate is an integer divided by a base.
            scene.render.fps = max(1, round(fps))
            scene.render.fps_base = scene.render.fps / fps
    show_frames(scene)
    return clip


@persistent
def show_frames(scene, _=None):
    """Gives every clip the mesh of the scene's frame. Before its start it shows its first frame, after its end its last."""
    for shown in scene.objects:
        clip = shown.pcmvs_clip
        if clip.frames:
            i = min(max(scene.frame_current - clip.start, 0), len(clip.frames) - 1)
            shown.data = clip.frames[i].mesh


class PcmvsFrame(bpy.types.PropertyGroup):
    mesh: bpy.props.PointerProperty(type=bpy.types.Mesh)


class PcmvsClip(bpy.types.PropertyGroup):
    start: bpy.props.IntProperty(name="Start", description="Frame of the scene that shows the first frame of the clip")
    frames: bpy.props.CollectionProperty(type=PcmvsFrame)


class ImportPcmvs(bpy.types.Operator, ImportHelper):
    """Import a clip of pcmvs: sequence.json, or a clip of pcmvs pack"""

    bl_idname = "import_scene.pcmvs"
    bl_label = "Import pcmvs clip"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".json"
    filter_glob: bpy.props.StringProperty(default="*.json;*.glb", options={"HIDDEN"})
    set_scene: bpy.props.BoolProperty(name="Set frame rate and range of the scene", default=True)

    def execute(self, context):
        try:
            import_clip(context, self.filepath, self.set_scene)
        except Unreadable as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def add_to_menu(menu, _):
    menu.layout.operator(ImportPcmvs.bl_idname, text="pcmvs clip (sequence.json, .glb)")


CLASSES = (PcmvsFrame, PcmvsClip, ImportPcmvs)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Object.pcmvs_clip = bpy.props.PointerProperty(type=PcmvsClip)
    bpy.types.TOPBAR_MT_file_import.append(add_to_menu)
    bpy.app.handlers.frame_change_pre.append(show_frames)


def unregister():
    bpy.app.handlers.frame_change_pre.remove(show_frames)
    bpy.types.TOPBAR_MT_file_import.remove(add_to_menu)
    del bpy.types.Object.pcmvs_clip
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)


if __name__ == "__main__":
    register()
