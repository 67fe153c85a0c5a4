"""Voxels as arrays equal the files of the tool."""

import gc
import warnings

import latvox
import numpy as np
import pytest
from harness import BUNNY, box, octahedron, write_obj
from harness import latvox as run_tool

MESH = tuple(np.array(part, float if n == 0 else int) for n, part in enumerate(octahedron()))
FIELDS = ["part", "distance", "triangle", "point", "normal"]


@pytest.fixture(scope="module")
def bunny():
    return latvox.voxelize(BUNNY, resolution=100, lattice="bcc", fields=FIELDS)


def test_arrays_have_stated_types_and_shapes(bunny):
    n = len(bunny)
    shapes = {"part": (np.int32, (n,)), "distance": (np.float32, (n,)), "triangle": (np.int32, (n,)),
              "point": (np.float32, (n, 2)), "normal": (np.float32, (n, 3))}  # fmt: skip
    assert bunny.fields == FIELDS
    for name, (dtype, shape) in shapes.items():
        assert (bunny[name].dtype, bunny[name].shape) == (dtype, shape)
    assert (bunny.ijk.dtype, bunny.ijk.shape) == (np.int32, (n, 3))
    assert (bunny.points.dtype, bunny.points.shape) == (np.float64, (n, 3))
    assert "part" in bunny and "color" not in bunny
    with pytest.raises(KeyError, match="voxels carry no field 'color'"):
        bunny["color"]


def test_voxels_and_fields_equal_the_tools(bunny, tool):
    options = ("--resolution", 100, "--lattice", "bcc", "--fields", ",".join(FIELDS))
    path, report = tool.voxelize(BUNNY, *options)
    table = np.load(path)
    for name in ("ijk", *FIELDS):
        own = bunny.ijk if name == "ijk" else bunny[name]
        assert np.array_equal(own, table[name]), name
    csv, _ = tool.voxelize(BUNNY, *options, out="tool.csv")
    xyz = np.loadtxt(csv, delimiter=",", skiprows=1, usecols=(3, 4, 5))
    assert np.array_equal(bunny.points, xyz)
    for key in ("voxels", "digest", "certificate", "basis", "origin", "lattice"):
        assert bunny.report[key] == report[key]
    assert bunny.certificate["tunnel_free"] and bunny.lattice == "bcc"
    assert bunny.voxel_size == pytest.approx(report["voxel_size"] if "voxel_size" in report else bunny.voxel_size)


def test_affine_gives_positions(bunny):
    homogeneous = np.column_stack([bunny.ijk, np.ones(len(bunny))])
    assert np.allclose(homogeneous @ bunny.affine.T, np.column_stack([bunny.points, np.ones(len(bunny))]), atol=1e-12)


def test_bricks_are_the_voxels(bunny):
    bits = np.unpackbits(bunny.masks.copy().view(np.uint8).reshape(-1, 64), axis=1, bitorder="little")
    brick, bit = np.nonzero(bits)
    xyz = np.column_stack([bit >> 6, bit >> 3 & 7, bit & 7])
    assert np.array_equal(8 * bunny.brick_ijk[brick] + xyz, bunny.ijk)


def test_views_are_read_only_and_keep_their_memory():
    v = latvox.voxelize(MESH, resolution=40, fields="distance")
    views = [v["distance"], v.masks, v.brick_ijk]
    copies = [view.copy() for view in views]
    assert views[0].base is not None and not any(view.flags.writeable or view.flags.owndata for view in views)
    del v
    gc.collect()
    junk = [np.ones(100000) for _ in range(20)]
    assert all(np.array_equal(view, copy) for view, copy in zip(views, copies, strict=True)) and junk


def test_dense_equals_the_tools(tool):
    v = latvox.voxelize(BUNNY, resolution=30, set="solid", force_open=True, fields="part")
    path, _ = tool.voxelize(BUNNY, "--resolution", 30, "--set", "solid", "--force-open", "--fields", "part", out="t.npz")
    file = np.load(path)
    data, low, affine = v.dense()
    assert data.dtype == bool and np.array_equal(data, file["data"])
    assert np.array_equal(low, file["index_min"]) and np.array_equal(affine, file["affine"])
    low, high = v.index_box
    assert np.array_equal(high - low, data.shape)


