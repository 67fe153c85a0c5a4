"""Writes what a file of voxels holds before its compression, block by block.

Usage: contents.py SOURCE TARGET

These are all bytes that deflate has packed. A .npz holds them in a ZIP archive, a .vti, .vtu and .cells.vtu in blocks of
VTK, a .h5 in chunks, a .png in its lines of pixels, a .nrrd, .mha and .nii.gz behind one header. Other files are written
as they are. A process of its own reads them, because the peak of a child counts what its parent holds.
"""

import gzip
import pathlib
import shutil
import struct
import sys
import zipfile
import zlib

BLOCK = 1 << 20


def write_content(source, target):
    name = pathlib.Path(source).name
    for extension, write in (
        (".npz", of_zip),
        (".vti", of_vtk),
        (".vtu", of_vtk),
        (".h5", of_hdf5),
        (".png", of_png),
        (".nrrd", lambda source, file: of_image(source, file, b"\n\n", 16 + zlib.MAX_WBITS)),
        (".mha", lambda source, file: of_image(source, file, b"ElementDataFile = LOCAL\n", zlib.MAX_WBITS)),
        (".nii.gz", lambda source, file: copy(gzip.open(source), file)),
    ):
        if name.endswith(extension):
            break
    else:
        write = as_it_is
    with open(target, "wb") as file:
        write(source, file)


def copy(opened, file):
    with opened:
        shutil.copyfileobj(opened, file, BLOCK)


def as_it_is(source, file):
    copy(open(source, "rb"), file)


def of_zip(source, file):
    with zipfile.ZipFile(source) as archive:
        for name in archive.namelist():
            copy(archive.open(name), file)


def of_image(source, file, end, bits):
    """Writes a header up to its end, and what the stream behind it holds."""
    with open(source, "rb") as opened:
        head, _, rest = opened.read(BLOCK).partition(end)
        file.write(head + end)
        stream = zlib.decompressobj(bits)
        while rest:
            file.write(stream.decompress(rest))
            rest = opened.read(BLOCK)
        file.write(stream.flush())
    if not stream.eof:
        sys.exit(f"{source}: its stream does not end")


def of_vtk(source, file):
    """Writes the header, and the blocks of each array. Before them are their number and their sizes."""
    with open(source, "rb") as opened:
        for line in opened:
            file.write(line)
            if line.startswith(b"<AppendedData"):
                break
        opened.read(1)  # an underscore
        while not (front := opened.read(24)).startswith(b"\n</"):
            (blocks,) = struct.unpack("<Q16x", front)
            for size in struct.unpack(f"<{blocks}Q", opened.read(8 * blocks)):
                file.write(zlib.decompress(opened.read(size)))


def of_hdf5(source, file):
    import h5py  # only for these files

    def write(_, item):
        if isinstance(item, h5py.Dataset) and item.size:
            step = item.chunks[0] if item.chunks else len(item)
            for start in range(0, len(item), step):
                file.write(item[start : start + step].tobytes())

    with h5py.File(source) as opened:
        opened.visititems(write)


def of_png(source, file):
    stream = zlib.decompressobj()
    with open(source, "rb") as opened:
        file.write(opened.read(8))
        while start := opened.read(8):
            size, kind = struct.unpack(">I4s", start)
            data = opened.read(size)
            file.write(stream.decompress(data) if kind == b"IDAT" else start + data)
            opened.read(4)


if __name__ == "__main__":
    write_content(*sys.argv[1:])
