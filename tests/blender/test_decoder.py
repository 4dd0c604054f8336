"""The decoder of the Blender extension, without Blender: right bytes, and errors for wrong ones.

PCMVS_COMMAND names the command and PCMVS_CAPTURE a capture, of which a plain and a compressed frame are made.
"""

import json
import os
import random
import shutil
import struct
import subprocess
import sys
import time

import compressed
import numpy
import package
import pytest

package.without_blender()
from pcmvs_clips import meshopt  # noqa: E402
from pcmvs_clips.clip import Clip, quality_names  # noqa: E402
from pcmvs_clips.glb import Glb, Unreadable  # noqa: E402


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """Folders with a plain frame and other forms, and a published clip."""
    folder = tmp_path_factory.mktemp("forms")
    command, capture = os.environ["PCMVS_COMMAND"], os.environ["PCMVS_CAPTURE"]

    def run(*arguments):
        subprocess.run([command, *arguments], check=True, capture_output=True)

    forms = {"plain": [], "compressed": ["--compress"], "web": ["--faces=1000", "--texture=128", "--compress"]}
    for name, options in forms.items():
        run("reconstruct", *options, "-o", folder / name, capture)
    run("pack", folder / "compressed", "-o", folder / "packed.glb")
    published = folder / "published"
    run("pack", folder / "web", "--manifest", "--quality", f"fine={folder / 'compressed'}", "-o", published)
    return folder


def frame(folder):
    return Glb(folder / "frame_0000.glb")


def test_blender_is_not_needed():
    assert "bpy" not in sys.modules


def test_a_compressed_frame_is_the_rounded_plain_one(made):
    vertices, triangles = compressed.equals_rounded(frame(made / "compressed"), frame(made / "plain"))
    assert vertices > 1000 and triangles > 2000


def test_a_packed_clip_has_the_meshes_of_its_files(made):
    clip = Clip(made / "packed.glb")
    manifest = json.loads((made / "compressed/sequence.json").read_bytes())
    assert clip.count == len(manifest["frames"]) and clip.fps == pytest.approx(manifest["fps"], rel=1e-6)
    for (_, packed), listed in zip(clip.frames(), manifest["frames"]):
        glb = Glb(made / "compressed" / listed["url"])
        own = glb.mesh(*glb.frames()[0])
        assert numpy.array_equal(packed.corners, own.corners) and numpy.array_equal(packed.colours, own.colours)
        assert numpy.abs(packed.positions - own.positions).max() < 1e-12