def test_dense_fields_equal_those_of_a_npz(tmp_path):
    paths = [write_obj(tmp_path / f"{n}.obj", octahedron(size)) for n, size in enumerate((1, 0.5))]
    fields = ["part", "distance", "triangle", "point", "normal", "fraction:3", "label_fractions:3"]
    v = latvox.voxelize(paths, voxel_size=0.1, set="supercover-solid", labels="part", fields=fields)
    v.save(tmp_path / "v.npz")
    file = np.load(tmp_path / "v.npz")
    for field in v.fields:
        data = v.dense(field).data
        if field == "label_fractions":
            expected = np.stack([file[f"fraction_{label}"] for label in v.fraction_labels], axis=-1)
        else:
            expected = file[field]
        assert data.dtype == expected.dtype and np.array_equal(data, expected, equal_nan=data.dtype == np.float32), field
    assert set(np.unique(v.dense("part").data)) == {-1, 0, 1}


def test_dense_of_a_box():
    v = latvox.voxelize(MESH, resolution=20, fields=["distance", "normal"])
    box = (v.ijk.min(0) - 1, v.ijk.max(0) - (9, 0, 5))
    data, low, affine = v.dense(box=box)
    assert data.shape == tuple(box[1] - box[0]) and low == tuple(box[0])
    inside = v.ijk[((v.ijk >= box[0]) & (v.ijk < box[1])).all(1)]
    assert data.sum() == len(inside) > 0 and data[tuple((inside - low).T)].all()
    assert np.allclose(affine @ (0, 0, 0, 1), v.affine @ (*low, 1))
    normal = v.dense("normal", box=box)
    assert normal.data.shape == (*data.shape, 3) and np.isnan(normal.data[~data]).all()
    with pytest.raises(latvox.InvalidArgument):
        v.dense(box=((0, 0, 0), (-1, 1, 1)))
    with pytest.raises(latvox.ResourceExhausted):
        v.dense(box=((0, 0, 0), (2**12, 2**12, 2**12)))
    with pytest.raises(KeyError):
        v.dense("part")
    for wrong in (((0, 0), (1, 1, 1)), ((0.5, 0, 0), (1, 1, 1)), ((0, 0, 0), (1, 1, 2**31)), ((0, 0, 0),), 5):
        with pytest.raises(latvox.InvalidArgument, match=r"^box: .* is not \(low, high\), two lattice points") as caught:
            v.dense(box=wrong)
        assert (caught.value.field, caught.value.value) == ("box", repr(wrong))
    assert v.dense(box=np.array([[0, 0, 0], [1, 2, 3]])).data.shape == (1, 2, 3)


def test_dense_of_a_field_takes_memory_for_that_field_alone(run):
    """An array of each field takes 105 bytes a point. This one needs 5."""
    process = run("""
import latvox, os, resource
v = latvox.voxelize(os.environ["BUNNY"], resolution=20, set="links", fields=["part", "links"])
points, before = 300**3, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
v.dense("part", box=((0, 0, 0), (300, 300, 300)))
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 / points)
""")
    out, error = process.communicate(timeout=60)
    assert error == "" and float(out) < 7, out


def test_links_have_a_column_for_each_neighbor(tmp_path):
    fields = ["links", "link_triangles", "link_crossings"]
    v = latvox.voxelize(MESH, resolution=10, set="links", fields=fields)
    assert v.neighbors.shape == (26, 3)
    assert all(v[field].shape == (len(v), 26) for field in fields)
    assert (np.isnan(v["links"]) == (v["link_triangles"] == -1)).all() and not np.isnan(v["links"]).all()
    v.save(tmp_path / "v.npz")
    file = np.load(tmp_path / "v.npz")
    for field in fields:
        assert v[field].dtype == file[field].dtype and np.array_equal(v[field], file[field], equal_nan=field == "links")
    for extension in (".vdb", ".nvdb"):
        v.save(tmp_path / f"v{extension}")
        done = run_tool("convert", tmp_path / f"v{extension}", "-o", tmp_path / "again.npz")
        assert done.returncode == 0 and (tmp_path / "again.npz").read_bytes() == (tmp_path / "v.npz").read_bytes(), done


