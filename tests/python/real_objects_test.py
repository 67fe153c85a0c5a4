"""Meshes of the packages themselves, where they are installed, give the voxels of their arrays."""

import latvox
import numpy as np
import pytest
from harness import octahedron

VERTICES, TRIANGLES = (np.array(part, float if n == 0 else np.int32) for n, part in enumerate(octahedron()))
OPTIONS = {"resolution": 20, "lattice": "fcc"}
RED = np.array([[255, 0, 0]] * len(VERTICES), np.uint8)


@pytest.fixture(scope="module")
def digest():
    return latvox.voxelize((VERTICES, TRIANGLES), **OPTIONS).digest


def check(mesh, colored, digest):
    """The mesh has the voxels of the arrays, and with colors it is red."""
    assert latvox.voxelize(mesh, **OPTIONS).digest == digest
    v = latvox.voxelize(colored, fields=["color"], **OPTIONS)
    assert v.digest == digest and (v["color"] == RED[0]).all()


def test_open3d(digest):
    open3d = pytest.importorskip("open3d")
    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(VERTICES), open3d.utility.Vector3iVector(TRIANGLES)
    )
    colored = open3d.geometry.TriangleMesh(mesh)
    colored.vertex_colors = open3d.utility.Vector3dVector(RED / 255)
    check(mesh, colored, digest)
    tensors = open3d.t.geometry.TriangleMesh.from_legacy
    check(tensors(mesh), tensors(colored), digest)


def test_trimesh(digest):
    trimesh = pytest.importorskip("trimesh")

    def made(**colors):
        return trimesh.Trimesh(VERTICES, TRIANGLES, process=False, **colors)

    check(made(), made(vertex_colors=RED), digest)
    check(made(), made(face_colors=np.array([RED[0]] * len(TRIANGLES))), digest)
    scene = trimesh.Scene()
    scene.add_geometry(made(), node_name="body")
    assert latvox.voxelize(scene, fields="part", **OPTIONS).names("part") == ["body"]


def test_pyvista(digest):
    pyvista = pytest.importorskip("pyvista")

    def made():
        return pyvista.PolyData(VERTICES, np.column_stack([np.full(len(TRIANGLES), 3), TRIANGLES]))

    colored = made()
    colored["RGB"] = RED
    check(made(), colored, digest)
    assert latvox.voxelize(made().cast_to_unstructured_grid(), **OPTIONS).digest == digest
