"""Arrays in and out."""

import numpy as np
import pcmvs
import pytest


def hull(scene, images, masks=None, **options):
    """The bytes of the hull, which depend on the silhouettes."""
    frame = pcmvs.Frame(scene.rig(), images, masks, params="preview", **options)
    frame.run("hull")
    return frame.hull().to_ply()


def test_meshes_are_closed_and_oriented(finished):
    mesh = finished.mesh()
    vertices, triangles = len(mesh.positions), mesh.triangles
    assert (mesh.positions.dtype, mesh.positions.shape) == (np.float64, (vertices, 3))
    assert (mesh.normals.dtype, mesh.normals.shape) == (np.float32, (vertices, 3))
    assert (mesh.colours.dtype, mesh.colours.shape) == (np.uint8, (vertices, 3))
    assert (triangles.dtype, triangles.shape[1]) == (np.uint32, 3)
    assert mesh.uvs is None and mesh.texture is None
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)
    # Every edge occurs once in each direction.
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    once = {tuple(edge) for edge in edges.tolist()}
    assert len(once) == len(edges) and all((b, a) in once for a, b in once)
    # The volume is positive where triangles are counter-clockwise from outside.
    a, b, c = (mesh.positions[triangles[:, i]] for i in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0


def test_positions_project_into_the_silhouettes(scene, finished):
    for index, camera in enumerate(scene.cameras):
        x, y, depth = camera.project(finished.mesh().positions).T
        assert (depth > 0).all()
        silhouette = finished.silhouette(index)
        inside = silhouette[np.rint(y).astype(int), np.rint(x).astype(int)]
        assert np.quantile(inside, 0.02) > -1


def test_changing_a_result_changes_nothing_else(finished):
    before = finished.mesh().to_glb()
    mesh = finished.mesh()
    mesh.positions[:] = 0
    assert mesh.to_glb() == before
    assert finished.mesh().positions.any()


def test_arrays_with_any_strides_are_taken_as_they_look(scene, pictures):
    images, masks = pictures["images"], pictures["masks"]
    expected = hull(scene, images, masks)
    fortran = [np.asfortranarray(image) for image in images]
    flipped = [image[::-1, :, ::-1].copy()[::-1, :, ::-1] for image in images]
    padded = [np.pad(mask, ((0, 0), (3, 5)))[:, 3:-5] for mask in masks]
    assert not padded[0].flags.c_contiguous
    assert hull(scene, fortran, padded) == expected
    assert hull(scene, flipped, [np.repeat(mask, 2, axis=1)[:, ::2] for mask in masks]) == expected
    assert hull(scene, np.stack(images), np.stack(masks)) == expected
    # They would not do if strides were ignored.
    assert hull(scene, images, [mask[::-1] for mask in masks[:3]] + masks[3:]) != expected


def test_pictures_are_copied(scene, pictures):
    expected = hull(scene, pictures["images"], pictures["masks"])
    masks = [mask.copy() for mask in pictures["masks"]]
    frame = pcmvs.Frame(scene.rig(), pictures["images"], masks, params="preview")
    for mask in masks:
        mask[:] = 0
    frame.run("hull")
    assert frame.hull().to_ply() == expected


def test_a_bool_mask_is_black_and_white(scene, pictures):
    images, bools = pictures["images"], [mask > 127 for mask in pictures["masks"]]
    white = [np.where(mask, 255, 0).astype(np.uint8) for mask in bools]
    assert hull(scene, images, bools) == hull(scene, images, white)


def test_without_masks_the_alpha_channel_is_the_mask(scene, pictures):
    images, masks = pictures["images"], pictures["masks"]
    cut_out = [np.dstack([image, mask]) for image, mask in zip(images, masks)]
    assert hull(scene, cut_out) == hull(scene, images, masks)
    # A mask takes precedence.
    assert hull(scene, cut_out, [mask > 127 for mask in masks]) == hull(scene, images, [mask > 127 for mask in masks])


def test_a_camera_may_have_no_picture_or_no_mask(scene, pictures):
    images, masks = list(pictures["images"]), list(pictures["masks"])
    images[2] = masks[5] = None
    frame = pcmvs.Frame(scene.rig(), images, masks, params="preview")
    frame.run("hull")
    found = {(warning.code, warning.camera) for warning in frame.warnings}
    assert {("no-picture", 2), ("no-silhouette", 5)} <= found
    assert [camera for camera, view in enumerate(frame.diagnostics) if not view.used] == [2]
    assert frame.silhouette(2) is None


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda image: image.astype(np.float32) / 255, "images[3] holds float32: give uint8"),
        (lambda image: image.astype(np.uint16), "images[3] holds uint16: give uint8"),
        (lambda image: image > 127, "images[3] holds bool: give uint8"),
        (lambda image: image.tolist(), "images[3] is a list: give a NumPy array"),
        (lambda image: image[..., :2], "images[3] has the shape [120, 160, 2]"),
        (lambda image: image[0, 0], "images[3] has the shape [3]"),
        (lambda image: image.transpose(1, 0, 2), "camera 3: the picture is 120 x 160 pixels but the camera was calibrated"),
        (lambda image: image[:0], "camera 3: the picture is 160 x 0 pixels: it is empty"),
    ],
)
def test_an_image_that_cannot_be_used_is_named(scene, pictures, change, expected):
    pictures["images"][3] = change(pictures["images"][3])
    with pytest.raises(ValueError) as raised:
        pcmvs.Frame(scene.rig(), **pictures).run("hull")
    assert expected in str(raised.value)
    assert isinstance(raised.value, pcmvs.InputError) and raised.value.camera == 3


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda mask: (mask > 127).astype(np.uint8), "masks[4] holds nothing above 1: give bool, or 255 on the object"),
        (lambda mask: mask / 255, "masks[4] holds float64: give uint8 or bool"),
        (lambda mask: mask[:, :80], "camera 4: the mask is 80 x 120 pixels"),
    ],
)
def test_a_mask_that_cannot_be_used_is_named(scene, pictures, change, expected):
    pictures["masks"][4] = change(pictures["masks"][4])
    with pytest.raises(pcmvs.InputError) as raised:
        pcmvs.Frame(scene.rig(), **pictures).run("hull")
    assert expected in str(raised.value) and raised.value.camera == 4


def test_lists_of_the_wrong_length_are_refused(scene, pictures):
    images, masks = pictures["images"], pictures["masks"]
    with pytest.raises(pcmvs.InputError, match="11 pictures given for 12 cameras"):
        pcmvs.Frame(scene.rig(), images[1:], masks)
    with pytest.raises(pcmvs.InputError, match="11 masks or plates given for 12 cameras"):
        pcmvs.Frame(scene.rig(), images, masks[1:])
    with pytest.raises(pcmvs.InputError, match="only one of them"):
        pcmvs.Frame(scene.rig(), images, masks, chroma=[(0, 255, 0)])