def test_fractions_have_a_column_for_each_label(tmp_path):
    paths = [write_obj(tmp_path / f"{n}.obj", octahedron(size)) for n, size in enumerate((1, 0.5))]
    options = {"voxel_size": 0.1, "set": "supercover-solid", "labels": "part"}
    v = latvox.voxelize(paths, **options, fields=["part", "fraction:4", "label_fractions:4"])
    assert v.fraction_labels == [0, 1]
    fractions = v["label_fractions"]
    assert (fractions.dtype, fractions.shape) == (np.uint16, (len(v), 2))
    assert np.array_equal(fractions.sum(axis=1), v["fraction"]) and fractions.max(axis=0).tolist() == [64, 64]
    assert v.dense("label_fractions").data.shape == (*v.dense().data.shape, 2)
    one = latvox.voxelize(paths, **options, fields=["label_fractions:4"], fraction_labels=[1])
    assert one.fraction_labels == [1] and np.array_equal(one["label_fractions"], fractions[:, 1:])
    assert one.dense("label_fractions").data.shape == (*one.dense().data.shape, 1)


def test_nothing_is_an_answer_too():
    with pytest.warns(latvox.VoxelizeWarning) as caught:
        v = latvox.voxelize(MESH, resolution=8, region=(100, 0, 0, 101, 1, 1), fields="distance")
    assert len(v) == 0 and v.ijk.shape == v.points.shape == (0, 3) and v["distance"].shape == (0,)
    assert v.masks.shape == (0, 8) and v.brick_ijk.shape == (0, 3)
    warning = caught.list[0]
    assert warning.filename == __file__ and warning.message.code == v.warnings[0].code and v.warnings[0].code.isupper()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        latvox.voxelize(MESH, resolution=8)


@pytest.mark.parametrize("extension", [each for each in latvox.EXTENSIONS if each != ".png"])  # below
def test_save_writes_what_the_tool_writes(extension, tool, tmp_path):
    mesh = write_obj(tmp_path / "mesh.obj", box([0] * 3, [1] * 3))
    fields = {"fields": "links"} if extension.startswith(".links.") else {}
    words = [word for name, value in fields.items() for word in (f"--{name}", value)]
    path, _ = tool.voxelize(mesh, "--resolution", 12, *words, out=f"tool{extension}")
    v = latvox.voxelize(mesh, resolution=12, **fields)
    saved = tmp_path / "own" / path.name  # a .mhd names its .raw
    saved.parent.mkdir()
    v.save(saved)
    assert saved.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("extension", [".vdb", ".html", ".nvdb", ".npz", ".vtu", ".h5"])
def test_save_of_fields_writes_what_the_tool_writes(extension, tool, tmp_path):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    path, _ = tool.voxelize(mesh, "--resolution", 12, "--lattice", "fcc", "--fields", ",".join(FIELDS), out=f"tool{extension}")
    saved = tmp_path / "own" / path.name  # a page has its name
    saved.parent.mkdir()
    latvox.voxelize(mesh, resolution=12, lattice="fcc", fields=FIELDS).save(saved)
    assert saved.read_bytes() == path.read_bytes()


def test_save_of_fields_replaces_and_refuses(bunny, tmp_path):
    (tmp_path / "a.csv").write_text("old")
    bunny.save(str(tmp_path / "a.csv"))
    assert (tmp_path / "a.csv").read_text().startswith("i,j,k,x,y,z,part,distance,triangle,u,v,nx,ny,nz\n")
    with pytest.raises(latvox.InvalidArgument, match="extension"):
        bunny.save(tmp_path / "a.xyz")
    with pytest.raises(latvox.InvalidArgument, match=r"a\.vox: the format holds cubes along the axes only, .*; \.vdb"):
        bunny.save(tmp_path / "a.vox")
    with pytest.raises(latvox.FailedPrecondition, match="missing"):
        bunny.save(tmp_path / "missing" / "a.vdb")
    with pytest.raises(latvox.InvalidArgument, match='npy: "sparse" is not one of coordinates, dense') as caught:
        bunny.save(tmp_path / "a.npy", npy="sparse")
    assert (caught.value.field, caught.value.value, caught.value.limit) == ("npy", "sparse", "coordinates, dense")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv"]


