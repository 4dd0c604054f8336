"""The parts of the Blender extension that need no Blender."""

import pathlib
import sys
import types

FOLDER = pathlib.Path(__file__).parents[2] / "examples/blender"


def without_blender():
    """Makes `import pcmvs_clips.glb` and others possible without Blender, which the package itself needs."""
    package = types.ModuleType("pcmvs_clips")
    package.__path__ = [str(FOLDER / "pcmvs_clips")]
    sys.modules["pcmvs_clips"] = package
