"""Images whose pixels are known, and meshes that show them."""

import json
import struct
import zlib


def png(pixels, width, color=2, bits=8, interlaced=False, more=b""):
    """Returns a PNG of these rows of pixels, each a tuple of numbers. `color` is the format's color type."""
    form = ">%d%s" % (len(pixels[0]), {8: "B", 16: "H"}[bits])
    rows = [b"".join(struct.pack(form, *p) for p in pixels[n : n + width]) for n in range(0, len(pixels), width)]
    body = b"".join(b"\0" + row for row in rows)
    header = struct.pack(">IIBBBBB", width, len(rows), bits, color, 0, 0, interlaced)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + more + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b"")


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def linear(byte):
    c = byte / 255
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def srgb(c):
    return round(255 * (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055))


def mean(colors):
    """Returns the mean of sRGB colors, as one."""
    return tuple(srgb(sum(linear(c[n]) for c in colors) / len(colors)) for n in range(3))


def quad(side=8.0):
    """Returns the corners of a square in the plane z = 1/4, and its triangles."""
    return [(0, 0, 0.25), (side, 0, 0.25), (0, side, 0.25), (side, side, 0.25)], [(0, 1, 2), (2, 1, 3)]


class Gltf:
    """A .glb of the square, whose material shows an image. Places (u, v) of a corner (x, y) are (x / 8, y / 8)."""

    def __init__(self, image=b"", **material):
        self.body = b""
        self.document = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "buffers": [{}],
            "bufferViews": [],
            "accessors": [],
            "materials": [{"name": "m", "pbrMetallicRoughness": material}],
        }
        corners, triangles = quad()
        attributes = {
            "POSITION": self.floats(corners),
            "TEXCOORD_0": self.floats([(x / 8, y / 8) for x, y, _ in corners]),
        }
        view = self.view(b"".join(struct.pack("<3H", *t) for t in triangles))
        self.document["accessors"].append({"bufferView": view, "componentType": 5123, "count": 6, "type": "SCALAR"})
        primitive = {"attributes": attributes, "indices": len(self.document["accessors"]) - 1, "material": 0}
        self.document["meshes"] = [{"primitives": [primitive]}]
        if image:
            self.document["images"] = [{"bufferView": self.view(image), "mimeType": "image/png"}]
            self.document["textures"] = [{"source": 0, "sampler": 0}]
            self.document["samplers"] = [{}]
            self.texture["index"] = 0

    @property
    def attributes(self):
        return self.document["meshes"][0]["primitives"][0]["attributes"]

    @property
    def texture(self):
        return self.document["materials"][0]["pbrMetallicRoughness"].setdefault("baseColorTexture", {})

    def view(self, data):
        self.body += bytes(-len(self.body) % 4)
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": len(self.body), "byteLength": len(data)})
        self.body += data
        return len(self.document["bufferViews"]) - 1

    def floats(self, rows):
        view = self.view(b"".join(struct.pack("<%df" % len(row), *row) for row in rows))
        kind = {2: "VEC2", 3: "VEC3", 4: "VEC4"}[len(rows[0])]
        accessor = {"bufferView": view, "componentType": 5126, "count": len(rows), "type": kind}
        if kind == "VEC3":
            accessor |= {"min": [min(c) for c in zip(*rows)], "max": [max(c) for c in zip(*rows)]}
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def write(self, path):
        self.document["buffers"][0]["byteLength"] = len(self.body)
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        body = self.body + bytes(-len(self.body) % 4)
        size = 28 + len(text) + len(body)
        path.write_bytes(
            struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A) + text + struct.pack("<II", len(body), 0x004E4942) + body
        )
        return path
