"""Makes the meshes of the fault suite, and finds what their voxels must be, without any server."""

import json
import os
import pathlib
import subprocess

BIN = pathlib.Path(os.environ["LATVOX_BIN"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
MESHES = ROOT / "build" / "faults" / "meshes"
BUNNY = "/usr/share/glmark2/models/bunny.obj"

# name: mesh as latvox_bench names it, times that each triangle becomes four, quantization bits
SOURCES = {
    "sphere": ("sphere:800", 0, 11),
    "bunny": (BUNNY, 0, 14),
    "bunny-x4": (BUNNY, 1, 16),
    "bunny-x16": (BUNNY, 2, 18),
}

# name: mesh, lattice, resolution, separability, weight. A name's first word tells the size in the report; weight 0 is
# for those who ask for it.
TABLE = {
    "small sphere-64-bcc": ("sphere", "bcc", 64, 0, 20),
    "small bunny-64-bcc": ("bunny", "bcc", 64, 0, 20),
    "small bunny-128-cartesian": ("bunny", "cartesian", 128, 2, 20),
    "medium bunny-256-fcc": ("bunny", "fcc", 256, 0, 15),
    "medium bunny-512-cartesian": ("bunny", "cartesian", 512, 2, 10),
    "large bunny-x4-512-cartesian": ("bunny-x4", "cartesian", 512, 0, 3),
    "large bunny-1024-bcc": ("bunny", "bcc", 1024, 0, 2),
    "huge bunny-8192-cartesian": ("bunny", "cartesian", 8192, 2, 0),
    "huge bunny-x16-512-cartesian": ("bunny-x16", "cartesian", 512, 0, 0),
}


def digest(mesh, lattice, resolution, separability):
    options = ["--lattice", lattice, "--separability", str(separability), "--threads", "2", "--reps", "1", "--json"]
    command = [BIN / "latvox_bench", mesh, str(resolution), *options, "--discard"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["digest"]


def main():
    MESHES.mkdir(parents=True, exist_ok=True)
    for name, (source, times, bits) in SOURCES.items():
        path = MESHES / f"{name}.drc"
        if not path.exists():
            encode = [BIN / "latvox_faults", "mesh", source, f"{path}.new", "--subdivide", str(times), "--bits", str(bits)]
            subprocess.run(encode, check=True)
            pathlib.Path(f"{path}.new").rename(path)
    jobs = []
    for name, (mesh, lattice, resolution, separability, weight) in TABLE.items():
        path = str(MESHES / f"{mesh}.drc")
        expected = digest(path, lattice, resolution, separability)
        jobs.append({"name": name, "mesh": path, "lattice": lattice, "resolution": resolution})
        jobs[-1] |= {"separability": separability, "weight": weight, "digest": expected}
    (MESHES / "jobs.json").write_text(json.dumps(jobs, indent=1) + "\n")


if __name__ == "__main__":
    main()
