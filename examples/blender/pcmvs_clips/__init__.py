"""Blender extension: imports a clip of pcmvs as one object whose mesh changes from frame to frame.

docs/players.md says how it is installed. It opens sequence.json of both versions with the files beside it, and clips of
`pcmvs pack`, in all forms. Blender must have the extension whenever the clip is to play, also where it is rendered.

The mesh is exchanged whenever the scene's frame changes, so that moving or scaling the object moves all frames. Colours are
those of the photographs and are not lit again; with the view transform "Standard" they look as in other players.
"""

import os
import pathlib

import bpy
from bpy.app.handlers import persistent
from bpy_extras.io_utils import ImportHelper

from .clip import quality_names
from .glb import Unreadable
from .scene import import_clip, show_frames


@persistent
def follow(scene, _=None):
    show_frames(scene)


class PcmvsFrame(bpy.types.PropertyGroup):
    mesh: bpy.props.PointerProperty(type=bpy.types.Mesh)


class PcmvsClip(bpy.types.PropertyGroup):
    start: bpy.props.IntProperty(name="Start", description="Frame of the scene that shows the first frame of the clip")
    frames: bpy.props.CollectionProperty(type=PcmvsFrame)


def offer_qualities(operator, context, _):
    """Names of the qualities that the chosen clip has."""
    chosen = getattr(context.space_data, "params", None)
    if chosen is None:
        return quality_names(operator.filepath)
    return quality_names(pathlib.Path(os.fsdecode(chosen.directory)) / chosen.filename)


class ImportPcmvs(bpy.types.Operator, ImportHelper):
    """Import a clip of pcmvs: sequence.json, or a clip of pcmvs pack"""

    bl_idname = "import_scene.pcmvs"
    bl_label = "Import pcmvs clip"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".json"
    filter_glob: bpy.props.StringProperty(default="*.json;*.glb", options={"HIDDEN"})
    quality: bpy.props.StringProperty(
        name="Quality",
        description="Name of a quality of the clip, such as web. Without a name the best one is imported",
        search=offer_qualities,
    )
    set_scene: bpy.props.BoolProperty(name="Set frame rate and range of the scene", default=True)
    sound: bpy.props.BoolProperty(name="Sound", description="Add the sound of the clip, if it has one", default=True)

    def execute(self, context):
        try:
            _, silent = import_clip(context, self.filepath, self.quality, self.set_scene, self.sound)
        except Unreadable as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if silent:
            self.report({"WARNING"}, silent)
        return {"FINISHED"}


def add_to_menu(menu, _):
    menu.layout.operator(ImportPcmvs.bl_idname, text="pcmvs clip (sequence.json, .glb)")


CLASSES = (PcmvsFrame, PcmvsClip, ImportPcmvs)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Object.pcmvs_clip = bpy.props.PointerProperty(type=PcmvsClip)
    bpy.types.TOPBAR_MT_file_import.append(add_to_menu)
    bpy.app.handlers.frame_change_pre.append(follow)


def unregister():
    bpy.app.handlers.frame_change_pre.remove(follow)
    bpy.types.TOPBAR_MT_file_import.remove(add_to_menu)
    del bpy.types.Object.pcmvs_clip
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
