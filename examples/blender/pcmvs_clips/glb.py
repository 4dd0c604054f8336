"""Reads the GLB files of pcmvs."""

import json
import pathlib
import struct

import numpy

from . import meshopt

# glTF's types of components and numbers of components.
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
COMPRESSION = "EXT_meshopt_compression"
READABLE = {"KHR_mesh_quantization", COMPRESSION}
# What Python and numpy raise where a file does not have what it should.
DAMAGE = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError, struct.error)


class Unreadable(Exception):
    """What is wrong with a file, for the user."""


class Glb:
    """A GLB file. Its binary data is read when it is used."""

    def __init__(self, path, size=None):
        """Opens a file, which has `size` bytes if that is known."""
        self.path = pathlib.Path(path)
        try:
            data = numpy.memmap(self.path, dtype=numpy.uint8, mode="r")
            magic, version, length, json_length, json_kind = struct.unpack("<4sIII4s", data[:20].tobytes())
            if (magic, version, length, json_kind) != (b"glTF", 2, len(data), b"JSON"):
                raise Unreadable(f"{path}: is no complete GLB file")
            self.json = json.loads(data[20 : 20 + json_length].tobytes())
            unknown = set(self.json.get("extensionsRequired", [])) - READABLE
        except (OSError, *DAMAGE) as error:
            raise Unreadable(f"{path}: cannot be read ({error})") from error
        self.binary = data[28 + json_length :]
        if size not in (None, len(data)):
            raise Unreadable(f"{path}: has {len(data)} bytes, and the clip lists {size}: copy the clip once more")
        if unknown:
            raise Unreadable(f"{path}: needs {', '.join(sorted(unknown))}, which this extension does not know")

    def part(self, view):
        """The stored bytes of a buffer view, or of the description of a compressed one."""
        start, length = view.get("byteOffset", 0), view["byteLength"]
        if view["buffer"] != 0 or not 0 <= start <= start + length <= len(self.binary):
            raise ValueError("a buffer view is outside of the file")
        return self.binary[start : start + length]

    def view(self, index):
        """The bytes of a buffer view, and how far apart its items are, if it says so."""
        view = self.json["bufferViews"][index]
        packed = view.get("extensions", {}).get(COMPRESSION)
        if not packed:
            return self.part(view).tobytes(), view.get("byteStride")
        mode, count, stride = packed["mode"], packed["count"], packed["byteStride"]
        decoded = meshopt.decode(self.part(packed).tobytes(), mode, count, stride, packed.get("filter", "NONE"))
        return decoded.tobytes(), view.get("byteStride")

    def accessor(self, index):
        """An array with a row per item. Normalised integers become fractions."""
        values, normalised = self.stored(index)
        return values / numpy.iinfo(values.dtype).max if normalised else values

    def stored(self, index):
        """An array with a row per item, and whether its integers stand for fractions."""
        accessor = self.json["accessors"][index]
        kind, columns = numpy.dtype(COMPONENTS[accessor["componentType"]]), COUNTS[accessor["type"]]
        data, stride = self.view(accessor["bufferView"])
        strides = (stride or kind.itemsize * columns, kind.itemsize)
        offset = accessor.get("byteOffset", 0)
        values = numpy.ndarray((accessor["count"], columns), kind, data, offset, strides)
        return values, accessor.get("normalized", False)

    def frames(self):
        """The frames' meshes, each with its place: one per child of a packed clip's root, otherwise the only mesh."""
        try:
            root = self.json["nodes"][self.json["scenes"][0]["nodes"][0]]
            return [self.place(child, True) for child in root["children"]] if "children" in root else [self.place(root)]
        except DAMAGE as error:
            raise Unreadable(f"{self.path}: has no mesh of pcmvs ({error!r})") from error

    def place(self, node, is_frame=False):
        """The mesh of a node or below it, and its matrix. A frame's own scale is animated, and is 1 while it is shown."""
        if isinstance(node, int):
            node = self.json["nodes"][node]
        scale = (1, 1, 1) if is_frame else node.get("scale", (1, 1, 1))
        matrix = numpy.identity(4)
        matrix[:3, :3] = turned(node.get("rotation", (0, 0, 0, 1))) * scale
        matrix[:3, 3] = node.get("translation", (0, 0, 0))
        if "mesh" in node:
            return self.json["meshes"][node["mesh"]]["primitives"][0], matrix
        primitive, below = self.place(node["children"][0])
        return primitive, matrix @ below

    def mesh(self, primitive, matrix):
        """The mesh of a primitive, at its place."""
        try:
            return Mesh(self, primitive, matrix)
        except DAMAGE as error:
            raise Unreadable(f"{self.path}: is damaged ({error})") from error

    def duration(self):
        """Seconds of a packed clip's animation, or nothing if there is none."""
        try:
            if not self.json.get("animations"):
                return None
            inputs = [sampler["input"] for sampler in self.json["animations"][0]["samplers"]]
            return float(max(self.json["accessors"][accessor]["max"][0] for accessor in inputs))
        except DAMAGE as error:
            raise Unreadable(f"{self.path}: has no animation of pcmvs ({error!r})") from error

    def up(self):
        try:
            x, y, z = map(float, self.json["scenes"][0].get("extras", {}).get("up", (0, 1, 0)))
            return x, y, z
        except DAMAGE as error:
            raise Unreadable(f"{self.path}: has a wrong upward direction ({error!r})") from error


class Mesh:
    """The arrays of a mesh: a row per vertex, and three corners per triangle."""

    def __init__(self, glb, primitive, matrix):
        attributes = primitive["attributes"]
        self.positions = glb.accessor(attributes["POSITION"]) @ matrix[:3, :3].T + matrix[:3, 3]
        corners, _ = glb.stored(primitive["indices"])
        self.corners = corners.ravel().astype(numpy.int32)
        # Linear light, and places in the texture from its upper left corner on.
        self.colours = glb.accessor(attributes["COLOR_0"])[:, :3] if "COLOR_0" in attributes else None
        self.uvs = glb.accessor(attributes["TEXCOORD_0"]) if "TEXCOORD_0" in attributes else None
        count = len(self.positions)
        if len(self.corners) % 3 or len(corners) and (corners.max() >= count):
            raise ValueError("triangles have corners that are no vertices")
        for values in (self.positions, self.colours, self.uvs):
            if values is not None and (len(values) != count or not numpy.isfinite(values).all()):
                raise ValueError("vertices lack values")
        self.picture = self.uvs is not None and self.find_picture(glb, primitive)

    @staticmethod
    def find_picture(glb, primitive):
        """The bytes of the texture's file."""
        texture = glb.json["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorTexture"]
        source = glb.json["images"][glb.json["textures"][texture["index"]]["source"]]
        return glb.view(source["bufferView"])[0]


def turned(rotation):
    """The matrix of a quaternion x, y, z, w."""
    x, y, z, w = rotation
    return numpy.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        )
    )
