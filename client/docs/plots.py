"""Pictures for `draw` that latvox cannot draw itself: the way of a leak, links, a comparison of their shares, fractions.

Each takes files that the commands of client/docs/sets.md or fields.md leave in a folder. No picture has text, because fonts differ.
"""

import csv
import json
import subprocess

SIDE = 400  # pixels of a square picture
CAR = ["car.obj", "--voxel-size", "0.05", "--set", "enclosed", "--leak-from", "2.1,0.9,1.3"]  # as in sets.md
LAYER, STEP = "0", 0.05  # of the sphere: the layer of links that is shown, and the voxel size
LOW, WIDTH = 0.45, 0.52  # the part of the world that is shown, along x and y


def run(*words, **options):
    return subprocess.run([*map(str, words)], check=True, capture_output=True, **options).stdout


def draw_way(latvox, folder):
    """Adds the way of the leak to the layer car-leak.png, all steps projected into it."""
    summary = json.loads(run(latvox, "voxelize", *CAR, "--json", "-o", "way.csv", cwd=folder))
    leak = summary["certificate"]["walk"]["leak"]
    with open(folder / "way.csv") as file:
        layer = [row for row in csv.DictReader(file) if int(row["i"]) == leak["narrowest"][0]]
    cells = [(int(row["j"]), int(row["k"])) for row in layer]
    left, top = min(j for j, _ in cells), max(k for _, k in cells)
    picture = folder / "car-leak.png"
    width, x, y = map(int, run("convert", picture, "-trim", "-format", "%w %X %Y", "info:").split())
    scale = width / (max(j for j, _ in cells) + 1 - left)  # pixels a cell
    way = [(x + (j + 0.5 - left) * scale, y + (top + 0.5 - k) * scale) for _, j, k in leak["path"]]
    # Lines, because ImageMagick 7.1 closes a polyline.
    lines = " ".join("line {:.1f},{:.1f} {:.1f},{:.1f}".format(*a, *b) for a, b in zip(way, way[1:]))
    run("convert", picture, "-draw", f"stroke #d62728 stroke-width 3 stroke-linecap round {lines}", picture)


def steps(row):
    """Yields the neighbor's step and the share of each link of a row that meets the mesh."""
    for name, share in row.items():
        if name.startswith("link_") and share != "nan":
            yield [int(number) for number in name.split("_")[1:]], float(share)


def draw_links(folder):
    """Draws links.png: lattice points outside of the sphere, their links in one layer, and where these meet it."""

    def pixel(x, y):
        return (x - LOW) / WIDTH * SIDE, SIDE - (y - LOW) / WIDTH * SIDE

    def circle(x, y, radius):
        return f"circle {x:.1f},{y:.1f} {x + radius:.1f},{y:.1f}"

    with open(folder / "sphere.csv") as file:
        rows = [row for row in csv.DictReader(file) if row["k"] == LAYER]
    lines, dots, marks = [], [], []
    for row in rows:
        x, y = float(row["x"]), float(row["y"])
        if min(x, y) < LOW or max(x, y) > LOW + WIDTH:
            continue
        start = pixel(x, y)
        dots.append(circle(*start, 5))
        for (i, j, k), share in steps(row):
            if k == 0:
                end = pixel(x + STEP * i * share, y + STEP * j * share)
                lines.append("line {:.1f},{:.1f} {:.1f},{:.1f}".format(*start, *end))
                marks.append(circle(*end, 3.5))
    radius = (1 - float(rows[0]["z"]) ** 2) ** 0.5 / WIDTH * SIDE
    picture = [
        "fill #dfe7f3", circle(*pixel(0, 0), radius), "stroke #8a8a8a stroke-width 2", *lines,
        "stroke none fill #1f4e9c", *dots, "fill #d62728", *marks,
    ]  # fmt: skip
    run("convert", "-size", f"{SIDE}x{SIDE}", "xc:#f8f8f6", "-draw", " ".join(picture), folder / "links.png")


def draw_shares(folder):
    """Draws shares.png: a point for each link, its share over that of the round sphere, both from 0 to 1."""
    pixels = bytearray(b"\xff" * (3 * SIDE * SIDE))

    def put(x, y, color):
        at = 3 * (x + SIDE * (SIDE - 1 - y))
        pixels[at : at + 3] = color

    for tenth in range(11):
        for n in range(SIDE):
            put(tenth * (SIDE - 1) // 10, n, b"\xdd\xdd\xdd")
            put(n, tenth * (SIDE - 1) // 10, b"\xdd\xdd\xdd")
    with open(folder / "shares.csv") as file:
        for exact, share in csv.reader(file):
            put(round(float(exact) * (SIDE - 1)), round(float(share) * (SIDE - 1)), b"\x1f\x4e\x9c")
    run("convert", "ppm:-", folder / "shares.png", input=b"P6 %d %d 255\n" % (SIDE, SIDE) + pixels)


def draw_fractions(folder):
    """Draws fraction.png: the middle layer of fraction.csv across z, darker where more of a cell is inside."""
    with open(folder / "fraction.csv") as file:
        rows = [[int(row[name]) for name in ("i", "j", "k", "fraction")] for row in csv.DictReader(file)]
    layer = (min(row[2] for row in rows) + max(row[2] for row in rows)) // 2
    cells = {(i, j): fraction for i, j, k, fraction in rows if k == layer}
    left, top = min(i for i, _ in cells), max(j for _, j in cells)
    width, height = max(i for i, _ in cells) + 1 - left, top + 1 - min(j for _, j in cells)
    side = SIDE // max(width, height)  # pixels of a cell
    most = max(cells.values())
    pixels = bytearray()
    for y in range(height):
        line = b"".join(bytes([255 - 225 * cells.get((left + x, top - y), 0) // most]) * side for x in range(width))
        pixels += line * side
    head = b"P5 %d %d 255\n" % (width * side, height * side)
    run("convert", "pgm:-", folder / "fraction.png", input=head + pixels)
