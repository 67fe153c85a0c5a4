"""Overlapping boxes, and files of bodies with names."""

# Low and high corners on quarters of voxels. The second box overlaps the first, the third lies within both.
BODIES = {"base": ((0.25, 0.25, 0.25), (5.5, 4.75, 4)), "lid": ((3, 1, -1.5), (8.25, 6.5, 3.75)), "pin": ((3.5, 2, 0.5), (5, 3.25, 2))}


def write_bodies(path, bodies):
    """Writes meshes by name as objects of a .obj."""
    lines, before = [], 1
    for name, (vertices, triangles) in bodies.items():
        lines += [f"o {name}"] + ["v " + " ".join(map(repr, map(float, v))) for v in vertices]
        lines += ["f " + " ".join(str(v + before) for v in t) for t in triangles]
        before += len(vertices)
    path.write_text("\n".join(lines) + "\n")
    return path
