"""Meshes come as files, arrays, and objects of other packages."""

import pathlib
import types

import latvox
import meshio
import numpy as np
import pytest
from harness import BUNNY, box, encode_drc, octahedron, write_obj, write_ply, write_stl
from latvox._meshes import source_of
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData, vtkUnstructuredGrid

VERTICES, TRIANGLES = (np.array(part) for part in octahedron())
BOX = box([0] * 3, [1] * 3)
OPTIONS = {"resolution": 20, "lattice": "fcc"}


@pytest.fixture(scope="module")
def digest():
    return latvox.voxelize((VERTICES.astype(float), TRIANGLES), **OPTIONS).digest


@pytest.mark.parametrize("vertices", [np.float64, np.float32, np.int32, np.uint8])
@pytest.mark.parametrize("faces", [np.int32, np.int64, np.uint32, np.uint64, np.int16])
def test_arrays_of_any_type(vertices, faces, digest):
    moved = VERTICES + (1 if vertices == np.uint8 else 0)
    v = latvox.voxelize((moved.astype(vertices), TRIANGLES.astype(faces)), **OPTIONS)
    assert v.digest == digest
    assert v.report["mesh"]["triangles"] == 8


def in_packed_records(array):
    """Returns the array as a field of records of odd length, whose numbers are not aligned."""
    records = np.zeros(len(array), [("first", "u1"), ("row", array.dtype, array.shape[1])])
    records["row"] = array
    return records["row"]


def after_a_byte(array):
    """Returns the array in order, at an odd address."""
    return np.frombuffer(b"x" + array.tobytes(), array.dtype, offset=1).reshape(array.shape)


@pytest.mark.parametrize("change", [np.asfortranarray, lambda a: np.repeat(a, 2, 0)[::2], np.ndarray.tolist, in_packed_records, after_a_byte])
def test_arrays_of_any_layout(change, digest):
    assert latvox.voxelize((change(VERTICES.astype(float)), change(TRIANGLES)), **OPTIONS).digest == digest


def test_arrays_equal_a_file_bit_for_bit(tool):
    rows = [line.split() for line in BUNNY.read_text().splitlines()]
    vertices = [[float(x) for x in row[1:4]] for row in rows if row[:1] == ["v"]]
    triangles = [[int(corner.split("/")[0]) - 1 for corner in row[1:]] for row in rows if row[:1] == ["f"]]
    path, report = tool.voxelize(BUNNY, "--resolution", "64", "--fields", "triangle,point")
    v = latvox.voxelize((np.array(vertices), np.array(triangles)), resolution=64, fields=["triangle", "point"])
    assert v.digest == report["digest"]
    assert np.array_equal(v["triangle"], np.load(path)["triangle"])
    assert np.array_equal(v["point"], np.load(path)["point"])


def test_positions_are_doubles(tool):
    far = VERTICES + np.array([1e7, 1e6 + 0.1, -1e7])
    v, w = (latvox.voxelize((points, TRIANGLES), resolution=20) for points in (far, VERTICES.astype(float)))
    assert np.array_equal(v.ijk, w.ijk)
    assert np.allclose(v.points - w.points, [1e7, 1e6 + 0.1, -1e7], rtol=0, atol=1e-7)


def test_arrays_are_turned_and_scaled_like_files(tmp_path):
    mesh = write_obj(tmp_path / "box.obj", BOX)
    vertices, faces = (np.array(part, float if n == 0 else int) for n, part in enumerate(BOX))
    options = {"up_axis": "y", "scale": 2.5, "voxel_size": 0.25}
    v = latvox.voxelize((vertices, faces), **options)
    assert np.array_equal(v.points, latvox.voxelize(mesh, **options).points)
    assert v.points.max(0).tolist() == [2.5, 0, 2.5]


@pytest.mark.parametrize("write", [write_obj, write_ply, write_stl])
def test_paths(write, tmp_path, digest):
    path = write(tmp_path / f"mesh.{write.__name__[-3:]}", octahedron())
    for mesh in (path, str(path), [path]):
        assert latvox.voxelize(mesh, **OPTIONS).digest == digest


