"""3MF: objects in their places, units, materials, and the parts of the archive."""

import re
import struct
import unittest
import zipfile

from harness import write_obj
from inputs import MESH, RELATIONS, InputCase, joined, mapped, mesh_xml, model, write_3mf

MATERIALS = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"


class Stream:
    """A file that cannot seek, so that zipfile writes data descriptors."""

    def __init__(self, file):
        self.write, self.flush = file.write, file.flush


class ThreeMf(InputCase):
    def test_units_items_and_components_place_objects(self):
        objects = (
            f'<object id="1" type="model">{mesh_xml(MESH)}</object>'
            '<object id="2"><components><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 1 0 0"/>'
            '<component objectid="1"/></components></object>'
        )
        items = '<item objectid="2"/><item objectid="1" transform="2 0 0 0 1 0 0 0 1 0 0 0.5"/><!-- not placed: 3 -->'
        path = write_3mf(self.dir / "a.3mf", model(objects, items, 'unit="centimeter"'))
        wanted = joined(
            mapped(MESH, lambda x, y, z: (10 * (1 - y), 10 * x, 10 * z)),
            mapped(MESH, lambda x, y, z: (10 * x, 10 * y, 10 * z)),
            mapped(MESH, lambda x, y, z: (20 * x, 10 * y, 10 * (z + 0.5))),
        )
        self.assertEqual(self.digest(path), self.expected(wanted))

    def test_objects_may_lie_in_other_files_of_the_archive(self):
        attributes = f'xmlns:p="{PRODUCTION}" requiredextensions="p"'
        objects = '<object id="1"><components><component p:path="/3D/more.model" objectid="1"/></components></object>'
        more = model(f'<object id="1">{mesh_xml(MESH)}</object>', "")
        path = write_3mf(self.dir / "a.3mf", model(objects, '<item objectid="1"/>', attributes), more=more)
        self.assertEqual(self.digest(path), self.expected(MESH))

    def test_errors_name_part_line_and_element(self):
        good = f'<object id="1">{mesh_xml(MESH)}</object>'
        item = '<item objectid="1"/>'
        tenfold = '<object id="{}"><components>' + '<component objectid="{}"/>' * 10 + "</components></object>"
        nest = "".join(tenfold.format(n, *[n + 1] * 10) for n in range(1, 12)) + '<object id="12"/>'
        itself = '<object id="1"><components><component objectid="1"/></components></object>'
        for text, code, says in (
            (model(good.replace('v3="1"', 'v3="4"'), item), 3, 'line 7: <triangle>: v3="4" of triangle 0 .* 4 vert'),
            (model(good.replace('z="', 'z="x', 1), item), 3, 'line 2: <vertex>: z="x.*" of vertex 0 is not a finite'),
            (model(good, '<item objectid="7"/>'), 3, 'line 11: <item>: objectid="7" is not an object'),
            (model(good, '<item objectid="1" transform="1 0 0"/>'), 3, "<item>: transform has 3 numbers, not 12"),
            (model(good, ""), 3, "the build has no item"),
            (model(good, item, 'unit="league"'), 3, 'unit "league" is not one of'),
            (model(good, item, 'xmlns:b="urn:beams" requiredextensions="b"'), 3, r'extension "b" \(urn:beams\)'),
            (model(itself, item), 3, "nest deeper than 64"),
            (model(nest, item), 5, "more than 1048576 objects"),
            ("<model", 3, "3dmodel.model, line 1: is not XML"),
        ):
            with self.subTest(says):
                self.assert_refused(code, f"a.3mf: .*{says}", write_3mf(self.dir / "a.3mf", text))

    def test_numbers_and_names_may_have_white_space_around_them(self):
        text = model(f'<object id=" 1 ">{mesh_xml(MESH)}</object>', '<item objectid="1\n" transform=" 1 0 0 0 1 0 0 0 1 0 0 0 "/>')
        padded = re.sub(r'(x|y|z|v1|v2|v3)="([^"]*)"', r'\1="\t\2 "', text)
        self.assertEqual(self.digest(write_3mf(self.dir / "a.3mf", padded)), self.expected(MESH))

    def test_a_model_may_be_utf_16(self):
        text = model(f'<object id="1" name="\U0001d11e\u00e4">{mesh_xml(MESH)}</object>', '<item objectid="1"/>')
        wanted = self.expected(MESH)
        for encoding in ("utf-16", "utf-16-be", "utf-16-le", "utf-8-sig"):
            with self.subTest(encoding):
                declared = f'<?xml version="1.0" encoding="{encoding[:6].upper()}"?>' + text
                path = write_3mf(self.dir / "a.3mf", declared.encode(encoding))
                self.assertEqual(self.digest(path), wanted)
        broken = text.replace('v3="1"', 'v3="4"').encode("utf-16")
        self.assert_refused(3, 'line 7: <triangle>: v3="4"', write_3mf(self.dir / "a.3mf", broken))

    def test_an_archive_may_be_a_stream_and_have_bytes_around_it(self):
        """Streams have data descriptors. .NET also writes the unpacked size to the local header."""
        text = model(f'<object id="1">{mesh_xml(MESH)}</object>', '<item objectid="1"/>')
        wanted = self.expected(MESH)
        path = self.dir / "a.3mf"
        with open(path, "wb") as file, zipfile.ZipFile(Stream(file), "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("_rels/.rels", RELATIONS)
            archive.writestr("3D/3dmodel.model", text)
        stream = path.read_bytes()
        sized = bytearray(stream)
        for name in (b"_rels/.rels", b"3D/3dmodel.model"):
            at = stream.index(name) - 30
            self.assertEqual(struct.unpack_from("<I", stream, at + 22), (0,), "not a stream")
            struct.pack_into("<I", sized, at + 22, len(text))
        for data, foreign in ((stream, 0), (sized, 0), (stream + bytes(100), 100), (b"\n" + stream + b"PK", 3)):
            path.write_bytes(data)
            self.assertEqual(self.digest(path), wanted)
            if foreign:
                self.assert_warns(f"{foreign} bytes before or after the archive are not read", path)

    def test_required_extensions_that_leave_the_mesh_alone_are_read(self):
        slices = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07"
        stack = '<s:slicestack id="5"><s:slice ztop="1"/></s:slicestack>'
        for resolution, says in (("fullres", ""), ("lowres", "object 1 has finer slices, which are not read")):
            sliced = f'{stack}<object id="1" s:slicestackid="5" s:meshresolution="{resolution}">{mesh_xml(MESH)}</object>'
            text = model(sliced, '<item objectid="1"/>', f'xmlns:s="{slices}" requiredextensions="\n s"')
            path = write_3mf(self.dir / "a.3mf", text)
            self.assertEqual(self.digest(path), self.expected(MESH))
            if says:
                self.assert_warns(says, path)

    def test_what_is_not_to_be_printed_is_placed_with_a_warning(self):
        text = model(f'<object id="1" type="support">{mesh_xml(MESH)}</object>', '<item objectid="1" printable="0"/>')
        path = write_3mf(self.dir / "a.3mf", text)
        self.assertEqual(self.digest(path), self.expected(MESH))
        self.assert_warns("object 1 is of type support, and is placed like a model", path)
        self.assert_warns("object 1 is not to be printed, and is placed all the same", path)

    def test_mirror_images_keep_their_outside(self):
        """Beside the object itself, its mirror image fills by the winding rule, too."""
        text = model(f'<object id="1">{mesh_xml(MESH)}</object>', '<item objectid="1"/><item objectid="1" transform="-1 0 0 0 1 0 0 0 1 3 0 0"/>')
        rule = ["--set", "solid", "--rule", "winding"]
        mirrored = mapped(MESH, lambda x, y, z: (3 - x, y, z))
        turned = mirrored[0], [(a, c, b) for a, b, c in mirrored[1]]
        self.assertEqual(self.digest(write_3mf(self.dir / "a.3mf", text), *rule),
                         self.digest(write_obj(self.dir / "a.obj", joined(MESH, turned)), *rule))  # fmt: skip

    BASES = '<basematerials id="5"><base name="a" displaycolor="#FF8000"/><base name="b" displaycolor="#0102037F"/>' \
            '<base name="c" displaycolor="red"/></basematerials>'
    COLORS = '<m:colorgroup id="6"><m:color color="#102030"/><m:color color="#405060FF"/></m:colorgroup>'

    def colored(self, *triangles, of_object=""):
        """Returns MESH with attributes of the object and of its triangles, placed twice, beside groups of
        properties."""
        mesh = mesh_xml(MESH)
        for n, attributes in enumerate(triangles):
            corners = 'v1="%d" v2="%d" v3="%d"' % MESH[1][n]
            mesh = mesh.replace(corners, f"{corners} {attributes}")
        groups = self.BASES + self.COLORS + '<m:compositematerials id="7"/>'
        groups += '<m:texture2dgroup id="8" texid="7"><m:tex2coord u="0" v="0"/></m:texture2dgroup>'
        extension = f'xmlns:m="{MATERIALS}" requiredextensions="m"'
        items = '<item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 9 0 0"/>'
        return write_3mf(self.dir / "a.3mf", model(f'{groups}<object id="1" {of_object}>{mesh}</object>', items, extension))

    def test_base_materials_and_colors_are_carried(self):
        orange, dark, slate, gray = (255, 128, 0), (1, 2, 3), (16, 32, 48), (64, 80, 96)
        path = self.colored('pid="5" p1="0"', of_object='pid="5" pindex="1"')
        self.assertEqual(self.carried(path, "--fields", "color"), {orange, dark})
        self.assertEqual(self.carried(path, "--fields", "material"), {(0,), (1,)})
        last = self.colored(of_object='pid="5" pindex="1"')
        self.assertEqual(self.carried(last, "--fields", "material,color"), {(0, *dark)}, "not by first use")
        path = self.colored('pid="5" p1="0"', of_object='pid="5" pindex="1"')
        self.assertEqual(self.digest(path), self.expected(joined(MESH, mapped(MESH, lambda x, y, z: (x + 9, y, z)))))
        path = self.colored('p1="1"', of_object='pid="6" pindex="0"')
        self.assertEqual(self.carried(path, "--fields", "color"), {slate, gray})
        self.assert_refused(3, "has no material$", path, "--fields", "material")
        # Corners of one triangle: their vertices have other colors in other triangles.
        path = self.colored('pid="6" p1="0" p2="1" p3="0"', of_object='pid="5" pindex="0"')
        self.assertEqual(self.carried(path, "--fields", "color"), {orange, slate, gray})

    def test_missing_properties_are_reported_if_requested(self):
        for says, attributes in (
            ("$", ""),
            ('3dmodel.model, line 7: <triangle>: pid="9" is not a group', 'pid="9" p1="0"'),
            ('line 7: <triangle>: p1="3" is not within the 3 of <basematerials> 5', 'pid="5" p1="3"'),
            ('line 7: <triangle>: p1="" is not within', 'pid="5"'),
            ('line 7: <triangle>: p2="-1" is not within the 2 of <colorgroup> 6', 'pid="6" p1="0" p2="-1"'),
            ('line 1: <base>: "red" is not a color', 'pid="5" p1="2"'),
            ('line 7: <triangle>: pid="7" is a <compositematerials>, and only basematerials, colorgroup and texture2dgroup are',
             'pid="7" p1="0"'),
            ('line 1: <m:texture2dgroup>: texid="7" is not a <texture2d>', 'pid="8" p1="0"'),
        ):
            with self.subTest(says):
                path = self.colored(attributes)
                self.assert_refused(3, "a.3mf: the mesh, or some of it, has no color.*" + says, path, "--fields", "color")
                self.assertEqual(self.carried(path), {()})

    def test_triangles_without_a_color_are_white_beside_others(self):
        path = self.colored('pid="6" p1="0"')
        self.assertEqual(self.carried(path, "--fields", "color"), {(16, 32, 48), (255, 255, 255)})
        self.assert_warns("6 of 8 triangles have no color, and are white", path)

    def test_an_archive_that_is_damaged_is_refused(self):
        text = model(f'<object id="1">{mesh_xml(MESH)}</object>', '<item objectid="1"/>')
        path = write_3mf(self.dir / "a.3mf", text)
        whole = path.read_bytes()
        elsewhere = whole.replace(b"3D/3dmodel", b"3D/3dmodal")
        for name, data in (("cut", whole[:-30]), ("text", b"PK\3\4 and no more"), ("elsewhere", elsewhere)):
            with self.subTest(name):
                path.write_bytes(data)
                self.assert_refused(3, "a.3mf: ", path)


if __name__ == "__main__":
    unittest.main()
