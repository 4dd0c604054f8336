"""Cameras, rigs, scenes and calibrations."""

import json
import math

import numpy as np
import pcmvs
import pytest

K = [[800, 0, 319.5], [0, 820, 239.5], [0, 0, 1]]


def camera(**changes):
    return pcmvs.Camera(**{"k": K, "r": np.eye(3), "t": [0, 0, 2], "size": (640, 480), **changes})


def turned(camera, degrees):
    """The camera, turned about its y axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return pcmvs.Camera(camera.k, turn @ camera.r, turn @ camera.t, camera.size)


def test_a_camera_projects_as_opencv_does():
    k1, k2, p1, p2, k3 = coefficients = [0.1, -0.05, 0.01, -0.02, 0.03]
    lens = camera(distortion=coefficients, r=[[0, -1, 0], [1, 0, 0], [0, 0, 1]], t=[0.1, 0.2, 3])
    x, y, z = (-0.3 + 0.1) / 3.5, (0.4 + 0.2) / 3.5, 3.5
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    pixel, behind = lens.project([[0.4, 0.3, 0.5], [0, 0, -4]])
    np.testing.assert_allclose(pixel, [800 * u + 319.5, 820 * v + 239.5, z])
    assert np.isnan(behind).all()
    np.testing.assert_allclose(lens.centre, -lens.r.T @ lens.t)


def test_a_camera_gives_back_what_it_was_given():
    made = camera(distortion=[0.1, 0.2, 0, 0], lens="fisheye")
    np.testing.assert_array_equal(made.k, K)
    np.testing.assert_array_equal(made.r, np.eye(3))
    np.testing.assert_array_equal(made.t, [0, 0, 2])
    np.testing.assert_array_equal(made.distortion, [0.1, 0.2, 0, 0])
    assert (made.size, made.lens) == ((640, 480), "fisheye")


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"k": np.eye(2)}, "k: .*give 3 x 3 numbers"),
        ({"r": "no"}, "r: .*give 3 x 3 numbers"),
        ({"t": [1, 2]}, "t: .*give 3 numbers"),
        ({"t": [0, 0, math.nan]}, "not finite"),
        ({"r": np.diag([1, 1, -1])}, "R reflects"),
        ({"distortion": [0.1] * 13}, "the distortion has coefficients beyond"),
        ({"lens": "f-theta"}, 'it is one of \\["opencv", "fisheye"\\]'),
    ],
)
def test_a_camera_that_cannot_be_is_refused(changes, expected):
    with pytest.raises(pcmvs.InputError, match=expected):
        camera(**changes)


def test_a_rig_names_the_camera_at_fault(scene):
    with pytest.raises(pcmvs.InputError, match="at least 3 are needed") as raised:
        pcmvs.Rig(scene.cameras[:2])
    assert raised.value.code == "too-few-views"
    assert len(pcmvs.Rig(scene.cameras)) == 12 and pcmvs.Rig(scene.cameras).warnings == []
    (warning,) = pcmvs.Rig([*scene.cameras, scene.cameras[0]]).warnings
    assert (warning.code, warning.camera) == ("same-place", 12)


def test_a_scene_is_read(scene, capture):
    described = json.loads((capture / "scene.json").read_text())
    assert scene.names == [camera["name"] for camera in described["cameras"]]
    assert scene.frames == [0, 1]
    assert scene.path == capture / "scene.json"
    assert list(scene.up) == described["up"] and scene.units == described["units"]
    pictures = scene.pictures(1)
    assert all(image.shape == (120, 160, 3) and image.dtype == np.uint8 for image in pictures["images"])
    assert all(mask.shape == (120, 160) and mask.dtype == np.uint8 for mask in pictures["masks"])
    assert all((a != b).any() for a, b in zip(pictures["masks"], scene.pictures(0)["masks"]))
    with pytest.raises(pcmvs.InputError, match="there is no frame 2"):
        scene.pictures(2)


def test_a_missing_file_is_a_warning_and_a_broken_one_an_error(scene, capture, tmp_path):
    described = json.loads((capture / "scene.json").read_text())
    for key in ("images", "masks"):
        described["frames"][0][key] = [str(capture / path) for path in described["frames"][0][key]]
    described["frames"][0]["images"][3] = "lost.png"
    (tmp_path / "scene.json").write_text(json.dumps(described))
    with pytest.warns(UserWarning, match=f"camera `{scene.names[3]}`: .*lost.png: the file does not exist"):
        pictures = pcmvs.Scene.open(tmp_path).pictures(0)
    assert [image is None for image in pictures["images"]] == [camera == 3 for camera in range(12)]
    (tmp_path / "lost.png").write_bytes(b"no picture")
    with pytest.raises(pcmvs.InputError, match="lost.png: the file is neither JPEG nor PNG"):
        pcmvs.Scene.open(tmp_path).pictures(0)
    with pytest.raises(pcmvs.InputError, match="no calibrated capture was found"):
        (tmp_path / "empty").mkdir()
        pcmvs.Scene.open(tmp_path / "empty")


def test_calibrations_of_other_programs_are_opened(capture, tmp_path):
    described = json.loads((capture / "scene.json").read_text())
    frames = []
    for camera, image in zip(described["cameras"], described["frames"][0]["images"]):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = camera["R"], camera["t"]
        # Camera to world, with OpenGL's axes and the corner of the first pixel at (0, 0).
        matrix = np.linalg.inv(pose) @ np.diag([1, -1, -1, 1])
        (fx, _, cx), (_, fy, cy), _ = camera["K"]
        intrinsics = {"fl_x": fx, "fl_y": fy, "cx": cx + 0.5, "cy": cy + 0.5, "w": camera["width"], "h": camera["height"]}
        frames.append({"file_path": str(capture / image), "transform_matrix": matrix.tolist(), **intrinsics})
    (tmp_path / "transforms.json").write_text(json.dumps({"frames": frames}))
    scene = pcmvs.Scene.open(tmp_path)
    point = [[0.1, -0.2, 1.0]]
    for found, expected in zip(scene.cameras, pcmvs.Scene.open(capture).cameras):
        np.testing.assert_allclose(found.project(point), expected.project(point), atol=1e-6)


def test_a_camera_that_was_moved_is_found_and_put_back(scene):
    frames = [scene.pictures(0), scene.pictures(1)]
    good = pcmvs.calibrate(scene.rig(), frames)
    assert good.findings == [] and len(good.reports) == 12
    cameras = scene.cameras
    cameras[4] = turned(cameras[4], 1.0)
    pixels = math.radians(1.0) * cameras[4].k[0, 0]
    found = pcmvs.calibrate(pcmvs.Rig(cameras), frames)
    assert found.verdict == "improved"
    (finding,) = found.findings
    assert (finding.code, finding.cameras) == ("camera-bumped", [4])
    report = found.reports[4]
    assert report.moved_px == pytest.approx(pixels, rel=0.2)
    assert report.contour_px[1] < report.contour_px[0]
    point = [[0.0, 0.0, 1.0]]
    off = lambda camera: np.linalg.norm(camera.project(point) - scene.cameras[4].project(point))
    assert off(found.cameras[4]) < 0.3 * off(cameras[4])


def test_calibration_says_what_it_needs(scene):
    with pytest.raises(pcmvs.InputError, match="frames is empty"):
        pcmvs.calibrate(scene.rig(), [])
    with pytest.raises(pcmvs.InputError, match="mask is not one of"):
        pcmvs.calibrate(scene.rig(), [{"images": [], "mask": []}])
    with pytest.raises(pcmvs.Cancelled):
        pcmvs.calibrate(scene.rig(), [scene.pictures(0)], progress=lambda stage, done: False)