def test_several_paths_form_one_mesh(tmp_path, tool):
    paths = [write_obj(tmp_path / f"{n}.obj", box([n] * 3, [n + 0.5] * 3)) for n in range(2)]
    v = latvox.voxelize(paths, voxel_size=0.25, fields="part")
    assert sorted(set(v["part"])) == [0, 1]
    assert v.names("part") == ["0.obj", "1.obj"]


def test_draco(tmp_path, digest):
    path = encode_drc(tmp_path / "mesh.drc", write_obj(tmp_path / "mesh.obj", octahedron()))
    assert latvox.voxelize(path, **OPTIONS).digest == digest


def test_a_path_is_never_standard_input():
    with pytest.raises(latvox.Error, match="-"):
        latvox.voxelize("-", input_format="obj")


def vtk_numbers(array):
    """Returns an array of VTK, which keeps its own memory."""
    return (numpy_to_vtkIdTypeArray if array.dtype == np.int64 else numpy_to_vtk)(array, deep=True)


class Trimesh:
    """As trimesh.Trimesh."""

    def __init__(self, colors=None, face_colors=None, vertices=VERTICES):
        self.vertices, self.faces = np.array(vertices, float), TRIANGLES
        kind = "vertex" if colors is not None else "face" if face_colors is not None else None
        self.visual = types.SimpleNamespace(kind=kind, vertex_colors=colors, face_colors=face_colors)


class Graph(dict):
    """As the graph of a trimesh.Scene: by node, a matrix and the name of a geometry."""

    @property
    def nodes_geometry(self):
        return np.array(list(self))


class Scene:
    """As trimesh.Scene."""

    def __init__(self, geometry, **graph):
        self.geometry, self.graph = geometry, Graph(graph)


class Open3d:
    """As open3d.geometry.TriangleMesh."""

    def __init__(self, colors=()):
        self.vertices, self.triangles, self.vertex_colors = VERTICES.tolist(), TRIANGLES.tolist(), colors


class Tensor:
    """As open3d.core.Tensor."""

    def __init__(self, array):
        self.array = array

    def cpu(self):
        return self

    def numpy(self):
        return self.array


class CudaTensor:
    """As open3d.core.Tensor in the memory of a GPU."""

    def __init__(self, array):
        self.array = array

    def cpu(self):
        return Tensor(self.array)

    def numpy(self):
        raise RuntimeError("Can only convert CPU Tensor to numpy.")


class Open3dTensors:
    """As open3d.t.geometry.TriangleMesh."""

    def __init__(self, **more):
        self.vertex = {"positions": Tensor(VERTICES.astype(np.float32)), **more}
        self.triangle = {"indices": Tensor(TRIANGLES)}


class PolyData(vtkPolyData):
    """As pyvista.PolyData, which is one of VTK, too."""

    def __init__(self, faces, vertices=VERTICES):
        self.faces, self.vertices = vtk_numbers(np.concatenate(faces).astype(np.int64)), vtkPoints()
        self.vertices.SetData(vtk_numbers(np.array(vertices, np.float32)))
        cells = vtkCellArray()
        cells.ImportLegacyFormat(self.faces)
        self.SetPoints(self.vertices)
        self.SetPolys(cells)


class Grid(vtkUnstructuredGrid):
    """As pyvista.UnstructuredGrid."""

    def extract_surface(self):
        return PolyData([[3, *t] for t in TRIANGLES])


class Image(vtkImageData):
    """As pyvista.ImageData. One of VTK 9.1 has no GetPoints."""

    def extract_surface(self):
        return PolyData([[3, *t] for t in TRIANGLES])


OBJECTS = [
    Trimesh(),
    Scene({"body": Trimesh()}, body=(np.eye(4), "body")),
    Open3d(),
    Open3dTensors(),
    PolyData([[3, *t] for t in TRIANGLES]),
    Grid(),
    Image(),
    meshio.Mesh(VERTICES.astype(float), [("triangle", TRIANGLES[:3]), ("line", TRIANGLES[:, :2]), ("triangle", TRIANGLES[3:])]),
]


@pytest.mark.parametrize("mesh", OBJECTS, ids=lambda mesh: type(mesh).__name__)
def test_objects_of_other_packages(mesh, digest):
    assert latvox.voxelize(mesh, **OPTIONS).digest == digest


