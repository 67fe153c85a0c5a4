"""Keyword arguments are the tool's options, and mean the same."""

import ast
import enum
import functools
import itertools
import re
import sys

import latvox
import numpy as np
import pytest
from bodies import write_bodies
from conftest import ROOT
from harness import BUNNY, box, latvox as run_tool, octahedron, write_obj

# For each keyword, values that make sense, and what they need besides.
SOLID = {"set": "solid", "force_open": True}
REGION = {"set": "region", "seed": (0, 0, 0), "allow_outside": True}
VALUES = {
    "lattice": ("bcc", {}),
    "basis": ([[0.5, 0, 0], [0, 0.25, 0], [0, 0, 0.5]], {"resolution": None}),
    "voxel_size": (np.array([0.25, 0.5, 0.5]), {"resolution": None}),
    "resolution": (np.int64(24), {}),
    "origin": ((0.125, -1e-7, np.float32(0.1)), {}),
    "placement": ("cells", {}),
    "set": ("supercover", {}),
    "rule": ("parity", SOLID),
    "force_open": (True, {"set": "solid"}),
    "seed": ([0, 0, 0], REGION),
    "close": (0.25, {"set": "enclosed"}),
    "leak_from": ((0, 0, 0), {"set": "enclosed"}),
    "allow_outside": (True, REGION),
    "band": ("1.5v", {}),
    "side": ("inside", {"set": "links"}),
    "fields": (["distance", "normal"], {}),
    "labels": ("part", {**SOLID, "fields": "part"}),
    "priority": ([0], {**SOLID, "fields": "part"}),
    "fraction_labels": ([7, 0], {"set": "solid", "labels": "part", "fields": "label_fractions:3"}),
    "signed": (True, {"band": 0.25}),
    "alpha_cutoff": (0.5, {}),
    "separability": (2, {}),
    "minimal": (False, {}),
    "algorithm": ("incremental", {}),
    "verify": (True, {}),
    "upload": ("raw", {}),
    "quantization": (enum.IntEnum("Bits", "n", start=12).n, {"upload": "draco"}),
    "encoding": ("masks", {}),
    "region": ([0, 0, 0, 9, 9, 5], {}),
    "bounds": ((-1, -1, -1, 1, 0.5, 0.5), {}),
    "shard": ("1/3", {"resolution": 200}),
    "up_axis": ("y", {}),
    "scale": (3, {}),
    "skip_bad": (True, {}),
    "input_format": ("obj", {}),
    "strict": (True, {}),
    "weld_report": (True, {}),
}
OF_FILES = {"out", "npy", "array", "dims", "pad", "align"}  # tested below
OF_COMMAND_LINE = {"help", "quiet", "json", "output_format"}


def words(options):
    """Returns the options as words of the command line."""

    def text(value):
        if isinstance(value, (list, tuple, np.ndarray)):
            return ",".join(map(text, value))
        return value if isinstance(value, str) else repr(np.asarray(value).item())

    result = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is not None:
            result += [option] if value is True else ["--no-" + name] if value is False else [f"{option}={text(value)}"]
    return result


def test_keywords_are_the_options_of_the_tool():
    shown = re.findall(r"^  (?:-\w, )?--([a-z-]+)", run_tool("voxelize", "--help").stdout, re.M)
    assert len(shown) > 40
    assert {name.replace("-", "_") for name in shown} - OF_COMMAND_LINE == latvox.KEYWORDS.keys()


def test_types_for_editors_are_those_of_the_options():
    sys.path.insert(0, str(ROOT / "client/python/stubs"))
    from options_stub import stub

    written = (ROOT / "client/python/latvox/_options.pyi").read_text()
    assert written == stub(), "renew it by client/python/stubs/options_stub.py"
    scopes = {"RequestOptions": "request", "CallOptions": "call", "ConnectionOptions": "connection"}
    classes = [node for node in ast.parse(written).body if isinstance(node, ast.ClassDef)]
    for node in classes:
        names = {line.target.id for line in node.body if isinstance(line, ast.AnnAssign)}
        assert names == {name for name, facts in latvox.KEYWORDS.items() if facts["scope"] == scopes.get(node.name)}
    assert len(classes) == 6 and '    lattice: Optional[Literal["cartesian", "bcc", "fcc", "hexagonal"]]\n' in written


