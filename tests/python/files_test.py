"""Files of voxels: reading, converting and joining them, as the tool does."""

import inspect
import os
import pathlib
import re

import latvox
import numpy as np
import pytest
from harness import latvox as run_tool, octahedron, write_obj

MESH = tuple(np.array(part, float if n == 0 else int) for n, part in enumerate(octahedron()))
FIELDS = ["part", "distance", "triangle", "point", "normal"]
CALLS = {
    "surface": {"fields": FIELDS, "lattice": "bcc"},
    "solid": {"set": "solid", "labels": "part", "fields": ["part", "fraction:3", "label_fractions:3"]},
    "band": {"band": "2v", "signed": True},
    "links": {"set": "links", "fields": ["links", "link_triangles", "link_crossings"]},
    "empty": {"region": (50, 50, 50, 51, 51, 51)},
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """Returns the answers to CALLS, for two bodies that are named like their files."""
    folder = tmp_path_factory.mktemp("meshes")
    paths = [write_obj(folder / f"{n}.obj", octahedron(size)) for n, size in enumerate((1, 0.5))]
    with np.testing.suppress_warnings() as suppressed:
        suppressed.filter(latvox.VoxelizeWarning)  # one is empty
        return {name: latvox.voxelize(paths, voxel_size=0.1, **options) for name, options in CALLS.items()}


def convert_by_tool(*words):
    """Converts, and expects that it succeeds."""
    done = run_tool("convert", *words)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("extension", [".vdb", ".nvdb"])
@pytest.mark.parametrize("name", CALLS)
def test_open_reads_what_save_wrote(name, extension, answers, tmp_path):
    v = answers[name]
    path = tmp_path / f"v{extension}"
    v.save(path)
    found = latvox.open(path)
    assert isinstance(found, latvox.Grid) and not isinstance(found, latvox.Voxels)
    assert (found.digest, found.lattice, len(found), found.fields) == (v.digest, v.lattice, len(v), v.fields)
    assert repr(found) == repr(v).replace("Voxels:", "Grid:")
    for one in ("basis", "origin", "neighbors"):
        assert np.array_equal(getattr(found, one), getattr(v, one)), one
    own, given = (np.lexsort(each.ijk.T) for each in (found, v))  # a file has its own order of bricks
    assert np.array_equal(found.ijk[own], v.ijk[given]) and np.array_equal(found.points[own], v.points[given])
    for field in v.fields:
        assert np.array_equal(found[field][own], v[field][given], equal_nan=v[field].dtype == np.float32), field
        assert np.array_equal(found.dense(field).data, v.dense(field).data, equal_nan=v[field].dtype == np.float32)
    assert found.fraction_labels == v.fraction_labels
    assert np.array_equal(found.dense().data, v.dense().data)
    if "part" in v:
        assert found.names("part") == v.names("part") == ["0.obj", "1.obj"]
    assert found.report["voxels"] == len(v) and found.report["metadata"]["latvox_digest"] == v.digest


@pytest.mark.parametrize("name", CALLS)
def test_an_opened_file_saves_what_the_tool_converts(name, answers, tmp_path):
    answers[name].save(tmp_path / "v.vdb")
    for extension in (".npz", ".csv", ".nvdb"):
        convert_by_tool(tmp_path / "v.vdb", "-o", tmp_path / f"tool{extension}")
        latvox.open(tmp_path / "v.vdb").save(tmp_path / f"own{extension}")
        assert (tmp_path / f"own{extension}").read_bytes() == (tmp_path / f"tool{extension}").read_bytes(), extension


def test_open_names_what_is_wrong(tmp_path):
    with pytest.raises(latvox.NotFound, match="missing.vdb"):
        latvox.open(tmp_path / "missing.vdb")
    (tmp_path / "bad.vdb").write_bytes(b"no grid")
    with pytest.raises(latvox.InvalidArgument, match="bad.vdb"):
        latvox.open(str(tmp_path / "bad.vdb"))
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    for call in (lambda: latvox.open(mesh), lambda: latvox.convert(mesh, tmp_path / "v.csv")):
        with pytest.raises(latvox.InvalidArgument, match=r"mesh\.obj: is neither a \.vdb nor a \.nvdb file, .*; latvox\.voxelize reads meshes$"):
            call()


def test_import_of_all_names_leaves_python_s_open():
    names = {}
    exec("from latvox import *", names)
    assert "open" not in names and names["convert"] is latvox.convert and names["merge"] is latvox.merge


def test_keywords_of_convert_are_the_options_of_the_tool():
    shown = re.findall(r"^  (?:-\w, )?--([a-z-]+)", run_tool("convert", "--help").stdout, re.M)
    parameters = inspect.signature(latvox.convert).parameters
    assert list(parameters)[:2] == ["path", "out"]
    assert set(shown) - {"help", "quiet"} == parameters.keys() - {"path"}


@pytest.mark.parametrize(
    ("name", "out", "options", "words"),
    [
        ("surface", "v.csv", {}, []),
        ("surface", "v.npz", {"fields": ["distance", "normal"], "pad": 2}, ["--fields", "distance,normal", "--pad", 2]),
        ("surface", "v.npy", {"npy": "dense", "array": "none"}, ["--npy", "dense", "--array", "none"]),
        ("solid", "v.nrrd", {"array": ["part"], "dims": np.array([30, 31, 32])}, ["--array", "part", "--dims", "30,31,32"]),
        ("solid", "v.vtu", {"fields": "none"}, ["--fields", "none"]),
    ],
)
def test_convert_writes_what_the_tool_writes(name, out, options, words, answers, tmp_path):
    answers[name].save(tmp_path / "v.vdb")
    (tmp_path / "own").mkdir()
    (tmp_path / "tool").mkdir()
    latvox.convert(tmp_path / "v.vdb", tmp_path / "own" / out, **options)
    convert_by_tool(tmp_path / "v.vdb", "-o", tmp_path / "tool" / out, *words)
    assert (tmp_path / "own" / out).read_bytes() == (tmp_path / "tool" / out).read_bytes()


def test_convert_writes_all_files_or_none(answers, tmp_path):
    answers["surface"].save(tmp_path / "v.vdb")
    latvox.convert(str(tmp_path / "v.vdb"), [tmp_path / "a.csv", tmp_path / "a.npz"])
    assert {path.name for path in tmp_path.iterdir()} == {"v.vdb", "a.csv", "a.npz"}
    for out, options, field, text in (
        (["b.csv", "b.vox"], {}, "out", r"b\.vox: the format holds cubes along the axes only"),
        (["b.csv"], {"fields": ["color"]}, "path", "v.vdb: has no field color"),
        (["b.csv"], {"fields": "weight"}, "fields", 'fields: "weight" is'),
        (["b.xyz"], {}, "out", 'extension ".xyz" is not one of'),
        (["b.npz"], {"pad": -1}, "pad", "pad: "),
        (["v.vdb"], {}, "out", "is the file itself"),
    ):
        with pytest.raises(latvox.InvalidArgument, match=text) as caught:
            latvox.convert(tmp_path / "v.vdb", [tmp_path / one for one in out], **options)
        assert "--" not in str(caught.value) and caught.value.field == field
    assert {path.name for path in tmp_path.iterdir()} == {"v.vdb", "a.csv", "a.npz"}
    with pytest.raises(latvox.NotFound):
        latvox.convert(tmp_path / "missing.vdb", tmp_path / "b.csv")
    with pytest.raises(TypeError):
        latvox.convert(tmp_path / "v.vdb", tmp_path / "b.csv", resolution=5)


def test_files_of_other_machines_are_refused_by_the_name_of_the_argument(tmp_path):
    url = "https://other.example/v.vdb"
    for call, field in (
        (lambda: latvox.open(url), "path"),
        (lambda: latvox.convert(url, tmp_path / "v.csv"), "path"),
        (lambda: latvox.merge([url], tmp_path / "v.vdb"), "parts"),
    ):
        with pytest.raises(latvox.InvalidArgument, match=f'^{field}: "{url}" is a URL; download it') as caught:
            call()
        assert (caught.value.field, caught.value.value) == (field, url)


def test_parts_are_a_list():
    for one in ("part.vdb", pathlib.Path("part.vdb")):
        with pytest.raises(TypeError, match="parts: .*part.vdb.* is one path; pass a list"):
            latvox.merge(one, "whole.vdb")


def test_a_name_like_an_option_is_a_path(answers, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answers["surface"].save("--v.vdb")
    latvox.convert("--v.vdb", "v.nvdb")
    assert latvox.open("--v.vdb").digest == latvox.open("v.nvdb").digest == answers["surface"].digest


def test_merge_joins_shards(tmp_path):
    options = {"resolution": 150, "fields": ["distance"]}
    parts = [tmp_path / f"{n}.vdb" for n in range(3)]
    for n, part in enumerate(parts):
        latvox.voxelize(MESH, **options, shard=f"{n}/3", out=part)
    whole = latvox.voxelize(MESH, **options)
    report = latvox.merge((part for part in parts), tmp_path / "whole.vdb")
    assert (report["voxels"], report["digest"]) == (len(whole), whole.digest)
    found = latvox.open(tmp_path / "whole.vdb")
    assert found.digest == whole.digest and np.array_equal(found.dense("distance").data, whole.dense("distance").data, True)
    for wrong, out, text in (
        (parts[:2], "w.vdb", "shard"),
        (parts, "w.csv", 'extension ".csv" is not one of .vdb'),
        (parts, "0.vdb", "is the part itself"),
        ([], "w.vdb", "parts"),
        (["s3://bucket/part.vdb"], "w.vdb", "is a URL; download it"),
    ):
        with pytest.raises(latvox.InvalidArgument, match=text):
            latvox.merge(wrong, tmp_path / out)
    with pytest.raises(latvox.NotFound):
        latvox.merge([tmp_path / "missing.vdb"], tmp_path / "w.vdb")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0.vdb", "1.vdb", "2.vdb", "whole.vdb"]


class NamedFile:
    """A path whose name is a text or bytes."""

    def __init__(self, name):
        self.name = name

    def __fspath__(self):
        return self.name


KINDS = {
    "text": os.fsdecode,
    "bytes": os.fsencode,
    "path": lambda name: pathlib.Path(os.fsdecode(name)),
    "path of bytes": lambda name: NamedFile(os.fsencode(name)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_names_of_files_need_not_be_utf8(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def path(extension, start=b""):
        return KINDS[kind](start + b"caf\xe9." + extension)

    write_obj(tmp_path / "mesh.obj", octahedron())
    os.rename(b"mesh.obj", b"caf\xe9.obj")
    v = latvox.voxelize(path(b"obj"), resolution=9, out=[path(b"npz"), path(b"csv", b"-")])
    assert latvox.voxelize([path(b"obj")], resolution=9, out=path(b"npy")).digest == v.digest
    v.save(path(b"vdb"))
    assert latvox.open(path(b"vdb")).digest == v.digest
    assert latvox.voxelize(path(b"obj"), align=path(b"vdb")).digest == v.digest
    latvox.convert(path(b"vdb"), path(b"nvdb"))
    assert latvox.merge([path(b"vdb")], path(b"vdb", b"-"))["digest"] == v.digest
    names = [b"caf\xe9." + name for name in (b"npy", b"npz", b"nvdb", b"obj", b"vdb")]
    assert sorted(os.listdir(b".")) == sorted([b"-caf\xe9.csv", b"-caf\xe9.vdb", *names])
    for call, field, extension in (
        (lambda: latvox.voxelize(path(b"stl")), "mesh", b"stl"),
        (lambda: latvox.voxelize(path(b"obj"), out=path(b"xyz")), "out", b"xyz"),
        (lambda: v.save(path(b"xyz")), "path", b"xyz"),
        (lambda: latvox.open(path(b"csv")), "path", b"csv"),
        (lambda: latvox.convert(path(b"csv"), "a.csv"), "path", b"csv"),
        (lambda: latvox.convert(path(b"vdb"), path(b"xyz")), "out", b"xyz"),
        (lambda: latvox.merge([path(b"csv")], "a.vdb"), "parts", b"csv"),
    ):
        with pytest.raises(latvox.Error, match=r"caf\\xe9\.") as caught:
            call()
        assert (caught.value.field, os.fsencode(caught.value.value)) == (field, b"caf\xe9." + extension)
        assert str(caught.value).encode()


def test_a_name_that_no_file_has_is_refused(answers, tmp_path):
    name, v = f"{tmp_path}/\ud800.vdb", answers["surface"]
    for call, field in (
        (lambda: latvox.voxelize(name), "mesh"),
        (lambda: latvox.voxelize(MESH, out=name), "out"),
        (lambda: v.save(name), "path"),
        (lambda: latvox.open(name), "path"),
        (lambda: latvox.convert(name, "a.csv"), "path"),
        (lambda: latvox.merge([name], "a.vdb"), "parts"),
    ):
        with pytest.raises(latvox.InvalidArgument, match=field) as caught:
            call()
        assert caught.value.field == field and caught.value.limit and str(caught.value).encode()
    for call in (
        lambda: v.save(5),
        lambda: latvox.open(None),
        lambda: latvox.convert(5, "a.csv"),
        lambda: latvox.merge([5], "a.vdb"),
    ):
        with pytest.raises(TypeError, match="(path|parts): .* is no path"):
            call()
    assert list(tmp_path.iterdir()) == []
