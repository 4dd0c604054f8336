"""Reconstructs a frame of a captured scene and looks at the result.

Usage: reconstruct.py SCENE OUT, with SCENE a folder with scene.json. Each part between lines of ``# %%`` is a cell of a notebook.
"""

import sys
from pathlib import Path

import numpy as np
import pcmvs

# %% Open a capture. Without scene.json, make the rig of `pcmvs.Camera`s and pass your own arrays.
scene = pcmvs.Scene.open(sys.argv[1])
out = Path(sys.argv[2])
rig = scene.rig()
pictures = scene.pictures(scene.frames[0])
print(f"{len(rig)} cameras, {len(scene.frames)} frames, pictures of {scene.cameras[0].size} pixels")


# %% Run the first stages and see whether cameras and masks agree.
def show(stage: str, done: float) -> None:
    """Returning False would cancel."""
    print(f"\r{stage:9}{done:6.0%}", end="", flush=True)


frame = pcmvs.Frame(rig, **pictures)
frame.run("hull", progress=show)
print()
for name, view in zip(scene.names, frame.diagnostics):
    print(f"{name}: overlap {view.silhouette_overlap or 0:.3f}, contour {view.contour_px or 0:.2f} px")
for warning in frame.warnings:
    print("warning:", warning.message)

# %% Run the others, and count the points of each camera.
frame.run(progress=show)
print()
points = frame.points("detected")
for camera, name in enumerate(scene.names):
    print(f"{name}: {np.count_nonzero(points.camera == camera)} points")
print(frame.counts)

# %% The mesh as arrays.
mesh = frame.mesh()
low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
print(f"{len(mesh.positions)} vertices, {len(mesh.triangles)} triangles")
print(f"size {np.round(high - low, 3)} {scene.units or ''}")
if mesh.colours is not None:
    print(f"mean colour {mesh.colours.mean(axis=0).round()}")

# %% Save it: as it is, and small and upright for viewers.
mesh.save(out / "mesh.glb", up=scene.up)
form = frame.form(faces=20_000, texture=True, progress=show)
print()
form.save(out / "viewer.glb", up=scene.up, upright=scene.up is not None, normals=False, compact=True)
for file in sorted(out.glob("*.glb")):
    print(f"{file.name}: {file.stat().st_size / 1e6:.2f} MB")
