import sys

import latvox
import numpy

vertices = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], numpy.float32)
triangles = numpy.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], numpy.uint32)
voxels = latvox.voxelize((vertices, triangles), lattice="bcc", resolution=32, server=sys.argv[1])
print(f"{len(voxels)} voxels, digest {voxels.digest}")
