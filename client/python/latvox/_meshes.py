"""Meshes of Python: paths, arrays, and objects of other packages. This module imports none of those packages."""

from __future__ import annotations

import os
from typing import Any, List, Tuple, Union

import numpy as np

from ._errors import InvalidArgument

# What _latvox takes: paths; or vertices (n, 3), faces (m, k) in their order, colors (n, 3) or (0, 3).
Source = Union[List[str], Tuple[np.ndarray, List[np.ndarray], np.ndarray]]

_NO_COLORS = np.empty((0, 3), np.uint8)
_WITHOUT_SURFACE = ("vertex", "line")  # cells of meshio
_POLYGONS = ("triangle", "quad", "polygon")


def source_of(mesh: Any, with_colors: bool) -> Source:
    """Returns a mesh in the form that _latvox takes.

    with_colors: whether the colors of vertices are needed.
    """
    if _is_path(mesh):
        return [_path(mesh)]
    if isinstance(mesh, (list, tuple)):
        if mesh and all(map(_is_path, mesh)):
            return [_path(one) for one in mesh]
        if len(mesh) == 2:
            return np.asarray(mesh[0]), [np.asarray(mesh[1])], _NO_COLORS
        raise TypeError(f"mesh: a sequence of {len(mesh)} is neither paths nor (vertices, faces)")
    for read in (_vtk, _meshio, _open3d_tensor, _open3d, _trimesh):
        found = read(mesh, with_colors)
        if found is not None:
            return found
    raise TypeError(
        f"mesh: {type(mesh).__module__}.{type(mesh).__name__} is neither a path, paths, (vertices, faces), nor a mesh of "
        "trimesh, meshio, PyVista or Open3D"
    )


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def _path(value: Any) -> str:
    path = os.fspath(value)
    return "./-" if path == "-" else path  # latvox would read standard input


def _bytes_of(colors: Any) -> np.ndarray:
    """Returns colors (n, 3 or more), numbers between 0 and 1 or bytes, as bytes (n, 3)."""
    colors = np.asarray(colors)[:, :3]
    if colors.dtype.kind == "f":
        colors = np.rint(np.clip(colors.astype(np.float64), 0, 1) * 255).astype(np.uint8)
    return colors


def _vtk(mesh: Any, with_colors: bool) -> Source | None:
    """PyVista: a PolyData, or any other dataset, which stands for its surface."""
    if not (hasattr(mesh, "GetPoints") and hasattr(mesh, "points")):
        return None
    if not hasattr(mesh, "faces"):
        mesh = mesh.extract_surface()
    if getattr(mesh, "n_strips", 0):
        mesh = mesh.triangulate()
    return np.asarray(mesh.points), _runs(np.asarray(mesh.faces)), _NO_COLORS


def _runs(faces: np.ndarray) -> List[np.ndarray]:
    """Splits VTK's list of faces, each its number of corners and then the corners, into arrays of faces of one size."""
    starts, at = [], 0
    if len(faces) % 4 == 0 and (faces[::4] == 3).all():
        return [faces.reshape(-1, 4)[:, 1:]]
    while at < len(faces):
        starts.append(at)
        at += 1 + int(faces[at])
    sizes = faces[starts]
    first = [n for n in range(len(sizes)) if n == 0 or sizes[n] != sizes[n - 1]]
    bounds = [starts[n] for n in first] + [len(faces)]
    return [
        faces[low:high].reshape(-1, 1 + sizes[n])[:, 1:] for n, low, high in zip(first, bounds, bounds[1:]) if sizes[n] >= 3
    ]


def _meshio(mesh: Any, with_colors: bool) -> Source | None:
    blocks = getattr(mesh, "cells", None)
    if not (hasattr(mesh, "points") and isinstance(blocks, list) and all(hasattr(b, "type") for b in blocks)):
        return None
    unknown = {block.type for block in blocks} - {*_POLYGONS, *_WITHOUT_SURFACE}
    if unknown:
        raise InvalidArgument(
            f"mesh: cells of type {', '.join(sorted(unknown))} are not {', '.join(_POLYGONS)}; pass their surface",
            reason="BAD_MESH",
            field="mesh",
            value=", ".join(sorted(unknown)),
            limit=", ".join(_POLYGONS),
        )
    faces = [np.asarray(block.data) for block in blocks if block.type in _POLYGONS]
    points = np.asarray(mesh.points)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    return points, faces, _NO_COLORS


def _open3d_tensor(mesh: Any, with_colors: bool) -> Source | None:
    vertex, triangle = getattr(mesh, "vertex", None), getattr(mesh, "triangle", None)
    if vertex is None or triangle is None:
        return None
    colors = _bytes_of(vertex["colors"].numpy()) if with_colors and "colors" in vertex else _NO_COLORS
    return vertex["positions"].numpy(), [triangle["indices"].numpy()], colors


def _open3d(mesh: Any, with_colors: bool) -> Source | None:
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "triangles")):
        return None
    colors = np.asarray(mesh.vertex_colors) if with_colors else _NO_COLORS
    return np.asarray(mesh.vertices), [np.asarray(mesh.triangles)], _bytes_of(colors) if len(colors) else _NO_COLORS


def _trimesh(mesh: Any, with_colors: bool) -> Source | None:
    """A Trimesh, or a Scene, which stands for all its meshes in their places."""
    if hasattr(mesh, "geometry") and hasattr(mesh, "graph"):
        mesh = mesh.to_mesh() if hasattr(mesh, "to_mesh") else mesh.dump(concatenate=True)
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        return None
    has_colors = with_colors and getattr(getattr(mesh, "visual", None), "kind", None) == "vertex"
    colors = _bytes_of(mesh.visual.vertex_colors) if has_colors else _NO_COLORS
    return np.asarray(mesh.vertices), [np.asarray(mesh.faces)], colors
