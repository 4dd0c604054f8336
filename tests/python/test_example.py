"""The example runs."""

import subprocess
import sys
from pathlib import Path


def test_the_example_writes_two_files(capture, tmp_path):
    example = Path(__file__).parents[2] / "examples/python/reconstruct.py"
    done = subprocess.run([sys.executable, example, capture, tmp_path], check=True, capture_output=True, text=True)
    assert "12 cameras, 2 frames, pictures of (160, 120) pixels" in done.stdout
    sizes = {file.name: file.stat().st_size for file in tmp_path.iterdir()}
    assert set(sizes) == {"mesh.glb", "viewer.glb"} and sizes["viewer.glb"] < sizes["mesh.glb"]
    assert all(file.read_bytes()[:4] == b"glTF" for file in tmp_path.iterdir())
