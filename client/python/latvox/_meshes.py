"""Meshes of Python: paths, arrays, and objects of other packages. This module imports none of those packages."""

from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple, Union

import numpy as np

from ._errors import InvalidArgument, checked_path

_NONE = np.empty((0, 3), np.uint8)
_WITHOUT_SURFACE = ("vertex", "line")  # cells of meshio
_POLYGONS = ("triangle", "quad", "polygon")
_COLORS = ("rgb", "rgba", "color", "colors")  # names of arrays, in any case
_CHANNELS = ("red", "green", "blue")  # names of three arrays, as files of .ply have them


class Part(NamedTuple):
    """A part of a mesh, as _latvox takes it: the members of PartArrays."""

    vertices: np.ndarray  # (n, 3)
    faces: List[np.ndarray]  # each (m, k), in their order; with sizes, one (c,): the corners, face after face
    colors: np.ndarray = _NONE  # (n, 3)
    face_colors: np.ndarray = _NONE  # (all m, 3)
    name: str = ""
    no_color: str = ""  # why there are no colors
    sizes: Optional[np.ndarray] = None  # (m,): the number of corners of each face


Source = Union[List[bytes], Tuple[Part, ...]]  # paths, or parts


def source_of(mesh: Any, with_colors: bool) -> Source:
    """Returns a mesh in the form that _latvox takes.

    with_colors: whether colors are needed.
    """
    if _is_path(mesh):
        return [_path(mesh)]
    if not isinstance(mesh, (list, tuple)) or _is_pair(mesh):
        return tuple(_parts("mesh", mesh, with_colors))
    if not mesh:
        raise TypeError("mesh: an empty list has no mesh")
    if all(map(_is_path, mesh)):
        return [_path(one) for one in mesh]
    return tuple(part for n, one in enumerate(mesh) for part in _parts(f"mesh[{n}]", one, with_colors))


def _parts(place: str, mesh: Any, with_colors: bool) -> List[Part]:
    """Returns the parts of one mesh, which is no path."""
    if _is_pair(mesh):
        vertices, faces = (_array(name, rows) for name, rows in zip(("vertices", "faces"), mesh))
        return [Part(vertices, [faces], no_color="arrays of vertices and faces have none")]
    for read in (_scene, _vtk, _meshio, _open3d_tensor, _open3d, _trimesh):
        found = read(mesh, with_colors)
        if found is not None:
            return found
    if _is_path(mesh):
        raise TypeError(f"{place}: a list holds paths alone, or other meshes alone")
    raise TypeError(
        f"{place}: {type(mesh).__module__}.{type(mesh).__name__} is neither a path, nor (vertices, faces), nor a list"
        " of meshes, nor a mesh with the attributes of trimesh (vertices, faces), Open3D (vertices, triangles), meshio"
        " (points, cells), or VTK and PyVista (GetPoints, GetPolys)"
        + ("; pass its surface" if hasattr(mesh, "GetPoints") else "")
    )


def _array(field: str, rows: Any) -> np.ndarray:
    """Returns an array. Errors: InvalidArgument for rows of unequal length."""
    try:
        return np.asarray(rows)
    except ValueError as error:
        text = f"{field}: no array has these rows, which may differ in length ({error})"
        raise InvalidArgument(text, reason="BAD_MESH", field=field, limit="rows of equal length") from None


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, bytes, os.PathLike))


def _path(value: Any) -> bytes:
    path = checked_path("mesh", value)
    return b"./-" if path == b"-" else path  # latvox would read standard input


def _rank(value: Any) -> Optional[int]:
    """Returns the number of axes of an array, a number, or nested lists of numbers; None for anything else."""
    if isinstance(value, (int, float)):
        return 0
    if not isinstance(value, (list, tuple)):
        return getattr(value, "ndim", None)
    inner = _rank(value[0]) if value else 0
    return None if inner is None else 1 + inner


def _is_pair(value: Any) -> bool:
    """Returns whether the value is (vertices, faces), and not a list of two such pairs."""
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        return False
    rank = _rank(value[0])
    return rank is not None and not (rank > 2 and isinstance(value[0], (list, tuple)))


