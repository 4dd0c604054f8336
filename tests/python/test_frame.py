"""Stages, parameters and files."""

import math

import numpy as np
import pcmvs
import pytest


def test_stages_run_one_by_one(scene, pictures, finished):
    frame = pcmvs.Frame(scene.rig(), **pictures)
    assert frame.reached is None
    for stage in pcmvs.Frame.STAGES:
        frame.run(stage)
        assert frame.reached == stage and list(frame.hashes)[-1] == stage
    assert frame.hashes == finished.hashes
    # What is complete does not run again.
    frame.run(progress=lambda stage, done: pytest.fail(stage))


def test_results_exist_after_their_stage_only(scene, pictures):
    frame = pcmvs.Frame(scene.rig(), **pictures)
    results = {
        "hull": [frame.hull, lambda: frame.silhouette(0), lambda: frame.diagnostics],
        "contours": [lambda: frame.points("frontier"), lambda: frame.points("implicit")],
        "coarse": [frame.coarse],
        "detect": [lambda: frame.points("detected"), lambda: frame.points("detected", camera=1)],
        "merge": [frame.points],
        "mesh": [frame.mesh],
        "colour": [frame.form, lambda: frame.gains],
    }
    for stage, calls in results.items():
        for call in calls:
            with pytest.raises(pcmvs.OrderError, match=f"requires the stage `{stage}`"):
                call()
        frame.run(stage)
        for call in calls:
            call()


def test_points_say_who_found_them(scene, finished):
    everyone = finished.points("detected")
    count = len(everyone)
    assert (everyone.positions.dtype, everyone.positions.shape) == (np.float64, (count, 3))
    assert (everyone.normals.dtype, everyone.normals.shape) == (np.float32, (count, 3))
    for values, kind in [
        (everyone.fidelity, np.float32),
        (everyone.sigma, np.float32),
        (everyone.weight, np.float32),
        (everyone.camera, np.int32),
        (everyone.rank, np.uint8),
    ]:
        assert (values.dtype, values.shape) == (kind, (count,))
    assert count == finished.counts["detected"] + finished.counts["substituted"] - sum(
        finished.counts[name] for name in ("cleaned_density", "cleaned_pca", "cleaned_normal")
    )
    for camera, calibrated in enumerate(scene.cameras):
        own = finished.points("detected", camera=camera)
        assert len(own) == np.count_nonzero(everyone.camera == camera) and (own.camera == camera).all()
        # The camera sees them from the front.
        towards = calibrated.centre - own.positions
        assert (np.einsum("ij,ij->i", towards, own.normals) > 0).mean() > 0.9
    assert set(np.unique(everyone.rank)) <= {1, 2}
    assert (finished.points("frontier").rank == 3).all()


def test_parameters_can_be_changed(scene, pictures):
    params = pcmvs.preset("preview")
    params["detection"]["search"]["neighbours"] = 2
    params["frontier"] = None
    frame = pcmvs.Frame(scene.rig(), **pictures, params=params)
    assert frame.params == params
    frame.run("contours")
    assert len(frame.points("frontier")) == 0


def test_parameters_with_a_slip_are_refused(scene, pictures):
    for change in [{"frontiers": None}, {"detection": 1}, {"hull": {"voxel_pixels": math.nan}}]:
        with pytest.raises(pcmvs.InputError, match="params: .*change what pcmvs.preset returns"):
            pcmvs.Frame(scene.rig(), **pictures, params={**pcmvs.preset("default"), **change})
    with pytest.raises(pcmvs.InputError, match='params is "best": it is one of'):
        pcmvs.Frame(scene.rig(), **pictures, params="best")
    with pytest.raises(pcmvs.InputError, match='there is no stage "shape"'):
        pcmvs.Frame(scene.rig(), **pictures).run("shape")


def test_files_are_whole_or_missing(finished, tmp_path):
    mesh = finished.mesh()
    mesh.save(tmp_path / "new/mesh.glb", upright=True, up=(0, 0, 1))
    assert (tmp_path / "new/mesh.glb").read_bytes() == mesh.to_glb(upright=True, up=(0, 0, 1))
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["mesh.glb"]
    (tmp_path / "folder.glb").mkdir()
    with pytest.raises(pcmvs.Error, match="folder.glb: cannot be written"):
        mesh.save(tmp_path / "folder.glb")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.glb", "new"]
    for name, options, expected in [
        ("mesh.obj", {}, "must end with .glb or .ply"),
        ("mesh.ply", {"compact": True}, "compact is for GLB files: write a .glb"),
        ("mesh.ply", {"compress": True}, "compress is for GLB files"),
        ("mesh.ply", {"upright": True, "up": (0, 0, 1)}, "upright is for GLB files"),
        ("mesh.ply", {"normals": False}, "normals=False is for GLB files"),
        ("mesh.glb", {"upright": True}, "upright needs the upward direction"),
        ("mesh.glb", {"jpeg_quality": 0}, "jpeg_quality is 0"),
        ("mesh.glb", {"up": (0, 0, math.inf)}, "up is not finite"),
        ("mesh.glb", {"up": (0, 0, 0), "upright": True}, "up has no length"),
    ]:
        with pytest.raises(pcmvs.InputError, match=expected):
            mesh.save(tmp_path / name, **options)


def test_colours_can_be_fixed_by_gains(scene, pictures, finished):
    gains = finished.gains
    assert (gains.dtype, gains.shape) == (np.float32, (len(scene.cameras), 3))
    rig = pcmvs.Rig(scene.cameras, gains=gains)
    fixed = pcmvs.reconstruct(rig, **pictures)
    np.testing.assert_array_equal(fixed.mesh().colours, finished.mesh().colours)
    bright = pcmvs.reconstruct(pcmvs.Rig(scene.cameras, gains=1.5 * gains), **pictures)
    assert bright.mesh().colours.mean() > finished.mesh().colours.mean() + 5
    with pytest.raises(pcmvs.InputError, match="11 gains given for 12 cameras"):
        pcmvs.Rig(scene.cameras, gains=gains[1:])
