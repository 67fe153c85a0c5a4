"""mypy accepts calls that are right, and finds those that are wrong."""

import re
import subprocess

from conftest import PACKAGE

RIGHT = """
import pathlib
from typing import List, Optional
import latvox
import numpy as np
vertices, faces = np.zeros((3, 3)), np.zeros((1, 3), np.int64)
v: latvox.Voxels = latvox.voxelize("a.obj", resolution=64, set="solid", labels="part", priority=["heart", 2])
w = latvox.voxelize((vertices, faces), voxel_size=np.float64(0.5), lattice="bcc", fields=["part", "normal"])
x = latvox.voxelize(pathlib.Path("a.obj"), basis=[[1, 0, 0], [0, 1, 0], [0, 0.5, 2]], out=["a.vdb", pathlib.Path("a.npz")])
y = latvox.voxelize(b"a.obj", out=[b"a.vdb", pathlib.Path("a.npz")], align=b"b.vdb")
shape: int = v.dense("part", box=((0, 0, 0), (1, 1, 1))).data.shape[0] + len(v.ijk) + len(v["part"])
v.save("a.nii", array=["part"])
grid: latvox.Grid = latvox.open("a.vdb")
latvox.convert("a.vdb", ["a.npy"], npy="dense", pad=np.int64(2), dims=(64, 64, 64))
digest: str = latvox.merge([pathlib.Path("a.vdb")], "b.vdb")["digest"]
counts: List[int] = [len(one) for one in latvox.voxelize_many(["a.obj"], jobs=2, band="2v", signed=True)]
with latvox.Client("host:1", token="t", timeout=60) as client, client.stream("a.obj", resolution=9) as stream:
    batches = [batch.masks for batch in stream]
    final: Optional[str] = stream.finish().digest
try:
    latvox.voxelize("a.obj", progress=print, threads=2)
except latvox.InvalidArgument as error:
    text: Optional[str] = error.field or error.reason
"""
WRONG = [
    'latvox.voxelize("a.obj", resolution="64")',
    'latvox.voxelize("a.obj", resolutoin=64)',
    'latvox.voxelize("a.obj", set="soild")',
    'latvox.voxelize("a.obj", lattice=["bcc"])',
    'latvox.voxelize("a.obj", separability=3)',
    'latvox.voxelize("a.obj", verify="yes")',
    "latvox.voxelize(resolution=64)",
    'latvox.voxelize_many(["a.obj"], jobs="2")',
    "latvox.Client(5)",
    "latvox.Client(resolution=9)",
    'latvox.convert("a.vdb", "a.npy", npy="sparse")',
    "latvox.open(5)",
    "v[3]",
    "v.dense(box=5)",
    "v.save(5)",
    "for one in v: print(one)",
    "digest: int = v.digest",
]


def wrong_lines(path):
    """Returns the numbers of lines in which mypy finds an error."""
    options = ["--strict", "--no-incremental", "--follow-imports=silent", "--enable-incomplete-feature=Unpack"]
    words = ["mypy", *options, path.name]
    environment = {"PATH": "/usr/bin:/bin", "MYPYPATH": str(PACKAGE)}
    done = subprocess.run(words, capture_output=True, text=True, cwd=path.parent, env=environment, timeout=600)
    assert done.returncode < 2, done.stderr
    return {int(line) for line in re.findall(rf"^{path.name}:(\d+): error", done.stdout, re.MULTILINE)}, done.stdout


def test_right_calls_pass(tmp_path):
    path = tmp_path / "right.py"
    path.write_text(RIGHT)
    found, told = wrong_lines(path)
    assert not found and told.endswith("Success: no issues found in 1 source file\n"), told


def test_each_wrong_call_is_found(tmp_path):
    path = tmp_path / "wrong.py"
    path.write_text("\n".join(["import latvox", 'v = latvox.voxelize("a.obj")', *WRONG]))
    found, told = wrong_lines(path)
    assert found == set(range(3, 3 + len(WRONG))), told
