"""Python and the command line give the same bytes."""

import json
import os
import shutil
import struct
import subprocess
import zlib

import numpy as np
import pcmvs
import pytest


@pytest.mark.parametrize("preset", ["default", "paper", "hull", "preview"])
def test_a_glb_file_equals_that_of_the_command_line(scene, pictures, command, preset):
    frame = pcmvs.reconstruct(scene.rig(), **pictures, params=preset)
    file = command("--preset", preset) / "frame_0000.glb"
    assert frame.mesh().to_glb(up=scene.up) == file.read_bytes()


def test_an_averaged_frame_equals_that_of_the_command_line(scene, finished, command):
    first, second = (pcmvs.reconstruct(scene.rig(), **scene.pictures(frame)) for frame in (0, 1))
    stages = set()
    first.steady([second], progress=lambda stage, done: stages.add(stage))
    assert stages == {"steady"} and list(first.hashes)[-1] == "steady"
    file = command(alone=False) / "frame_0000.glb"
    assert first.mesh().to_glb(up=scene.up) == file.read_bytes()
    # The other frame's own mesh counts, whatever has been averaged before. Without neighbours a frame is itself again.
    second.steady([first])
    first.steady([second])
    assert first.mesh().to_glb(up=scene.up) == file.read_bytes()
    first.steady([])
    assert (first.mesh().positions == finished.mesh().positions).all()
    with pytest.raises(pcmvs.OrderError, match="colour"):
        first.steady([pcmvs.Frame(scene.rig(), **scene.pictures(1))])


def png(gray):
    """A PNG file of gray levels."""
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    header = struct.pack(">IIBBBBB", gray.shape[1], gray.shape[0], 8, 0, 0, 0, 0)
    rows = zlib.compress(b"".join(b"\0" + row.tobytes() for row in gray))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def test_a_frame_that_gets_a_lost_part_back_equals_that_of_the_command_line(capture, tmp_path):
    # The masks of the second of three frames lack the upper third of the person.
    take = tmp_path / "take"
    shutil.copytree(capture, take)
    document = json.loads((take / "scene.json").read_text())
    first, second = document["frames"]
    document["frames"] = [first, second, {**first, "index": second["index"] + 1}]
    document["frames"][1]["masks"] = [f"lacking_{i}.png" for i in range(len(second["images"]))]
    for mask, path in zip(pcmvs.Scene.open(take).pictures(second["index"])["masks"], document["frames"][1]["masks"]):
        mask = np.array(mask)
        rows = np.flatnonzero((mask > 127).any(axis=1))
        mask[: rows[len(rows) // 3]] = 0
        (take / path).write_bytes(png(mask))
    (take / "scene.json").write_text(json.dumps(document))
    scene = pcmvs.Scene.open(take)
    rig, pictures = scene.rig(), [scene.pictures(index) for index in scene.frames]
    before, lacking, after = (pcmvs.reconstruct(rig, **of) for of in pictures)
    assert lacking.may_have_lost_part(before, after)
    assert not before.may_have_lost_part(after, after)
    with pytest.raises(pcmvs.OrderError, match="colour"):
        lacking.may_have_lost_part(before, pcmvs.Frame(rig, **pictures[2]))
    with pytest.raises(pcmvs.InputError, match="both frames"):
        pcmvs.Frame(rig, **pictures[1], before=pictures[0])
    whole = pcmvs.Frame(rig, **pictures[1], before=pictures[0], after=pictures[2])
    whole.run()
    assert whole.restored > 0
    assert "silhouette-restored" in [warning.code for warning in whole.warnings]
    whole.steady([before, after])
    out = tmp_path / "command"
    program = os.environ["PCMVS_COMMAND"]
    subprocess.run([program, "reconstruct", take, "-o", out, "--frames", str(scene.frames[1])], check=True)
    file = out / f"frame_{scene.frames[1]:04}.glb"
    assert whole.mesh().to_glb(up=scene.up) == file.read_bytes()


def test_a_form_equals_that_of_the_command_line(scene, finished, command):
    form = finished.form(faces=2000, texture=256)
    assert form.texture.shape == (256, 256, 3) and form.uvs.shape == (len(form.positions), 2) and form.colours is None
    file = command("--faces", "2000", "--texture=256", "--upright") / "frame_0000.glb"
    assert form.to_glb(up=scene.up, upright=True) == file.read_bytes()


@pytest.mark.parametrize(
    "form, options",
    [
        ({}, ()),
        ({"faces": 20_000, "texture": 1024}, ("--faces", "20000", "--texture=1024", "--upright")),
        ({"faces": 5000, "texture": 512}, ("--faces", "5000", "--texture=512", "--upright")),
    ],
)
def test_a_compressed_file_equals_that_of_the_command_line(scene, finished, command, tmp_path, form, options):
    mesh = finished.form(**form)
    asked = {"up": scene.up, "upright": "--upright" in options, "compress": True}
    compressed = mesh.to_glb(**asked)
    assert compressed == (command("--compress", *options) / "frame_0000.glb").read_bytes()
    mesh.save(tmp_path / "mesh.glb", **asked)
    assert (tmp_path / "mesh.glb").read_bytes() == compressed
    assert len(compressed) < len(mesh.to_glb(**{**asked, "compress": False}, compact=True, normals=False))
    assert b'"NORMAL"' not in compressed and b'"NORMAL"' in mesh.to_glb(**asked, normals=True)


def test_a_ply_file_equals_that_of_the_command_line(finished, command, tmp_path):
    finished.mesh().save(tmp_path / "mesh.ply")
    assert (tmp_path / "mesh.ply").read_bytes() == (command("--format", "ply") / "frame_0000.ply").read_bytes()


def test_chroma_keys_are_those_of_the_command_line(capture, command):
    scene = pcmvs.Scene.open(capture, silhouettes="chroma")
    frame = pcmvs.reconstruct(scene.rig(), **scene.pictures(0))
    assert frame.mesh().to_glb(up=scene.up) == (command("--masks", "chroma") / "frame_0000.glb").read_bytes()


def test_intermediate_results_are_those_of_the_command_line(finished, command):
    folder = command("--stages") / "stages/frame_0000"
    read = lambda name: (folder / name).read_bytes()
    assert finished.hull().to_ply() == read("hull.ply")
    assert finished.coarse().to_ply() == read("coarse.ply")
    assert finished.points("frontier").to_ply() == read("frontier.ply")
    assert finished.points("implicit").to_ply() == read("implicit.ply")
    assert finished.points("merged").to_ply() == read("merge.ply")


def test_the_report_is_that_of_the_command_line(scene, finished, command):
    report = json.loads((command() / "report.json").read_text())
    frame = report["frames"][0]
    assert finished.hashes == frame["hashes"]
    assert finished.counts == frame["counts"]
    assert finished.params == report["params"]
    assert [warning.code for warning in finished.warnings] == [warning["code"] for warning in report["warnings"]]
    for name, found, reported in zip(scene.names, finished.diagnostics, frame["cameras"]):
        assert (name, found.used) == (reported["name"], reported["used"])
        assert found.silhouette_overlap == pytest.approx(reported["silhouette_overlap"], abs=1e-4)
        assert found.contour_px == pytest.approx(reported["contour_px"], abs=1e-4)
