"""Programs and libraries of others read files of voxels, whatever the format.

    rows_of(path, grid)      one row for each voxel: Rows
    box_of(path)             a dense box: its elements by field, and its affine
    links_of(path, grid)     a list of links: fields of links as they are in Rows
    by_npm(paths)            what readers from npm find, by path
"""

import csv
import dataclasses
import json
import re
import subprocess

import h5py
import numpy
import pyopenvdb
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLUnstructuredGridReader

from formats_test import nano_map
from harness import NODE, PATIENCE
from science_test import read as read_image

COLUMNS = {"color": ["red", "green", "blue"], "point": ["u", "v"], "normal": ["nx", "ny", "nz"]}
SCALARS = "part", "material", "distance", "triangle", "fraction"
LINKS = {"links": "link", "link_triangles": "link_triangle", "link_crossings": "link_crossings"}  # their columns' names
OF_LISTS = {"links": "share", "link_triangles": "triangle", "link_crossings": "crossings"}
NOT_CROSSED = {"links": numpy.nan, "link_triangles": -1, "link_crossings": 0}
# pyopenvdb has no grids of integers.
FLOAT_GRIDS = {"color": 3, "distance": 1, "point": 2, "normal": 3}


@dataclasses.dataclass
class Grid:
    """What a call tells of its lattice: the world position of lattice point 0, steps along i, j and k, and links."""

    origin: numpy.ndarray
    basis: numpy.ndarray
    neighbors: numpy.ndarray

    def step_names(self):
        return ["_".join(map(str, step)) for step in self.neighbors.tolist()]


@dataclasses.dataclass
class Rows:
    """Lattice coordinates and positions of voxels, None where the format has none, and components of fields."""

    ijk: numpy.ndarray
    xyz: numpy.ndarray
    values: dict


def rows_of(path, grid):
    for extension, reader in (
        (".csv", csv_rows),
        (".npy", npy_rows),
        (".npz", npz_rows),
        (".cells.vtu", vtu_rows),
        (".vtu", vtu_rows),
        (".h5", h5_rows),
        (".vdb", vdb_rows),
        (".nvdb", nvdb_rows),
    ):
        if path.name.endswith(extension):
            return reader(path, grid)
    raise ValueError(path)


def wide(array):
    return numpy.asarray(array).reshape(len(array), -1)


def of_columns(columns, grid):
    """Returns the fields of columns with one number each."""
    labels = sorted((name for name in columns if re.fullmatch(r"fraction_\d+", name)), key=lambda name: int(name[9:]))
    names = {**{name: [name] for name in SCALARS}, **COLUMNS, "label_fractions": labels}
    names |= {field: [f"{start}_{step}" for step in grid.step_names()] for field, start in LINKS.items()}
    return {
        field: numpy.stack([columns[name] for name in some], axis=1) for field, some in names.items() if some and some[0] in columns
    }


def of_arrays(arrays):
    """Returns the fields of arrays: one for each field, except those of labels."""
    labels = sorted((name for name in arrays if re.fullmatch(r"fraction_\d+", name)), key=lambda name: int(name[9:]))
    values = {name: wide(arrays[name]) for name in (*SCALARS, *COLUMNS, *LINKS) if name in arrays}
    return {**values, "label_fractions": numpy.stack([arrays[name] for name in labels], axis=1)} if labels else values


def csv_rows(path, grid):
    with open(path, encoding="utf-8", newline="") as file:
        head, *lines = csv.reader(file)
    numbers = {name: n for n, name in enumerate(head) if not name.endswith("_name")}
    columns = {name: numpy.array([float(line[n]) for line in lines]) for name, n in numbers.items()}
    return of_table(columns, grid)


def of_table(columns, grid):
    ijk, xyz = (numpy.stack([columns[name] for name in names], axis=1) for names in ("ijk", "xyz"))
    return Rows(ijk, xyz, of_columns(columns, grid))