def test_files_of_meshio(tmp_path, digest):
    meshio.read(write_stl(tmp_path / "mesh.stl", octahedron())).write(tmp_path / "mesh.vtk")
    assert latvox.voxelize(meshio.read(tmp_path / "mesh.vtk"), **OPTIONS).digest == digest


def test_polygons_are_cut_like_those_of_files(tmp_path):
    vertices, _ = BOX
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    path = tmp_path / "box.obj"
    lines = ["v %d %d %d" % v for v in vertices] + ["f " + " ".join(str(c + 1) for c in quad) for quad in quads]
    path.write_text("\n".join(lines))
    options = {"resolution": 8, "fields": "triangle"}
    expected = latvox.voxelize(path, **options)
    faces = [[4, *quads[0]], [2, 0, 1], [4, *quads[1]], [3, *quads[2][:3]], [3, *quads[2][::2], quads[2][3]]]
    mixed = PolyData(faces, vertices)
    for mesh in (
        (np.array(vertices, float), np.array(quads)),
        meshio.Mesh(np.array(vertices, float), [("quad", np.array(quads))]),
    ):
        v = latvox.voxelize(mesh, **options)
        assert np.array_equal(v.ijk, expected.ijk) and np.array_equal(v["triangle"], expected["triangle"])
    assert latvox.voxelize(mixed, resolution=8).report["mesh"]["triangles"] == 6


def test_many_polygons_of_two_sizes_are_one_list_of_corners():
    """An array for each run of equal faces took time that grew with the square of their number."""
    columns = 200_001
    vertices = np.stack([np.repeat(np.arange(columns), 2) / 1000, np.tile([0, 1], columns), np.zeros(2 * columns)], -1)
    low = 2 * np.arange(columns - 1)
    quads = np.stack([low, low + 2, low + 3, low + 1], -1)[::2]
    triangles = np.stack([low, low + 2, low + 3], -1)[1::2]
    listed = np.column_stack([np.full(len(quads), 4), quads, np.full(len(triangles), 3), triangles]).ravel()
    mixed = PolyData([listed], vertices)
    (part,) = source_of(mixed, with_colors=False)
    assert len(part.faces) == 1 and len(part.sizes) == columns - 1
    v = latvox.voxelize(mixed, resolution=500)
    assert len(v) > 500 and v.report["mesh"]["triangles"] == 2 * len(quads) + len(triangles)
    assert v.digest == latvox.voxelize([(vertices, quads), (vertices, triangles)], resolution=500).digest


def test_many_blocks_of_meshio():
    vertices, _ = BOX
    quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    blocks = [("quad", quads[n % 6 : n % 6 + 1]) if n % 2 else ("triangle", quads[n % 6 : n % 6 + 1, :3]) for n in range(20_000)]
    v = latvox.voxelize(meshio.Mesh(np.array(vertices, float), blocks), resolution=8)
    assert v.report["mesh"]["triangles"] == 30_000


def test_colors_of_vertices():
    colors = np.array([[255, 0, 0]] * 6, np.uint8)
    shares = (colors / 255).astype(np.float32)
    for mesh in (Trimesh(np.column_stack([colors, colors[:, 0]])), Open3d(shares), Open3dTensors(colors=Tensor(shares))):
        v = latvox.voxelize(mesh, resolution=9, fields=["color"])
        assert v["color"].shape == (len(v), 3) and (v["color"] == [255, 0, 0]).all()
    with pytest.raises(latvox.InvalidArgument, match="color"):
        latvox.voxelize(Trimesh(), resolution=9, fields=["color"])


RED, BLUE = [255, 0, 0], [0, 0, 255]
OF_VERTICES = np.array([RED] * 6, np.uint8)
OF_FACES = np.array([RED] * 4 + [BLUE] * 4, np.uint8)


def faces_of(mesh):
    """Voxelizes for colors. Returns the color of each triangle that is nearest to a voxel in its middle."""
    v = latvox.voxelize(mesh, resolution=30, fields=["color", "triangle", "point"])
    middle = (v["point"].min(1) > 0.1) & (v["point"].sum(1) < 0.9)
    return {t: {tuple(c) for c in v["color"][middle & (v["triangle"] == t)].tolist()} for t in range(8)}


EXPECTED = {t: {tuple(OF_FACES[t].tolist())} for t in range(8)}


