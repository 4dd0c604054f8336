"""A capture that the studio has rendered, and what the command line makes of it. ``cargo xtask python`` sets both paths."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

import pcmvs
import pytest


def path_from(variable: str) -> Path:
    path = os.environ.get(variable)
    if path is None:
        pytest.exit(f"{variable} is not set: run the tests by `cargo xtask python`", returncode=2)
    return Path(path)


@pytest.fixture(scope="session")
def capture() -> Path:
    """A scene folder with 12 cameras and 2 frames."""
    return path_from("PCMVS_CAPTURE")


@pytest.fixture(scope="session")
def scene(capture: Path) -> pcmvs.Scene:
    return pcmvs.Scene.open(capture)


@pytest.fixture
def pictures(scene: pcmvs.Scene) -> Any:
    """Images and masks of the first frame, as arguments of a frame."""
    return scene.pictures(0)


@pytest.fixture(scope="session")
def finished(scene: pcmvs.Scene) -> pcmvs.Frame:
    """The first frame with the default parameters."""
    return pcmvs.reconstruct(scene.rig(), **scene.pictures(0))


@pytest.fixture
def command(capture: Path, tmp_path: Path) -> Any:
    """Runs ``pcmvs reconstruct`` on the first frame, by itself unless told otherwise. Returns the folder of its results."""

    def run(*options: str, alone: bool = True) -> Path:
        out = tmp_path / "command"
        program = path_from("PCMVS_COMMAND")
        subprocess.run([program, "reconstruct", capture, "-o", out, "--frames", "0", *["--alone"][: int(alone)], *options], check=True)
        return out

    return run
