"""The basis of the tests of the gateway's page: one server, one gateway and one browser for all tests of a class.
Screenshots are in gateway-page of the build directory."""

import base64
import os
import pathlib
import struct
import sys
import tempfile
import time

import numpy
from gateway import ROOT, gateway

sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402
from browser import Browser, Tab, decode  # noqa: E402
from harness import PATIENCE, Case, octahedron  # noqa: E402

PICTURES = pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "gateway-page"
ONLY_HERE = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"


def stl(mesh):
    """Returns a binary STL file."""
    vertices, triangles = mesh
    corners = [struct.pack("<12fH", 0, 0, 0, *(x for v in t for x in vertices[v]), 0) for t in triangles]
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(corners)


def ply_head(form, counts, colored):
    """Returns the head of a .ply. `colored`: the element with colors, or None."""
    lines = ["ply", f"format {form} 1.0"]
    for element, properties in (
        ("vertex", [f"float {axis}" for axis in "xyz"]),
        ("face", ["list uchar int vertex_indices"]),
    ):
        colors = [f"uchar {name}" for name in ("red", "green", "blue") if element == colored]
        lines += [f"element {element} {counts[element]}", *(f"property {each}" for each in properties + colors)]
    return "\n".join([*lines, "end_header", ""])


def ply(mesh, colors=(), colored="vertex"):
    """Returns a .ply whose vertices or faces have the colors in turn. Faces may have any number of corners."""
    rows = {"vertex": mesh[0], "face": [(len(face), *face) for face in mesh[1]]}
    text = ply_head("ascii", {name: len(each) for name, each in rows.items()}, colored if colors else None)
    for name, each in rows.items():
        for n, row in enumerate(each):
            more = colors[n % len(colors)] if colors and name == colored else ()
            text += " ".join(map("{:g}".format, (*row, *more))) + "\n"
    return text.encode()


def binary_ply(mesh):
    """Returns a binary .ply. Faces may have any number of corners."""
    vertices, faces = mesh
    head = ply_head("binary_little_endian", {"vertex": len(vertices), "face": len(faces)}, None)
    rows = [struct.pack("<3f", *v) for v in vertices] + [struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces]
    return head.encode() + b"".join(rows)


class PageCase(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        home, cls.place = (
            pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="latvox-"))) for _ in range(2)
        )
        cls.server = cls.enterClassContext(harness.server(cls.place))
        cls.gateway = cls.enterClassContext(gateway(cls.place, cls.server.address))
        cls.browser = Browser(home, ONLY_HERE)
        cls.addClassCleanup(cls.browser.close)
        cls.mesh = octahedron(7.0)
        PICTURES.mkdir(parents=True, exist_ok=True)

    def assert_no_process_left(self):
        """They end with the class."""

    def tab(self, place="", width=1280, height=800, **device):
        tab = Tab(self.browser, width, height, **device)
        self.addCleanup(tab.close)  # pages that nobody looks at slow down the others
        tab.open(f"{self.gateway.url}/{place}")
        return tab

    def drop(self, tab, name, data):
        tab.run(
            f"""{{
          const bytes = Uint8Array.from(atob("{base64.b64encode(data).decode()}"), (c) => c.charCodeAt(0));
          const dropped = new DataTransfer(), how = {{ dataTransfer: dropped, bubbles: true, cancelable: true }};
          dropped.items.add(new File([bytes], "{name}"));
          document.body.dispatchEvent(new DragEvent("drop", how));
        }}"""
        )
        tab.rest()

    def shown(self, tab):
        """Returns the rows of the page's table."""
        self.assertEqual(self.error(tab), "")
        tab.run(
            """new Promise((resolve) => {
          const isBusy = () => document.getElementById('viewer').contentDocument.body.dataset.busy !== 'no';
          const look = () => (isBusy() ? setTimeout(look, 20) : resolve());
          look();
        })"""
        )
        self.assertEqual(tab.complaints(), [])
        return dict(
            tab.run(
                "[...document.querySelectorAll('#summary tr')].map(({ cells }) => [...cells].map((td) => td.innerText))"
            )
        )

    def picture(self, tab, name):
        png = tab.png()
        (PICTURES / f"{name}.png").write_bytes(png)
        return decode(png)

    def direct(self, path, *options, out="direct.csv"):
        """Runs the tool; its voxels are in self.dir / out."""
        return self.voxelize(path, *options, "--server", self.server.address, out=out)

    def error(self, tab):
        """Returns the text of the page's error; "" if it shows none."""
        return tab.run("(({ hidden, innerText }) => (hidden ? '' : innerText))(document.getElementById('error'))")

    def theme(self, tab, name):
        tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def saved(self, tab, kind):
        """Returns the file that a click on a button gives, for a mesh of the name a."""
        place = self.dir / f"saved-{len(list(self.dir.glob('saved-*')))}"
        place.mkdir()
        self.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(place))
        tab.run(f"document.getElementById('{kind}').click()")
        deadline = time.monotonic() + PATIENCE
        while not (path := place / f"a.{kind}").exists() or path.stat().st_size < 100:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        return path

    def assert_csv(self, tab):
        """Checks that the page's .csv has the lines of the tool's, without the names of parts and materials."""
        path = self.saved(tab, "csv")
        ours, tools = (
            [line.split(",") for line in each.read_text().splitlines()] for each in (path, self.dir / "direct.csv")
        )
        self.assertEqual(ours[0], [name for name in tools[0] if not name.endswith("_name")])
        width = len(ours[0])
        ours, tools = (numpy.array(sorted(line[:width] for line in lines[1:]), float) for lines in (ours, tools))
        numpy.testing.assert_allclose(ours, tools, rtol=0, atol=1e-6)

    def assert_npz(self, tab):
        """Checks that the page's .npz has the arrays of the tool's."""
        with numpy.load(self.saved(tab, "npz")) as ours, numpy.load(self.dir / "direct.npz") as tools:
            self.assertEqual(sorted(ours), sorted(tools))
            for name in tools:
                self.assertEqual((ours[name].dtype, ours[name].shape), (tools[name].dtype, tools[name].shape), name)
                numpy.testing.assert_array_equal(ours[name], tools[name], name)
