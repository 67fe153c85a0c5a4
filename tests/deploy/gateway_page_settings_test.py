"""The settings of the gateway's page in Chromium: every set and field is that of the tool. An error in a form, a link
or a file is told with its reason."""

import unittest

from page_case import PageCase, binary_ply, ply, stl

from harness import box, write_obj

SETS = [
    ("set=supercover", ["--set", "supercover"]),
    ("set=solid&rule=positive", ["--set", "solid", "--rule", "positive"]),
    ("set=supercover-solid", ["--set", "supercover-solid"]),
    ("set=interior", ["--set", "interior"]),
    ("set=enclosed&close=2", ["--set", "enclosed", "--close", 2]),
    ("set=enclosed-interior", ["--set", "enclosed-interior"]),
    ("set=region&seed=0,0.5,-1&close=0.5", ["--set", "region", "--seed", "0,0.5,-1", "--close", 0.5]),
    ("set=region&seed=6,6,6&allow-outside=yes", ["--set", "region", "--seed", "6,6,6", "--allow-outside"]),
    ("set=band&width=2.5", ["--band", "2.5v"]),
    ("set=links&side=inside&k=2", ["--set", "links", "--side", "inside", "--separability", 2]),
]

WRONG = {
    "set=wall": 'set: "wall" is not one of surface, supercover, solid,',
    "lattice=nonsense": 'lattice: "nonsense" is not one of cartesian, bcc, fcc, hexagonal, basis',
    "k=7": 'k: "7" is not one of 0, 1, 2',
    "k=1&set=interior": 'k: "1" counts only with set surface, solid, enclosed,',
    "k=1&set=supercover": 'k: "1" counts only with set surface, solid,',
    "k=1&set=supercover-solid&verify=yes": 'k: "1" counts only with set surface, solid,',
    "fields=part,hue": 'fields: "part,hue" has "hue", which is not one of part, material,',
    "fields=part,part": 'fields: "part,part" names a field twice',
    "resolution=99999": 'resolution: "99999" is not a whole number from 2 to 65536',
    "resolution=": 'resolution: "" is not a whole number from 2 to 65536',
    "resolution=6.5": 'resolution: "6.5" is not a whole number from 2 to 65536',
    "set=band&width=300": 'width: "300" is not a number from 0.001 to 256',
    "width=3": 'width: "3" counts only with set band',
    "lattice=basis&basis=1,2": 'basis: "1,2" is not nine numbers a1,a2,a3,b1,b2,b3,c1,c2,c3',
    "set=region": 'seed: "" is not three numbers x,y,z',
    "set=region&seed=1,2": 'seed: "1,2" is not three numbers x,y,z',
    "set=enclosed&close=-1": 'close: "-1" is not a number of at least 0',
    "set=links&side=left": 'side: "left" is not one of both, inside, outside',
    "set=solid&rule=odd": 'rule: "odd" is not one of auto, parity, winding, positive',
    "set=solid&labels=color": 'labels: "color" is not one of none, part, material',
    "set=region&seed=1,1,1&labels=part": 'labels: "part" counts only with set solid, supercover-solid, interior, enclosed,',
    "force-open=yes": 'force-open: "yes" counts only with set solid, supercover-solid, interior',
    "set=solid&verify=yes": 'verify: "yes" counts only with set surface, supercover',
    "verify=no": 'verify: "no" is not yes',
    "fields=fraction&fraction-n=17": 'fraction-n: "17" is not a whole number from 2 to 16',
    "signed=yes": 'signed: "yes" counts only with fields distance',
    "up=x": 'up: "x" is not one of y, z',
    "hue=red": '"hue" is not one of the settings lattice, resolution,',
    "k=0&k=0": "k: is there twice",
    "mesh=12": 'mesh: "12" is not the 64 hexadecimal digits of a SHA-256',
    f"mesh={'ab' * 32}&raw=3,1,int8": 'raw: "3,1,int8" is not VERTICES,TRIANGLES,float32 or float64, then fields',
}