def _bytes_of(colors: Any) -> np.ndarray:
    """Returns colors (n, 3 or more), floats from 0 to 1 or integers from 0 to 255, as bytes (n, 3)."""
    colors = np.asarray(colors)[:, :3]
    if colors.dtype.kind == "f":
        levels = np.rint(colors.astype(np.float64) * 255)
        wrong = colors[~((levels >= 0) & (levels <= 255))]  # also NaN
        if wrong.size > 0:
            limit = "0 to 1"
            text = f"the color {wrong[0]:g} is not from {limit}; colors of floats are; pass others as uint8"
            raise _bad(f"{wrong[0]:g}", limit, text)
        return levels.astype(np.uint8)
    if colors.size == 0 or (colors.min() >= 0 and colors.max() <= 255):
        return colors.astype(np.uint8)
    return colors  # _latvox refuses them


def _colors_among(arrays: Mapping[str, Any]) -> np.ndarray:
    """Returns the colors that have one of the known names; (0, 3): there are none."""
    named = {name.lower(): np.asarray(values) for name, values in arrays.items()}
    for name in _COLORS:
        values = named.get(name)
        if values is not None and values.ndim == 2 and values.shape[1] in (3, 4):
            return _bytes_of(values)
    if all(channel in named and named[channel].ndim == 1 for channel in _CHANNELS):
        return _bytes_of(np.column_stack([named[channel] for channel in _CHANNELS]))
    return _NONE


_NO_COLOR_ARRAY = f"looked for arrays {', '.join(_COLORS).upper()}, and {', '.join(_CHANNELS)}, of points and of cells"


def _vtk(mesh: Any, with_colors: bool) -> Optional[List[Part]]:
    """VTK and PyVista: a PolyData. Any other dataset of PyVista stands for its surface."""
    if not hasattr(mesh, "GetPolys") and hasattr(mesh, "extract_surface"):
        mesh = mesh.extract_surface()
    if not hasattr(mesh, "GetPoints") or not hasattr(mesh, "GetPolys"):
        return None
    if mesh.GetNumberOfStrips() > 0 and hasattr(mesh, "triangulate"):
        mesh = mesh.triangulate()
    if mesh.GetNumberOfStrips() > 0:
        raise _bad("strips", "polygons", "triangle strips are not read; pass the output of vtkTriangleFilter")
    points = mesh.GetPoints()
    vertices = np.empty((0, 3)) if points is None else np.asarray(points.GetData())
    faces, sizes, has_surface = _polygons(np.asarray(mesh.GetPolys().GetData()))
    if not with_colors:
        return [Part(vertices, [faces], sizes=sizes)]
    before = mesh.GetNumberOfVerts() + mesh.GetNumberOfLines()  # the cells of polygons come after them
    of_cells = _vtk_colors(mesh.GetCellData())[before:][: len(has_surface)]
    face_colors = of_cells[has_surface] if len(of_cells) else _NONE
    colors = _vtk_colors(mesh.GetPointData())
    return [Part(vertices, [faces], colors, face_colors, no_color=_NO_COLOR_ARRAY, sizes=sizes)]


def _vtk_colors(data: Any) -> np.ndarray:
    """Returns the colors among VTK's arrays of points or cells. Scalars of three or four bytes are colors, too."""
    arrays = [data.GetArray(n) for n in range(data.GetNumberOfArrays())]
    found = _colors_among({array.GetName(): array for array in arrays if array is not None and array.GetName()})
    scalars = data.GetScalars()
    if len(found) or scalars is None:
        return found
    values = np.asarray(scalars)
    return _bytes_of(values) if values.dtype == np.uint8 and values.ndim == 2 and values.shape[1] in (3, 4) else _NONE


