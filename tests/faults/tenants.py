"""Meshes and requests of a tenant who wants others to wait: each takes as long as it can for what it seems to be."""

import dataclasses

import numpy

from stage import FULL


@dataclasses.dataclass
class Burden:
    triangles: numpy.ndarray  # corners x 3, in the unit cube
    options: list  # of latvox voxelize


def chance():
    return numpy.random.default_rng(1)


def triangles_between(corners):
    return corners.reshape(-1, 3).astype("<f4")


def needles(count):
    """From side to side of the cube, and thinner than any voxel."""
    ends = chance().random((count, 2, 3))
    return triangles_between(numpy.concatenate([ends, ends[:, 1:] + 1e-4], axis=1))


def large(count):
    return triangles_between(chance().random((count, 3, 3)))


def heap(count, size):
    """Triangles of this size in one corner of the cube, and one at the other end."""
    centers = chance().random((count, 1, 3)) * 2 * size
    corners = centers + size * chance().random((count, 3, 3))
    return numpy.concatenate([triangles_between(corners), numpy.array([[1, 1, 1], [1, 1, 0.99], [1, 0.99, 1]], "<f4")])


def tent():
    """Two large triangles, which a band of maximal width surrounds."""
    return numpy.array([[0, 0, 0], [1, 0, 0.3], [0, 1, 0.5], [0, 0, 0], [0, 1, 0.5], [1, 1, 1]], "<f4")


def burdens():
    """By name."""
    times = 10 if FULL else 1  # the full dose takes minutes
    return {
        "needles": Burden(needles(20_000 * times), ["--resolution", 64]),
        "large random triangles": Burden(large(500 * times), ["--resolution", 128]),
        "a wide band": Burden(tent(), ["--resolution", 160 if FULL else 80, "--band", "60v"]),
        "a tangle": Burden(large(4_000 * times), ["--resolution", 48, "--lattice", "bcc"]),
        "coincident triangles, verified": Burden(numpy.tile(large(100), (10 * times, 1)), ["--resolution", 64, "--verify"]),
        "all triangles in one voxel": Burden(heap(200_000 * times, 1e-3), ["--resolution", 64]),
        "all triangles in one tile": Burden(heap(300_000 * times, 0.04), ["--resolution", 256]),
    }


def write(path, corners):
    """Writes a binary .ply file."""
    faces = numpy.zeros(len(corners) // 3, [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, numpy.arange(len(corners)).reshape(-1, 3)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(corners)}\n"
    header += "property float x\nproperty float y\nproperty float z\n"
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_bytes(header.encode() + corners.tobytes() + faces.tobytes())