def npy_rows(path, _):
    rows = numpy.load(path)
    if rows.dtype.names is None:
        return Rows(rows, None, {})
    return Rows(rows["ijk"], None, of_arrays({name: rows[name] for name in rows.dtype.names}))


def npz_rows(path, _):
    with numpy.load(path) as arrays:
        ijk = arrays["ijk"]
        at = tuple((ijk - arrays["index_min"]).T)
        dense = {name: arrays[name][at] for name in arrays if name not in LINKS and arrays[name].shape[:3] == arrays["data"].shape}
        assert arrays["data"].sum() == len(ijk) and (dense.pop("data") == 1).all(), path
        links = {name: arrays[name] for name in LINKS if name in arrays}
        return Rows(ijk, arrays["origin"] + ijk @ arrays["basis"], of_arrays({**dense, **links}))


def vtk_output(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0, path
    return reader.GetOutput()


def vtk_arrays(data):
    return {data.GetArrayName(n): vtk_to_numpy(data.GetArray(n)) for n in range(data.GetNumberOfArrays())}


def vtu_rows(path, _):
    grid = vtk_output(vtkXMLUnstructuredGridReader(), path)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    if path.name.endswith(".cells.vtu"):
        arrays, cells = vtk_arrays(grid.GetCellData()), grid.GetCells()
        corners, starts = (vtk_to_numpy(a) for a in (cells.GetConnectivityArray(), cells.GetOffsetsArray()))
        points = numpy.add.reduceat(points[corners], starts[:-1]) / numpy.diff(starts)[:, None]  # the centers of the cells
    else:
        arrays = vtk_arrays(grid.GetPointData())
    return Rows(arrays["ijk"], points, of_arrays(arrays))


def h5_rows(path, grid):
    with h5py.File(path) as file:
        ijk = file["sets/voxels/ijk"][()]
        values = {name: wide(item[()]) for name, item in file.get("fields", {}).items()}
        for field, name in OF_LISTS.items():
            if f"links/{name}" in file:
                numpy.testing.assert_array_equal(file["links/neighbors"], grid.neighbors)
                values[field] = numpy.full((len(ijk), len(grid.neighbors)), NOT_CROSSED[field])
                values[field][file["links/voxel"][()], file["links/neighbor"][()]] = file[f"links/{name}"][()]
        return Rows(ijk, file.attrs["origin"] + ijk @ file.attrs["basis"], values)


def vdb_rows(path, grid):
    """Reads the grids that pyopenvdb knows: bool and floats."""
    names = [name for name in FLOAT_GRIDS if has_grid(path, name)]
    main = pyopenvdb.read(str(path), "voxels" if has_grid(path, "voxels") else "distance")
    ijk = numpy.array([item.min for item in leaf_values(main)])
    values = {}
    for name in names:
        found = {item.min: item.value for item in leaf_values(pyopenvdb.read(str(path), name))}
        assert len(found) == len(ijk), (path, name)
        values[name] = wide([found[tuple(p)] for p in ijk.tolist()])[:, : FLOAT_GRIDS[name]]
    steps = grid.step_names()
    if has_grid(path, f"link_{steps[0]}"):
        shares = [{i.min: i.value for i in leaf_values(pyopenvdb.read(str(path), f"link_{step}"))} for step in steps]
        values["links"] = numpy.array([[each.get(tuple(p), numpy.nan) for each in shares] for p in ijk.tolist()])
    if "color" in values:
        values["color"] = numpy.rint(values["color"] * 255)
    return Rows(ijk, numpy.array([main.transform.indexToWorld(tuple(p)) for p in ijk.tolist()]), values)


def leaf_values(grid):
    for item in grid.citerOnValues():
        assert item.min == item.max, "latvox writes no tiles"
        yield item


def has_grid(path, name):
    try:
        pyopenvdb.readGridMetadata(str(path), name)
    except KeyError:
        return False
    return True


def nvdb_rows(path, grid):
    """Reads what NanoVDB's converter makes of the file. It transposes the matrix, which comes from the
    bytes therefore."""
    back = path.with_suffix(".back.vdb")
    subprocess.run(["nanovdb_convert", "-f", path, back], capture_output=True, timeout=PATIENCE, check=True)
    rows = vdb_rows(back, grid)
    matrix, shift = nano_map(path)
    return Rows(rows.ijk, rows.ijk @ matrix.T + shift, rows.values)


def links_of(path, grid):
    """Returns lattice coordinates of voxels -> components, by field, of the voxels that have a crossed link."""
    numbers = {tuple(step): n for n, step in enumerate(grid.neighbors.tolist())}
    lengths = numpy.linalg.norm(grid.neighbors @ grid.basis, axis=1)
    if path.suffix == ".csv":
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        ijk = [tuple(int(row[name]) for name in "ijk") for row in rows]
        neighbor = [numbers[tuple(int(row[name]) for name in ("di", "dj", "dk"))] for row in rows]
        columns = {name: [float(row[name]) for row in rows] for name in OF_LISTS.values() if rows and name in rows[0]}
        if "share" in columns:
            numpy.testing.assert_allclose([float(row["distance"]) for row in rows], columns["share"] * lengths[neighbor], rtol=1e-6)
    else:
        with numpy.load(path) as arrays:
            numpy.testing.assert_array_equal(arrays["neighbors"], grid.neighbors)
            numpy.testing.assert_allclose(arrays["lengths"], lengths, rtol=1e-12)
            numpy.testing.assert_allclose(arrays["origin"], grid.origin, atol=1e-12)
            numpy.testing.assert_allclose(arrays["basis"], grid.basis, atol=1e-12)
            ijk, neighbor = list(map(tuple, arrays["ijk"].tolist())), arrays["neighbor"]
            columns = {name: arrays[name] for name in OF_LISTS.values() if name in arrays}
    found = {}
    for field, name in OF_LISTS.items():
        if name in columns:
            of_voxels = found[field] = {}
            for voxel, n, value in zip(ijk, neighbor, columns[name], strict=True):
                of_voxels.setdefault(voxel, numpy.full(len(lengths), NOT_CROSSED[field]))[n] = value
    return found


def box_of(path):
    """Returns the elements by field, components last, and the affine. An image's elements have the name `image`. A dense
    .npy has no affine."""
    if path.suffix == ".npy":
        return {"image": numpy.load(path)}, None
    if path.suffix == ".npz":
        with numpy.load(path) as arrays:
            shape = arrays["data"].shape
            dense = {name: arrays[name].reshape(-1, *arrays[name].shape[3:]) for name in arrays if arrays[name].shape[:3] == shape}
            data = dense.pop("data")
            return boxes({"data": wide(data), **of_arrays(dense)}, shape), arrays["affine"]
    if path.suffix != ".vti":
        array, affine = read_image(path)
        return {"image": array}, affine
    image = vtk_output(vtkXMLImageDataReader(), path)
    arrays, affine = vtk_arrays(image.GetCellData()), numpy.diag([*image.GetSpacing(), 1])
    affine[:3, 3] = numpy.add(image.GetOrigin(), numpy.divide(image.GetSpacing(), 2))
    shape = numpy.subtract(image.GetDimensions(), 1)
    fast = {name: wide(a).reshape(*shape[::-1], -1).transpose(2, 1, 0, 3).reshape(shape.prod(), -1) for name, a in arrays.items()}
    data = fast.pop("data")
    return boxes({"data": data, **of_arrays({n: a[:, 0] if a.shape[1] == 1 else a for n, a in fast.items()})}, shape), affine


def boxes(values, shape):
    return {name: array.reshape(*shape, -1) for name, array in values.items()}


def by_npm(paths):
    if not paths:
        return {}
    command = ["node", "read_voxels.js", *paths]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True, cwd=NODE)
    return json.loads(done.stdout)
