"""Types of arguments, for type checkers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, Optional, TypedDict, Union

import numpy as np
from numpy.typing import NDArray

Images = Sequence[Optional[NDArray[np.uint8]]]
"""One picture per camera: height x width, x 3 (RGB) or x 4 (RGBA). None for a camera without one."""
Masks = Sequence[Union[NDArray[np.uint8], NDArray[np.bool_], None]]
"""One mask per camera, white on the object. None where there is none."""
Colours = Sequence[tuple[int, int, int]]
"""sRGB colours."""
Vector = Union[Sequence[float], NDArray[np.float64]]
Parameters = Union[Literal["default", "paper", "hull", "preview"], dict[str, Any]]
"""The name of a preset, or what ``pcmvs.preset`` returns, changed."""
Progress = Callable[[str, float], Optional[bool]]
"""Called with the name of a stage and the share of it that is done. False cancels."""


class Pictures(TypedDict, total=False):
    """Arguments of ``Frame`` and ``reconstruct``: the pictures of one frame."""

    images: Images
    masks: Masks
    chroma: Colours
    plates: Images
