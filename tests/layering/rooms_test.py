"""The rooms of core, server and client, and their order: a room includes only rooms below it.

A room is a folder. server/main.cc is a room, too, and client/include is one room with its subfolders. The test prints
the number of rooms and the number of arrows between them. An arrow is an ordered pair of rooms; the first includes the
second. Neither number may grow unnoticed: LIMITS records today's numbers.
"""

import collections
import functools
import os
import pathlib
import posixpath
import re
import unittest

from layering_test import ROOT, includes

# From low to high. The README.md of each folder gives the reasons.
ORDER = {
    "core": (
        "base lattice mesh brick request snap tile digitize thin triangles plane scan supercover verify solid thesis tree tiny"
        " band fields block walk voxelizer"
    ).split(),
    "server": "base guard access decode wire work calls listen config main.cc".split(),
    "client": (
        "include internal mesh json mesh_files grid tool/curve tool/hdf5 tool/vdb tool/output tool/remote tool/texture"
        " tool/inspect tool/confined tool/view tool/cli python"
    ).split(),
}

# A change that adds an arrow raises `arrows`, if the arrow is worth it, but not beyond `most_arrows`. The same holds
# for rooms.
Limits = collections.namedtuple("Limits", "rooms most_rooms arrows most_arrows upward")
LIMITS = {
    # A walk fills what the scan of the surface leaves free, so it sees what a block sees, and the metric of a band.
    # The scan of a supercover sees the lattice's cell.
    "core": Limits(rooms=23, most_rooms=26, arrows=125, most_arrows=125, upward=0),
    "server": Limits(rooms=10, most_rooms=10, arrows=25, most_arrows=30, upward=0),
    # Four are of tool/confined: cli calls it, and it takes types, printable texts and a grid's stream from the SDK.
    # Three are of tool/hdf5: output and confined call it, and confined takes the box of bricks from output.
    # Four are of tool/texture: cli calls it, and it takes types, meshes and digests from the SDK.
    # Six are of tool/vdb: output, confined, cli and python call it, and it takes grids and types from the SDK.
    # Seven are of python: it takes types, grids, meshes and errors of files from the SDK, and options, jobs and files
    # from the tool.
    # Three are of tool/remote: cli calls it, and it takes options of calls from the SDK, and outputs.
    # Grids write the labels of a request as json does it for the tool.
    # Names of meshes are valid texts, by the same rules as messages.
    "client": Limits(rooms=17, most_rooms=22, arrows=61, most_arrows=61, upward=0),
}

# The public headers of the SDK may include each other, the standard library and abseil. One header is about OpenVDB.
PUBLIC = re.compile(r"latvox/(?!v1/)|absl/|[a-z_]+$")
OPENVDB_HEADER = "client/include/latvox/grid/openvdb_grid.h"


def room(path):
    """Returns the room of a file, or None if it is in none."""
    if path.startswith("client/include/"):
        return "client/include"
    if path.startswith("client/examples/") or path.partition("/")[0] not in ORDER:
        return None
    folder = posixpath.dirname(path)
    return folder if "/" in folder else path


def target(path, name):
    """Returns the path of our file that `path` includes as `name`, or `name` if it is not ours."""
    if name.startswith("."):
        return posixpath.normpath(posixpath.join(posixpath.dirname(path), name))
    if name.startswith("latvox/") and not name.startswith("latvox/v1/"):
        return "client/include/" + name
    return name