def test_the_best_quality_comes_first(made):
    path = made / "published/sequence.json"
    names = quality_names(path)
    assert names == ["fine", "full"]
    counts = {name: [len(mesh.corners) // 3 for _, mesh in Clip(path, name).frames()] for name in names}
    best = [len(mesh.corners) // 3 for _, mesh in Clip(path).frames()]
    assert best == counts[names[0]] and len(best) == 2
    assert all(few <= 1000 < many for few, many in zip(counts[names[1]], counts[names[0]]))


# The example of the extension's text: sixteen numbers of 4 bits, of which two are followed by bytes.
GROUP = bytes.fromhex("175ff0bc77a9210034b5")
DELTAS = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]


def test_the_example_of_the_extension():
    # One such group for the first byte of four, and nothing for the others.
    first = bytes(28) + bytes([100, 7, 8, 9])
    data = bytes([0xA0, 2]) + GROUP + bytes(3) + first
    decoded = meshopt.vertices(data, 16, 4)
    assert decoded[:, 0].tolist() == [(100 + sum(DELTAS[: i + 1])) % 256 for i in range(16)]
    assert decoded[:, 1:].tolist() == [[7, 8, 9]] * 16


# No entry of a table refers to a corner.
TABLE = bytes(16)


@pytest.mark.parametrize(
    "codes, more, expected",
    [
        # A new triangle, and one at its last edge with a new corner.
        ("f000", "", [0, 1, 2, 0, 2, 3]),
        # Two numbers, 5 and 5 more, then the corners before and after the last one.
        ("fe0d0e", "ff0a0a", [0, 5, 10, 0, 10, 9, 0, 9, 10]),
        # A number of two bytes, at the edge before the last one.
        ("f01f", "8802", [0, 1, 2, 2, 1, 132]),
        # Counting begins again.
        ("f0fe", "00", [0, 1, 2, 0, 1, 2]),
    ],
)
def test_triangles(codes, more, expected):
    codes, more = bytes.fromhex(codes), bytes.fromhex(more)
    decoded = meshopt.triangles(bytes([0xE1]) + codes + more + TABLE, 3 * len(codes), 2)
    assert decoded.tolist() == expected


@pytest.mark.parametrize(
    "what, arguments",
    [
        ("too few", (b"", 16, 4)),
        ("too few", (bytes([0xA0]) + bytes(40), 1 << 60, 8)),
        ("too few", (bytes([0xA0]) + bytes(40), 1 << 12, 8)),
        ("begin", (bytes(40), 1, 4)),
        ("bytes", (bytes([0xA0]) + bytes(40), 1, 6)),
        ("bytes", (bytes([0xA0]) + bytes(40), -1, 4)),
        ("longer", (bytes([0xA0, 3]) + bytes(35), 1, 4)),
        ("shorter", (bytes([0xA0]) + bytes(37), 1, 4)),
    ],
)
def test_wrong_vertices_are_errors(what, arguments):
    with pytest.raises(ValueError, match=what):
        meshopt.vertices(*arguments)


@pytest.mark.parametrize(
    "what, arguments",
    [
        ("too few", (b"", 3, 2)),
        ("too few", (bytes([0xE1]) + TABLE, 3 << 60, 2)),
        ("begin", (bytes([0xE0, 0xF0]) + TABLE, 3, 2)),
        ("corners", (bytes([0xE1, 0xF0]) + TABLE, 4, 2)),
        ("longer", (bytes([0xE1, 0xFF]) + TABLE, 3, 2)),
        ("too many", (bytes([0xE1, 0x0F]) + b"\xff" * 9 + TABLE, 3, 4)),
        ("does not fit", (bytes([0xE1, 0x0D]) + TABLE, 3, 2)),
        ("shorter", (bytes([0xE1, 0xF0, 0]) + TABLE, 3, 2)),
        ("wrong entry", (bytes([0xE1, 0xF0, 0x1F]) + bytes(15), 3, 2)),
    ],
)
def test_wrong_triangles_are_errors(what, arguments):
    with pytest.raises(ValueError, match=what):
        meshopt.triangles(*arguments)


def test_damaged_files_are_errors(made, tmp_path):
    """Bytes anywhere in a file are changed. It is opened, or refused by name, and takes no longer than a good one."""
    source = made / "web/frame_0000.glb"
    whole = source.read_bytes()
    path = tmp_path / "damaged.glb"
    chance = random.Random(1)
    start, outcomes = time.monotonic(), {True: 0, False: 0}
    for i in range(300):
        data = bytearray(whole)
        # Half of them in the description, which is at the beginning.
        end = 2000 if i % 2 else len(data)
        for _ in range(1 + i % 5):
            data[chance.randrange(12, end)] = chance.randrange(256)
        path.write_bytes(data)
        try:
            glb = Glb(path)
            for primitive, matrix in glb.frames():
                mesh = glb.mesh(primitive, matrix)
                assert mesh.corners.max() < len(mesh.positions) and mesh.corners.min() >= 0
            outcomes[True] += 1
        except Unreadable as error:
            assert "damaged.glb" in str(error)
            outcomes[False] += 1
    assert min(outcomes.values()) > 10, outcomes
    assert time.monotonic() - start < 120


def test_files_of_another_length_are_errors(made, tmp_path):
    whole = (made / "web/frame_0000.glb").read_bytes()
    path = tmp_path / "cut.glb"
    for length in [0, 11, 19, 20, 100, len(whole) // 2, len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(Unreadable, match="cut.glb"):
            Glb(path)
        # A file whose header has the length that is left. Its last bytes are those of a picture, which Blender reads.
        if 20 <= length <= len(whole) // 2:
            path.write_bytes(whole[:8] + struct.pack("<I", length) + whole[12:length])
            with pytest.raises(Unreadable, match="cut.glb"):
                glb = Glb(path)
                glb.mesh(*glb.frames()[0])


def test_manifests_that_lead_elsewhere_or_are_wrong_are_errors(made, tmp_path):
    folder = tmp_path / "clip"
    shutil.copytree(made / "published", folder)
    path = folder / "sequence.json"
    manifest = json.loads(path.read_bytes())

    def refused(what, quality="", **changes):
        path.write_text(json.dumps(manifest | changes))
        with pytest.raises(Unreadable, match=what):
            list(Clip(path, quality).frames())

    segment = manifest["qualities"][0]["segments"][0]
    for url in ["../full.glb", "/etc/passwd", str(made / "packed.glb")]:
        quality = {"name": "a", "bytes": 1, "segments": [segment | {"url": url}]}
        refused("not in its folder", qualities=[quality])
    refused("bytes", qualities=[{"name": "a", "bytes": 1, "segments": [segment | {"bytes": 7}]}])
    refused("frames", qualities=[{"name": "a", "bytes": 1, "segments": [segment | {"frames": [0]}]}])
    refused("cannot be read", qualities=[{"name": "a", "bytes": 1, "segments": [segment | {"url": "no.glb"}]}])
    refused("no quality best", quality="best")
    refused("version 3", version=3)
    refused("frames per second", fps=0)
    refused("no frames", qualities=[{"name": "a", "bytes": 1, "segments": []}])
    refused("sequence.json", qualities=7)
