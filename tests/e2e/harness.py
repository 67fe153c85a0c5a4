"""Runs the programs of $LATVOX_BIN as a user does, and writes meshes for the tests."""

import contextlib
import ctypes
import json
import os
import pathlib
import random
import re
import signal
import struct
import subprocess
import tempfile
import time
import unittest

BIN = pathlib.Path(os.environ["LATVOX_BIN"])
NODE = pathlib.Path(__file__).resolve().parents[1] / "node"  # with packages of npm
BUNNY = pathlib.Path("/usr/share/glmark2/models/bunny.obj")
PATIENCE = float(os.environ.get("LATVOX_PATIENCE", "60"))  # seconds that one command may take

PR_SET_CHILD_SUBREAPER = 36


class Case(unittest.TestCase):
    """A test with a directory of its own. It must end without any process left over."""

    def setUp(self):
        # Orphans of our children become our children, so none can hide.
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
        self.dir = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-")))
        self.addCleanup(self.assert_no_process_left)

    def assert_no_process_left(self, seconds=10):
        deadline = time.monotonic() + seconds
        while children():
            if time.monotonic() > deadline:
                self.fail(f"processes left over: {children()}")
            time.sleep(0.02)

    def voxelize(self, mesh, *options, out="out.csv"):
        """Runs a job that must succeed. Returns the summary; the voxels are in self.dir / out."""
        done = latvox("voxelize", mesh, "-o", self.dir / out, "--json", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def peak_memory(self, *arguments):
        """Runs a command that must succeed. Returns the bytes that it held at most."""
        process = subprocess.Popen([BIN / "latvox", *map(str, arguments)], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return usage.ru_maxrss * 1024


def latvox(*arguments, **options):
    command = [BIN / "latvox", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, **options)


def children():
    """Returns the command lines of this thread's living children, by pid."""
    return children_of("thread-self")


def children_of(process):
    """Returns the command lines of the living children of a process's first thread, by pid."""
    living = {}
    folder = process if process == "thread-self" else f"{process}/task/{process}"
    for pid in pathlib.Path(f"/proc/{folder}/children").read_text().split():
        with contextlib.suppress(OSError):
            process = pathlib.Path("/proc") / pid
            if process.joinpath("stat").read_text().rpartition(")")[2].split()[0] != "Z":
                living[int(pid)] = process.joinpath("cmdline").read_bytes().replace(b"\0", b" ").decode().strip()
    return living


def unfinished_files(pid, directory):
    """Returns the sizes of the files without a name that a process has open in a directory."""
    sizes, fds = [], []
    with contextlib.suppress(OSError):  # the process has ended
        fds = list(pathlib.Path(f"/proc/{pid}/fd").iterdir())
    for fd in fds:
        with contextlib.suppress(OSError):
            if os.readlink(fd).startswith(f"{directory}/#") and os.stat(fd).st_nlink == 0:
                sizes.append(os.stat(fd).st_size)
    return sizes


def bytes_written(pid):
    """Returns the bytes that a process has passed to the system's calls for writing."""
    return int(re.search(r"wchar: (\d+)", pathlib.Path(f"/proc/{pid}/io").read_text())[1])


@contextlib.contextmanager
def server(directory, *options, mortal=False):
    """Runs a latvoxd on a socket in `directory`. It ends with SIGTERM, and must then exit with 0. A mortal one has been
    killed by then."""
    address = f"unix:{directory}/latvoxd.socket"
    with open(directory / "latvoxd.log", "ab") as log:
        process = subprocess.Popen([BIN / "latvoxd", "--listen", address, *options], stderr=log, stdout=log)
    process.address = address
    try:
        wait_until_healthy(process)
        yield process
        if mortal:
            assert process.wait(PATIENCE) == -signal.SIGKILL, "latvoxd was not killed"
            return
        assert process.poll() is None, f"latvoxd ended by itself: {(directory / 'latvoxd.log').read_text()}"
        process.send_signal(signal.SIGTERM)
        code = process.wait(PATIENCE)
        assert code == 0, f"latvoxd exited with {code}: {(directory / 'latvoxd.log').read_text()}"
    finally:
        process.kill()
        process.wait()


def await_true(fault, condition, seconds=PATIENCE):
    """Waits until condition() is true, and returns its value. Fails with the text `fault` if it stays false."""
    deadline = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < deadline, fault
        time.sleep(0.01)
    return value


def await_log(directory, pattern, count=1):
    """Waits for the count-th match in the log of the server in `directory`. Returns its first group, or all of it."""
    deadline = time.monotonic() + PATIENCE
    while len(found := re.findall(pattern, log := (directory / "latvoxd.log").read_text())) < count:
        assert time.monotonic() < deadline, f"no {pattern} in {log}"
        time.sleep(0.02)
    return found[count - 1]


def wait_until_healthy(process):
    deadline = time.monotonic() + PATIENCE
    while latvox("health", "--server", process.address).returncode != 0:
        assert process.poll() is None, "latvoxd did not start"
        assert time.monotonic() < deadline, "latvoxd does not become healthy"
        time.sleep(0.05)


def rows(csv):
    """Returns (i, j, k) -> (x, y, z) of a .csv file."""
    lines = csv.read_text().splitlines()
    assert lines[0] == "i,j,k,x,y,z", lines[0]
    voxels = {}
    for line in lines[1:]:
        i, j, k, x, y, z = line.split(",")
        voxels[int(i), int(j), int(k)] = (float(x), float(y), float(z))
    assert len(voxels) == len(lines) - 1, "a voxel stands twice"
    return voxels


def gltf_info(path):
    """Returns the counts of Khronos' validator for a .glb, which must have no errors or warnings."""
    script = (
        "const v = require('gltf-validator'); const bytes = require('fs').readFileSync(process.argv[1]);"
        "v.validateBytes(new Uint8Array(bytes)).then(r => console.log(JSON.stringify(r)));"
    )
    command = ["node", "-e", script, path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True, cwd=NODE)
    report = json.loads(done.stdout)
    assert report["issues"]["numErrors"] == report["issues"]["numWarnings"] == 0, report["issues"]
    return report["info"]


def by_three(path):
    """Returns the content of a .glb that three.js reads: corners, number of triangles, colors."""
    command = ["node", "read_glb.js", path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True, cwd=NODE)
    return json.loads(done.stdout)


def read_points(path, *names):
    """Returns, by meshio, for each point of a .ply its position and its values of these names."""
    script = (
        "import json, meshio, sys; mesh = meshio.read(sys.argv[1]);"
        "print(json.dumps([mesh.points.tolist(), *(mesh.point_data[name].tolist() for name in sys.argv[2:])]))"
    )
    command = ["/usr/bin/python3", "-c", script, path, *names]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    return list(zip(*json.loads(done.stdout), strict=True))


# Meshes: a list of vertices (three float32-exact numbers) and a list of triangles (three indices).


def float32(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def read_obj(path):
    vertices, triangles = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words and words[0] == "v":
            vertices.append(tuple(float32(float(w)) for w in words[1:4]))
        elif words and words[0] == "f":
            triangles.append(tuple(int(w.split("/")[0]) - 1 for w in words[1:4]))
    return vertices, triangles


def octahedron(radius=1.0):
    vertices = [(radius, 0, 0), (-radius, 0, 0), (0, radius, 0), (0, -radius, 0), (0, 0, radius), (0, 0, -radius)]
    triangles = [(x, y, z) if (x + y + z) % 2 == 0 else (x, z, y) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    return vertices, triangles


def box(low, high):
    """Returns a closed box, oriented outwards."""
    vertices = [tuple((high if n >> m & 1 else low)[m] for m in range(3)) for n in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return vertices, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def shuffled(mesh, seed):
    """Returns the same triangles in another order, each starting at another corner."""
    vertices, triangles = mesh
    chance = random.Random(seed)
    turned = [t[n:] + t[:n] for t in triangles for n in [chance.randrange(3)]]
    chance.shuffle(turned)
    return vertices, turned


def write_obj(path, mesh):
    vertices, triangles = mesh
    lines = ["v %.9g %.9g %.9g" % v for v in vertices]
    lines += ["f %d %d %d" % (a + 1, b + 1, c + 1) for a, b, c in triangles]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_ply(path, mesh):
    vertices, triangles = mesh
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    body = b"".join(struct.pack("<3f", *v) for v in vertices)
    body += b"".join(struct.pack("<B3i", 3, *t) for t in triangles)
    path.write_bytes(header.encode() + body)
    return path


def write_stl(path, mesh):
    vertices, triangles = mesh
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *vertices[a], *vertices[b], *vertices[c], 0) for a, b, c in triangles)
    path.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + body)
    return path


def encode_drc(path, mesh_path, *options):
    """Runs Draco's own encoder, lossless unless `options` say otherwise."""
    command = ["draco_encoder", "-i", mesh_path, "-o", path, "-qp", "0", *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path
