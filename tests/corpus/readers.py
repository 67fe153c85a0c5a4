"""The readers that the corpus compares: latvox, and programs of others."""

import json
import os
import pathlib
import select
import subprocess
import threading

HERE = pathlib.Path(__file__).resolve().parent
LATVOX = pathlib.Path(os.environ["LATVOX_BIN"]) / "latvox"
SECONDS = 60  # that one reader has for one file

# A reader takes paths as lines of standard input, and answers each with a line of JSON.
COMMANDS = {
    "three.js": ["node", HERE.parent / "node/read_meshes.js"],
    "meshio": ["/usr/bin/python3", "-B", HERE / "read_meshio.py"],
}

# The first of a format's readers that reads a file is its reference. tests/corpus/README.md gives the reasons.
READERS = {
    ".obj": ("three.js",),
    ".ply": ("meshio", "three.js"),
    ".stl": ("three.js",),
    ".glb": ("three.js",),
    ".gltf": ("three.js",),
    ".3mf": ("three.js",),
    ".drc": ("three.js",),
    ".off": ("meshio",),
}


class Reader:
    """A program that reads many files, one after the other. It is replaced when it takes too long or ends."""

    def __init__(self, name):
        self.name = name
        self.process = None

    def read(self, path):
        """Returns the facts, or {"error"}."""
        if self.process is None:
            self.process = subprocess.Popen(COMMANDS[self.name], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        try:
            self.process.stdin.write(f"{path}\n".encode())
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        line = self.process.stdout.readline() if select.select([self.process.stdout], [], [], SECONDS)[0] else None
        if not line:
            self.close()
            return {"error": "ended without an answer" if line == b"" else f"took more than {SECONDS} seconds"}
        return json.loads(line)

    def close(self):
        if self.process is None:
            return
        self.process.kill()
        self.process.communicate()
        self.process = None


class Readers:
    """The readers of others, one process of each for every thread."""

    def __init__(self):
        self.local = threading.local()
        self.all = []

    def read(self, path, extension):
        """Returns the facts of the first reader that reads the file, or the first error; and the reader's name."""
        answers = []
        for name in READERS[extension]:
            answer = self.reader(name).read(path)
            answers.append((answer, name))
            if "error" not in answer:
                return answer, name
        return answers[0]

    def reader(self, name):
        if not hasattr(self.local, "readers"):
            self.local.readers = {}
        if name not in self.local.readers:
            self.local.readers[name] = Reader(name)
            self.all.append(self.local.readers[name])
        return self.local.readers[name]

    def close(self):
        for reader in self.all:
            reader.close()


def read_latvox(path):
    """Returns the facts in the form of the other readers."""
    try:
        done = subprocess.run([LATVOX, "info", "--json", path], capture_output=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return {"error": f"took more than {SECONDS} seconds"}
    if done.returncode != 0:
        message = done.stderr.decode(errors="replace").strip().replace(f"{path}: ", "").removeprefix("latvox: ")
        if message == "the mesh has no triangles":
            return {"triangles": 0, "colors": None}
        # Status 3 says that the input is bad; any other status, such as a signal's, is a fault of ours.
        return {"error": message if done.returncode == 3 else f"exit status {done.returncode}: {message}"}
    facts = json.loads(done.stdout)
    bounds = facts["bounds"] or {"min": None, "max": None}
    colors = facts["colors"] and {**facts["colors"], "mean": facts["mean_color"]}
    return {"triangles": facts["triangles"], **bounds, "colors": colors}
