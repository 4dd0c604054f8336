"""Installs the extension in Blender as people do, and imports a clip with it: install.py FOLDER.

The folder has compressed/, a clip of `pcmvs reconstruct`. BLENDER_USER_RESOURCES must name a folder for Blender's settings.
"""

import os
import pathlib
import subprocess
import sys

import bpy
from package import FOLDER as EXTENSION

# Blender brings this module.
import addon_utils  # noqa: E402, I001

folder = pathlib.Path(sys.argv[1])
assert os.environ["BLENDER_USER_RESOURCES"], "the settings of the user must not change"
archive = folder / "pcmvs_clips.zip"
# The command that docs/players.md gives.
command = [sys.executable, "-m", "zipfile", "-c", str(archive), "pcmvs_clips/"]
subprocess.run(command, cwd=EXTENSION, check=True)
# What "Install from Disk" runs.
addon_utils.enable("bl_pkg")
done = bpy.ops.extensions.package_install_files(filepath=str(archive), repo="user_default", enable_on_install=True)
assert done == {"FINISHED"}, done
assert "bl_ext.user_default.pcmvs_clips" in bpy.context.preferences.addons
assert bpy.ops.import_scene.pcmvs(filepath=str(folder / "compressed/sequence.json")) == {"FINISHED"}
assert len(bpy.context.scene.objects["compressed"].pcmvs_clip.frames) > 1
