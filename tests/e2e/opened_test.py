"""`--set enclosed --close G` of meshes with holes equals that of the closed meshes, except near the holes."""

import json
import random
import subprocess
import unittest

import numpy
from harness import NODE, Case, latvox, read_obj, write_obj


def boundary_loops(triangles):
    """Returns the holes of an oriented mesh, each a list of vertices along its border."""
    edges = {(t[n], t[(n + 1) % 3]) for t in triangles for n in range(3)}
    after = {b: a for a, b in edges if (b, a) not in edges}
    loops = []
    while after:
        loop = [next(iter(after))]
        while (vertex := after.pop(loop[-1])) != loop[0]:
            loop.append(vertex)
        loops.append(loop)
    return loops


def without_holes(vertices, triangles):
    """Returns the mesh with a fan around the center of each hole."""
    vertices, triangles = list(vertices), list(triangles)
    for loop in boundary_loops(triangles):
        center = len(vertices)
        vertices.append(tuple(sum(x) / len(loop) for x in zip(*(vertices[n] for n in loop), strict=True)))
        triangles += [(a, b, center) for a, b in zip(loop, loop[1:] + loop[:1], strict=True)]
    return vertices, triangles


def sphere(rings, seed):
    """Returns an oriented sphere of radius 1, turned at random."""
    turn = numpy.linalg.qr(numpy.random.default_rng(seed).normal(size=(3, 3)))[0]
    angles = [(numpy.pi * a / rings, numpy.pi * b / rings) for a in range(1, rings) for b in range(2 * rings)]
    points = [(0, 0, 1)] + [(numpy.sin(a) * numpy.cos(b), numpy.sin(a) * numpy.sin(b), numpy.cos(a)) for a, b in angles]
    vertices = [tuple(map(float, point)) for point in numpy.array([*points, (0, 0, -1)]) @ turn]
    around, last, triangles = 2 * rings, len(vertices) - 1, []
    for b in range(around):
        c = (b + 1) % around
        triangles += [(0, 1 + b, 1 + c), (last, last - around + c, last - around + b)]
        for a in range(rings - 2):
            p, q, r, s = (1 + around * (a + d) + e for d in (0, 1) for e in (b, c))
            triangles += [(p, r, s), (p, s, q)]
    return vertices, triangles


class Opened(Case):
    def assert_equal_except_near(self, holes, size, far, one, other):
        """`far`: a distance from the vertices of the holes."""
        voxels = [set(map(bytes, numpy.load(path))) for path in (one, other)]
        self.assertGreater(len(voxels[0]), 1000)
        differing = numpy.frombuffer(b"".join(voxels[0] ^ voxels[1]), numpy.int32).reshape(-1, 3) * size
        for voxel in differing:
            self.assertLessEqual(((holes - voxel) ** 2).sum(axis=1).min(), far**2, voxel)
        return len(differing) / len(voxels[0])

    def run_batch(self, jobs):
        (self.dir / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in jobs))
        done = latvox("batch", self.dir / "jobs.jsonl", "--out", self.dir)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_bunny_with_its_223_open_edges(self):
        done = subprocess.run(["node", "draco_to_obj.js", NODE / "node_modules/draco3d/bunny.drc"], cwd=NODE, check=True,
                              capture_output=True, text=True, timeout=60)  # fmt: skip
        (self.dir / "open.obj").write_text(done.stdout)
        vertices, triangles = read_obj(self.dir / "open.obj")
        loops = boundary_loops(triangles)
        self.assertEqual(sum(map(len, loops)), 223)
        write_obj(self.dir / "closed.obj", without_holes(vertices, triangles))
        size, close = 0.002, 0.03
        grid = {"voxel_size": size, "origin": [0, 0, 0], "set": "enclosed", "close": close}
        leaks = {**grid, "mesh": "open.obj", "out": "leaks.npy"}
        del leaks["close"]
        self.run_batch([{**grid, "mesh": f"{name}.obj", "out": f"{name}.npy"} for name in ("open", "closed")] + [leaks])
        holes = numpy.array([vertices[n] for loop in loops for n in loop])
        share = self.assert_equal_except_near(holes, size, close, self.dir / "open.npy", self.dir / "closed.npy")
        self.assertLess(share, 0.02)
        self.assertLess(len(numpy.load(self.dir / "leaks.npy")), len(numpy.load(self.dir / "open.npy")) / 2)

    def test_a_hundred_spheres_without_random_triangles(self):
        chance = random.Random(1)
        rings, size, holes, jobs = 8, 0.08, [], []
        for n in range(100):
            vertices, triangles = sphere(rings, n)
            removed = chance.sample(triangles, chance.randint(1, 4))
            holes.append(numpy.array([vertices[v] for triangle in removed for v in triangle]))
            write_obj(self.dir / f"closed{n}.obj", (vertices, triangles))
            write_obj(self.dir / f"open{n}.obj", (vertices, [t for t in triangles if t not in removed]))
            for name in "closed", "open":
                jobs.append({"mesh": f"{name}{n}.obj", "voxel_size": size, "origin": [0, 0, 0], "set": "enclosed",
                             "separability": n % 3, "close": 0.8, "out": f"{name}{n}.npy"})  # fmt: skip
        self.run_batch(jobs)
        for n in range(100):
            with self.subTest(n):
                self.assert_equal_except_near(
                    holes[n], size, 0.8, self.dir / f"closed{n}.npy", self.dir / f"open{n}.npy")


if __name__ == "__main__":
    unittest.main()
