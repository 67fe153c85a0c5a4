"""Errors about files name the argument, the file, and the formats that can."""

import os
import pathlib

import harness
import latvox
import numpy as np
import pytest
from harness import octahedron

MESH = tuple(np.array(part, float if n == 0 else int) for n, part in enumerate(octahedron()))


@pytest.fixture(scope="module")
def cubes():
    return latvox.voxelize(MESH, resolution=9, fields=["normal", "part"])


@pytest.fixture(scope="module")
def bcc():
    return latvox.voxelize(MESH, resolution=9, lattice="bcc")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "l.csv").write_text("i,j,k\n")
    (tmp_path / "directory.vdb").mkdir()


def refusal(call):
    """Returns the error of a call, which fails."""
    with pytest.raises(latvox.Error) as caught:
        call()
    assert "(field" not in str(caught.value) and "(limit" not in str(caught.value)  # the text says it already
    return caught.value


@pytest.mark.parametrize("name", ["v.vox", "v.binvox", "v.nii", "v.glb", "v.nrrd", "v.links.csv"])
def test_save_and_convert_refuse_a_format_without_the_fields(name, cubes):
    cubes.save("v.vdb")
    for call, field in ((lambda: cubes.save(name), "path"), (lambda: latvox.convert("v.vdb", name), "out")):
        error = refusal(call)
        assert (error.reason, error.field, error.value) == ("BAD_SPEC", field, name)
        able = error.limit.split()
        assert {".vdb", ".npz", ".h5"} <= set(able) <= set(latvox.EXTENSIONS)
        assert name[1:] not in able and error.limit in str(error)


def test_names_with_a_nul_are_refused(cubes):
    pathlib.Path("data").write_text("precious")
    cubes.save("v.vdb")
    for call, field in (
        (lambda: cubes.save("data\0.csv"), "path"),
        (lambda: latvox.voxelize(MESH, resolution=9, out="data\0.csv"), "out"),
        (lambda: latvox.convert("v.vdb", "data\0.csv"), "out"),
        (lambda: latvox.convert("v.vdb\0.nvdb", "a.csv"), "path"),
        (lambda: latvox.merge(["v.vdb"], "data\0.vdb"), "out"),
        (lambda: latvox.merge(["v.vdb\0"], "a.vdb"), "parts"),
        (lambda: latvox.open(pathlib.PurePath("v.vdb\0.nvdb")), "path"),
        (lambda: latvox.voxelize(f"{harness.BUNNY}\0.stl", resolution=9), "mesh"),
    ):
        error = refusal(call)
        assert (error.reason, error.field, error.limit) == ("BAD_SPEC", field, "no NUL") and "NUL" in str(error)
    assert pathlib.Path("data").read_text() == "precious" and not os.path.exists("a.csv")


@pytest.mark.parametrize("name", ["50% fill.mhd", "LIST.mhd", " lead.mhd"])
def test_readers_of_mhd_take_the_name_of_the_data_for_that_of_one_file(name, cubes):
    error = refusal(lambda: cubes.save(name, array="none"))
    assert (error.reason, error.field, error.value) == ("BAD_SPEC", "path", name)
    assert not os.path.exists(name) and not os.path.exists(name.replace(".mhd", ".raw"))


def test_the_data_of_a_mhd_are_not_written_over_the_mesh():
    text = pathlib.Path(harness.BUNNY).read_bytes()
    pathlib.Path("in.raw").write_bytes(text)
    with pytest.raises(latvox.InvalidArgument, match="is the mesh itself"):
        latvox.voxelize("in.raw", input_format="obj", resolution=9, out="in.mhd")
    assert pathlib.Path("in.raw").read_bytes() == text