def _polygons(listed: np.ndarray) -> Tuple[np.ndarray, Optional[np.ndarray], np.ndarray]:
    """Returns the faces and sizes of a Part from VTK's list: for each face its number of corners, then the corners.

    Also returns whether each face of the list is among them: those of less than three corners are not.
    """
    if len(listed) % 4 == 0 and (listed[::4] == 3).all():
        return listed.reshape(-1, 4)[:, 1:], None, np.ones(len(listed) // 4, bool)
    numbers, starts, at = listed.tolist(), [], 0
    while at < len(numbers):
        starts.append(at)
        at += 1 + numbers[at]
    sizes = listed[starts]
    has_surface = sizes >= 3
    corners = np.delete(listed, starts)
    return corners[np.repeat(has_surface, sizes)], sizes[has_surface], has_surface


def _bad(value: str, limit: str, text: str) -> InvalidArgument:
    return InvalidArgument(f"mesh: {text}", reason="BAD_MESH", field="mesh", value=value, limit=limit)


def _meshio(mesh: Any, with_colors: bool) -> Optional[List[Part]]:
    blocks = getattr(mesh, "cells", None)
    if not (hasattr(mesh, "points") and isinstance(blocks, list) and all(hasattr(b, "type") for b in blocks)):
        return None
    unknown = ", ".join(sorted({block.type for block in blocks} - {*_POLYGONS, *_WITHOUT_SURFACE}))
    if unknown:
        known = ", ".join(_POLYGONS)
        raise _bad(unknown, known, f"cells of type {unknown} are not {known}; pass their surface")
    of_faces = [n for n, block in enumerate(blocks) if block.type in _POLYGONS]
    points = np.asarray(mesh.points)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    faces = [np.asarray(blocks[n].data) for n in of_faces]
    if not with_colors:
        return [Part(points, faces)]
    of_cells = {name: np.concatenate([data[n] for n in of_faces]) for name, data in mesh.cell_data.items() if of_faces}
    return [Part(points, faces, _colors_among(mesh.point_data), _colors_among(of_cells), no_color=_NO_COLOR_ARRAY)]


def _numbers_of(tensor: Any) -> np.ndarray:
    """Returns the numbers of a tensor of Open3D, also of one in the memory of a GPU."""
    return tensor.cpu().numpy()


def _open3d_tensor(mesh: Any, with_colors: bool) -> Optional[List[Part]]:
    vertex, triangle = getattr(mesh, "vertex", None), getattr(mesh, "triangle", None)
    if vertex is None or triangle is None:
        return None

    def colors_of(elements: Any) -> np.ndarray:
        return _bytes_of(_numbers_of(elements["colors"])) if with_colors and "colors" in elements else _NONE

    # An empty mesh lacks both.
    vertices = _numbers_of(vertex["positions"]) if "positions" in vertex else np.empty((0, 3))
    faces = _numbers_of(triangle["indices"]) if "indices" in triangle else np.empty((0, 3), np.int64)
    why_not = "looked for colors of vertex and of triangle"
    return [Part(vertices, [faces], colors_of(vertex), colors_of(triangle), no_color=why_not)]


def _open3d(mesh: Any, with_colors: bool) -> Optional[List[Part]]:
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "triangles")):
        return None
    colors = np.asarray(mesh.vertex_colors) if with_colors else _NONE
    found = _bytes_of(colors) if len(colors) else _NONE
    faces = [np.asarray(mesh.triangles)]
    return [Part(np.asarray(mesh.vertices), faces, found, no_color="vertex_colors is empty")]


def _trimesh(mesh: Any, with_colors: bool) -> Optional[List[Part]]:
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        return None
    colors: Dict[str, Any] = {}
    kind = getattr(getattr(mesh, "visual", None), "kind", None)  # others have colors that trimesh made up
    if with_colors and kind == "vertex":
        colors["colors"] = _bytes_of(mesh.visual.vertex_colors)
    elif with_colors and kind == "face":
        colors["face_colors"] = _bytes_of(mesh.visual.face_colors)
    elif with_colors:
        colors["no_color"] = f"visual.kind is {kind!r}; only those of kind 'vertex' and 'face' are read"
    return [Part(np.asarray(mesh.vertices), [np.asarray(mesh.faces)], **colors)]


def _scene(scene: Any, with_colors: bool) -> Optional[List[Part]]:
    """A Scene of trimesh: a part for each node with a mesh, in its place, with the node's name."""
    if not (hasattr(scene, "geometry") and hasattr(scene, "graph")):
        return None
    parts = []
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        for part in _trimesh(scene.geometry[geometry], with_colors) or []:  # points and curves have no faces
            parts.append(_placed(part, np.asarray(matrix))._replace(name=str(node).encode("utf-8", "replace").decode()))
    if not parts:
        raise _bad("", "", "the scene has no mesh")
    return parts


def _placed(part: Part, matrix: np.ndarray) -> Part:
    """Returns the part moved by a matrix (4, 4). A mirror image keeps its outside: the order of corners changes."""
    if np.array_equal(matrix, np.eye(4)):
        return part
    faces = [one[:, ::-1] for one in part.faces] if np.linalg.det(matrix[:3, :3]) < 0 else part.faces
    return part._replace(vertices=part.vertices @ matrix[:3, :3].T + matrix[:3, 3], faces=faces)
