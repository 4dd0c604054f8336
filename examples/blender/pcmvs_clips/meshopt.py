"""Decodes buffer views that EXT_meshopt_compression has compressed: vertices, also with the filter EXPONENTIAL, and triangles.

Bytes come from files of unknown origin. Sizes are compared before memory is allocated, and what does not follow the format
raises ValueError.
"""

from collections import deque

import numpy

# Vertices are stored in groups, and groups in blocks.
GROUP = 16
BLOCK_BYTES = 8192
BLOCK_VERTICES = 256
# How a group is stored: as nothing, with 2 or 4 bits per number, or with whole bytes. Numbers that do not fit their bits
# follow as bytes, and the largest number of the bits stands in their place.
ZERO, TWO_BITS, FOUR_BITS, BYTES = range(4)
BITS = {TWO_BITS: 2, FOUR_BITS: 4}
LARGEST_GROUP = 24
# The modes of the four groups that a byte of a header describes.
MODES = [tuple(byte >> shift & 3 for shift in (0, 2, 4, 6)) for byte in range(256)]

VERTICES_HEADER = 0xA0
TRIANGLES_HEADER = 0xE1
VERTICES_TAIL = 32
TRIANGLES_TAIL = 16


def decode(data, mode, count, stride, name="NONE"):
    """The bytes of `count` items of `stride` bytes. `mode` and `name`, that of the filter, are those of the extension."""
    if name not in ("NONE", "EXPONENTIAL") or (name != "NONE" and mode != "ATTRIBUTES"):
        raise ValueError(f"the filter {name} is not known")
    if mode == "ATTRIBUTES":
        decoded = vertices(data, count, stride)
        return exponential(decoded) if name == "EXPONENTIAL" else decoded
    if mode == "TRIANGLES":
        return triangles(data, count, stride)
    raise ValueError(f"the mode {mode} is not known")


