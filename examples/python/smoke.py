"""Calls the C ABI from Python with ctypes alone.

Usage: smoke.py LIBPCMVS FOLDER OUT.glb, with FOLDER as in examples/c/capture.h.
"""

import ctypes as c
import pathlib
import sys


class Camera(c.Structure):
    _fields_ = [("struct_size", c.c_uint32), ("width", c.c_uint32), ("height", c.c_uint32), ("reserved", c.c_uint32),
                ("k", c.c_double * 9), ("distortion", c.c_double * 5), ("r", c.c_double * 9), ("t", c.c_double * 3)]


class Image(c.Structure):
    _fields_ = [("struct_size", c.c_uint32), ("format", c.c_uint32), ("width", c.c_uint32), ("height", c.c_uint32),
                ("data", c.c_char_p), ("stride", c.c_ssize_t), ("chroma", c.c_void_p), ("chroma_stride", c.c_ssize_t)]


class View(c.Structure):
    _fields_ = [("struct_size", c.c_uint32), ("reserved", c.c_uint32), ("image", c.POINTER(Image)),
                ("mask", c.POINTER(Image)), ("clean_plate", c.c_void_p), ("chroma_key", c.c_void_p)]


WRITE = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_void_p, c.c_size_t)


def check(lib, status):
    if status != 0:
        raise RuntimeError(lib.pcmvs_status_name(status).decode())


def read_netpbm(path):
    kind, width, height, _, pixels = path.read_bytes().split(maxsplit=4)
    return Image(c.sizeof(Image), 1 if kind == b"P6" else 0, int(width), int(height), pixels)


def main(library, folder, out):
    lib = c.CDLL(library)
    lib.pcmvs_status_name.restype = c.c_char_p
    lib.pcmvs_version_string.restype = c.c_char_p
    for name, arguments in {
        "pcmvs_rig_new": [c.POINTER(c.c_void_p)],
        "pcmvs_rig_set_cameras": [c.c_void_p, c.POINTER(Camera), c.c_size_t],
        "pcmvs_frame_new": [c.c_void_p, c.POINTER(c.c_void_p)],
        "pcmvs_frame_reconstruct": [c.c_void_p, c.POINTER(View), c.c_size_t, c.c_void_p],
        "pcmvs_frame_export_mesh": [c.c_void_p, c.c_uint32, c.c_void_p, WRITE, c.c_void_p],
        "pcmvs_frame_free": [c.c_void_p],
        "pcmvs_rig_free": [c.c_void_p],
    }.items():
        getattr(lib, name).argtypes = arguments

    folder = pathlib.Path(folder)
    words = iter((folder / "cameras.txt").read_text().split())
    count = int(next(words))
    cameras, views, images = (Camera * count)(), (View * count)(), []

    def numbers(n):
        return (c.c_double * n)(*(float(next(words)) for _ in range(n)))

    for i in range(count):
        cameras[i] = Camera(c.sizeof(Camera), int(next(words)), int(next(words)), 0,
                            numbers(9), numbers(5), numbers(9), numbers(3))
        images += [read_netpbm(folder / f"cam{i:02}.ppm"), read_netpbm(folder / f"cam{i:02}.pgm")]
        views[i] = View(c.sizeof(View), 0, c.pointer(images[-2]), c.pointer(images[-1]))

    rig, frame = c.c_void_p(), c.c_void_p()
    check(lib, lib.pcmvs_rig_new(rig))
    check(lib, lib.pcmvs_rig_set_cameras(rig, cameras, count))
    check(lib, lib.pcmvs_frame_new(rig, frame))
    check(lib, lib.pcmvs_frame_reconstruct(frame, views, count, None))
    with open(out, "wb") as file:
        def write(_, data, size):
            return 0 if file.write(c.string_at(data, size)) == size else 1
        check(lib, lib.pcmvs_frame_export_mesh(frame, 0, None, WRITE(write), None))
    check(lib, lib.pcmvs_frame_free(frame))
    check(lib, lib.pcmvs_rig_free(rig))
    print(lib.pcmvs_version_string().decode())


main(*sys.argv[1:])