class Floor:
    """The rooms of one of the top folders, and the arrows between them."""

    def __init__(self, top, sources):
        """`sources`: path -> text, of all C++ files."""
        self.top = top
        self.rooms = set()
        self.arrows = collections.defaultdict(list)  # (from, to) -> "path includes path"
        for path, text in sources.items():
            source = room(path)
            if source is None or not source.startswith(top + "/"):
                continue
            self.rooms.add(source)
            for included in (target(path, name) for name in includes(text)):
                goal = room(included)
                if goal is not None and goal != source and goal.startswith(top + "/"):
                    self.arrows[source, goal].append(f"{path} includes {included}")

    def unordered(self):
        """Returns the rooms that the order does not name."""
        return sorted(self.rooms - {f"{self.top}/{name}" for name in ORDER[self.top]})

    def upward(self):
        """Returns the arrows to a room that is not below."""
        height = {f"{self.top}/{name}": number for number, name in enumerate(ORDER[self.top])}
        return {
            arrow: why for arrow, why in self.arrows.items() if height.get(arrow[0], -1) <= height.get(arrow[1], len(height))
        }

    def circle(self):
        """Returns the rooms that remain after repeatedly removing rooms that include none of the others."""
        left = set(self.rooms)
        while free := {source for source in left if not any((source, goal) in self.arrows for goal in left)}:
            left -= free
        return sorted(left)

    def violations(self):
        """Returns the violations, as lines for people."""
        limits = LIMITS[self.top]
        wrong = [f"{name} has no place in ORDER" for name in self.unordered()]
        upward = self.upward()
        if len(upward) > limits.upward:
            wrong += [f"{source} includes the higher {goal}: {why[0]}" for (source, goal), why in sorted(upward.items())]
            if circle := self.circle():
                wrong.append(f"these rooms are in or above a circle: {' '.join(circle)}")
        for what, count, limit, most in (
            ("rooms", len(self.rooms), limits.rooms, limits.most_rooms),
            ("arrows", len(self.arrows), limits.arrows, limits.most_arrows),
        ):
            if count > limit:
                wrong.append(f"{self.top} has {count} {what}; LIMITS records {limit}, and allows {most} at most")
        return wrong


def public_violations(path, text):
    """Returns the forbidden includes of a public header of the SDK, as lines for people."""
    return [
        f"{path} includes {name}"
        for name in includes(text)
        if not PUBLIC.match(name) and not (path == OPENVDB_HEADER and name.startswith("openvdb/"))
    ]


@functools.cache
def tree():
    """Returns path -> text of all our C++ files."""
    return {
        str(path.relative_to(ROOT)): path.read_text(encoding="utf-8", errors="replace")
        for top in ORDER
        for path in sorted((ROOT / top).rglob("*"))
        if path.suffix in (".h", ".cc", ".inc")
    }


def read_sources():
    """A copy of the tree that tests can change."""
    return dict(tree())


class TheTree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sources = read_sources()

    def test_rooms_include_only_lower_rooms(self):
        for top in ORDER:
            floor = Floor(top, self.sources)
            print(f"{top}: {len(floor.rooms)} rooms, {len(floor.arrows)} arrows, {len(floor.upward())} upward", flush=True)
            with self.subTest(top):
                self.assertEqual(floor.violations(), [])

    def test_the_order_names_only_rooms_that_are_there(self):
        for top, names in ORDER.items():
            for name in names:
                self.assertTrue((ROOT / top / name).exists(), f"{top}/{name}")

    @unittest.skipUnless("LATVOX_BUILD_DIR" in os.environ, "needs LATVOX_BUILD_DIR")
    def test_every_room_has_tests(self):
        lines = (pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "rooms.txt").read_text().splitlines()
        tested = {line.split()[0] for line in lines}
        self.assertEqual({f"{top}/{name}" for top, names in ORDER.items() for name in names} - tested, set())

    def test_recorded_limits_are_allowed(self):
        for top, limits in LIMITS.items():
            with self.subTest(top):
                self.assertLessEqual(limits.rooms, limits.most_rooms)
                self.assertLessEqual(limits.arrows, limits.most_arrows)

    def test_public_headers_include_only_what_users_have(self):
        headers = {path: text for path, text in self.sources.items() if path.startswith("client/include/")}
        self.assertGreater(len(headers), 10, "the headers were not found")
        self.assertEqual([line for path, text in headers.items() for line in public_violations(path, text)], [])


