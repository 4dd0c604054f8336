"""The programs of both README files run."""

import re
from pathlib import Path

import numpy as np
import pytest


def programs():
    root = Path(__file__).parents[2]
    for file in ("README.md", "python/README.md"):
        for program in re.findall(r"```python\n(.*?)```", (root / file).read_text(), flags=re.DOTALL):
            yield pytest.param(program, id=file)


@pytest.mark.parametrize("program", list(programs()))
def test_a_program_of_a_readme_writes_a_file(program, scene, pictures, capture, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "capture").symlink_to(capture)
    width, height = scene.cameras[0].size
    calibration = [(camera.k, camera.r, camera.t, np.zeros(5)) for camera in scene.cameras]
    exec(program, {"calibration": calibration, "width": width, "height": height, **pictures})
    (file,) = tmp_path.glob("*.glb")
    assert file.read_bytes()[:4] == b"glTF"