def test_signatures_name_types_that_exist():
    tree = ast.parse((ROOT / "client/python/latvox/_calls.py").read_text())
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.args.kwarg]
    typed = {ast.unparse(node.args.kwarg.annotation) for node in functions if node.name != "_describe"}
    assert typed == {"Unpack[AllOptions]", "Unpack[ClientCallOptions]", "Unpack[ClientOptions]"}


def test_every_option_of_a_request_has_a_value_here():
    of_request = {name for name, facts in latvox.KEYWORDS.items() if facts["scope"] == "request"}
    assert VALUES.keys() | OF_FILES == of_request


@pytest.mark.parametrize("name", VALUES)
def test_an_option_means_what_it_means_to_the_tool(name, tool, tmp_path, server):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    value, others = VALUES[name]
    options = {"resolution": 16, **others, name: value}
    path, report = tool.voxelize(mesh, *words(options))
    v = server.voxelize(mesh, **options)
    assert len(v) > 0
    found = np.load(path)
    assert np.array_equal(v.ijk, found["ijk"] if found.dtype.names else found)
    for key in ("digest", "certificate", "basis", "origin", "placement", "warnings", "mesh"):
        assert v.report[key] == report[key], key


def test_an_enclosed_set_has_labels_by_priority(tool, tmp_path, server):
    bodies = {"low": box((0, 0, 0), (6, 6, 6)), "high": box((3, 3, 3), (9, 9, 9))}
    mesh = write_bodies(tmp_path / "bodies.obj", bodies)
    found = {}
    for priority in (["low"], [1, 0]):
        options = {"resolution": 16, "set": "enclosed-interior", "labels": "part", "priority": priority}
        path, report = tool.voxelize(mesh, *words(options))
        v = server.voxelize(mesh, **options)
        assert v.digest == report["digest"]
        assert np.array_equal(v["part"], np.load(path)["part"])
        found[str(priority)] = np.count_nonzero(v["part"])
    assert found["['low']"] < found["[1, 0]"]


def test_defaults_are_those_of_the_tool(tool, server):
    path, report = tool.voxelize(BUNNY)
    v = server.voxelize(BUNNY, lattice=None)
    assert v.digest == report["digest"]
    assert np.array_equal(v.ijk, np.load(path))
    assert repr(v) == f"<latvox.Voxels: {len(v)} voxels, cartesian, voxel size {v.voxel_size:g}>"


def test_dims_and_pad_shape_the_arrays_of_files(tool, tmp_path, server):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    server.voxelize(mesh, dims=(20, 21, 22), pad=2, out=tmp_path / "own.npz")
    path, _ = tool.voxelize(mesh, "--dims", "20,21,22", "--pad", "2", out="tool.npz")
    assert (tmp_path / "own.npz").read_bytes() == path.read_bytes()
    assert np.load(path)["data"].shape == (20, 21, 22)


def test_dims_and_pad_shape_dense_arrays(tmp_path, server):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    plain = server.voxelize(mesh, resolution=9, fields=["triangle"])
    padded = server.voxelize(mesh, resolution=9, fields=["triangle"], pad=2)
    assert np.array_equal(padded.dense().data, np.pad(plain.dense().data, 2))
    assert np.array_equal(padded.dense("triangle").data, np.pad(plain.dense("triangle").data, 2, constant_values=-1))
    low, high = plain.index_box
    assert padded.dense().index_min == tuple(low - 2)
    assert padded.dense(box=(low, high)).data.shape == plain.dense().data.shape
    v = server.voxelize(mesh, dims=(20, 21, 22), pad=2)  # dims choose the resolution
    data, index_min, affine = v.dense()
    assert data.shape == (20, 21, 22) and np.count_nonzero(data) == len(v)
    assert np.array_equal(np.argwhere(data) + index_min, v.ijk[np.lexsort(v.ijk.T[::-1])])
    assert np.allclose(affine[:3, 3], v.origin + v.basis.T @ np.array(index_min))
    v.save(tmp_path / "own.npz")
    assert np.array_equal(np.load(tmp_path / "own.npz")["data"].astype(bool), data)
    nothing = server.voxelize(mesh, resolution=9, dims=(8, 9, 10), region=(900, 0, 0, 901, 1, 1))
    nothing.save(tmp_path / "nothing.npz")
    assert len(nothing) == 0 and tuple(np.load(tmp_path / "nothing.npz")["index_min"]) == nothing.dense().index_min
    with pytest.raises(latvox.InvalidArgument, match=r"dense\(\): dims: 4 along i is less than the"):
        server.voxelize(mesh, resolution=9, dims=(4, 40, 40)).dense()


