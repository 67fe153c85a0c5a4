"""Damaged files of every format that the tool reads: an exit status and one line, never a crash or an output.

$LATVOX_MUTANTS is the number of mutants of each format, 20 by default. $LATVOX_MUTANTS_SEED makes other random choices.
Files that broke a promise stay in build/mutants.
"""

import itertools
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

from harness import BIN, Case, encode_drc, latvox, octahedron, write_obj, write_ply, write_stl
from inputs import write_3mf, write_gltf, write_off, mesh_xml, model
from textures import Gltf, png

COUNT = int(os.environ.get("LATVOX_MUTANTS", "20"))
SEED = int(os.environ.get("LATVOX_MUTANTS_SEED", "1"))
BAD = ROOT / "build" / "mutants"
GRID = ["--lattice", "cartesian", "--resolution", "24"]
WRITTEN = "vdb nvdb csv npy npz ply glb vox binvox png html vti vtu nrrd mha nii nii.gz".split()


def write_wholes(folder):
    """Writes a file of each format."""
    mesh = octahedron()
    obj = write_obj(folder / "mesh.obj", mesh)
    write_ply(folder / "mesh.ply", mesh)
    write_stl(folder / "mesh.stl", mesh)
    write_off(folder / "mesh.off", mesh)
    write_gltf(folder / "mesh.glb", mesh)
    image = folder / "image.png"
    image.write_bytes(png([(n * 4 % 256, n % 256, n // 4) for n in range(32 * 32)], 32))
    for kind in ("jpg", "webp"):
        subprocess.run(["convert", image, image.with_suffix(f".{kind}")], check=True)
    Gltf(image.read_bytes()).write(folder / "textured.glb")
    encode_drc(folder / "mesh.drc", obj)
    write_3mf(folder / "mesh.3mf", model(f'<object id="1">{mesh_xml(mesh)}</object>', '<item objectid="1"/>'))
    for name in ("star.svg", "star.txt", "word.svg"):
        shutil.copy(ROOT / "tests" / "e2e" / "drawings" / name, folder)
    shutil.copy(ROOT / "tests" / "fuzz" / "corpus" / "mesh_fuzz" / "sparse.gltf", folder)
    job = {"mesh": "mesh.obj", "lattice": "bcc", "resolution": 16, "out": ["a.vdb", "a.csv"], "bounds": [0, 0, 0, 1, 1, 1]}
    (folder / "jobs.jsonl").write_text(json.dumps(job) + "\n" + json.dumps(job | {"id": "b"}) + "\n")
    colored = folder.parent / "colored.obj"
    colored.write_text("\n".join(f"{line} 1 0 0.5" if line.startswith("v ") else line for line in obj.read_text().splitlines()))
    outs = [word for kind in WRITTEN for word in ("-o", folder / f"voxels.{kind}")]
    for source, options in (
        (obj, outs),
        (obj, ["--set", "band", "--band", "2v", "-o", folder / "band.vdb"]),
        (colored, ["--fields", "part,color,distance,normal", "-o", folder / "parts.vdb"]),
    ):
        done = latvox("voxelize", source, *GRID, *options)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)
    for option, name in ("-z", "zip.nvdb"), ("-b", "blosc.nvdb"):
        subprocess.run(["nanovdb_convert", option, folder / "voxels.vdb", folder / name], capture_output=True, check=True)


def damaged(data, chance):
    """Returns the bytes with a changed bit, or without their end, or with bytes of the file elsewhere."""
    data = bytearray(data)
    at = chance.randrange(len(data))
    kind = chance.randrange(3)
    if kind == 0:
        data[at] ^= 1 << chance.randrange(8)
    elif kind == 1:
        del data[at:]
    else:
        data[at : at + 32] = data[chance.randrange(len(data)) :][:32]
    return bytes(data)


class Mutants(Case):
    def setUp(self):
        super().setUp()
        self.wholes = self.dir / "wholes"
        self.wholes.mkdir()
        write_wholes(self.wholes)

    def test_readers(self):
        shutil.rmtree(BAD, ignore_errors=True)
        command = [BIN / "latvox_mutants", self.wholes, str(COUNT), str(SEED), BAD]
        with tempfile.TemporaryFile("w+") as output:
            done = subprocess.run(command, stdout=output, stderr=output)
            output.seek(0)
            text = output.read()
        print(text)
        self.assertEqual(done.returncode, 0, text)

    def test_commands(self):
        chance = random.Random(SEED)
        for number, kind in itertools.product(range(max(1, COUNT // 10)), ("vdb", "nvdb")):
            whole, mutant, out = self.wholes / f"voxels.{kind}", self.dir / f"mutant.{kind}", self.dir / "out"
            mutant.write_bytes(damaged(whole.read_bytes(), chance))
            for words in (
                ["info", mutant],
                ["merge", mutant, "-o", out.with_suffix(".vdb")],
                ["convert", mutant, "-o", out.with_suffix(".vdb")],
                ["compare", mutant, whole],
                ["render", mutant, "-o", out.with_suffix(".png")],
                ["slice", mutant, "-o", out.with_suffix(".csv")],
                ["view", mutant, "-o", out.with_suffix(".html")],
                ["voxelize", self.wholes / "mesh.obj", "--align", mutant, "--region", "0,0,0,1,1,1", "-o", out.with_suffix(".npy")],
            ):
                with self.subTest(command=words[0], mutant=number, kind=kind):
                    done = latvox(*words)
                    self.assertIn(done.returncode, (0, 1, 3) if words[0] == "compare" else (0, 3), done.stderr)
                    if done.returncode == 3:
                        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                        self.assertIn(mutant.name, done.stderr)
                        self.assertEqual(list(self.dir.glob("out.*")), [])
                    for left in self.dir.glob("out.*"):
                        left.unlink()


if __name__ == "__main__":
    unittest.main()