class TheRules(unittest.TestCase):
    """The test finds violations that are put into a copy of the tree."""

    def violations(self, top, path, *names):
        sources = read_sources()
        sources[path] = sources.get(path, "") + "".join(f'\n#include "{name}"' for name in names)
        return "\n".join(Floor(top, sources).violations())

    def test_upward_includes_are_found(self):
        for top, path, name in (
            ("core", "core/base/new.h", "core/lattice/lattice.h"),
            ("core", "core/tree/new.cc", "core/voxelizer/voxelizer.h"),
            ("core", "core/tree/new.cc", "../tiny/fine_pass.h"),
            ("client", "client/internal/new.cc", "client/tool/cli/report.h"),
            ("client", "client/include/latvox/grid/new.h", "client/grid/merge.h"),
            ("client", "client/tool/view/new.h", "client/tool/cli/report.h"),
        ):
            with self.subTest(path):
                goal = room(target(path, name))
                self.assertIn(f"{room(path)} includes the higher {goal}: {path} includes", self.violations(top, path, name))

    def test_a_circle_is_found(self):
        self.assertIn(
            "these rooms are in or above a circle: core/base core/lattice",
            "\n".join(
                Floor(
                    "core",
                    {
                        "core/base/a.h": '#include "core/lattice/b.h"',
                        "core/lattice/b.h": '#include "core/base/a.h"',
                        "core/mesh/c.h": "#include <map>",
                    },
                ).violations()
            ),
        )

    def test_a_room_without_a_place_is_found(self):
        for top, path in (("core", "core/new/a.h"), ("server", "server/new.cc"), ("client", "client/tool/new/a.cc")):
            with self.subTest(path):
                self.assertIn(f"{room(path)} has no place in ORDER", self.violations(top, path))

    def test_more_arrows_than_recorded_are_found(self):
        for top in ORDER:
            names = [f"{top}/{name}" for name in ORDER[top]]
            arrows = Floor(top, read_sources()).arrows
            pairs = [
                (source, goal)
                for index, source in enumerate(names)
                for goal in names[:index]
                if (source, goal) not in arrows and "." not in source
            ]
            spare = LIMITS[top].arrows - len(arrows)
            sources = read_sources()
            for number, (source, goal) in enumerate(pairs[: spare + 1]):
                sources[f"{source}/new{number}.cc"] = f'#include "{goal}/new.h"'
            with self.subTest(top):
                self.assertEqual(
                    Floor(top, sources).violations(),
                    [f"{top} has {LIMITS[top].arrows + 1} arrows; LIMITS records {LIMITS[top].arrows}, and allows "
                     f"{LIMITS[top].most_arrows} at most"],
                )

    def test_wrong_public_headers_are_found(self):
        for name in ("grpcpp/grpcpp.h", "latvox/v1/voxelizer.pb.h", "client/internal/wire.h", "openvdb/openvdb.h", "draco/a.h"):
            with self.subTest(name):
                path = "client/include/latvox/new.h"
                self.assertEqual(public_violations(path, f"#include <{name}>"), [f"{path} includes {name}"])
        for name in ("latvox/types.h", "absl/time/time.h", "string_view"):
            self.assertEqual(public_violations("client/include/latvox/new.h", f'#include "{name}"'), [])
        self.assertEqual(public_violations(OPENVDB_HEADER, "#include <openvdb/openvdb.h>"), [])

    def test_rooms_are_understood(self):
        for path, name in (
            ("core/tree/tile_tree.h", "core/tree"),
            ("server/main.cc", "server/main.cc"),
            ("client/tool/cli/main.cc", "client/tool/cli"),
            ("client/include/latvox/grid/merge.h", "client/include"),
            ("client/examples/cpp/a.cc", None),
            ("absl/status/status.h", None),
        ):
            self.assertEqual(room(path), name)


if __name__ == "__main__":
    unittest.main()
