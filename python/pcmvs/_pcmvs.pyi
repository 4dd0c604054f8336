import os
from collections.abc import Sequence
from typing import Any, ClassVar, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .types import Colours, Images, Masks, Parameters, Pictures, Progress, Vector

__all__ = [
    "Calibration",
    "Camera",
    "CameraReport",
    "CaptureWarning",
    "Finding",
    "Frame",
    "Mesh",
    "Points",
    "Rig",
    "Scene",
    "ViewDiagnostics",
    "__version__",
    "calibrate",
    "preset",
    "reconstruct",
]

__version__: str

@final
class Camera:
    def __new__(
        cls,
        k: ArrayLike,
        r: ArrayLike,
        t: ArrayLike,
        size: tuple[int, int],
        *,
        distortion: Vector = ...,
        lens: Literal["opencv", "fisheye"] = "opencv",
    ) -> Camera: ...
    @property
    def k(self) -> NDArray[np.float64]: ...
    @property
    def r(self) -> NDArray[np.float64]: ...
    @property
    def t(self) -> NDArray[np.float64]: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def distortion(self) -> NDArray[np.float64]: ...
    @property
    def lens(self) -> Literal["opencv", "fisheye"]: ...
    @property
    def centre(self) -> NDArray[np.float64]: ...
    def project(self, points: ArrayLike) -> NDArray[np.float64]: ...

@final
class Rig:
    def __new__(cls, cameras: Sequence[Camera], *, gains: ArrayLike | None = None) -> Rig: ...
    @property
    def cameras(self) -> list[Camera]: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def warnings(self) -> list[CaptureWarning]: ...
    def __len__(self) -> int: ...

@final
class Scene:
    @staticmethod
    def open(path: str | os.PathLike[str], *, silhouettes: Literal["masks", "chroma", "plates"] = "masks") -> Scene: ...
    @property
    def path(self) -> os.PathLike[str]: ...
    @property
    def cameras(self) -> list[Camera]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def frames(self) -> list[int]: ...
    @property
    def up(self) -> list[float] | None: ...
    @property
    def units(self) -> str | None: ...
    @property
    def fps(self) -> float | None: ...
    def rig(self) -> Rig: ...
    def pictures(self, index: int, *, threads: int | None = None) -> Pictures: ...

@final
class Frame:
    STAGES: ClassVar[tuple[str, ...]]
    def __new__(
        cls,
        rig: Rig,
        images: Images,
        masks: Masks | None = None,
        *,
        chroma: Colours | None = None,
        plates: Images | None = None,
        before: Pictures | None = None,
        after: Pictures | None = None,
        params: Parameters = "default",
        max_memory: int | None = None,
    ) -> Frame: ...
    def run(self, until: str = "colour", *, threads: int | None = None, progress: Progress | None = None) -> None: ...
    @property
    def reached(self) -> str | None: ...
    def mesh(self) -> Mesh: ...
    def hull(self) -> Mesh: ...
    def coarse(self) -> Mesh: ...
    @property
    def restored(self) -> int: ...
    def may_have_lost_part(self, before: Frame, after: Frame, *, threads: int | None = None) -> bool: ...
    def steady(
        self,
        neighbours: Sequence[Frame],
        *,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> None: ...
    def form(
        self,
        *,
        faces: int | None = None,
        texture: bool | int = False,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Mesh: ...
    def points(
        self,
        kind: Literal["frontier", "implicit", "detected", "merged"] = "merged",
        *,
        camera: int | None = None,
    ) -> Points: ...
    def silhouette(self, camera: int) -> NDArray[np.float32] | None: ...
    @property
    def warnings(self) -> list[CaptureWarning]: ...
    @property
    def diagnostics(self) -> list[ViewDiagnostics]: ...
    @property
    def gains(self) -> NDArray[np.float32]: ...
    @property
    def counts(self) -> dict[str, int]: ...
    @property
    def hashes(self) -> dict[str, str]: ...
    @property
    def params(self) -> dict[str, Any]: ...

@final
class Mesh:
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def normals(self) -> NDArray[np.float32]: ...
    @property
    def colours(self) -> NDArray[np.uint8] | None: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def uvs(self) -> NDArray[np.float32] | None: ...
    @property
    def texture(self) -> NDArray[np.uint8] | None: ...
    def to_glb(
        self,
        *,
        normals: bool | None = None,
        up: Vector | None = None,
        upright: bool = False,
        compact: bool = False,
        compress: bool = False,
        jpeg_quality: int = 90,
    ) -> bytes: ...
    def to_ply(self) -> bytes: ...
    def save(
        self,
        path: str | os.PathLike[str],
        *,
        normals: bool | None = None,
        up: Vector | None = None,
        upright: bool = False,
        compact: bool = False,
        compress: bool = False,
        jpeg_quality: int = 90,
    ) -> None: ...

@final
class Points:
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def normals(self) -> NDArray[np.float32]: ...
    @property
    def fidelity(self) -> NDArray[np.float32]: ...
    @property
    def sigma(self) -> NDArray[np.float32]: ...
    @property
    def weight(self) -> NDArray[np.float32]: ...
    @property
    def camera(self) -> NDArray[np.int32]: ...
    @property
    def rank(self) -> NDArray[np.uint8]: ...
    def to_ply(self) -> bytes: ...
    def __len__(self) -> int: ...

@final
class CaptureWarning:
    @property
    def code(self) -> str: ...
    @property
    def camera(self) -> int | None: ...
    @property
    def message(self) -> str: ...

@final
class ViewDiagnostics:
    @property
    def used(self) -> bool: ...
    @property
    def silhouette_overlap(self) -> float | None: ...
    @property
    def contour_px(self) -> float | None: ...
    @property
    def epipolar_px(self) -> float | None: ...

@final
class Calibration:
    @property
    def verdict(self) -> Literal["improved", "kept", "undecided"]: ...
    @property
    def cameras(self) -> list[Camera]: ...
    @property
    def reports(self) -> list[CameraReport]: ...
    @property
    def findings(self) -> list[Finding]: ...
    @property
    def epipolar_bias_px(self) -> tuple[float, float] | None: ...
    @property
    def points(self) -> int: ...

@final
class CameraReport:
    @property
    def contour_px(self) -> tuple[float | None, float | None]: ...
    @property
    def epipolar_px(self) -> tuple[float | None, float | None]: ...
    @property
    def matches(self) -> tuple[int, int]: ...
    @property
    def moved_px(self) -> float: ...
    @property
    def sigma_px(self) -> float | None: ...
    @property
    def silhouette_overlap(self) -> float | None: ...
    @property
    def gain(self) -> float | None: ...

@final
class Finding:
    @property
    def code(self) -> str: ...
    @property
    def cameras(self) -> list[int]: ...
    @property
    def message(self) -> str: ...

def preset(name: Literal["default", "paper", "hull", "preview"]) -> dict[str, Any]: ...
def reconstruct(
    rig: Rig,
    images: Images,
    masks: Masks | None = None,
    *,
    chroma: Colours | None = None,
    plates: Images | None = None,
    params: Parameters = "default",
    max_memory: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Frame: ...
def calibrate(
    rig: Rig,
    frames: Sequence[Pictures],
    *,
    intrinsics: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Calibration: ...
