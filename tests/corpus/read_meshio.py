"""Reads mesh files with meshio. Lines of standard input and output are those of tests/node/read_meshes.js."""

import contextlib
import io
import json
import os
import sys

import meshio
import numpy


def triangles_of(mesh):
    """Returns the corners of all triangles: a polygon of n corners has n - 2."""
    found = [numpy.empty((0, 3), int)]
    for block in mesh.cells:
        corners = numpy.asarray(block.data)
        if corners.ndim == 2 and corners.shape[1] >= 3:
            found += [corners[:, [0, n, n + 1]] for n in range(1, corners.shape[1] - 1)]
    return numpy.concatenate(found)


def colors_of(mesh):
    """Returns the bytes of the vertices' colors, or nothing."""
    for prefix in ("", "diffuse_"):
        names = [prefix + name for name in ("red", "green", "blue")]
        if all(name in mesh.point_data for name in names):
            values = numpy.stack([mesh.point_data[name] for name in names], axis=1)
            return values * 255.0 if values.dtype.kind == "f" else values.astype(float)
    return None


def facts_of(path):
    mesh = meshio.read(path)
    corners = triangles_of(mesh)
    facts = {"triangles": len(corners), "min": None, "max": None, "colors": None}
    if len(corners) == 0:
        return facts
    if corners.min() < 0 or corners.max() >= len(mesh.points):
        raise ValueError("a vertex index is not within the vertices")
    used = mesh.points[corners.ravel()][:, :3].astype(float)
    if not numpy.isfinite(used).all():
        raise ValueError("a corner of a triangle is not finite")
    facts["min"], facts["max"] = used.min(axis=0).tolist(), used.max(axis=0).tolist()
    colors = colors_of(mesh)
    if colors is not None:
        colors = colors[corners.ravel()]
        facts["colors"] = {"min": colors.min(axis=0).tolist(), "max": colors.max(axis=0).tolist(), "mean": colors.mean(axis=0).tolist()}
    return facts


def answer(path):
    try:
        # meshio prints, and ends the program on some files.
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return facts_of(path)
    except (Exception, SystemExit) as error:
        return {"error": f"{type(error).__name__}: {error}".splitlines()[0]}


# Its printing must not mix with the answers.
output = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
for line in sys.stdin:
    print(json.dumps(answer(line.rstrip("\n"))), file=output, flush=True)