def test_arguments_of_other_types_are_named(bunny, tmp_path):
    for call, text in (
        (lambda: bunny.save(tmp_path / "a.nrrd", array=5), "array: 5 is neither the name of a field nor a sequence"),
        (lambda: bunny.save(tmp_path / "a.nrrd", array=["part", 5]), r"array: \['part', 5\] is neither"),
        (lambda: bunny.save(tmp_path / "a.csv", allow_http="no"), "allow_http: 'no' is not True or False"),
        (lambda: bunny.dense(["distance"]), r"^\['distance'\] is no name of a field"),
        (lambda: bunny.names(5), "^5 is no name of a field"),
    ):
        with pytest.raises(TypeError, match=text) as caught:
            call()
        assert "incompatible function arguments" not in str(caught.value)
    with pytest.raises(KeyError, match="voxels carry no field"):
        bunny["\ud800"]
    assert list(tmp_path.iterdir()) == []


def test_files_that_are_too_small_for_the_voxels(server, tmp_path):
    """The error names what is wrong, the limit, and formats that can hold them."""
    for call, limit, formats in (
        ({"resolution": 9, "pad": 2100, "out": tmp_path / "a.binvox"}, "4096", ".vdb, .h5 and .vtu hold any number"),
        ({"resolution": 9, "pad": 900, "out": tmp_path / "a.npz"}, "4294967296 bytes", "or a .npy or .h5"),
    ):
        with pytest.raises(latvox.ResourceExhausted, match=formats) as caught:
            server.voxelize(MESH, **call)
        assert (caught.value.reason, caught.value.field, caught.value.limit) == ("LIMIT_EXCEEDED", "out", limit)
        assert caught.value.value in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_files_that_merge_parts_warn(tmp_path):
    size = 0.5
    parts = [box([2 * n, 0, 0], [2 * n + 1, 1, 1]) for n in range(13)]
    paths = [write_obj(tmp_path / f"{n}.obj", part) for n, part in enumerate(parts)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        v = latvox.voxelize(paths, voxel_size=size, fields="part", out=tmp_path / "a.vdb")
        v.save(tmp_path / "a.vox")
        latvox.convert(tmp_path / "a.vdb", tmp_path / "a.vox")
    for write in (v.save, lambda path: latvox.convert(tmp_path / "a.vdb", path)):
        with pytest.warns(latvox.VoxelizeWarning, match="has 12 colors for the 13 parts") as caught:
            write(tmp_path / "a.glb")
        (warning,) = caught.list
        assert (warning.message.code, warning.message.element) == ("COLORS_MERGED", str(tmp_path / "a.glb"))
        assert warning.filename == __file__


@pytest.mark.parametrize("take", [iter, list, np.asarray, np.array, np.sum, lambda v: v[0], lambda v: [*v], lambda v: v[:3]])
def test_voxels_are_no_sequence_and_no_array(bunny, take):
    with pytest.raises(TypeError, match=r"; take ijk, points, dense\(\) or the values of a field, such as v\['distance'\]$"):
        take(bunny)
    assert len(bunny) > 0 and 0 not in bunny


def test_notebooks_show_a_picture(bunny):
    picture = bunny._repr_png_()
    assert picture.startswith(b"\x89PNG\r\n") and len(picture) > 1000


def test_a_mesh_may_change_after_the_call():
    vertices = MESH[0].copy()
    v = latvox.voxelize((vertices, MESH[1]), resolution=30)
    points = v.points.copy()
    vertices[:] = 0
    assert np.array_equal(v.points, points)
