"""deploy/scale/measure writes the file that deploy/scale/farm reads."""

import json
import pathlib
import subprocess
import tempfile
import unittest

SCALE = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "scale"


def shape(value):
    """Returns keys and names, without the figures."""
    if isinstance(value, dict):
        return {key: shape(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [shape(inner) for inner in value]
    return value if isinstance(value, str) else None


class Measure(unittest.TestCase):
    def test_writes_what_the_page_was_made_from_with_figures_of_this_machine(self):
        with tempfile.TemporaryDirectory(prefix="latvox-measure-") as directory:
            file = pathlib.Path(directory) / "measured.json"
            subprocess.run([SCALE / "measure", "1", file], check=True, timeout=550)
            now, then = json.loads(file.read_text()), json.loads((SCALE / "measured.json").read_text())
            self.assertEqual(shape(now), shape(then))
            for here, there in zip(now["kinds"], then["kinds"]):
                self.assertEqual((here["triangles"], here["voxels"]), (there["triangles"], there["voxels"]))
                self.assertTrue(0.05 < here["core_seconds"] / there["core_seconds"] < 20, (here, there))
            self.assertNotEqual(now["kinds"][0]["core_seconds"], then["kinds"][0]["core_seconds"])
            tables = subprocess.run([SCALE / "farm", "--measured", file], check=True, capture_output=True, text=True).stdout
            self.assertIn("### What fills up first", tables)


if __name__ == "__main__":
    unittest.main()
