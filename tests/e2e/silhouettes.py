"""The expected silhouette of a picture of voxels: cells of the lattices, as the page of `latvox view` projects them."""

import itertools
import math

import numpy
import pyopenvdb

TURNS = {"x": lambda x, y, z: (z, x, y), "y": lambda x, y, z: (x, y, z), "z": lambda x, y, z: (x, z, -y)}
# Corners of the Voronoi cells of LATTICES.
CELLS = {
    "cartesian": list(itertools.product((-0.5, 0.5), repeat=3)),
    "bcc": [p for x, y in itertools.product((-0.3, 0.3), (-0.6, 0.6)) for p in itertools.permutations((0, x, y))],
    "fcc": [*itertools.product((-0.4, 0.4), repeat=3), *itertools.permutations((0.8, 0, 0)), *itertools.permutations((-0.8, 0, 0))],
    "hexagonal": [(math.sin(n * math.pi / 3) / 3**0.5, math.cos(n * math.pi / 3) / 3**0.5, z) for n in range(6) for z in (-0.5, 0.5)],
}  # fmt: skip


def write_shape(path, basis, **metadata):
    """Writes the lattice points of a shape without any symmetry, and returns them."""
    grid = pyopenvdb.BoolGrid()
    grid.name = "voxels"
    grid.transform = pyopenvdb.createLinearTransform([[*vector, 0] for vector in basis] + [[0, 0, 0, 1]])
    grid.metadata = metadata
    accessor, points = grid.getAccessor(), []
    for ijk in itertools.product(range(-10, 11), repeat=3):
        x, y, z = (sum(n * vector[m] for n, vector in zip(ijk, basis)) for m in range(3))
        if abs(x) + 1.5 * abs(y) + 0.7 * abs(z) <= 5 and not (x > 0.7 and y > 0.7) and not (z > 1.5 and x < -0.5):
            accessor.setValueOn(ijk, True)
            points.append(ijk)
    pyopenvdb.write(str(path), grids=[grid])
    return points


def hull(points):
    """Returns the convex hull, counter-clockwise."""
    turns = lambda p, q, r: (q[0] - p[0]) * (r[1] - p[1]) > (q[1] - p[1]) * (r[0] - p[0])

    def half(points):
        line = []
        for p in points:
            while len(line) > 1 and not turns(*line[-2:], p):
                line.pop()
            line.append(p)
        return line[:-1]

    points = sorted(points.tolist())
    return half(points) + half(points[::-1])


def places(cells, basis, corners, page, size, azimuth, elevation, up="y", distance=1.0):
    """Yields the positions of these cells' corners on a canvas of this size, by geometry alone. The page's data give
    the point in its middle and the scale."""
    width, height = size
    turn = lambda v: numpy.array(TURNS[up](*v))
    scale = numpy.linalg.norm(page["basis"][0]) / numpy.linalg.norm(basis[0])
    middle = numpy.array(page["low"]) + page["middle"]
    a, e = math.radians(azimuth), math.radians(elevation)
    towards = numpy.array((math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a)))
    right = numpy.array((math.cos(a), 0, -math.sin(a)))
    view = numpy.array((right, numpy.cross(towards, right), towards))
    focus = height / 2 / math.tan(math.radians(15))
    offsets = numpy.array([view @ turn(corner) * scale for corner in corners])
    for ijk in cells:
        world = sum((n - m) * numpy.array(vector) for n, m, vector in zip(ijk, middle, basis))
        at = view @ turn(world) * scale + offsets
        depth = 4 * distance / min(1, width / height) - at[:, 2]
        yield numpy.stack((width / 2 + focus * at[:, 0] / depth, height / 2 - focus * at[:, 1] / depth), 1)


def silhouette(cells, basis, corners, page, size, *view, **how):
    """Returns the pixels that the cells cover."""
    mask = numpy.zeros(size[::-1], bool)
    for place in places(cells, basis, corners, page, size, *view, **how):
        polygon = hull(place)
        low, high = (numpy.array(f(polygon, 0), int) for f in (numpy.min, numpy.max))
        x, y = numpy.meshgrid(*(numpy.arange(max(0, low[m]), min(size[m], high[m] + 1)) for m in (0, 1)))
        inside = numpy.ones(x.shape, bool)
        for p, q in zip(polygon, polygon[1:] + polygon[:1]):
            inside &= (q[0] - p[0]) * (y + 0.5 - p[1]) - (q[1] - p[1]) * (x + 0.5 - p[0]) >= 0
        mask[y[inside], x[inside]] = True
    return mask