def test_array_selects_the_fields_of_files_of_one_array(tool, tmp_path, server):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    labeled = {"resolution": 9, "set": "solid", "labels": "part", "fields": ["distance"]}
    v = server.voxelize(mesh, **labeled, array=["distance"], out=tmp_path / "own.nrrd")
    path, _ = tool.voxelize(mesh, *words(labeled), "--array", "distance", out="tool.nrrd")
    assert (tmp_path / "own.nrrd").read_bytes() == path.read_bytes()
    v.save(tmp_path / "saved.nrrd")
    assert (tmp_path / "saved.nrrd").read_bytes() == path.read_bytes()
    v.save(tmp_path / "none.npy", npy="dense", array="none")
    assert np.array_equal(np.load(tmp_path / "none.npy").astype(bool), v.dense().data)
    for array in ("part", ["part"], np.array(["part"])):  # in place of the call's array
        v.save(tmp_path / "part.npy", npy="dense", array=array)
        assert np.array_equal(np.load(tmp_path / "part.npy"), v.dense("part").data)
    v = server.voxelize(mesh, **labeled)
    for array, out, text in (
        (None, "a.nrrd", "a.nrrd: cannot hold distance,part; .vdb"),
        (None, "a.nrrd", "and array selects some for this file"),
        ("normal", "a.nrrd", "array: normal is not among fields"),
        ("weight", "a.nrrd", 'array: "weight" is neither none nor a field'),
        ("part", "a.vdb", "array: needs an output that cannot hold all fields"),
        ("part,none", "a.nrrd", 'array: "none" stands alone'),
    ):
        with pytest.raises(latvox.InvalidArgument, match=text):
            v.save(tmp_path / out, array=array)
    for empty in ([], "", np.array([])):
        with pytest.raises(latvox.InvalidArgument, match="array: is empty"):
            v.save(tmp_path / "a.nrrd", array=empty)


@pytest.mark.parametrize(("lattice", "no_cubes"), [("cartesian", False), ("bcc", True)])
def test_a_refusal_of_save_names_formats_that_hold_the_same_voxels(lattice, no_cubes, tmp_path, server):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    v = server.voxelize(mesh, resolution=9, lattice=lattice, fields=["part", "distance"])
    v.save(tmp_path / "v.vdb")
    refused = set()
    for voxels in v, latvox.open(tmp_path / "v.vdb"):

        @functools.cache
        def save(extension, array, npy=None):
            """Returns the error, or None."""
            try:
                voxels.save(tmp_path / f"a{extension}", array=array, **({"npy": npy} if npy else {}))
            except latvox.InvalidArgument as error:
                return str(error)

        for extension, array in itertools.product(latvox.EXTENSIONS, (None, "part", "none")):
            if (error := save(extension, array)) is None:
                continue
            named = [word for word in re.split("[ ;,]", error) if word in latvox.EXTENSIONS]
            refused.add((extension, array, "along the axes only" in error))
            assert named, error
            for other in named:
                second = save(other, array, "dense" if other == ".npy" and "npy dense" in error else None)
                if second is not None:
                    assert "array: needs an output that cannot hold all fields" in second, error
                    assert save(other, None) is None
    of_cubes = {(extension, array) for extension in (".vox", ".binvox") for array in (None, "part", "none")}
    assert {(extension, array) for extension, array, by_lattice in refused if by_lattice} >= (of_cubes if no_cubes else set())
    assert any(by_lattice for _, _, by_lattice in refused) == no_cubes


def test_out_writes_files_and_align_reads_one(tool, tmp_path, server):
    mesh = write_obj(tmp_path / "mesh.obj", octahedron())
    v = server.voxelize(mesh, resolution=9, out=[tmp_path / "a.vdb", tmp_path / "a.npy"], npy="dense")
    assert np.array_equal(np.load(tmp_path / "a.npy").astype(bool), v.dense().data)
    w = server.voxelize(mesh, align=tmp_path / "a.vdb", scale=0.5)
    assert np.array_equal(w.basis, v.basis) and np.array_equal(w.origin, v.origin)
    assert w.digest == tool.voxelize(mesh, "--align", tmp_path / "a.vdb", "--scale", "0.5")[1]["digest"]