def vertices(data, count, stride):
    """The bytes of vertices: an array with a row per vertex."""
    if not (4 <= stride <= 256 and stride % 4 == 0 and count >= 0):
        raise ValueError(f"there are no {count} vertices of {stride} bytes")
    in_block = min(BLOCK_BYTES // stride // GROUP * GROUP, BLOCK_VERTICES)
    blocks = [in_block] * min(count // in_block, len(data)) + [count % in_block] * (count % in_block > 0)
    headers = stride * sum(-(-block // (4 * GROUP)) for block in blocks)
    end = len(data) - max(stride, VERTICES_TAIL)
    if count // in_block > len(data) or end < 1 + headers:
        raise ValueError(f"{len(data)} bytes are too few for {count} vertices")
    if data[0] != VERTICES_HEADER:
        raise ValueError("the vertices do not begin as they should")
    # A header that promises more than there is must not lead beyond the array.
    padded = numpy.zeros(len(data) + GROUP * LARGEST_GROUP, dtype=numpy.uint8)
    padded[: len(data)] = numpy.frombuffer(data, dtype=numpy.uint8)
    places, modes = find_groups(padded, blocks, stride, end)
    deltas = read_groups(padded, places, modes)

    # Within a block, all first bytes come first, then all second bytes.
    full = count // in_block
    first = deltas[: full * stride * in_block // GROUP].reshape(full, stride, in_block).transpose(0, 2, 1)
    rest = deltas[full * stride * in_block // GROUP :].reshape(stride, -1)[:, : count % in_block].T
    deltas = numpy.concatenate((first.reshape(-1, stride), rest))
    # Signs are in the lowest bit, and every byte is the difference to that of the vertex before.
    deltas = deltas >> 1 ^ -(deltas & 1)
    return padded[len(data) - stride : len(data)] + numpy.cumsum(deltas, axis=0, dtype=numpy.uint8)


def exponential(decoded):
    """The bytes of single-precision numbers. Each is stored as 24 bits times two to the power of the highest 8 bits."""
    numbers = numpy.ascontiguousarray(decoded).view("<i4")
    return numpy.ldexp((numbers << 8 >> 8).astype("<f4"), numbers >> 24).astype("<f4").view(numpy.uint8)


def find_groups(data, blocks, stride, end):
    """Where each group begins, and how it is stored."""
    two, four = (group_sizes(data, bits) for bits in (2, 4))
    places, modes = [], []
    position = 1
    for block in blocks:
        groups = -(-block // GROUP)
        header = -(-groups // 4)
        for _ in range(stride):
            listed = [mode for byte in data[position : position + header].tolist() for mode in MODES[byte]][:groups]
            position += header
            modes += listed
            for mode in listed:
                places.append(position)
                if mode == TWO_BITS:
                    position += two[position]
                elif mode == FOUR_BITS:
                    position += four[position]
                elif mode == BYTES:
                    position += GROUP
            if position > end:
                raise ValueError("the vertices are longer than their bytes")
    if position != end:
        raise ValueError("the vertices are shorter than their bytes")
    return numpy.array(places, dtype=numpy.int64), numpy.array(modes, dtype=numpy.uint8)


def group_sizes(data, bits):
    """The size of a group with so many bits per number that would begin at each byte."""
    largest = (1 << bits) - 1
    own = numpy.array([sum(byte >> shift & largest == largest for shift in range(0, 8, bits)) for byte in range(256)])
    before = numpy.concatenate(([0], numpy.cumsum(own[data])))
    length = GROUP * bits // 8
    return (before[length:] - before[:-length] + length).tolist()


def read_groups(data, places, modes):
    """The numbers of all groups: an array with a row per group."""
    numbers = numpy.zeros((len(modes), GROUP), dtype=numpy.uint8)
    whole = modes == BYTES
    numbers[whole] = data[places[whole, None] + numpy.arange(GROUP)]
    for mode, bits in BITS.items():
        chosen = modes == mode
        starts, length, largest = places[chosen, None], GROUP * bits // 8, (1 << bits) - 1
        shifts = numpy.arange(8 - bits, -1, -bits, dtype=numpy.uint8)
        small = data[starts + numpy.arange(length)][:, :, None] >> shifts & largest
        small = small.reshape(-1, GROUP)
        is_large = small == largest
        behind = data[starts + length + numpy.maximum(numpy.cumsum(is_large, axis=1) - 1, 0)]
        numbers[chosen] = numpy.where(is_large, behind, small)
    return numbers


def triangles(data, count, stride):
    """The `count` corners of triangles, with `stride` bytes each."""
    if not (stride in (2, 4) and count >= 0 and count % 3 == 0):
        raise ValueError(f"there are no triangles of {count} corners of {stride} bytes")
    end = len(data) - TRIANGLES_TAIL
    if end < 1 + count // 3:
        raise ValueError(f"{len(data)} bytes are too few for {count // 3} triangles")
    if data[0] != TRIANGLES_HEADER:
        raise ValueError("the triangles do not begin as they should")
    reader = Numbers(bytes(data), 1 + count // 3, end)
    corners = numpy.array(read_triangles(reader, count // 3), dtype=numpy.int64)
    if reader.position != end:
        raise ValueError("the triangles are shorter than their bytes")
    if count and corners.max() >> 8 * stride:
        raise ValueError(f"a corner does not fit {stride} bytes")
    return corners.astype(f"<u{stride}")


class Numbers:
    """Numbers that do not fit the triangles' codes."""

    def __init__(self, data, position, end):
        self.data, self.position, self.end = data, position, end
        # The number that was read last.
        self.last = 0

    def byte(self):
        if self.position >= self.end:
            raise ValueError("the triangles are longer than their bytes")
        self.position += 1
        return self.data[self.position - 1]

    def corner(self):
        """A corner, stored as its difference to the last one, with 7 bits per byte and the sign in the lowest bit."""
        value = 0
        for shift in range(0, 35, 7):
            byte = self.byte()
            value |= (byte & 127) << shift
            if byte < 128:
                return self.step(value >> 1 ^ -(value & 1))
        raise ValueError("a corner has too many bytes")

    def step(self, by):
        self.last = self.last + by & 0xFFFFFFFF
        return self.last


def read_triangles(reader, count):
    """The corners of triangles. Each has a code of one byte, which refers to edges and corners that were used lately."""
    table = reader.data[reader.end :]
    edges, recent = deque([(0, 0)] * 16, maxlen=16), deque([0] * 16, maxlen=16)
    push_edge, push = edges.appendleft, recent.appendleft
    following = 0
    corners = []
    for code in reader.data[1 : 1 + count]:
        low = code & 15
        if code < 0xF0:
            a, b = edges[code >> 4]
            if low == 0:
                c = following
                following += 1
                push(c)
            elif low < 13:
                c = recent[low]
            else:
                c = reader.corner() if low == 15 else reader.step(1 if low == 14 else -1)
                push(c)
        else:
            # A triangle without an edge that was used. What its corners are is in a byte: 0 for the next corner that was not
            # used, 15 for a number, otherwise one that was used lately.
            kinds = table[low] if low < 14 else reader.byte()
            if low >= 14 and kinds == 0:
                following = 0
            a_is_new, second, third = low != 15, kinds >> 4, kinds & 15
            if low < 14 and 15 in (second, third):
                raise ValueError("the table of triangles has a wrong entry")
            a, following = (following, following + 1) if a_is_new else (reader.corner(), following)
            if second == 0:
                b, following = following, following + 1
            else:
                b = reader.corner() if second == 15 else recent[second - 1]
            if third == 0:
                c, following = following, following + 1
            else:
                c = reader.corner() if third == 15 else recent[third - 1]
            push(a)
            if second in (0, 15):
                push(b)
            if third in (0, 15):
                push(c)
            push_edge((b, a))
        push_edge((c, b))
        push_edge((a, c))
        corners += (a, b, c)
    return corners
