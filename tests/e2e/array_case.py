"""Cases that compare the files of a call with the .npz and the .csv of the same call, on several lattices."""

import numpy

from harness import Case

SPIDER = "/usr/share/assimp/models/OBJ/spider.obj"  # of assimp-testmodels
LATTICES = {
    "cartesian": ["--lattice", "cartesian", "--resolution", "24", "--origin", "0.5,-3,1"],
    "stretched": ["--voxel-size", "0.05,0.08,0.11"],
    "bcc": ["--lattice", "bcc", "--resolution", "24"],
    "fcc": ["--lattice", "fcc", "--resolution", "24"],
    "hexagonal": ["--lattice", "hexagonal", "--resolution", "24"],
    "skewed": ["--basis", "0.1,0,0.01,0.02,0.12,0,0,0.03,0.15", "--origin", "0.5,-3,1"],
}


class ArrayCase(Case):
    def write(self, mesh, extensions, *options):
        """Writes a.npz, a.csv and files of these extensions. Returns the arrays of a.npz."""
        outputs = [word for extension in (".npz", *extensions) for word in ("-o", self.dir / f"a{extension}")]
        self.summary = self.voxelize(mesh, *outputs, *options, out="a.csv")
        with numpy.load(self.dir / "a.npz") as arrays:
            return dict(arrays)