@pytest.mark.parametrize(
    ("options", "field", "text"),
    [
        ({"resolution": 70000}, "resolution", 'resolution: "70000" is not a whole number from 2 to 65536'),
        ({"resolution": 2.5}, "resolution", 'resolution: "2.5" is not a whole number from 2 to 65536'),
        ({"voxel_size": float("nan")}, "voxel_size", 'voxel_size: "nan" is not a finite number above 0'),
        ({"voxel_size": -1}, "voxel_size", 'voxel_size: "-1" is not a finite number above 0'),
        ({"lattice": "ball"}, "lattice", 'lattice: "ball" is not one of cartesian, bcc, fcc, hexagonal'),
        ({"lattice": ""}, "lattice", "lattice: is empty"),
        ({"basis": np.eye(2)}, "basis", 'basis: "1.0,0.0,0.0,1.0" is not 9 finite numbers with commas between them'),
        ({"resolution": 9, "voxel_size": 1}, "voxel_size", "voxel_size excludes resolution"),
        ({"timeout": 0}, "timeout", 'timeout: "0" is not a finite number above 0'),
        ({"separability": 26, "lattice": "bcc"}, "separability", "separability: 26 requires lattice cartesian"),
        ({"set": "solid", "force_open": False}, None, "closed"),
        ({"set": "surface", "force_open": True}, "force_open", "force_open"),
        ({"strict": True, "resolution": 9, "region": (99, 0, 0, 100, 1, 1)}, None, "strict: no warning is allowed"),
    ],
)
def test_wrong_values_name_field_value_and_limit(options, field, text, server):
    with pytest.raises(latvox.InvalidArgument) as caught:
        vertices, triangles = octahedron()
        server.voxelize((np.array(vertices), np.array(triangles[1:])), **options)
    assert text in str(caught.value)
    assert "--" not in str(caught.value)
    assert caught.value.field == field or field is None
    assert isinstance(caught.value, ValueError) and caught.value.code == "INVALID_ARGUMENT"


@pytest.mark.parametrize(
    ("options", "facts"),
    [
        ({"resolution": 70000}, ("resolution", "70000", "2 to 65536", None)),
        ({"resolution": 1}, ("resolution", "1", "2 to 65536", None)),
        ({"voxel_size": -1}, ("voxel_size", "-1", "0", None)),
        ({"lattice": "ball"}, ("lattice", "ball", "cartesian, bcc, fcc, hexagonal", None)),
        ({"quantization": 31}, ("quantization", "31", "0 to 30", None)),
        ({"region": (0, 0, 5, 9, 9, 5)}, ("region", "5", "5", None)),
        ({"alpha_cutoff": 2}, ("alpha_cutoff", "2", "0 to 1", None)),
        ({"fields": "fraction:17"}, ("fields", "17", "2 to 16", None)),
        ({"fields": "fraction:1"}, ("fields", "1", "2 to 16", None)),
        ({"dims": (2, 3, 3), "pad": 1}, ("dims", "2,3,3", "3", None)),
        ({"dims": (0, 3, 3)}, ("dims", "0,3,3", "1 to 1048576", None)),
        ({"resolution": 9, "voxel_size": 1}, ("voxel_size", None, None, "resolution")),
        ({"retries": -1}, ("retries", "-1", "0 to 1000000", None)),
        ({"set": "solid", "labels": "part", "priority": ["heart"]}, ("priority", "heart", None, None)),
        ({"set": "solid", "labels": "part", "priority": ["a,b"]}, ("priority", "a,b", "no comma", None)),
        ({"set": "solid", "labels": "part", "fraction_labels": ("a,b", "c")}, ("fraction_labels", "a,b", "no comma", None)),
        ({"set": "interior", "separability": 2}, ("separability", "2", None, "set")),
        ({"lattice": "\ud800"}, ("lattice", None, "characters of Unicode", None)),
        ({"lattice": "\udcff"}, ("lattice", "\udcff", "cartesian, bcc, fcc, hexagonal", None)),
        ({"fields": 5}, ("fields", "5", "part, material, color, distance, triangle, point, normal, links, link_triangles, link_crossings, fraction, label_fractions", None)),
    ],
)
def test_errors_have_field_value_and_limit(options, facts, server):
    vertices, triangles = octahedron()
    with pytest.raises(latvox.InvalidArgument) as caught:
        server.voxelize((np.array(vertices), np.array(triangles)), **options)
    error = caught.value
    assert (error.field, error.value, error.limit, error.other) == facts
    assert error.reason == "BAD_SPEC"