def with_arrays(of_points=None, of_cells=None, cells=None, scalars=False):
    """Returns a plain vtkPolyData with arrays of colors by name."""
    mesh = vtkPolyData()
    mesh.ShallowCopy(PolyData(cells or [[3, *t] for t in TRIANGLES]))
    for data, arrays in ((mesh.GetPointData(), of_points or {}), (mesh.GetCellData(), of_cells or {})):
        for name, values in arrays.items():
            array = vtk_numbers(values)
            array.SetName(name)
            (data.SetScalars if scalars else data.AddArray)(array)
    return mesh


RGBA = np.column_stack([OF_VERTICES, OF_VERTICES[:, 0]])
CHANNELS = dict(zip(("red", "green", "blue"), np.ascontiguousarray(OF_VERTICES.T), strict=True))


@pytest.mark.parametrize(
    "mesh",
    [
        with_arrays({"RGB": OF_VERTICES}),
        with_arrays({"Normals": VERTICES.astype(np.float32), "RGBA": RGBA}),
        with_arrays({"colors": (OF_VERTICES / 255).astype(np.float32)}),
        with_arrays({"anything": RGBA}, scalars=True),
        with_arrays(CHANNELS),
        meshio.Mesh(VERTICES.astype(float), [("triangle", TRIANGLES)], point_data={"RGB": OF_VERTICES}),
        meshio.Mesh(VERTICES.astype(float), [("triangle", TRIANGLES)], point_data=CHANNELS | {"nx": np.zeros(6)}),
        meshio.Mesh(VERTICES.astype(float), [("triangle", TRIANGLES)], point_data={"Colors": OF_VERTICES.astype(int)}),
    ],
)  # fmt: skip
def test_colors_of_points(mesh):
    assert faces_of(mesh) == {t: {tuple(RED)} for t in range(8)}


MIXED = [[2, 0, 1], *([3, *t] for t in TRIANGLES)]  # a face of two corners is none


@pytest.mark.parametrize(
    "mesh",
    [
        Trimesh(face_colors=np.column_stack([OF_FACES, OF_FACES[:, 0]])),
        with_arrays(of_cells={"RGB": OF_FACES}),
        with_arrays(of_cells={"anything": OF_FACES}, scalars=True),
        with_arrays(of_cells={"RGB": np.vstack([[[0, 255, 0]], OF_FACES]).astype(np.uint8)}, cells=MIXED),
        Open3dTensors(),
        meshio.Mesh(
            VERTICES.astype(float),
            [("line", TRIANGLES[:, :2]), ("triangle", TRIANGLES[:3]), ("triangle", TRIANGLES[3:])],
            cell_data={"RGB": [OF_FACES[::-1], OF_FACES[:3], OF_FACES[3:]]},
        ),
    ],
)
def test_colors_of_faces(mesh):
    if isinstance(mesh, Open3dTensors):
        mesh.triangle["colors"] = Tensor((OF_FACES / 255).astype(np.float32))
    assert faces_of(mesh) == EXPECTED


def test_cells_of_points_and_lines_come_before_those_of_faces():
    mesh = with_arrays(of_cells={"RGB": np.vstack([[[0, 255, 0]] * 3, OF_FACES]).astype(np.uint8)})
    for add, count in ((mesh.SetVerts, 1), (mesh.SetLines, 2)):
        cells = vtkCellArray()
        cells.ImportLegacyFormat(vtk_numbers(np.array([count, *range(count)] * count, np.int64)))
        add(cells)
    assert faces_of(mesh) == EXPECTED


