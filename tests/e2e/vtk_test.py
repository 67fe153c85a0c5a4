"""VTK and meshio read .vti, .vtu and .cells.vtu, and find the voxels and fields of the .npz at their positions."""

import binascii
import json
import unittest

import meshio
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIntArray, vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_VERTEX, vtkUnstructuredGrid
from vtkmodules.vtkFiltersGeneral import vtkCellValidator
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from array_case import LATTICES, SPIDER, ArrayCase
from harness import BUNNY, latvox


def named_arrays(data):
    return {data.GetArrayName(n): vtk_to_numpy(data.GetArray(n)) for n in range(data.GetNumberOfArrays())}


def read_vtk(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0, reader.GetErrorCode()
    return reader.GetOutput()


def meshio_reads_files_of_vtk(path):
    """meshio 5.3 with Python 3.13 does not: it finds no end of the base64 that it makes of raw data."""
    grid, points, numbers = vtkUnstructuredGrid(), vtkPoints(), vtkIntArray()
    points.InsertNextPoint(0, 0, 0)
    grid.SetPoints(points)
    grid.InsertNextCell(VTK_VERTEX, 1, [0])
    numbers.SetName("number")
    numbers.InsertNextValue(7)
    grid.GetPointData().AddArray(numbers)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(str(path))
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.Write()
    try:
        return meshio.read(path).point_data["number"] == 7
    except binascii.Error:
        return False


class Vtk(ArrayCase):
    def test_vti_has_cells_around_the_positions(self):
        for name in ("cartesian", "stretched"):
            arrays = self.write(SPIDER, [".vti"], "--resolution", "16", "--fields", "part,color,normal,distance") \
                if name == "cartesian" else self.write(BUNNY, [".vti"], *LATTICES[name])  # fmt: skip
            image = read_vtk(vtkXMLImageDataReader(), self.dir / "a.vti")
            shape = arrays["data"].shape
            self.assertEqual(image.GetDimensions(), tuple(n + 1 for n in shape))
            found = named_arrays(image.GetCellData())
            self.assertEqual(set(found), {n for n in arrays if arrays[n].shape[:3] == shape})
            for each, values in found.items():
                array = values.reshape(*shape[::-1], -1).transpose(2, 1, 0, 3).reshape(arrays[each].shape)
                self.assertEqual(array.dtype, arrays[each].dtype)
                numpy.testing.assert_array_equal(array, arrays[each], each)
            spacing = image.GetSpacing()
            numpy.testing.assert_allclose(spacing, numpy.diag(arrays["affine"])[:3], rtol=1e-14)
            center = numpy.add(image.GetOrigin(), numpy.divide(spacing, 2))
            numpy.testing.assert_allclose(center, arrays["affine"][:3, 3], rtol=1e-14)

    def test_vti_has_a_component_for_each_link(self):
        arrays = self.write(BUNNY, [".vti"], "--resolution", "12", "--fields", "part,links,link_triangles,link_crossings")
        found = named_arrays(read_vtk(vtkXMLImageDataReader(), self.dir / "a.vti").GetCellData())
        at = tuple((arrays["ijk"] - arrays["index_min"]).T)
        self.assertEqual(set(found), {"data", "part", "links", "link_triangles", "link_crossings"})
        for name, nothing in (("links", numpy.nan), ("link_triangles", -1), ("link_crossings", -1)):
            array = found[name].reshape(*arrays["data"].shape[::-1], 26).transpose(2, 1, 0, 3)
            numpy.testing.assert_array_equal(array[at], arrays[name], name)
            numpy.testing.assert_array_equal(array[arrays["data"] == 0], nothing, name)

    def test_vtu_has_a_point_for_each_voxel_of_every_lattice(self):
        for name, options in LATTICES.items():
            fields = ["--fields", "part,distance,links"] if name == "bcc" else []
            arrays = self.write(BUNNY, [".vtu"], *options, *fields)
            grid = read_vtk(vtkXMLUnstructuredGridReader(), self.dir / "a.vtu")
            self.assertEqual((grid.GetNumberOfPoints(), grid.GetNumberOfCells()), (self.summary["voxels"],) * 2)
            self.assertEqual({grid.GetCellType(n) for n in range(grid.GetNumberOfCells())}, {1})
            table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", names=True)
            numpy.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), numpy.c_[table["x"], table["y"], table["z"]])
            found = named_arrays(grid.GetPointData())
            ijk = found.pop("ijk")
            numpy.testing.assert_array_equal(ijk, numpy.c_[table["i"], table["j"], table["k"]])
            self.assertEqual(set(found), {"part", "distance", "links"} if fields else set())
            at = tuple((ijk - arrays["index_min"]).T)
            for each, values in found.items():
                numpy.testing.assert_array_equal(values, arrays[each] if each == "links" else arrays[each][at], each)

    def test_cells_of_a_vtu_are_the_voronoi_cells_of_every_lattice(self):
        for name, options in LATTICES.items():
            with self.subTest(name):
                fields = ["--fields", "part,links"] if name == "bcc" else []
                self.write(BUNNY, [".cells.vtu"], *options, *fields)
                grid = read_vtk(vtkXMLUnstructuredGridReader(), self.dir / "a.cells.vtu")
                table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", names=True)
                found = named_arrays(grid.GetCellData())
                self.assertEqual(set(found), {"ijk", "part", "links"} if fields else {"ijk"})
                numpy.testing.assert_array_equal(found["ijk"], numpy.c_[table["i"], table["j"], table["k"]])
                box = name in ("cartesian", "stretched")
                self.assertEqual({grid.GetCellType(n) for n in range(grid.GetNumberOfCells())}, {12 if box else 42})
                for n in range(0, grid.GetNumberOfCells(), 97):
                    cell = grid.GetCell(n)
                    center = numpy.mean([cell.GetPoints().GetPoint(c) for c in range(cell.GetNumberOfPoints())], axis=0)
                    numpy.testing.assert_allclose(center, [table[x][n] for x in "xyz"], atol=1e-9)
                    self.check_convex(cell)
                volume = abs(numpy.linalg.det(numpy.reshape(self.summary["basis"], (3, 3))))
                numpy.testing.assert_allclose(self.filtered(vtkCellSizeFilter(), grid)["Volume"], volume, rtol=1e-6)
                if name not in ("fcc", "hexagonal"):  # VTK finds some of these equal cells not convex
                    self.assertEqual(set(self.filtered(vtkCellValidator(), grid)["ValidityState"]), {0})
                info = json.loads(latvox("info", "--json", self.dir / "a.cells.vtu").stdout)
                self.assertEqual(info["voxels"], self.summary["voxels"])

    def test_meshio_reads_points_and_cells_of_every_lattice(self):
        if not meshio_reads_files_of_vtk(self.dir / "of_vtk.vtu"):
            self.skipTest(f"meshio {meshio.__version__} reads no file that VTK writes in this way")
        for name, options in LATTICES.items():
            with self.subTest(name):
                self.write(BUNNY, [".vtu", ".cells.vtu"], *options, "--fields", "part,normal")
                table = numpy.genfromtxt(self.dir / "a.csv", delimiter=",", names=True)
                centers = numpy.c_[table["x"], table["y"], table["z"]]
                ijk = numpy.c_[table["i"], table["j"], table["k"]]
                points, cells = (meshio.read(self.dir / f"a{extension}") for extension in (".vtu", ".cells.vtu"))
                numpy.testing.assert_array_equal(points.points, centers)
                block = cells.cells[0]
                self.assertEqual((len(cells.cells), len(block.data)), (1, len(centers)))
                if block.type == "hexahedron":
                    numpy.testing.assert_allclose(cells.points[block.data].mean(axis=1), centers, atol=1e-9)
                else:
                    self.assertEqual(block.type, f"polyhedron{len(cells.points) // len(centers)}")
                for data in (points.point_data, {key: values[0] for key, values in cells.cell_data.items()}):
                    numpy.testing.assert_array_equal(data["ijk"], ijk)
                    numpy.testing.assert_array_equal(data["part"], table["part"])
                    numpy.testing.assert_allclose(data["normal"], numpy.c_[table["nx"], table["ny"], table["nz"]], rtol=1e-6)

    def check_convex(self, cell):
        """Each face is plane, and no corner is before it."""
        corners = numpy.array([cell.GetPoints().GetPoint(c) for c in range(cell.GetNumberOfPoints())])
        for number in range(cell.GetNumberOfFaces()):
            face = cell.GetFace(number)
            on = numpy.array([face.GetPoints().GetPoint(c) for c in range(face.GetNumberOfPoints())])
            normal = numpy.cross(on[1] - on[0], on[2] - on[0])
            normal /= numpy.linalg.norm(normal)
            numpy.testing.assert_allclose((on - on[0]) @ normal, 0, atol=1e-9)
            self.assertLess(((corners - on[0]) @ normal).max(), 1e-9)

    def filtered(self, vtk_filter, grid):
        """Returns the arrays of the cells that a filter of VTK's makes."""
        vtk_filter.SetInputData(grid)
        vtk_filter.Update()
        return named_arrays(vtk_filter.GetOutput().GetCellData())

    def test_a_box_without_a_voxel_is_readable(self):
        self.write(BUNNY, (".vti", ".vtu"), "--resolution", "20", "--region", "1000,0,0,1001,1,1")
        self.assertEqual(read_vtk(vtkXMLImageDataReader(), self.dir / "a.vti").GetNumberOfCells(), 1)
        self.assertEqual(read_vtk(vtkXMLUnstructuredGridReader(), self.dir / "a.vtu").GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