@pytest.mark.parametrize("name", ["v.vti", "v.vox", "v.binvox"])
def test_a_format_without_the_lattice_is_refused(name, bcc):
    bcc.save("b.vdb")
    for call, field in (
        (lambda: bcc.save(name), "path"),
        (lambda: latvox.convert("b.vdb", name), "out"),
        (lambda: latvox.voxelize(MESH, resolution=9, lattice="bcc", out=name), "out"),
    ):
        error = refusal(call)
        assert (error.reason, error.field, error.value) == ("BAD_SPEC", field, name) and error.limit


def test_voxelize_names_the_fields_that_an_output_cannot_hold():
    error = refusal(lambda: latvox.voxelize(MESH, resolution=9, fields="normal,part", out="v.nii"))
    assert (error.reason, error.field, error.value) == ("BAD_SPEC", "fields", "normal,part")
    assert ".vdb" in error.limit.split()
    error = refusal(lambda: latvox.voxelize(MESH, resolution=9, out=["v.vdb", "v.vdb"]))
    assert (error.field, error.value) == ("out", "v.vdb")


def test_an_unknown_extension_is_refused(cubes):
    cubes.save("v.vdb")
    for call, field in (
        (lambda: cubes.save("v.xyz"), "path"),
        (lambda: latvox.convert("v.vdb", "v.xyz"), "out"),
        (lambda: latvox.voxelize(MESH, resolution=9, out="v.xyz"), "out"),
    ):
        error = refusal(call)
        assert (error.reason, error.field, error.value) == ("BAD_SPEC", field, "v.xyz")
        assert error.limit.split() == latvox.EXTENSIONS


@pytest.mark.parametrize("place", ["/nonexistent/v{}", "l.csv/v{}", "directory{}"])
@pytest.mark.parametrize("extension", [".vdb", ".npz"])
def test_a_file_that_cannot_be_written_is_named(place, extension, cubes):
    if extension == ".npz":
        os.mkdir("directory.npz")
    cubes.save("v.vdb")
    path = place.format(extension)
    for call, field in (
        (lambda: cubes.save(path), "path"),
        (lambda: latvox.convert("v.vdb", path), "out"),
        (lambda: latvox.voxelize(MESH, resolution=9, out=path), "out"),
    ):
        error = refusal(call)
        assert (type(error), error.field, error.value) == (latvox.FailedPrecondition, field, path)


@pytest.mark.parametrize(
    ("path", "kind", "limited"),
    [
        ("nope.obj", latvox.NotFound, False),
        ("nope.drc", latvox.NotFound, False),
        ("directory.vdb", latvox.InvalidArgument, False),
        ("l.csv", latvox.InvalidArgument, True),
        ("bad.obj", latvox.InvalidArgument, False),
    ],
)
def test_a_mesh_that_cannot_be_read_is_named(path, kind, limited):
    with open("bad.obj", "w") as file:
        file.write("f 1 2 3\n")
    for mesh in (path, [str(harness.BUNNY), path]):
        error = refusal(lambda: latvox.voxelize(mesh, resolution=9))
        assert (type(error), error.field, error.value) == (kind, "mesh", path) and str(error).startswith(path)
        assert (".obj" in (error.limit or "").split()) == limited


@pytest.mark.parametrize(
    ("path", "kind", "limit"),
    [
        ("nope.vdb", latvox.NotFound, None),
        ("nope.csv", latvox.NotFound, None),
        ("bad.vdb", latvox.InvalidArgument, None),
        ("l.csv", latvox.InvalidArgument, ".vdb .nvdb"),
    ],
)
def test_a_file_without_voxels_is_named(path, kind, limit):
    with open("bad.vdb", "w") as file:
        file.write("no grid")
    for call, field in ((lambda: latvox.open(path), "path"), (lambda: latvox.convert(path, "v.csv"), "path")):
        error = refusal(call)
        assert (type(error), error.field, error.value, error.limit) == (kind, field, path, limit)
    error = refusal(lambda: latvox.merge([path], "v.vdb"))
    assert (type(error), error.field, error.value) == (kind, "parts", path)
