"""Opens clips of pcmvs: sequence.json of both versions, and clips in one file."""

import json
import pathlib

from .glb import DAMAGE, Glb, Unreadable

LARGEST_MANIFEST = 64 << 20


class Clip:
    """A clip whose files are read frame by frame."""

    def __init__(self, path, quality=""):
        """Opens the clip at a path, in the quality of a name or in the best one."""
        self.path = pathlib.Path(path)
        self.fps = self.audio = None
        if self.path.suffix.lower() == ".glb":
            glb = Glb(self.path)
            self.count = len(glb.frames())
            duration = glb.duration()
            self.fps = self.count / duration if duration else None
            self.files = [(self.path, None, self.count)]
        else:
            manifest = read_manifest(self.path)
            try:
                self.fps = float(manifest["fps"])
                self.files = listed(manifest, self.path, quality)
                self.audio = inside(self.path, manifest["audio"]["url"]) if manifest.get("audio") else None
                self.count = sum(count for *_, count in self.files)
            except DAMAGE as error:
                raise Unreadable(f"{path}: is no sequence.json of pcmvs ({error!r})") from error
        if self.fps is not None and not 0 < self.fps <= 1000:
            raise Unreadable(f"{path}: has {self.fps} frames per second")
        if self.count == 0:
            raise Unreadable(f"{path}: lists no frames: run pcmvs reconstruct")

    def frames(self):
        """The meshes of all frames, each with its file."""
        for path, size, count in self.files:
            glb = Glb(path, size)
            frames = glb.frames()
            if len(frames) != count:
                raise Unreadable(f"{path}: has {len(frames)} frames, and the clip lists {count}: copy the clip once more")
            for primitive, matrix in frames:
                yield glb, glb.mesh(primitive, matrix)


def read_manifest(path):
    try:
        if path.stat().st_size > LARGEST_MANIFEST:
            raise ValueError("it is too large")
        manifest = json.loads(path.read_bytes())
        version = manifest["version"]
    except (OSError, *DAMAGE) as error:
        raise Unreadable(f"{path}: is no sequence.json of pcmvs ({error!r})") from error
    if version not in (1, 2):
        raise Unreadable(f"{path}: has version {version!r}, and this extension reads versions 1 and 2")
    return manifest


def listed(manifest, path, quality):
    """The files of a quality: paths, bytes, and numbers of frames."""
    if manifest["version"] == 1:
        if quality:
            raise Unreadable(f"{path}: has no qualities to choose from")
        return [(inside(path, frame["url"]), frame.get("bytes"), 1) for frame in manifest["frames"]]
    qualities = by_size(manifest)
    names = [one["name"] for one in qualities]
    if quality and quality not in names:
        raise Unreadable(f"{path}: has no quality {quality}, but {', '.join(map(str, names))}")
    segments = qualities[names.index(quality) if quality else 0]["segments"]
    return [(inside(path, segment["url"]), segment["bytes"], len(segment["frames"])) for segment in segments]


def by_size(manifest):
    """The qualities of a manifest of version 2, the best first."""
    return sorted(manifest["qualities"], key=lambda one: -one["bytes"])


def quality_names(path):
    """Names of the qualities that the clip at a path has, the best first. None if it cannot be read."""
    try:
        manifest = read_manifest(pathlib.Path(path))
        return [str(one["name"]) for one in by_size(manifest)] if manifest["version"] == 2 else []
    except (Unreadable, *DAMAGE):
        return []


def inside(manifest, url):
    """The path of a file that a manifest lists. A manifest must not make Blender read other files."""
    folder = manifest.resolve().parent
    found = (folder / url).resolve()
    if folder not in found.parents:
        raise Unreadable(f"{manifest}: lists {url}, which is not in its folder: it is not read")
    return found
