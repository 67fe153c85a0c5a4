"""deploy/scale: the page has the tables that the program prints, and the program's formulas are right."""

import functools
import importlib.machinery
import importlib.util
import json
import pathlib
import re
import subprocess
import sys
import types
import unittest

SCALE = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "scale"


def load():
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("farm", str(SCALE / "farm"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("farm", loader))
    loader.exec_module(module)
    return module


farm = load()
KIND = {"core_seconds": 2.0, "voxels": 1e6, "mesh_bytes": 1e6, "vdb_bytes": 4e6}


def made(kinds=(KIND,), mix=(1,), **changed):
    values = {"mix": mix, "cores": 2, "read": 1.0, "write": 1.0, "files": 1e9, "start": 0.0} | changed
    return farm.Farm(list(kinds), types.SimpleNamespace(**values))


@functools.cache
def printed(*arguments):
    return subprocess.run([SCALE / "farm", *arguments], capture_output=True, text=True)


class ThePage(unittest.TestCase):
    def test_has_the_tables_that_the_program_prints(self):
        done = printed()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = (SCALE / "README.md").read_text()
        self.assertIn(done.stdout.strip(), page, "deploy/scale/farm prints other tables: put them into the page")

    def test_quotes_figures_of_the_tables_alone(self):
        """Each figure in bold in the page's text is also in a table."""
        text, _, tables = (SCALE / "README.md").read_text().partition("### What one core does")
        quoted = re.findall(r"\*\*([\d.,]+)", text)
        self.assertGreater(len(quoted), 5)
        self.assertEqual([figure for figure in quoted if not re.search(rf"(?<![\d.,]){re.escape(figure)}(?![\d.,]*\d)", tables)], [])

    def test_simulation_and_formula_agree_except_near_the_knee(self):
        ratios = sorted(map(float, re.findall(r"(\d\.\d\d) \([\d,]+\) \|", printed().stdout)))
        self.assertGreaterEqual(len(ratios), 5)
        self.assertGreater(ratios[0], 0.9)
        self.assertLess(ratios[-2], 1.1)
        self.assertLess(ratios[-1], 1.4)

    def test_measured_rates_are_plausible(self):
        for kind in json.loads((SCALE / "measured.json").read_text())["kinds"]:
            self.assertGreater(kind["core_seconds"], kind["decode_seconds"] + kind["voxelize_seconds"], kind)
            self.assertGreater(kind["vdb_bytes"], kind["voxels"] / 8, kind)


class TheFormula(unittest.TestCase):
    def test_cores_decide_where_there_are_few(self):
        self.assertEqual(made().total(1000, 1), (1000.0, "cores"))
        self.assertEqual(made().total(1000, 10), (100.0, "cores"))
        self.assertEqual(made(start=7.0).total(1000, 10), (107.0, "cores"))

    def test_each_part_of_the_storage_decides_where_it_is_slow(self):
        self.assertEqual(made(read=1e-3).total(1000, 10), (1000.0, "reading"))
        self.assertEqual(made(write=1e-3).total(1000, 10), (4000.0, "writing"))
        self.assertEqual(made(files=1.0).total(1000, 10), (1000.0 * farm.FILES_A_JOB, "files"))

    def test_unequal_jobs_make_the_unluckiest_worker_late(self):
        mixed = made([KIND, KIND | {"core_seconds": 200.0}], mix=(99, 1))
        self.assertGreater(mixed.seconds(1000, 10)["cores"], 1.3 * 1000 / 10 * mixed.core_seconds / 2)
        self.assertAlmostEqual(mixed.seconds(1e9, 10)["cores"] / (1e9 / 10 * mixed.core_seconds / 2), 1, places=2)


class TheSimulation(unittest.TestCase):
    def test_alone_a_job_takes_its_reading_computing_and_writing(self):
        self.assertAlmostEqual(made(files=10.0).simulate(1, 1), 0.1 + 2 + 0.2)

    def test_jobs_queue_for_cores_and_storage(self):
        self.assertAlmostEqual(made().simulate(1000, 1), 1000, delta=10)
        self.assertAlmostEqual(made().simulate(1000, 10), 100, delta=3)
        self.assertAlmostEqual(made(write=1e-3).simulate(1000, 10), 4000, delta=10)

    def test_no_worker_helps_another(self):
        slow = KIND | {"core_seconds": 20.0}  # two in one share: 40 s; with help, at most 36 s
        self.assertGreater(made([KIND, slow], mix=(90, 10), cores=1).simulate(400, 100), 40)


class Arguments(unittest.TestCase):
    def test_count(self):
        self.assertNotEqual(printed("--price", "1").stdout, printed().stdout)
        wrong = printed("--mix", "1,2")
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("--mix has 2 shares", wrong.stderr)


if __name__ == "__main__":
    unittest.main()
