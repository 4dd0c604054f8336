"""Compares a compressed file with the plain file of the same mesh: places must be equal after those of the plain one are rounded,
and colours within one sRGB code."""

import numpy

# Largest coordinate of a compact position.
STEPS = 16383


def equals_rounded(compressed, plain):
    """Fails unless a compressed file has the vertices and triangles of a plain one, in another order. Both are opened."""
    assert "EXT_meshopt_compression" in compressed.json["extensionsRequired"]
    rounded = vertices_of_plain(plain)
    decoded = vertices_of_compressed(compressed)
    assert decoded.dtype == rounded.dtype and decoded.shape == rounded.shape, (decoded.shape, rounded.shape)
    # A vertex is known by its place.
    known, first, numbers = numpy.unique(rounded[:, :3], axis=0, return_index=True, return_inverse=True)
    known_too, first_too, numbers_too = numpy.unique(decoded[:, :3], axis=0, return_index=True, return_inverse=True)
    assert numpy.array_equal(known, known_too), "the places of vertices differ"
    colours = numpy.abs(rounded[first, 3:] - decoded[first_too, 3:])
    assert colours.max() <= 1, f"the colours differ by {colours.max()} sRGB codes"
    expected, found = triangles(plain, numbers), triangles(compressed, numbers_too)
    assert numpy.array_equal(expected, found), "the triangles differ"
    return len(decoded), len(found)


def vertices_of_plain(glb):
    """Rounded positions and colours in sRGB codes, a row per vertex."""
    primitive = glb.json["meshes"][0]["primitives"][0]
    accessor = glb.json["accessors"][primitive["attributes"]["POSITION"]]
    positions, _ = glb.stored(primitive["attributes"]["POSITION"])
    low, high = numpy.array(accessor["min"]), numpy.array(accessor["max"])
    places = (positions.astype(float) - low) / ((high - low).max() / STEPS)
    # Halves are rounded away from zero, and numpy would round them to even numbers.
    places = numpy.floor(places + 0.5)
    colours, _ = glb.stored(primitive["attributes"]["COLOR_0"])
    return numpy.hstack((places, srgb(colours.astype(float)))).astype(int)


def vertices_of_compressed(glb):
    attributes = glb.json["meshes"][0]["primitives"][0]["attributes"]
    places, is_fraction = glb.stored(attributes["POSITION"])
    assert places.dtype == numpy.uint16 and not is_fraction
    colours, is_fraction = glb.stored(attributes["COLOR_0"])
    assert colours.dtype == numpy.float32 and not is_fraction
    return numpy.hstack((places, srgb(colours.astype(float)))).astype(int)


def srgb(linear):
    """sRGB codes of linear light."""
    return numpy.rint(255 * numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))


def triangles(glb, numbers):
    """Sorted triangles of known vertices, each with its smallest number first."""
    corners, _ = glb.stored(glb.json["meshes"][0]["primitives"][0]["indices"])
    rows = numbers.reshape(-1)[corners.reshape(-1, 3)]
    turn = (numpy.argmin(rows, axis=1)[:, None] + numpy.arange(3)) % 3
    rows = numpy.take_along_axis(rows, turn, axis=1)
    return rows[numpy.lexsort(rows.T)]
