"""Every failure has its exit status and its one line, and leaves files alone. The server goes on serving."""

import contextlib
import os
import pathlib
import signal
import subprocess
import time
import unittest

import harness
from harness import BIN, BUNNY, Case, children, encode_drc, latvox, octahedron, write_obj

OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED, STOPPED = range(7)
GOOD = ["--lattice", "bcc", "--resolution", "16"]
LONG = ["--lattice", "cartesian", "--separability", "0", "--resolution", "30000"]  # minutes of work


def listens(pid):
    """Returns whether latvox has begun to wait for signals from its user. It then blocks these three. A library, or
    Python, that starts a thread or a process blocks all signals for a moment."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    blocked = [int(line.split()[1], 16) for line in status.splitlines() if line.startswith("SigBlk:")]
    return blocked == [sum(1 << number - 1 for number in (signal.SIGHUP, signal.SIGINT, signal.SIGTERM))]


def children_of(pid):
    """Returns the children of a process, by number; none if it has ended."""
    found = set()
    with contextlib.suppress(OSError):  # a thread, or the process, has ended
        for thread in pathlib.Path(f"/proc/{pid}/task").iterdir():
            found |= {int(child) for child in (thread / "children").read_text().split()}
    return found


class Failures(Case):
    def setUp(self):
        super().setUp()
        self.mesh = write_obj(self.dir / "octahedron.obj", octahedron())
        self.out = self.dir / "out.vdb"
        self.lines = {}  # error line -> name of its failure

    def good(self, *options):
        done = latvox("voxelize", self.mesh, "-o", self.dir / "good.vdb", *GOOD, *options)
        self.assertEqual(done.returncode, OK, done.stderr)

    def bad(self, name, mesh, *options, code, says, out=None):
        """Checks that the run fails with `code` and one line matching `says`, and neither makes nor touches the
        output."""
        out = out or self.out
        for old in (None, b"what was here before"):
            with self.subTest(name, output_exists=old is not None):
                if old:
                    out.write_bytes(old)
                before = sorted(self.dir.iterdir())
                done = latvox("voxelize", mesh, "-o", out, *options)
                self.assertEqual(done.returncode, code, done.stderr)
                line = self.one_line(done.stderr)
                self.assertRegex(line, says)
                self.assertEqual(self.lines.setdefault(line, name), name, "two failures with the same line")
                self.assertEqual(sorted(self.dir.iterdir()), before)
                if old:
                    self.assertEqual(out.read_bytes(), old)
        out.unlink(missing_ok=True)

    def one_line(self, stderr):
        """Returns the error's line, which is the only one."""
        lines = stderr.splitlines()
        self.assertEqual(len(lines), 1, stderr)
        return lines[0]

    def bad_meshes(self):
        """Yields name, file, and the pattern of the error's line."""
        vertices, triangles = octahedron()
        text = self.mesh.read_text()

        def write(name, content):
            path = self.dir / name
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
            return path

        drc = encode_drc(self.dir / "whole.drc", self.mesh).read_bytes()
        yield "truncated drc", write("truncated.drc", drc[: len(drc) * 2 // 3]), "drc: mesh: truncated or corrupt Draco data"
        yield "drc header only", write("header.drc", drc[:11]), r"drc: mesh: truncated or corrupt Draco data \(header\)"
        yield "empty drc", write("empty.drc", b""), "drc: is empty$"
        yield "no drc", write("text.drc", "this is no mesh\n" * 20), "drc: mesh: not a Draco file .*\"this"
        yield "no obj", write("text.obj", "this is no mesh\n"), "text.obj: the mesh has no triangles$"
        yield "no ply", write("text.ply", "this is no mesh\n"), "text.ply: not a PLY file$"
        yield "NaN vertex", write("nan.obj", text.replace("v 1 0 0", "v nan 0 0")), r": line \d+: vertex 1 of a face is not finite \(nan 0 0\)$"
        yield "infinite vertex", write("inf.obj", text.replace("v 1 0 0", "v 1e999 0 0")), r": line \d+: vertex 1 of a face is not finite \(inf 0 0\)$"
        yield "index out of range", write("index.obj", text + "f 1 2 7\n"), r": line 15: vertex index 7 .* not within the file's 6 vertices$"
        yield "no triangle", write("points.obj", "\n".join("v %g %g %g" % v for v in vertices)), "points.obj: the mesh has no triangles$"
        yield "missing file", self.dir / "missing.obj", "missing.obj: no such file$"
        yield "directory", self.dir, ": is a directory$"

    OPTIONS = [
        ("resolution 0", ["--lattice", "bcc", "--resolution", "0"], '--resolution: "0" is not .* 2 to 65536'),
        ("resolution 70000", ["--lattice", "bcc", "--resolution", "70000"], "resolution.*70000.*65536"),
        ("resolution -5", ["--lattice", "bcc", "--resolution=-5"], '--resolution: "-5" is not .* 2 to 65536'),
        ("voxel size 0", ["--lattice", "bcc", "--voxel-size", "0"], '--voxel-size: "0" is not a finite number above 0'),
        ("voxel size nan", ["--lattice", "bcc", "--voxel-size", "nan"], '--voxel-size: "nan" is not a finite number above 0'),
        ("density given twice", ["--lattice", "bcc", "--voxel-size", "1", "--resolution", "9"], "--voxel-size excludes --resolution"),
        ("unknown lattice", ["--lattice", "cubic", "--resolution", "16"], '--lattice: "cubic" is not one of cartesian, '),
        ("separability 3", [*GOOD, "--separability", "3"], '--separability: "3" is not one of 0, 1, 2'),
        ("eight numbers", ["--basis", "1,0,0,0,1,0,0,0"], '--basis: ".*" is not 9 finite numbers'),
        ("infinite basis", ["--basis", "1,0,0,0,1,0,0,0,inf"], '--basis: ".*inf" is not 9 finite numbers'),
        ("origin of two numbers", [*GOOD, "--origin", "1,2"], '--origin: "1,2" is not 3 finite numbers'),
        ("empty region", [*GOOD, "--region", "0,0,0,0,1,1"], "--region: .* is empty: 0 does not exceed 0 on lattice axis i"),
        ("region and verify", [*GOOD, "--region", "0,0,0,8,8,8", "--verify"], "--verify: not together with --region"),
        ("quantization 31", [*GOOD, "--quantization", "31"], '--quantization: "31" is neither auto nor .* 0 to 30'),
        ("unknown option", [*GOOD, "--frobnicate"], "unknown option \"--frobnicate\""),
    ]

    def test_bad_meshes_are_named_and_the_server_goes_on(self):
        with harness.server(self.dir) as server:
            remote = ["--server", server.address]
            for name, mesh, says in self.bad_meshes():
                self.bad(name, mesh, *GOOD, *remote, code=BAD_INPUT, says=says)
                self.good(*remote)

    def test_bad_options_are_named_and_the_server_goes_on(self):
        with harness.server(self.dir) as server:
            remote = ["--server", server.address]
            for name, options, says in self.OPTIONS:
                self.bad(name, self.mesh, *options, *remote, code=USAGE, says=says)
                self.good(*remote)

    def test_a_basis_that_spans_no_lattice_is_bad_input(self):
        with harness.server(self.dir) as server:
            remote = ["--server", server.address]
            for name, basis, says in (
                ("rank 2", "1,0,0,0,1,0,1,1,0", "basis.*rank below 3"),
                ("too skew", "1,0,0,0,1,0,17,5,1", "basis.*too skew.*1,"),
            ):
                self.bad(name, self.mesh, "--basis", basis, *remote, code=BAD_INPUT, says=says)
                self.good(*remote)

    def test_a_mesh_too_large_for_its_voxels_is_told_by_their_size_and_one_too_far_by_the_origin(self):
        with harness.server(self.dir) as server:
            remote = ["--server", server.address]
            for name, options, code, says in (
                ("fine", ["--voxel-size", "1e-9"], REFUSED, r"--voxel-size: at 1e-09 the mesh extends over \d+ voxels .* limit is 131072"),
                ("basis", ["--basis", "1e-8,0,0,0,1e-8,0,0,0,1e-8"], REFUSED, r"--voxel-size: at 1e-08 .* limit is 131072"),
                ("far", [*GOOD, "--origin", "0,1e12,0"], BAD_INPUT, r"origin: it puts the mesh at .* axis j, the limit is 536870912"),
            ):
                self.bad(name, self.mesh, *options, *remote, code=code, says=says, out=self.dir / "out.csv")

    def test_voxels_that_are_too_small_for_a_vdb_file_are_refused_before_the_work(self):
        tiny = write_obj(self.dir / "tiny.obj", octahedron(radius=0.05))
        options = ["--lattice", "bcc", "--resolution", "65536", "--separability", "0"]  # minutes of work
        started = time.monotonic()
        self.bad("tiny voxels", tiny, *options, code=BAD_INPUT, says="out.vdb: --voxel-size 1.5.*e-06 is below 1.44225e-05")
        self.assertLess(time.monotonic() - started, 20)
        done = latvox("voxelize", tiny, "-o", self.dir / "tiny.csv", "--lattice", "bcc", "--voxel-size", "0.001")
        self.assertEqual(done.returncode, OK, done.stderr)

    def test_an_unknown_extension_is_refused_before_any_work(self):
        self.bad("unknown output", self.mesh, *GOOD, out=self.dir / "out.xyz", code=USAGE, says="xyz")
        odd = self.dir / "mesh.xyz"
        odd.write_text(self.mesh.read_text())
        self.bad("unknown input", odd, *GOOD, code=BAD_INPUT, says="xyz")

    def test_a_server_that_is_not_there_is_unreachable(self):
        nowhere = f"unix:{self.dir}/nobody.socket"
        self.bad("no socket", self.mesh, *GOOD, "--server", nowhere, code=UNREACHABLE, says="nobody.socket")
        self.bad("no port", self.mesh, *GOOD, "--server", "127.0.0.1:1", code=UNREACHABLE, says="127.0.0.1:1.*refused")

    def test_bad_input_without_a_server_leaves_none_behind(self):
        self.bad("embedded", self.mesh, "--lattice", "bcc", "--resolution", "70000", code=USAGE, says="70000")
        self.assert_no_process_left()


class Interruptions(Case):
    def start(self, *options):
        """Starts a run that would take minutes, and waits until it is well under way."""
        before = set(children())
        command = [BIN / "latvox", "voxelize", BUNNY, "-o", self.dir / "out.vdb", *LONG, *options]
        client = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.addCleanup(client.stderr.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        time.sleep(1.5)
        self.assertIsNone(client.poll(), "the long run has ended already")
        self.assertIn(client.pid, set(children()) - before)
        return client

    def assert_stopped(self, client, code):
        stderr = client.communicate(timeout=15)[1]
        self.assertEqual(client.returncode, code, stderr)
        self.assertTrue(stderr.strip(), "nothing was said")
        self.assertEqual([p.name for p in self.dir.iterdir() if p.name.startswith("out")], [])

    def test_a_timeout_ends_with_6(self):
        started = time.monotonic()
        done = latvox("voxelize", BUNNY, "-o", self.dir / "out.vdb", *LONG, "--timeout", "1")
        self.assertEqual(done.returncode, STOPPED, done.stderr)
        self.assertRegex(done.stderr, "(?i)time|deadline")
        self.assertLess(time.monotonic() - started, 10)
        self.assertEqual(list(self.dir.iterdir()), [])

    def test_sigint_ends_with_6(self):
        client = self.start()
        client.send_signal(signal.SIGINT)
        self.assert_stopped(client, STOPPED)

    def await_output(self, client):
        harness.await_true("no output is begun", lambda: harness.unfinished_files(client.pid, self.dir))

    def test_timeouts_two_signals_count_as_one(self):
        """`timeout` signals its child, and then its group, which contains the child."""
        client = self.start()
        client.send_signal(signal.SIGTERM)
        time.sleep(0.05)  # after the first arrived: two pending signals would be one
        client.send_signal(signal.SIGTERM)
        stderr = client.communicate(timeout=15)[1]
        self.assertTrue(stderr.endswith("latvox: cancelled by the caller\n"), stderr)
        self.assertEqual((client.returncode, list(self.dir.iterdir())), (STOPPED, []))

    def test_sigterm_ends_a_run_that_waits_for_a_pipe(self):
        os.mkfifo(self.dir / "in.obj")  # which nobody opens to write
        command = [BIN / "latvox", "voxelize", self.dir / "in.obj", "--resolution", "9", "-o", self.dir / "out.vdb"]
        client = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        self.addCleanup(client.kill)
        self.await_output(client)
        client.send_signal(signal.SIGTERM)
        self.assertEqual((client.communicate(timeout=15)[1], client.returncode), ("latvox: cancelled\n", STOPPED))
        self.assertEqual([path.name for path in self.dir.iterdir()], ["in.obj"])

    def test_timeout_ends_a_run_that_waits_for_input(self):
        silent, endless = ["sleep", "60"], ["yes", "# more"]
        for command, writer in ("voxelize", silent), ("voxelize", endless), ("pixelize", silent):
            with self.subTest(command=command, writer=writer):
                source = subprocess.Popen(writer, stdout=subprocess.PIPE)
                self.addCleanup(source.wait)
                self.addCleanup(source.kill)
                out = self.dir / ("out.vdb" if command == "voxelize" else "out.png")
                size = "--resolution" if command == "voxelize" else "--pixel-size"
                done = subprocess.run([BIN / "latvox", command, "-", size, "9", "-o", out, "--timeout", "0.3"],
                                      stdin=source.stdout, stderr=subprocess.PIPE, text=True, timeout=15)  # fmt: skip
                source.stdout.close()
                message = "latvox: the --timeout passed\n"
                self.assertEqual((done.stderr, done.returncode), (message, STOPPED))
                self.assertEqual(list(self.dir.iterdir()), [])

    def test_sigint_ends_a_run_that_waits_for_standard_input(self):
        command = [BIN / "latvox", "voxelize", "-", "--resolution", "9", "-o", self.dir / "out.vdb"]
        client = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(client.stdin.close)
        self.addCleanup(client.kill)
        self.await_output(client)
        client.send_signal(signal.SIGINT)
        self.assertEqual(client.wait(timeout=15), STOPPED)
        self.assertEqual(client.stderr.read(), "latvox: cancelled\n")
        client.stderr.close()
        self.assertEqual(list(self.dir.iterdir()), [])

    def test_a_second_signal_leaves_nothing_of_a_server_that_does_not_come(self):
        server = self.dir / "latvoxd"
        server.write_text("#!/bin/sh\ntrap '' TERM\necho $$ >pid.part && mv pid.part pid\nexec sleep 60\n")
        server.chmod(0o755)
        runtime = self.dir / "runtime"
        runtime.mkdir()
        environment = {**os.environ, "LATVOX_LATVOXD": str(server), "XDG_RUNTIME_DIR": str(runtime)}
        command = [BIN / "latvox", "voxelize", BUNNY, "--resolution", "9", "-o", self.dir / "out.vdb"]
        with (self.dir / "stderr").open("w") as stderr:  # not a pipe, which the server would hold open
            client = subprocess.Popen(command, stderr=stderr, env=environment, cwd=self.dir)
        self.addCleanup(client.kill)
        self.await_output(client)
        harness.await_true("the server does not start", (self.dir / "pid").exists)
        self.addCleanup(os.kill, int((self.dir / "pid").read_text()), signal.SIGKILL)
        self.assertEqual(len(list(runtime.iterdir())), 1)
        self.assertEqual(harness.unfinished_files(client.pid, self.dir), [0])
        client.send_signal(signal.SIGINT)
        client.send_signal(signal.SIGHUP)  # follows at once, and does not count
        time.sleep(0.5)
        self.assertIsNone(client.poll())
        client.send_signal(signal.SIGTERM)
        self.assertEqual(client.wait(timeout=15), STOPPED)
        self.assertEqual(list(runtime.iterdir()), [])
        self.assertEqual([path for path in self.dir.iterdir() if path.suffix == ".part"], [])
        self.assertEqual((self.dir / "stderr").read_text(), "latvox: cancelled\n")

    def interrupt(self, words, seconds):
        """Sends SIGINT once the program listens, and after these seconds. Returns its exit status and standard error."""
        client = subprocess.Popen([BIN / "latvox", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        listening = time.monotonic() + harness.PATIENCE
        while client.poll() is None and not listens(client.pid):
            self.assertLess(time.monotonic(), listening)
        time.sleep(seconds)
        client.send_signal(signal.SIGINT)
        stderr = client.communicate(timeout=15)[1]
        return client.returncode, stderr

    def test_commands_without_a_server_end_with_6_on_sigint(self):
        voxels = self.dir / "voxels.vdb"
        self.assertEqual(latvox("voxelize", BUNNY, "--resolution", "1000", "-o", voxels).returncode, OK)
        for words in (["render", voxels, "--size", "4096", "-o", self.dir / "out.png"],
                      ["slice", voxels, "--axis", "z", "--index", "400", "-o", self.dir / "out.csv"],
                      ["view", voxels, "-o", self.dir / "out.html"],
                      ["compare", voxels, voxels]):
            with self.subTest(words[0]):
                seconds = 3 if words[0] == "render" else 0  # until it draws the picture, which takes half a minute
                for _ in range(50):  # on a busy machine, a short command may end before its signal
                    status, stderr = self.interrupt(words, seconds)
                    if status != OK:
                        break
                    for path in self.dir.glob("out.*"):
                        path.unlink()
                self.assertEqual((status, stderr), (STOPPED, "latvox: cancelled\n"))
                self.assertEqual([p.name for p in self.dir.iterdir()], ["voxels.vdb"])

    def test_a_reader_of_voxels_that_the_system_kills_is_an_error(self):
        voxels, out = self.dir / "voxels.vdb", self.dir / "out.csv"
        self.assertEqual(latvox("voxelize", BUNNY, "--resolution", "1000", "-o", voxels).returncode, OK)
        words = ["slice", voxels, "--axis", "z", "--index", "400", "-o", out]
        client = subprocess.Popen([BIN / "latvox", *words], stderr=subprocess.PIPE, text=True)
        self.addCleanup(client.kill)
        while not (readers := children_of(client.pid)):
            self.assertIsNone(client.poll())
        for reader in readers:
            os.kill(reader, signal.SIGKILL)
        self.assertIn("voxels.vdb: the process that read it was killed", client.communicate(timeout=60)[1])
        self.assertEqual((client.returncode, out.exists()), (REFUSED, False))

    def test_a_cancelled_call_frees_the_server(self):
        with harness.server(self.dir) as server:
            client = self.start("--server", server.address)
            client.send_signal(signal.SIGINT)
            self.assert_stopped(client, STOPPED)
            mesh = write_obj(self.dir / "octahedron.obj", octahedron())
            done = latvox("voxelize", mesh, "-o", self.dir / "good.vdb", *GOOD, "--server", server.address)
            self.assertEqual(done.returncode, OK, done.stderr)
            self.assert_becomes_idle(server.pid)

    def assert_becomes_idle(self, pid):
        """Checks that the server uses next to no processor time in some second of the next ten."""
        used = []
        for _ in range(10):
            fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            used.append(int(fields[11]) + int(fields[12]))
            if len(used) > 1 and used[-1] - used[-2] <= os.sysconf("SC_CLK_TCK") // 10:
                return
            time.sleep(1)
        self.fail(f"the server goes on working: {used}")

    def test_a_killed_client_leaves_no_server_behind(self):
        client = self.start()
        client.send_signal(signal.SIGKILL)
        client.wait()
        self.assert_no_process_left()

    def test_sigterm_ends_an_idle_server(self):
        with harness.server(self.dir):
            pass  # server() asserts exit status 0

    def test_sigterm_ends_a_busy_server_and_its_client_hears_of_it(self):
        with contextlib.ExitStack() as stack:
            server = stack.enter_context(harness.server(self.dir, "--grace", "1"))
            client = self.start("--server", server.address, "--retries", "0")
            started = time.monotonic()
            stack.close()
            self.assertLess(time.monotonic() - started, 11)
        stderr = client.communicate(timeout=15)[1]
        self.assertIn(client.returncode, (UNREACHABLE, REFUSED, STOPPED), stderr)
        self.assertFalse((self.dir / "out.vdb").exists())


if __name__ == "__main__":
    unittest.main()
