"""Exceptions of pcmvs."""

from __future__ import annotations


class Error(Exception):
    """Base class of all exceptions of pcmvs. The message names the camera, if one is to blame, and the remedy."""

    code: str
    """Stable name of the kind of error, such as ``"silhouette"`` or ``"too-few-views"``."""
    camera: int | None
    """Index of the camera to blame, if there is one."""

    def __init__(self, message: str, code: str = "other", camera: int | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.camera = camera


class InputError(Error, ValueError):
    """Cameras, pictures, masks or other arguments cannot be used."""


class OrderError(Error, RuntimeError):
    """A result was asked for before its stage has run."""


class MemoryLimitError(Error, MemoryError):
    """The frame needs more memory than ``max_memory`` allows. Nothing of it has been allocated."""


class Cancelled(Error):
    """The progress callback returned False."""
