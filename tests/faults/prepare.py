"""Makes the meshes of the fault suite, and computes their expected voxels without any server."""

import json
import os
import pathlib
import random
import subprocess

BIN = pathlib.Path(os.environ["LATVOX_BIN"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
MESHES = ROOT / "build" / "faults" / "meshes"
BUNNY = "/usr/share/glmark2/models/bunny.obj"

# name: mesh as latvox_bench names it, how often each triangle is divided into four, quantization bits
SOURCES = {
    "sphere": ("sphere:800", 0, 11),
    "bunny": (BUNNY, 0, 14),
    "bunny-x4": (BUNNY, 1, 16),
    "bunny-x16": (BUNNY, 2, 18),
    "tangle": (str(MESHES / "tangle.obj"), 0, 14),
}

# name: mesh, lattice, resolution, separability, weight. A name's first word tells the size in the report. Weight 0:
# only for tests that ask for it. None: never meant to finish.
TABLE = {
    "small sphere-64-bcc": ("sphere", "bcc", 64, 0, 20),
    "small bunny-64-bcc": ("bunny", "bcc", 64, 0, 20),
    "small bunny-128-cartesian": ("bunny", "cartesian", 128, 2, 20),
    "medium bunny-256-fcc": ("bunny", "fcc", 256, 0, 15),
    "medium bunny-512-cartesian": ("bunny", "cartesian", 512, 2, 10),
    "large bunny-x4-512-cartesian": ("bunny-x4", "cartesian", 512, 0, 3),
    "large bunny-1024-bcc": ("bunny", "bcc", 1024, 0, 2),
    "huge bunny-8192-cartesian": ("bunny", "cartesian", 8192, 2, 0),
    "huge bunny-32768-cartesian": ("bunny", "cartesian", 32768, 2, None),
    "huge bunny-x16-512-cartesian": ("bunny-x16", "cartesian", 512, 0, 0),
    "huge tangle-128-bcc": ("tangle", "bcc", 128, 0, None),
}


def digest(mesh, lattice, resolution, separability):
    options = ["--lattice", lattice, "--separability", str(separability), "--threads", "2", "--reps", "1", "--json"]
    command = [BIN / "latvox_bench", mesh, str(resolution), *options, "--discard"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["digest"]


def write_tangle(path):
    """Triangles between random points: few voxels, with many triangles in each. Meshes with flipped bits may be like
    this."""
    chance = random.Random(1)
    lines = ["v %f %f %f" % tuple(chance.random() for _ in range(3)) for _ in range(60000)]
    lines += ["f %d %d %d" % (n, n + 1, n + 2) for n in range(1, 60000, 3)]
    path.write_text("\n".join(lines) + "\n")


def main():
    MESHES.mkdir(parents=True, exist_ok=True)
    write_tangle(MESHES / "tangle.obj")
    for name, (source, times, bits) in SOURCES.items():
        path = MESHES / f"{name}.drc"
        if not path.exists():
            encode = [
                BIN / "latvox_faults",
                "mesh",
                source,
                f"{path}.new",
                "--subdivide",
                str(times),
                "--bits",
                str(bits),
            ]
            subprocess.run(encode, check=True)
            pathlib.Path(f"{path}.new").rename(path)
    jobs = []
    for name, (mesh, lattice, resolution, separability, weight) in TABLE.items():
        path = str(MESHES / f"{mesh}.drc")
        expected = "" if weight is None else digest(path, lattice, resolution, separability)
        jobs.append({"name": name, "mesh": path, "lattice": lattice, "resolution": resolution})
        jobs[-1] |= {"separability": separability, "weight": weight or 0, "digest": expected}
    (MESHES / "jobs.json").write_text(json.dumps(jobs, indent=1) + "\n")


if __name__ == "__main__":
    main()