class PageSettings(PageCase):
    def repeated(self, tab):
        """Returns a tab with the address of another one."""
        return self.tab(tab.run("location.hash"))

    def submit(self, tab):
        tab.run("document.forms[0].requestSubmit()")
        tab.rest()

    def put(self, tab, name, value):
        """Changes a setting as a user does."""
        tab.run(
            f"""{{
          const element = document.forms[0].elements["{name}"];
          element.value = "{value}";
          element.dispatchEvent(new Event("change", {{ bubbles: true }}));
        }}"""
        )

    def is_hidden(self, tab, name):
        return tab.run(f"document.querySelector('[name={name}]').closest('label').hidden")

    def bodies(self):
        """Writes a.obj: two boxes that overlap, of a material each. Returns its bytes."""
        (first, triangles), (second, _) = box((-4, -4, -4), (4, 4, 4)), box((0, -2, -2), (9, 2, 2))
        path = write_obj(self.dir / "a.obj", (first + second, triangles))
        more = ["f %d %d %d" % tuple(n + 9 for n in triangle) for triangle in triangles]
        text = path.read_text().replace("f ", "usemtl red\nf ", 1) + "\n".join(["usemtl blue", *more]) + "\n"
        path.write_text(text)
        return text.encode()

    def test_every_set_is_that_of_the_tool(self):
        obj = write_obj(self.dir / "a.obj", self.mesh)
        for words, options in SETS:
            with self.subTest(words):
                direct = self.direct(obj, "--lattice", "fcc", "--resolution", 20, *options)
                tab = self.tab(f"#lattice=fcc&resolution=20&{words}")
                self.drop(tab, "a.obj", obj.read_bytes())
                self.assertEqual(self.shown(tab)["digest"], direct["digest"])
                again = self.repeated(tab)
                tab.close()
                self.assertEqual(self.shown(again)["digest"], direct["digest"])
                again.close()

    def test_every_field_is_in_the_files_as_the_tool_has_it(self):
        data = self.bodies()
        nearest = "distance,material,triangle,point,normal"
        for words, options in (
            (f"set=supercover-solid&labels=material&fields={nearest},fraction,label_fractions&fraction-n=4&signed=yes",
             ["--set", "supercover-solid", "--labels", "material", "--signed",
              "--fields", f"{nearest},fraction:4,label_fractions:4"]),
            ("set=enclosed-interior&labels=material&fields=distance",
             ["--set", "enclosed-interior", "--labels", "material", "--fields", "distance"]),
            ("set=interior&k=1&fields=links,link_triangles,link_crossings",
             ["--set", "interior", "--separability", 1, "--fields", "links,link_triangles,link_crossings"]),
        ):  # fmt: skip
            with self.subTest(words):
                self.direct(self.dir / "a.obj", "--resolution", 20, *options)
                self.direct(self.dir / "a.obj", "--resolution", 20, *options, out="direct.npz")
                tab = self.tab(f"#resolution=20&{words}")
                self.drop(tab, "a.obj", data)
                self.shown(tab)
                self.assert_csv(tab)
                self.assert_npz(tab)
                again = self.repeated(tab)
                self.shown(again)
                self.assert_csv(again)
        self.picture(tab, "links")

    def test_the_viewer_shows_fractions_labels_and_signs(self):
        fields = "distance,fraction,label_fractions,point,normal,links,link_triangles,link_crossings"
        tab = self.tab(f"#resolution=20&set=supercover-solid&labels=material&signed=yes&fields={fields}")
        self.drop(tab, "a.obj", self.bodies())
        self.shown(tab)
        paints = "[...document.getElementById('viewer').contentDocument.querySelectorAll('#by option')]"
        names = tab.run(f"{paints}.map(({{ innerText }}) => innerText)")
        self.assertEqual(set(names) - {"none"}, {*fields.split(","), "fraction_0", "fraction_1", "material"} - {"label_fractions"})
        self.picture(tab, "fractions")

    def test_colors_and_values_of_fields_of_links_and_of_vectors(self):
        fields = """[
            { name: 'links', columns: ['a', 'b'], values: new Float32Array([NaN, NaN, NaN, 0.5, 1, 0.25]) },
            { name: 'link_triangles', columns: ['a', 'b'], values: new Int32Array([-1, -1, -1, 7, 2, 1]) },
            { name: 'link_crossings', columns: ['a', 'b'], values: new Int32Array([0, 0, 3, 1, 1, 2]) },
            { name: 'normal', columns: ['nx', 'ny', 'nz'], values: new Float32Array([1, 0, 0, 0, -1, 0, 0, 0, 0]) },
            { name: 'point', columns: ['u', 'v'], values: new Float32Array([0, 0, 1, 0, 0, 0.5]) }]"""
        found = self.tab().run(f"""import('./scene.js').then(({{ paintsOf }}) => paintsOf({fields}, 8).map((paint) => {{
            const {{ paint: {{ name, components, values: kind }}, colors, values }} = paint();
            const Kind = kind === 'float32' ? Float32Array : Uint32Array;
            const numbers = [...new Kind(values.buffer, values.byteOffset, values.length / 4)];
            return [name, components, numbers.map(String), [...colors]]; }}))""")
        uncrossed = [0xBB] * 3
        (links, triangles, crossings, normal, point) = found
        self.assertEqual(links[:3], ["links", 1, ["NaN", "0.5", "0.25"]])
        self.assertEqual(links[3][:3], uncrossed)
        self.assertNotEqual(links[3][3:6], links[3][6:])
        self.assertEqual(triangles[:3], ["link_triangles", 1, ["4294967295", "7", "1"]])
        self.assertEqual(triangles[3][:3], uncrossed)
        self.assertEqual(crossings[:3], ["link_crossings", 1, ["0", "3", "2"]])
        self.assertEqual(crossings[3][:3], uncrossed)
        self.assertEqual(normal[:2] + normal[3:], ["normal", 3, [255, 128, 128, 128, 0, 128, 128, 128, 128]])
        self.assertEqual(point[:2] + point[3:], ["point", 2, [255, 0, 0, 0, 255, 0, 128, 0, 128]])

    def test_a_wrong_link_is_an_error_until_the_form_is_sent(self):
        data = write_obj(self.dir / "a.obj", self.mesh).read_bytes()
        plain = self.direct(self.dir / "a.obj", "--resolution", 64)["digest"]
        tab = self.tab()
        for words, message in WRONG.items():
            with self.subTest(words):
                tab.run(f"location.hash = '{words}'")
                tab.rest()
                told = self.error(tab)
                self.assertIn(f"The address is wrong. {message}", told)
                self.drop(tab, "a.obj", data)
                self.assertEqual(self.error(tab), told)
                self.assertTrue(tab.run("document.getElementById('result').hidden"))
        tab.run("location.hash = 'k=7'")
        tab.rest()
        self.submit(tab)
        self.assertEqual(self.shown(tab)["digest"], plain)
        self.assertIn("k=0", tab.run("location.hash"))

    def test_a_changed_address_is_taken_with_the_mesh_that_was_dropped(self):
        path = self.dir / "a.ply"
        path.write_bytes(ply(self.mesh))
        tab = self.tab("#resolution=20")
        self.drop(tab, "a.ply", path.read_bytes())
        self.shown(tab)
        tab.run("location.hash = location.hash.replace('k=0', 'k=2')")
        tab.rest()
        self.assertEqual(
            self.shown(tab)["digest"], self.direct(path, "--resolution", 20, "--separability", 2)["digest"]
        )
        self.assertEqual(tab.run("document.getElementById('facts').innerText"), "8 triangles")
        tab.run("location.hash = 'resolution=500&set=supercover&k=7'")
        tab.rest()
        self.assertIn('k: "7" is not one of 0, 1, 2', self.error(tab))
        hidden = "['cancel', 'result'].map((id) => document.getElementById(id).hidden)"
        self.assertEqual(tab.run(hidden), [True, True])
        self.submit(tab)
        self.shown(tab)
        tab.run("location.hash = 'resolution=20'")
        tab.rest()
        self.assertEqual(tab.run(hidden), [True, True])

    def test_a_wrong_link_keeps_a_mesh_that_is_right(self):
        tab = self.tab("#resolution=20")
        self.drop(tab, "a.stl", stl(self.mesh))
        digest = self.shown(tab)["digest"]
        again = self.tab(tab.run("location.hash").replace("k=0", "k=7"))
        self.assertIn('k: "7" is not one of 0, 1, 2', self.error(again))
        self.submit(again)
        self.assertEqual(self.shown(again)["digest"], digest)

    def test_a_wrong_value_in_the_form_is_an_error(self):
        tab = self.tab("#resolution=20")
        self.drop(tab, "a.stl", stl(self.mesh))
        self.put(tab, "resolution", 99999)
        self.submit(tab)
        self.assertEqual(self.error(tab), 'resolution: "99999" is not a whole number from 2 to 65536')
        self.put(tab, "resolution", 20)
        self.put(tab, "set", "band")
        self.put(tab, "width", 300)
        self.submit(tab)
        self.assertEqual(self.error(tab), 'width: "300" is not a number from 0.001 to 256')
        self.assertEqual(tab.run("document.activeElement.name"), "width")
        self.put(tab, "set", "solid")
        self.put(tab, "labels", "material")
        self.submit(tab)
        self.assertEqual(self.error(tab), 'labels: "material" is not in a.stl, which has part')
        self.put(tab, "labels", "none")
        self.submit(tab)
        self.shown(tab)

    def test_only_settings_that_count_are_offered(self):
        tab = self.tab("#resolution=20&k=1")
        self.drop(tab, "a.stl", stl(self.mesh))
        self.assertTrue(self.is_hidden(tab, "force-open"))
        self.put(tab, "set", "interior")
        self.assertTrue(self.is_hidden(tab, "k"))
        self.assertTrue(self.is_hidden(tab, "verify"))
        self.assertFalse(self.is_hidden(tab, "force-open"))
        self.submit(tab)
        self.shown(tab)
        tab.run("document.querySelector('[value=links]').click()")
        self.assertFalse(self.is_hidden(tab, "k"))
        tab.run("document.querySelector('[value=links]').click()")
        self.put(tab, "set", "supercover")
        self.assertTrue(self.is_hidden(tab, "k"))
        tab.run("document.querySelector('[name=verify]').click()")
        self.assertFalse(self.is_hidden(tab, "k"))

    def test_a_supercover_has_its_redundant_voxels_counted_for_k(self):
        path = write_obj(self.dir / "a.obj", self.mesh)
        counted = []
        for k in range(3):
            direct = self.direct(path, "--resolution", 20, "--set", "supercover", "--verify", "--separability", k)
            tab = self.tab(f"#resolution=20&set=supercover&verify=yes&k={k}")
            self.drop(tab, "a.obj", path.read_bytes())
            counted.append(direct["certificate"]["redundant"])
            self.assertEqual(self.shown(tab)["counted"], f"0 tunnels, {counted[-1]} redundant")
        self.assertEqual(len(set(counted)), 3)

    def test_an_open_mesh_has_ways_to_fill_it(self):
        vertices, triangles = self.mesh
        path = write_obj(self.dir / "a.obj", (vertices, triangles[1:]))
        tab = self.tab("#resolution=20&set=solid")
        self.drop(tab, "a.obj", path.read_bytes())
        self.assertIn("force_open fills the others", self.error(tab))
        forced = "document.querySelector('[name=force-open]')"
        self.assertGreater(tab.run(f"{forced}.getBoundingClientRect().height"), 0)
        tab.run(f"{forced}.click()")
        self.submit(tab)
        filled = self.direct(path, "--resolution", 20, "--set", "solid", "--force-open")["digest"]
        self.assertEqual(self.shown(tab)["digest"], filled)
        self.put(tab, "set", "enclosed")
        self.put(tab, "close", 20)
        self.submit(tab)
        closed = self.direct(path, "--resolution", 20, "--set", "enclosed", "--close", 20)["digest"]
        self.assertEqual(self.shown(tab)["digest"], closed)
        self.put(tab, "set", "region")
        self.put(tab, "close", 0)
        self.put(tab, "seed", "0,0,0")
        tab.run("document.getElementById('more').open = false")
        self.submit(tab)
        self.assertIn("allow_outside", self.error(tab))
        self.assertTrue(tab.run("document.getElementById('more').open"))

    def test_a_damaged_file_is_named_with_the_reason(self):
        obj = write_obj(self.dir / "a.obj", self.mesh).read_bytes()
        tab = self.tab("#resolution=20")
        for name, data, reason in (
            ("e.stl", b"no mesh", "the file is damaged"),
            ("e.stl", stl(self.mesh)[:-20], "the file is damaged"),
            ("e.stl", b"solid", "the file is damaged"),
            ("e.ply", ply(self.mesh)[:30], ""),
            ("e.ply", b"no mesh", ""),
            ("e.ply", ply(self.mesh)[:-8], "the file ends or is damaged at face 7 of 8"),
            ("e.ply", binary_ply(self.mesh)[:-1], "the file ends or is damaged at face 7 of 8"),
            ("e.ply", ply((self.mesh[0], [(0, 1, 2, 3), (0, 1, 2, 3, 4)])), "face 1 has 5 corners"),
            ("e.ply", binary_ply((self.mesh[0], [(0, 1, 2, 3), (0, 1, 2, 3, 4)])), "face 1 has 5 corners"),
            ("e.ply", ply(self.mesh).replace(b"int v", b"long v"), 'the header has the type "long"'),
            ("e.ply", ply(self.mesh).replace(b"face", b"tristrips"), "the file has an element tristrips"),
            ("e.ply", ply(self.mesh).replace(b"_indices", b"_places"), "element face has no list vertex_indices"),
            ("e.ply", ply((self.mesh[0], [])), "the file has no triangles"),
            ("e.obj", b"v 0 0 0\n", "the file has no triangles"),
            ("e.obj", obj.replace(b"f 1 ", b"f 99 "), "vertex 0 is not finite"),
            ("e.glb", b"glTF", ""),
            ("e.gltf", b"{", ""),
            ("e.gltf", b'{"asset": {"version": "2.0"}}', "the file has no scene"),
            ("e.xyz", obj, "the file is none of .stl, .ply, .obj, .glb, .gltf"),
            ("e", obj, "the file is none of .stl"),
        ):
            with self.subTest(name=name, data=data[:20]):
                self.drop(tab, name, data)
                told = self.error(tab)
                self.assertTrue(told.startswith(f"{name}: {reason}"), told)
                self.assertGreater(len(told), len(name) + 8)
        tab.complaints()

    def test_all_settings_fit_on_a_phone(self):
        words = "resolution=20&set=solid&fields=distance,fraction&signed=yes&rule=parity"
        tab = self.tab(f"#{words}", width=390, height=844, phone=True)
        self.drop(tab, "a.stl", stl(self.mesh))
        self.shown(tab)
        self.assertTrue(tab.run("document.getElementById('more').open"), "the link sets what is in there")
        self.assertLessEqual(tab.run("document.documentElement.scrollWidth"), 390)
        for theme in ("light", "dark"):
            self.theme(tab, theme)
            self.picture(tab, f"phone-settings-{theme}")
        tab.resize(1280, 800)
        self.picture(tab, "desktop-settings-dark")


if __name__ == "__main__":
    unittest.main()