def test_a_missing_color_is_the_mesh_s_fault(tmp_path, server):
    path = write_obj(tmp_path / "mesh.obj", octahedron())
    vertices, triangles = octahedron()
    for mesh in (path, (np.array(vertices), np.array(triangles))):
        with pytest.raises(latvox.InvalidArgument) as caught:
            server.voxelize(mesh, fields="color")
        error = caught.value
        assert (error.reason, error.field, error.value) == ("BAD_MESH", "mesh", "color")


def test_errors_of_the_server_name_keywords(server):
    mesh = tuple(np.array(part) for part in octahedron())
    for options, text in (
        ({"set": "interior", "separability": 2}, "separability 2: not together with set interior, which has no"),
        ({"fields": "label_fractions:4"}, "fields label_fractions: needs a solid with labels"),
        ({"set": "region", "seed": (9, 9, 9)}, "seed: the nearest lattice point, .*, lies outside of the mesh's box; allow_outside allows it"),
        ({"set": "enclosed", "close": 1e9}, "close 1e.09: of half of it"),
    ):
        with pytest.raises(latvox.InvalidArgument, match=text):
            server.voxelize(mesh, resolution=9, **options)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"resolutoin": 9}, "unexpected keyword argument 'resolutoin'"),
        ({"json": True}, "unexpected keyword argument 'json'"),
        ({"voxel-size": 9}, "unexpected keyword argument 'voxel-size'"),
        ({"tls": True}, "unexpected keyword argument 'tls'; it belongs to latvox.Client"),
        ({"verify": "yes"}, "verify: 'yes' is not True or False"),
        ({"resolution": True}, "resolution: True is not a number, a text, a path or a sequence of these"),
        ({"origin": {1: 2}}, "origin: {1: 2} is not a number"),
        ({"origin": [0, None, 0]}, "origin: None is not a number"),
        ({"lattice": b"bcc"}, "lattice: b'bcc' is not a number"),
    ],
)
def test_wrong_names_and_types_are_type_errors(options, text, server):
    with pytest.raises(TypeError, match=re.escape(text)):
        server.voxelize(BUNNY, **options)


def test_the_number_of_threads_is_a_number():
    for threads in ([2], ([2],)):
        with pytest.raises(TypeError, match=r"threads: .* is not a whole number"):
            latvox.voxelize(BUNNY, threads=threads)


def test_numbers_of_any_type(server):
    v = server.voxelize(BUNNY, voxel_size=np.longdouble(0.125), origin=np.array([0, 0.5, 0], np.longdouble))
    assert v.voxel_size == 0.125 and v.origin.tolist() == [0, 0.5, 0]
    if hasattr(sys, "get_int_max_str_digits"):
        with pytest.raises(latvox.InvalidArgument, match="resolution: the number has too many digits"):
            server.voxelize(BUNNY, resolution=10 ** (sys.get_int_max_str_digits() + 1))


def test_errors_of_the_server_have_its_details(server):
    vertices, triangles = box([0] * 3, [1] * 3)
    with pytest.raises(latvox.ResourceExhausted) as caught:
        server.voxelize((np.array(vertices, float), np.array(triangles)), voxel_size=1e-6)
    error = caught.value
    assert error.reason.isupper() and (error.field, error.limit) == ("voxel_size", "131072")


def test_help_lists_every_option():
    import inspect

    assert inspect.signature(latvox.voxelize).parameters.keys() >= latvox.KEYWORDS.keys()
    assert "voxel_size: Edge of a cube" in latvox.voxelize.__doc__


@pytest.mark.parametrize("function", [latvox.voxelize, latvox.stream, latvox.voxelize_many, latvox.Client.__init__])
def test_help_is_about_python(function):
    for word in ("--", "MESH", "json", "standard output", "may be repeated"):
        assert word not in function.__doc__, word
    assert max(map(len, function.__doc__.splitlines())) < 120


def test_help_tells_values_and_defaults():
    text = " ".join(latvox.voxelize.__doc__.split())
    assert "lattice: Named lattice. Values: cartesian|bcc|fcc|hexagonal. Default: cartesian." in text
    assert "rescale them. " in text and "; voxel_size and resolution rescale them" in text
    assert "out: Path or URL of an output, or a list of them: .vdb " in text
    assert latvox.KEYWORDS["set"]["standard"] == "surface, unless band is given"
