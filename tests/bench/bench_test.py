"""Tests of latvox_bench: fields and exit statuses that scripts rely on, and the same digest from every kernel."""

import contextlib
import importlib.machinery
import io
import json
import os
import pathlib
import random
import re
import subprocess
import tempfile
import types
import unittest

BENCH = pathlib.Path(os.environ["LATVOX_BIN"]) / "latvox_bench"
MODULES = [*BENCH.parent.parent.glob("client/python/latvox/_latvox.*.so")]  # some builds have no Python module
BUNNY = "/usr/share/glmark2/models/bunny.obj"
# The program beside this file; the tests use its function `count`.
COUNTER = types.ModuleType("instructions")
COUNTER.__file__ = str(pathlib.Path(__file__).with_name("instructions"))
importlib.machinery.SourceFileLoader("instructions", COUNTER.__file__).exec_module(COUNTER)
FIELDS = {"voxels", "ms_min", "ms_median", "ms_processor", "ns_per_triangle", "mvoxels_per_s", "peak_rss_bytes"}
FIELDS |= {"threads", "simd", "digest"}


def run(*words, stdin=""):
    return subprocess.run([BENCH, *words], input=stdin, capture_output=True, text=True, timeout=60)


def measured(*words):
    done = run(*words, "--reps", "2", "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def once(*words):
    done = run(*words, "--warmups", "0", "--reps", "1", "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def instructions(*words):
    """Counts by valgrind, which has no AVX-512: the same on every machine, however busy."""
    return COUNTER.count(BENCH, [*words, "--warmups", "0"], "avx2")


def cost_of_a_voxel(*words):
    return instructions(*words) / once(*words)["voxels"]


class Bench(unittest.TestCase):
    def test_prints_all_fields(self):
        out = measured("sphere:2000", "64", "--threads", "2", "--cancel")
        self.assertLessEqual(FIELDS, out.keys())
        self.assertEqual(out["threads"], 2)
        self.assertLessEqual(out["ms_min"], out["ms_median"])
        self.assertLessEqual(out["ms_first_brick"], out["ms_min"])
        self.assertGreater(out["job_peak_bytes"], 0)
        self.assertGreater(out["ms_read"], 0)

    def test_every_kernel_has_the_digest_of_the_scalar_one(self):
        for lattice in ("cartesian", "bcc", "fcc", "hexagonal"):
            words = ("sphere:20000", "96", "--lattice", lattice)
            reference = measured(*words, "--simd", "scalar")
            self.assertEqual(reference["simd"], "scalar")
            for simd in ("avx2", "avx512"):
                done = run(*words, "--simd", simd, "--json", "--reps", "1")
                if done.returncode == 3:
                    self.assertEqual(done.stderr, f"latvox_bench: simd: this processor has no {simd}\n")
                    continue
                out = json.loads(done.stdout)
                self.assertEqual(out["simd"], simd)
                self.assertEqual(out["digest"], reference["digest"], (lattice, simd))

    def test_loading_highways_library_measures_no_clock(self):
        """It would do so by an instruction that some machines hide. Valgrind then ends every program."""
        loader = {**os.environ, "LD_DEBUG": "bindings", "LD_BIND_NOW": "1"}
        for program in (BENCH, BENCH.with_name("latvoxd")):
            lines = subprocess.run([program, "--help"], env=loader, capture_output=True, text=True, timeout=60).stderr.splitlines()
            of_library = [line.partition(" to ")[2] for line in lines if re.search(r"binding file \S*libhwy\.so", line)]
            self.assertTrue(of_library)
            clock = [line for line in of_library if "TimerResolution" in line]
            self.assertEqual([line for line in clock if not line.startswith(str(program))], [])

    def test_discarded_bricks_count(self):
        kept, discarded = measured("box", "128"), measured("box", "128", "--discard")
        self.assertEqual((kept["voxels"], kept["digest"]), (discarded["voxels"], discarded["digest"]))

    def test_solids_have_more_voxels_and_interiors_fewer(self):
        surface, solid, inside = (
            measured("box", "64", *words)["voxels"]
            for words in ((), ("--set", "solid", "--rule", "winding"), ("--set", "interior"))
        )
        self.assertGreater(inside, surface)
        self.assertGreater(solid, inside)
        self.assertLess(solid, inside + surface)

    def test_each_copy_of_a_labeled_solid_is_a_solid(self):
        words = ("box", "64", "--set", "interior", "--copies", "3")
        united, labeled = measured(*words, "--rule", "winding"), measured(*words, "--labels")
        self.assertEqual((labeled["voxels"], labeled["digest"]), (united["voxels"], united["digest"]))
        self.assertGreater(labeled["voxels"], measured(*words)["voxels"])

    def test_an_enclosed_set_has_labels_too(self):
        words = ("sphere:500", "32", "--set", "enclosed")
        plain, labeled = measured(*words), measured(*words, "--labels")
        self.assertEqual((labeled["voxels"], labeled["digest"]), (plain["voxels"], plain["digest"]))

    def test_peers(self):
        self.assertEqual(measured("box", "32", "--peer", "openvdb")["simd"], "openvdb")
        recast = run("box", "32", "--peer", "recast", "--json")
        if recast.returncode != 0:
            self.assertIn("built without Recast; install Debian's librecast-dev", recast.stderr)
        else:  # Recast's cells are those that the triangles touch, and a few more.
            out, touched = json.loads(recast.stdout), measured("box", "32", "--set", "supercover")["voxels"]
            self.assertEqual(out["simd"], "recast")
            self.assertTrue(0.9 * touched < out["voxels"] < 1.5 * touched, (out["voxels"], touched))
        self.assertNotEqual(
            measured("box", "32", "--algorithm", "optimized-incremental")["digest"], measured("box", "32")["digest"]
        )

    def test_options_without_an_equivalent_in_the_peer_are_refused(self):
        refused = (("--lattice", "bcc"), ("--region", "0,0,0,1,1,1"), ("--set", "solid"), ("--band", "3"))
        for peer, options in (("openvdb", refused[:3]), ("recast", refused)):
            for option, value in options:
                done = run("box", "32", "--peer", peer, option, value)
                self.assertEqual(done.returncode, 2)
                self.assertIn(f"{peer} has no equivalent of {option}", done.stderr)

    def test_a_supercover_takes_at_most_half_as_long_again_as_the_unthinned_surface(self):
        for words in (("box", "256"), ("sphere:2000", "128"), ("sphere:20000", "256")):
            surface = instructions(*words, "--separability", "0", "--no-minimal")
            self.assertLess(instructions(*words, "--set", "supercover"), 1.5 * surface, words)

    def test_a_supercover_has_more_voxels(self):
        words = ("sphere:2000", "64", "--lattice", "bcc", "--no-minimal")
        self.assertGreater(measured(*words, "--set", "supercover")["voxels"], measured(*words)["voxels"])

    def test_boxes_of_lattice_and_world_hold_what_is_in_them(self):
        words = ("box", "33", "--lattice", "bcc", "--no-minimal")
        whole = measured(*words)
        sizes = {"--region": ("-999,-999,-999,999,999,999", "-999,-999,-999,999,999,16"),
                 "--bounds": ("-99,-99,-99,99,99,99", "-99,-99,-99,99,99,11.5")}  # fmt: skip
        for option, (everything, part) in sizes.items():
            self.assertEqual(measured(*words, option, everything)["digest"], whole["digest"])
            self.assertTrue(0 < measured(*words, option, part)["voxels"] < whole["voxels"], option)
        self.assertEqual(run(*words, "--bounds", "0,0,0,1,1").returncode, 2)
        inverted = run(*words, "--bounds", "0,0,1,1,1,0")
        self.assertEqual(inverted.returncode, 2)
        self.assertIn("bounds.max.z 0 is below bounds.min's 1", inverted.stderr)

    def test_bands(self):
        words = ("box", "32", "--band", "2")
        self.assertGreater(measured(*words)["voxels"], 2 * measured("box", "32")["voxels"])
        self.assertGreater(measured(*words, "--peer", "openvdb")["voxels"], measured("box", "32")["voxels"])

    def test_lines_are_answered_one_by_one(self):
        done = run("-", stdin="box 32 --reps 1\nbox 1\nnone.obj 32\nbox 32 --subdivide 1 --reps 1\n")
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual([answer.get("triangles") for answer in answers], [12, None, None, 48])
        self.assertIn("RESOLUTION", answers[1]["error"])
        self.assertIn("none.obj", answers[2]["error"])

    def test_memory_does_not_grow_with_the_resolution(self):
        out = once(BUNNY, "8192", "--separability", "2", "--discard", "--threads", "2")
        self.assertGreater(out["voxels"], 100_000_000)
        self.assertLess(out["peak_rss_bytes"], 300e6)

    def test_a_large_mesh_takes_few_bytes_beyond_its_own_arrays(self):
        out = once("sphere:2000000", "256", "--threads", "2")
        if out["job_peak_bytes"] is None:
            self.skipTest("the kernel does not forget peaks of memory")
        self.assertGreater(out["triangles"], 1_900_000)
        self.assertLess(out["job_peak_bytes"] / out["triangles"], 60)

    def test_thinning_triangles_that_fill_a_volume_takes_bounded_time_and_memory(self):
        words = ("tangle:900", "64", "--threads", "1", "--discard")
        # Each voxel has some ten voxel-triangle pairs, and thinning has to ask all of them.
        self.assertLess(instructions(*words), 6 * instructions(*words, "--no-minimal"))
        self.assertLess(once(*words)["job_peak_bytes"], 60e6)

    def test_wires_are_thinned_without_scanning_each_block_several_times(self):
        words = ("wires:200", "256", "--separability", "0", "--threads", "1")
        self.assertLess(instructions(*words), 3.1 * instructions(*words, "--no-minimal"))

    def test_long_pipes_are_thinned_by_one_question_for_each_voxel_and_mostly_in_floats(self):
        words = ("pipes", "256", "--separability", "0", "--threads", "1")
        self.assertLess(instructions(*words), 3.9 * instructions(*words, "--no-minimal"))

    def test_triangles_that_lie_far_apart_take_little_each(self):
        random.seed(6)
        with tempfile.NamedTemporaryFile("w", suffix=".obj") as mesh:
            count = 17000
            for n in range(count):  # most have a tile of 64 voxels a side to themselves
                corner = [random.random() for _ in range(3)]
                for _ in range(3):
                    mesh.write("v {:.6f} {:.6f} {:.6f}\n".format(*(x + 0.0004 * random.random() for x in corner)))
                mesh.write(f"f {3 * n + 1} {3 * n + 2} {3 * n + 3}\n")
            mesh.flush()
            fine, coarse = ((mesh.name, resolution, "--threads", "1", "--discard") for resolution in ("2048", "8192"))
            self.assertLess(once(*fine)["job_peak_bytes"] / count, 300)
            self.assertLess(instructions(*coarse) / count, 80_000)

    def test_cost_grows_with_output_not_with_volume(self):
        # Some twenty triangles: a lattice of 8 times the volume has 4 times the voxels. The column lies in a lattice of
        # 2^48 points, and the part of the surface in it is as large as the whole surface at 256.
        words = ("sphere:20", "--separability", "2", "--discard")
        column = ("65536", "--region", "30000,30000,0,30200,30200,65536")
        coarse, fine, part = (cost_of_a_voxel(*words, *more) for more in (("256",), ("512",), column))
        self.assertLess(fine, 1.5 * coarse)
        self.assertLess(part, 5 * coarse)

    def test_an_empty_region_of_a_huge_lattice_costs_next_to_nothing(self):
        words = ("sphere:20", "65536", "--region", "30000,30000,30000,30999,30999,30999")
        self.assertEqual(once(*words)["voxels"], 0)
        self.assertLess(instructions(*words), 5_000_000)

    def test_a_small_region_of_a_huge_solid_costs_little(self):
        def region(low):
            return ("--region", f"{low},{low},{low},{low + 9},{low + 9},{low + 9}", "--set", "solid", "--threads", "1", "--discard")

        deep = once("box", "65536", *region(30000))
        self.assertEqual(deep["voxels"], 729)
        self.assertLess(deep["job_peak_bytes"], 4e6)
        self.assertLess(instructions("box", "65536", *region(30000)), 2 * instructions("box", "1024", *region(470)))

    def test_more_instructions_than_the_reference_fail_and_so_do_jobs_without_one(self):
        reference = {("a", "avx2"): 1000, ("b", "avx2"): 1000}
        for counts, equal_packages, wrong, doubtful in (
            ({("a", "avx2"): 1029, ("b", "avx2"): 900}, True, [], []),
            ({("a", "avx2"): 1031, ("b", "avx2"): 900}, True, ["a avx2 +3.1 %"], []),
            ({("a", "avx2"): 1031, ("b", "avx2"): 900}, False, [], ["a avx2 +3.1 %"]),
            ({("a", "avx2"): 1000}, False, ["has jobs that nothing counts: b avx2"], []),
            ({**reference, ("c", "avx2"): 1}, True, ["lacks jobs that are counted: c avx2"], []),
        ):
            with contextlib.redirect_stdout(io.StringIO()):
                said = COUNTER.compare(counts, reference, equal_packages)
            for texts, expected in zip(said, (wrong, doubtful)):
                self.assertEqual(len(texts), len(expected), counts)
                for text, part in zip(texts, expected):
                    self.assertIn(part, text)

    def test_the_scripts_fill_their_tables(self):
        for script, words, row in (
            ("whole", [f"{BUNNY}:32"], r"\| bunny.obj 32 (\| -?\d+ ){8}\|\n"),
            ("user", ["ground"], r"\| ground \| 1024 (\| [^|]+ ){8}\|\n\n"),
            ("writers", ["--resolution", "32", "--formats", ".npy"], r"\| `.npy` (\| -?[\d.]+ ){7}\|\n"),
            ("writers", ["--resolution", "16"], r"\| `.mhd` [^$]*\| `.links.npz` (\| -?[\d.]+ ){7}\|\n"),
            *([("python", ["--resolution", "32"], r"\| file (\| [\d.]+ ){3}\|\n")] if MODULES else []),
        ):
            command = [pathlib.Path(__file__).with_name(script), "--bin", BENCH.parent, "--rounds", "1", *words]
            done = subprocess.run(command, capture_output=True, text=True, timeout=120)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, row + "$")

    def test_exit_statuses(self):
        for words, status in (
            (("--help",), 0),
            (("box",), 2),
            (("box", "64", "--simd", "mmx"), 2),
            (("box", "64", "--algorithm", "guess"), 2),
            (("none.obj", "64"), 3),
        ):
            self.assertEqual(run(*words).returncode, status, words)


if __name__ == "__main__":
    unittest.main()
