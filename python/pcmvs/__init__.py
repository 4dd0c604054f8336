"""Multi-view stereo for free-viewpoint video: one closed, coloured mesh per frame from calibrated cameras with masks.

>>> scene = pcmvs.Scene.open("capture")
>>> frame = pcmvs.reconstruct(scene.rig(), **scene.pictures(0))
>>> frame.mesh().save("frame_0000.glb", up=scene.up)
"""

from ._pcmvs import (
    Calibration,
    Camera,
    CameraReport,
    CaptureWarning,
    Finding,
    Frame,
    Mesh,
    Points,
    Rig,
    Scene,
    ViewDiagnostics,
    __version__,
    calibrate,
    preset,
    reconstruct,
)
from .errors import Cancelled, Error, InputError, MemoryLimitError, OrderError

__all__ = [
    "Calibration",
    "Camera",
    "CameraReport",
    "Cancelled",
    "CaptureWarning",
    "Error",
    "Finding",
    "Frame",
    "InputError",
    "MemoryLimitError",
    "Mesh",
    "OrderError",
    "Points",
    "Rig",
    "Scene",
    "ViewDiagnostics",
    "__version__",
    "calibrate",
    "preset",
    "reconstruct",
]