def test_polygons_give_their_color_to_all_their_triangles():
    vertices, _ = BOX
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    colors = np.array([[40 * n, 0, 0] for n in range(6)], np.uint8)
    mesh = meshio.Mesh(np.array(vertices, float), [("quad", np.array(quads))], cell_data={"RGB": [colors]})
    v = latvox.voxelize(mesh, resolution=9, fields=["color", "triangle"])
    assert np.array_equal(v["color"][:, 0], v["triangle"] // 2 * 40)


def test_broken_faces_take_no_color():
    faces, colors = np.vstack([[[0, 1, 99]], TRIANGLES]), np.vstack([[[0, 255, 0]], OF_FACES]).astype(np.uint8)
    mesh = meshio.Mesh(VERTICES.astype(float), [("triangle", faces)], cell_data={"RGB": [colors]})
    with pytest.warns(latvox.VoxelizeWarning, match="1 broken element"):
        v = latvox.voxelize(mesh, resolution=9, fields=["color", "triangle"], skip_bad=True)
    assert set(map(tuple, v["color"].tolist())) == {tuple(RED), tuple(BLUE)}


def test_colors_of_points_count_before_those_of_faces():
    with pytest.warns(latvox.VoxelizeWarning, match="faces and vertices have colors") as caught:
        assert faces_of(with_arrays({"RGB": OF_VERTICES}, {"RGB": OF_FACES})) == {t: {tuple(RED)} for t in range(8)}
    assert caught[0].message.code == "IGNORED_COLOR"


def test_parts_of_a_scene_keep_their_colors():
    move = np.eye(4)
    move[0, 3] = 5
    scene = Scene({"a": Trimesh(colors=OF_VERTICES), "b": Trimesh(face_colors=OF_FACES)}, a=(np.eye(4), "a"), b=(move, "b"))
    v = latvox.voxelize(scene, resolution=40, fields=["color", "part"])
    assert (v["color"][v["part"] == 0] == RED).all() and set(map(tuple, v["color"][v["part"] == 1].tolist())) == {
        tuple(RED),
        tuple(BLUE),
    }


@pytest.mark.parametrize(
    ("mesh", "text"),
    [
        (Trimesh(), "visual.kind is None; only those of kind 'vertex' and 'face' are read"),
        (Open3d(), "vertex_colors is empty"),
        (Open3dTensors(), "looked for colors of vertex and of triangle"),
        (with_arrays({"Normals": VERTICES.astype(np.float32)}), "looked for arrays RGB, RGBA, COLOR, COLORS, and red, green"),
        (meshio.Mesh(VERTICES, [("triangle", TRIANGLES)]), "looked for arrays RGB, RGBA"),
        ((VERTICES, TRIANGLES), "arrays of vertices and faces have none"),
    ],
)
def test_the_error_of_missing_colors_tells_where_they_were_looked_for(mesh, text):
    with pytest.raises(latvox.InvalidArgument, match=rf"the mesh, or some of it, has no color \({text}") as caught:
        latvox.voxelize(mesh, resolution=9, fields="color")
    assert (caught.value.reason, caught.value.field, caught.value.value) == ("BAD_MESH", "mesh", "color")


def test_tensors_of_a_gpu_are_copied():
    expected = latvox.voxelize(Open3dTensors(colors=Tensor(OF_VERTICES)), resolution=9, fields="color")
    mesh = Open3dTensors(colors=CudaTensor(OF_VERTICES))
    mesh.vertex["positions"], mesh.triangle["indices"] = (CudaTensor(mesh.vertex["positions"].array), CudaTensor(TRIANGLES))
    v = latvox.voxelize(mesh, resolution=9, fields="color")
    assert v.digest == expected.digest and np.array_equal(v["color"], expected["color"])


@pytest.mark.parametrize("faces", [np.int8, np.uint16, np.int32, np.uint32, np.int64, np.uint64, ">i4"])
@pytest.mark.parametrize("vertices", [np.int16, np.float32, np.float64, ">f8", np.longdouble])
def test_arrays_of_every_type_and_order_are_one_mesh(vertices, faces):
    expected = latvox.voxelize((VERTICES.astype(float), TRIANGLES), resolution=9, fields="triangle")
    wide = np.full((12, 6), 99, vertices)  # with strides
    wide[::2, ::2] = VERTICES
    for one in (VERTICES.astype(vertices), np.asfortranarray(VERTICES, vertices), wide[::2, ::2]):
        for order in "CF":
            v = latvox.voxelize((one, np.array(TRIANGLES, faces, order=order)), resolution=9, fields="triangle")
            assert v.digest == expected.digest and np.array_equal(v["triangle"], expected["triangle"])


@pytest.mark.parametrize("wrong", [128.0, -0.5, 1.01, np.nan, np.inf])
def test_floats_that_are_no_colors_are_refused(wrong):
    colors = (OF_VERTICES / 255).astype(np.float32)
    colors[3, 1] = wrong
    for mesh in (with_arrays({"colors": colors}), Open3d(colors), Open3dTensors(colors=Tensor(colors))):
        with pytest.raises(latvox.InvalidArgument, match=f"mesh: the color {wrong:g} is not from 0 to 1") as caught:
            latvox.voxelize(mesh, resolution=9, fields="color")
        assert (caught.value.field, caught.value.value, caught.value.limit) == ("mesh", f"{wrong:g}", "0 to 1")
    colors[3, 1] = 1.000001  # a rounding
    assert latvox._meshes._bytes_of(colors)[3, 1] == 255


def test_numbers_that_are_no_colors_are_refused():
    mesh = meshio.Mesh(VERTICES, [("triangle", TRIANGLES)], point_data={"RGB": np.full((6, 3), 300)})
    with pytest.raises(latvox.InvalidArgument, match=r"colors: an array of shape \(6, 3\) and type int64 is not \(6, 3\) uint8"):
        latvox.voxelize(mesh, resolution=9, fields="color")


def test_plain_objects_of_vtk(digest):
    mesh = with_arrays()
    assert type(mesh) is vtkPolyData and latvox.voxelize(mesh, **OPTIONS).digest == digest
    mesh.SetStrips(mesh.GetPolys())
    with pytest.raises(latvox.InvalidArgument, match="mesh: triangle strips are not read; pass the output of vtkTriangleFilter"):
        latvox.voxelize(mesh)
    with pytest.raises(latvox.InvalidArgument, match="faces: the mesh has none"):
        latvox.voxelize(vtkPolyData())


POINTS = VERTICES.astype(float)


@pytest.mark.parametrize(
    ("vertices", "faces", "text"),
    [
        (POINTS[:, :2], TRIANGLES, r"vertices: an array of shape \(6, 2\) and type float64 is not \(n, 3\) numbers"),
        (POINTS[0], TRIANGLES, r"vertices: an array of shape \(3\)"),
        (POINTS.astype(complex), TRIANGLES, "type complex128"),
        (POINTS.astype(str), TRIANGLES, "vertices: an array of shape"),
        (POINTS, TRIANGLES.astype(float), r"faces: an array of shape \(8, 3\) and type float64 is not \(m, 3\) integers"),
        (POINTS, TRIANGLES[:, :2], r"faces: an array of shape \(8, 2\)"),
        (POINTS, TRIANGLES.ravel(), r"faces: an array of shape \(24\)"),
        (POINTS, TRIANGLES[:0], "faces: the mesh has none"),
        (POINTS, TRIANGLES + 1, r"faces\[1\]: index 6 is not within 0 and 6, the number of vertices"),
        (POINTS, TRIANGLES - 1, r"faces\[0\]: index -1 is not within 0 and 6"),
        (POINTS, np.array([[0, 1, 2**64 - 1]], np.uint64), r"faces\[0\]: index 18446744073709551615 is not within 0 and 6"),
        (POINTS, np.array([[0, 1, 2**63]], ">u8"), r"faces\[0\]: index 9223372036854775808 is not within 0 and 6"),
        (POINTS[:0], TRIANGLES, r"faces\[0\]: index"),
        (np.where(POINTS == 1, np.nan, POINTS), TRIANGLES, r"vertices\[0\]: nan is not finite"),
        (np.where(POINTS == -1, np.inf, POINTS), TRIANGLES, r"vertices\[1\]: inf is not finite"),
    ],
)
def test_wrong_arrays_name_array_row_and_limit(vertices, faces, text):
    with pytest.raises(latvox.InvalidArgument, match=text) as caught:
        latvox.voxelize((vertices, faces), resolution=9)
    error = caught.value
    assert error.field in ("vertices", "faces") and error.reason == "BAD_MESH"
    if "none" not in text:
        assert error.value in str(error) and error.limit


def test_skip_bad_leaves_out_what_it_leaves_out_of_files(tmp_path):
    points = np.vstack([POINTS, [[np.nan, 0, 0], [0, np.inf, 0], [2, 2, 2]]])
    faces = np.vstack([TRIANGLES[:4], [[0, 1, 6], [7, 1, 2]], TRIANGLES[4:], [[0, 1, 99], [-1, 0, 1]]])
    with pytest.warns(latvox.VoxelizeWarning, match="4 broken elements are left out; the first: ") as caught:
        v = latvox.voxelize((points, faces), skip_bad=True, fields="triangle", **OPTIONS)
    (warning,) = [each.message for each in caught]
    assert (warning.code, warning.element) == ("BAD_ELEMENTS", "faces[4]")
    assert "vertices[6]: nan is not finite" in str(warning)
    used = (np.vstack([POINTS, [[2, 2, 2]]]), TRIANGLES)  # the vertex that no face has stays
    expected = latvox.voxelize(used, fields="triangle", **OPTIONS)
    assert v.digest == expected.digest and np.array_equal(v["triangle"], expected["triangle"])
    lines = ["v " + " ".join(map(str, p)) for p in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces[:-1]]
    (tmp_path / "mesh.obj").write_text("\n".join(lines))
    with pytest.warns(latvox.VoxelizeWarning, match="broken elements are left out"):
        assert latvox.voxelize(tmp_path / "mesh.obj", skip_bad=True, **OPTIONS).digest == v.digest


def test_rows_of_unequal_length_are_refused():
    for vertices, faces, field in ((POINTS, [[0, 1, 2], [0, 1, 2, 3]], "faces"), ([[0, 0, 0], [1, 0]], TRIANGLES, "vertices")):
        with pytest.raises(latvox.InvalidArgument, match=f"^{field}: ") as caught:
            latvox.voxelize((vertices, faces), resolution=9)
        assert (caught.value.reason, caught.value.field) == ("BAD_MESH", field) and caught.value.limit


def test_an_empty_mesh_of_tensors_has_no_faces():
    for vertex in ({}, {"positions": Tensor(VERTICES.astype(np.float32))}):
        mesh = types.SimpleNamespace(vertex=vertex, triangle={})
        with pytest.raises(latvox.InvalidArgument, match="faces: the mesh has none"):
            latvox.voxelize(mesh, resolution=9)


def test_skip_bad_that_leaves_no_face_names_the_first_broken_one():
    first = f"faces\\[0\\]: index 99 is not within 0 and {len(POINTS)}, the number of vertices"
    for faces, what in (
        ([[0, 1, 99], [-1, 0, 1]], "2 broken elements are left out; the first"),
        ([[0, 1, 99]], "1 broken element is left out"),
    ):
        with pytest.raises(latvox.InvalidArgument, match=f"faces: the mesh has none; {what}: {first}"):
            latvox.voxelize((POINTS, np.array(faces)), skip_bad=True)


@pytest.mark.parametrize("mesh", [None, 5, [], (1, 2, 3), object(), bytearray(b"mesh.obj"), ["mesh.obj", (VERTICES, TRIANGLES)]])
def test_other_objects_are_type_errors(mesh):
    with pytest.raises(TypeError, match=r"mesh(\[[01]\])?: "):
        latvox.voxelize(mesh)


def test_the_error_of_another_object_names_what_was_looked_for():
    with pytest.raises(TypeError, match=r"mesh: builtins.object is neither .* trimesh \(vertices, faces\), Open3D .* VTK"):
        latvox.voxelize(object())
    with pytest.raises(TypeError, match=r"mesh\[1\]: builtins.int is neither"):
        latvox.voxelize([(VERTICES, TRIANGLES), 5])
    with pytest.raises(TypeError, match="vtkUnstructuredGrid is neither .*; pass its surface"):
        latvox.voxelize(vtkUnstructuredGrid())


CORNERS, FACES = VERTICES.astype(float), TRIANGLES
SIDE_BY_SIDE = [(CORNERS + np.array([3 * n, 0, 0]), FACES) for n in range(3)]


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("kind", [list, tuple])
@pytest.mark.parametrize("change", [np.asarray, np.ndarray.tolist], ids=["arrays", "lists"])
def test_a_list_of_meshes_has_a_part_for_each(count, kind, change, tmp_path):
    pairs = kind((change(vertices), change(faces)) for vertices, faces in SIDE_BY_SIDE[:count])
    tuples = [(list(map(tuple, vertices.tolist())), faces) for vertices, faces in SIDE_BY_SIDE[:count]]
    paths = [write_obj(tmp_path / f"{n}.obj", mesh) for n, mesh in enumerate(tuples)]
    v, w = (latvox.voxelize(mesh, voxel_size=0.2, fields="part") for mesh in (pairs, paths))
    assert v.digest == w.digest and np.array_equal(v["part"], w["part"])
    assert np.unique(v["part"]).tolist() == list(range(count)) and v.names("part") == []
    assert v.report["mesh"]["triangles"] == 8 * count


def test_a_list_may_hold_objects_of_several_packages():
    objects = [Trimesh(vertices=SIDE_BY_SIDE[0][0]), SIDE_BY_SIDE[1], meshio.Mesh(SIDE_BY_SIDE[2][0], [("triangle", FACES)])]
    v, w = (latvox.voxelize(mesh, voxel_size=0.2, set="solid", labels="part") for mesh in (objects, SIDE_BY_SIDE))
    assert v.digest == w.digest and np.array_equal(v["part"], w["part"]) and set(v["part"]) == {0, 1, 2}


def test_errors_and_warnings_name_the_part():
    broken = np.vstack([FACES, [[0, 1, 99]]])
    with pytest.raises(latvox.InvalidArgument, match=r"^part 1: faces\[8\]: index 99 is not within") as caught:
        latvox.voxelize([SIDE_BY_SIDE[0], (CORNERS, broken)])
    assert (caught.value.field, caught.value.value, caught.value.reason) == ("faces", "99", "BAD_MESH")
    with pytest.warns(latvox.VoxelizeWarning, match=r"^part 1: 1 broken element is left out: faces\[8\]"):
        latvox.voxelize([SIDE_BY_SIDE[0], (CORNERS, broken)], resolution=9, skip_bad=True)


def test_a_scene_has_a_named_part_for_each_node():
    move, mirror = np.eye(4), np.diag([-1.0, 1, 1, 1])
    move[0, 3], mirror[0, 3] = 3, 6
    lopsided = CORNERS * [1.5, 1, 1] + [0.25, 0, 0]
    points = types.SimpleNamespace(vertices=CORNERS)  # without faces
    scene = Scene(
        {"body": Trimesh(vertices=lopsided), "cloud": points},
        heart=(np.eye(4), "body"), lung=(move, "body"), dots=(np.eye(4), "cloud"), other_lung=(mirror, "body"),
    )  # fmt: skip
    expected = [(lopsided, FACES), (lopsided + [3, 0, 0], FACES), (lopsided * [-1, 1, 1] + [6, 0, 0], FACES[:, ::-1])]
    options = {"voxel_size": 0.2, "set": "solid", "rule": "winding", "labels": "part"}
    v, w = (latvox.voxelize(mesh, **options) for mesh in (scene, expected))
    assert v.digest == w.digest and np.array_equal(v["part"], w["part"])
    assert v.names("part") == ["heart", "lung", "other_lung"]
    lungs = latvox.voxelize(scene, **options, priority=["lung"])
    assert np.count_nonzero(lungs["part"] == 1) >= np.count_nonzero(v["part"] == 1)
    with pytest.raises(latvox.InvalidArgument, match="mesh: the scene has no mesh"):
        latvox.voxelize(Scene({"cloud": points}, dots=(np.eye(4), "cloud")))
    with pytest.raises(latvox.InvalidArgument, match=r"^part 1 \(b\): faces\[0\]: index"):
        bad = types.SimpleNamespace(vertices=CORNERS[:1], faces=FACES)
        latvox.voxelize(Scene({"good": Trimesh(), "bad": bad}, a=(move, "good"), b=(move, "bad")))


def test_volume_cells_are_refused():
    mesh = meshio.Mesh(POINTS, [("triangle", TRIANGLES), ("tetra", np.array([[0, 1, 2, 3]]))])
    with pytest.raises(latvox.InvalidArgument, match="mesh: cells of type tetra") as caught:
        latvox.voxelize(mesh)
    error = caught.value
    assert (error.reason, error.field, error.value, error.limit) == ("BAD_MESH", "mesh", "tetra", "triangle, quad, polygon")


def test_a_missing_file_and_a_wrong_one(tmp_path):
    with pytest.raises(latvox.NotFound, match="missing.obj") as caught:
        latvox.voxelize(tmp_path / "missing.obj")
    assert isinstance(caught.value, FileNotFoundError)
    (tmp_path / "bad.ply").write_text("not a mesh")
    with pytest.raises(latvox.InvalidArgument, match="bad.ply"):
        latvox.voxelize(pathlib.Path(tmp_path / "bad.ply"))
