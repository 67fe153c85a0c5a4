"""Servers, streams, threads, interrupts, forks and kills."""

import concurrent.futures
import contextlib
import io
import os
import pathlib
import pickle
import re
import signal
import socket
import threading
import time

import harness
import latvox
import numpy as np
import pytest
from harness import BUNNY, octahedron
from tls_test import Authority

MESH = tuple(np.array(part, float if n == 0 else int) for n, part in enumerate(octahedron()))
TOKEN = "alice-0123456789"
LONG = {"resolution": 6000, "verify": True}  # of the bunny: some seconds


def servers_of(pid):
    """Returns the ids of the latvoxd that a process has started."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            name, rest = stat.read_text().split("(", 1)[1].rsplit(")", 1)
        except OSError:
            continue
        if name == "latvoxd" and int(rest.split()[1]) == pid:
            found.append(int(stat.parent.name))
    return found


def ended(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def test_one_private_server_serves_all_calls_of_the_process():
    for resolution in (10, 11):
        latvox.voxelize(MESH, resolution=resolution)
    before = servers_of(os.getpid())
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        digests = list(pool.map(lambda n: latvox.voxelize(MESH, resolution=20 + n % 2).digest, range(12)))
    assert len(set(digests)) == 2 and digests[0::2] == digests[:1] * 6
    assert servers_of(os.getpid()) == before


def test_none_chooses_no_other_server():
    latvox.voxelize(MESH, resolution=9)
    before = set(latvox._calls._private.values())
    nothing = {name: None for name, facts in latvox.KEYWORDS.items() if facts["scope"] == "connection"}
    assert {"server", "tls", "token_file"} < nothing.keys()
    client, others = latvox._calls._choose({**nothing, "resolution": 9})
    assert client in before and others == {"resolution": 9}
    servers = servers_of(os.getpid())
    with latvox.stream(MESH, resolution=9, **nothing) as stream:
        assert sum(map(len, stream)) > 0 and servers_of(os.getpid()) == servers


def test_a_client_ends_its_server():
    before = set(servers_of(os.getpid()))
    with latvox.Client(threads=1) as client:
        (own,) = set(servers_of(os.getpid())) - before
        assert "--threads\x001" in pathlib.Path(f"/proc/{own}/cmdline").read_text()
        stream = client.stream(MESH, resolution=30)
    assert sum(map(len, stream)) > 0  # the stream keeps the connection
    del stream
    assert set(servers_of(os.getpid())) == before
    with pytest.raises(latvox.FailedPrecondition, match="closed"):
        client.voxelize(MESH)


def take_stream(finish):
    """Takes all batches of a stream, or the answer alone."""

    def take(mesh, **options):
        stream = latvox.stream(mesh, **options)
        return stream.finish() if finish else list(stream)

    return take


@pytest.mark.parametrize(
    "call",
    [latvox.voxelize, take_stream(False), take_stream(True), lambda mesh, **options: list(latvox.voxelize_many([mesh], **options))],
)
def test_a_lost_private_server_is_replaced(call):
    latvox.voxelize(MESH, resolution=9, threads=2)
    client = latvox._calls._private[2]
    (lost,) = [pid for pid in servers_of(os.getpid()) if "--threads\x002" in pathlib.Path(f"/proc/{pid}/cmdline").read_text()]
    os.kill(lost, signal.SIGKILL)
    with pytest.raises(latvox.Unavailable) as caught:
        call(MESH, resolution=9, threads=2)
    assert isinstance(caught.value, ConnectionError)
    assert latvox.voxelize(MESH, resolution=9, threads=2).digest
    assert latvox._calls._private.pop(2) is not client


def test_tls_and_a_token(tmp_path):
    authority = Authority(tmp_path, "authority")
    certificate, key = authority.issue("server", "server", "subjectAltName=IP:127.0.0.1")
    (tmp_path / "tokens").write_text(f"alice {TOKEN}\n")
    (tmp_path / "tokens").chmod(0o600)
    (tmp_path / "token").write_text(f"{TOKEN}\n")
    options = ["--tls-cert", certificate, "--tls-key", key, "--token-file", tmp_path / "tokens"]
    with harness.server(tmp_path, "--listen", "127.0.0.1:0", *options):
        address = harness.await_log(tmp_path, r"event=listening address=(127\.0\.0\.1:\d+)")
        ca = {"tls_ca": authority.root}
        expected = latvox.voxelize(MESH, resolution=20)
        with latvox.Client(address, token=TOKEN, **ca) as client:
            v = client.voxelize(MESH, resolution=20)
            assert np.array_equal(v.ijk, expected.ijk) and v.digest == expected.digest
            assert v.report["certificate"]["quantization_bits"] == expected.certificate["quantization_bits"]
            with pytest.raises(TypeError, match="server"):
                client.voxelize(MESH, server=address)
        assert latvox.voxelize(MESH, resolution=20, server=address, token_file=tmp_path / "token", **ca).digest == v.digest
        with pytest.raises(latvox.Unauthenticated) as caught, latvox.Client(address, token="bob-0123456789", **ca) as client:
            client.voxelize(MESH, resolution=20)
        assert isinstance(caught.value, PermissionError)
        with pytest.raises(latvox.Unavailable):
            latvox.Client(address, token=TOKEN, tls=True, timeout=5)


def test_wrong_connections(tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        with pytest.raises(latvox.Unavailable, match="127.0.0.1"):
            latvox.Client(f"127.0.0.1:{free.getsockname()[1]}")
    with pytest.raises(latvox.InvalidArgument, match="no port"):
        latvox.Client("no port")
    with pytest.raises(latvox.InvalidArgument, match="tls_ca requires server"):
        latvox.Client(tls_ca="root.crt")
    key = str(tmp_path / "key")
    pathlib.Path(key).write_text("no key\n")
    for wrong, limit in (("token_file", "one word"), ("tls_ca", "CERTIFICATE"), ("tls_cert", "CERTIFICATE")):
        for path, says in ((str(tmp_path / "none"), "cannot be read"), (key, "")):
            options = {"tls_cert": key, "tls_key": key} if wrong == "tls_cert" else {}
            with pytest.raises(latvox.InvalidArgument, match=f"^{path}: .*{says}") as caught:
                latvox.Client("127.0.0.1:1", **options | {wrong: path})
            error = caught.value
            assert (error.reason, error.field, error.value) == ("BAD_SPEC", wrong, path)
            assert limit in error.limit and "(field" not in str(error)
    with pytest.raises(latvox.InvalidArgument, match="tls_key requires tls_cert") as caught:
        latvox.Client("127.0.0.1:1", tls_key=key)
    assert caught.value.field == "tls_key"
    with pytest.raises(latvox.InvalidArgument, match="other characters") as caught:
        latvox.Client("127.0.0.1:1", token="secret word")
    assert caught.value.field == "token" and "secret" not in str(caught.value)
    with pytest.raises(TypeError, match="resolution"):
        latvox.Client(resolution=5)
    with pytest.raises(latvox.InvalidArgument, match="token requires server") as caught:
        latvox.Client(token="alice-0123456789")
    assert caught.value.field == "token"
    with pytest.raises(TypeError, match="token: is no str, but bytes") as caught:
        latvox.Client("127.0.0.1:1", token=b"secret")
    assert "secret" not in str(caught.value)


def test_a_stream_is_the_whole_in_order():
    v = latvox.voxelize(BUNNY, resolution=400, fields=["distance", "normal"])
    with latvox.stream(BUNNY, resolution=400, fields=["distance", "normal"]) as stream:
        batches = list(stream)
        assert len(batches) > 3
        for name in ("ijk", "points", "masks", "brick_ijk"):
            assert np.array_equal(np.concatenate([getattr(batch, name) for batch in batches]), getattr(v, name)), name
        for name in v.fields:
            assert np.array_equal(np.concatenate([batch[name] for batch in batches]), v[name], equal_nan=True)
        shares = [batch.progress for batch in batches]
        assert shares == sorted(shares) and 0 < shares[0] and shares[-1] <= 1
        answer = stream.finish()
        assert (answer.digest, answer.report["voxels"], len(answer)) == (v.digest, len(v), len(v))


def test_a_stream_is_finished_after_its_last_batch():
    with latvox.stream(BUNNY, resolution=400, fields=["distance", "normal"]) as stream:
        for _ in range(2):  # once before the first batch is there
            with pytest.raises(latvox.FailedPrecondition, match="the stream has batches left"):
                stream.finish()
        next(stream)
        with pytest.raises(latvox.FailedPrecondition, match="the stream has batches left"):
            stream.finish()
        assert len(list(stream)) > 3  # more than may wait
        assert stream.finish().digest
    with latvox.stream(BUNNY, **LONG) as stream:
        next(stream)
    with pytest.raises(latvox.Cancelled):
        stream.finish()


def test_the_answer_of_a_stream_has_no_voxels(tmp_path):
    with latvox.stream(MESH, resolution=20, fields="part") as stream:
        count = sum(map(len, stream))
        answer = stream.finish()
    takes = [lambda: answer.ijk, lambda: answer.points, lambda: answer.masks, lambda: answer.brick_ijk]
    takes += [lambda: answer["part"], lambda: answer.index_box, answer.dense]
    takes += [lambda: answer.save(tmp_path / "a.vdb"), lambda: answer.dense("part", ((0, 0, 0), (1, 1, 1)))]
    for take in takes:
        with pytest.raises(latvox.FailedPrecondition, match="the batches of the stream had the voxels"):
            take()
    assert answer._repr_png_() is None  # a notebook shows its text
    assert list(tmp_path.iterdir()) == [] and f"{count} voxels" in repr(answer) and answer.certificate and count > 0


def test_threads_share_the_batches_of_a_stream():
    expected = latvox.voxelize(BUNNY, resolution=400)
    for _ in range(5):
        with latvox.stream(BUNNY, resolution=400) as stream:

            def take():
                voxels = sum(map(len, stream))
                return voxels, stream.finish().digest

            with concurrent.futures.ThreadPoolExecutor(4) as pool:
                taken = [each.result() for each in [pool.submit(take) for _ in range(4)]]
        assert sum(voxels for voxels, _ in taken) == len(expected)
        assert {digest for _, digest in taken} == {expected.digest}


def test_a_stream_ends_when_it_is_left_or_wrong():
    with latvox.stream(BUNNY, **LONG) as stream:
        next(stream)
    with pytest.raises(latvox.Cancelled):
        list(stream)
    start = time.monotonic()
    dropped = latvox.stream(BUNNY, **LONG)
    next(dropped)
    del dropped
    assert time.monotonic() - start < 5
    with pytest.raises(latvox.NotFound):
        next(latvox.stream("missing.obj"))


def test_many_meshes_come_in_their_order():
    meshes = [(MESH[0] * (n + 1), MESH[1]) for n in range(9)]
    answers = list(latvox.voxelize_many(iter(meshes), jobs=3, voxel_size=0.25))
    assert [v.digest for v in answers] == [latvox.voxelize(mesh, voxel_size=0.25).digest for mesh in meshes]
    wrong = latvox.voxelize_many([MESH, "missing.obj", MESH], jobs=2, resolution=9)
    assert len(next(wrong)) > 0
    with pytest.raises(latvox.NotFound):
        next(wrong)


def test_the_number_of_jobs_is_checked_and_bounds_the_calls(server):
    for wrong in (0, -1, np.int64(-7)):
        with pytest.raises(latvox.InvalidArgument, match=rf"jobs: {wrong} is below 1") as caught:
            server.voxelize_many([MESH], jobs=wrong)
        assert (caught.value.field, caught.value.value, caught.value.limit) == ("jobs", str(wrong), "1")
    for wrong in (1.5, "2", True):
        with pytest.raises(TypeError, match="jobs: .* is not a whole number"):
            latvox.voxelize_many([MESH], jobs=wrong)
    allowed = os.sched_getaffinity(0)
    for jobs, taken in ((1, 1), (np.int64(2), 2), (None, 1)):
        given = []
        if jobs is None:
            os.sched_setaffinity(0, list(allowed)[:1])
        try:
            answers = server.voxelize_many((given.append(n) or MESH for n in range(5)), jobs=jobs, resolution=9)
        finally:
            os.sched_setaffinity(0, allowed)
        next(answers)
        assert len(given) == taken + 1  # the next mesh is ready when the first answer is taken
        answers.close()


def test_one_path_is_no_list_of_meshes(server):
    for paths in ("bunny.obj", BUNNY):
        for call in (latvox.voxelize_many, server.voxelize_many):
            with pytest.raises(TypeError, match="meshes: .*bunny.obj.* is one path; pass a list"):
                call(paths)


def test_a_client_has_one_address():
    with pytest.raises(TypeError, match="address: 'a:1' and server: 'b:2' exclude each other"):
        latvox.Client("a:1", server="b:2")


def test_an_open_mesh_of_arrays_is_named_once(server):
    with pytest.raises(latvox.InvalidArgument, match="^mesh: it is not closed"):
        server.voxelize((MESH[0], MESH[1][:-1]), resolution=9, set="solid")


def test_progress_grows_and_an_error_in_it_ends_the_call():
    shares = []
    latvox.voxelize(BUNNY, resolution=2500, progress=shares.append)
    assert shares == sorted(shares) and 0 <= shares[0] and shares[-1] == 1
    short = []
    latvox.voxelize(MESH, resolution=9, progress=short.append)
    assert short[-1] == 1

    def fail(share):
        raise LookupError(share)

    with pytest.raises(LookupError):
        latvox.voxelize(BUNNY, progress=fail, **LONG)


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (io.StringIO, "".join(f"latvox: {percent:3d} %\n" for percent in range(10, 101, 10))),
        (Terminal, "".join(f"\rlatvox: {percent:3d} %" for percent in range(1, 101)) + "\r\x1b[K"),
    ],
)
def test_progress_is_shown_when_it_changes(kind, expected):
    with kind() as stream:
        shown = latvox._calls._Shown(stream)
        for thousandth in range(1001):
            for _ in range(3):
                shown(thousandth / 1000)
        shown.end()
        assert stream.getvalue() == expected


@pytest.mark.parametrize("kind", [io.StringIO, Terminal])
def test_a_call_shows_progress_if_it_has_some_to_tell(kind):
    with contextlib.redirect_stderr(kind()) as stream:
        with pytest.warns(latvox.VoxelizeWarning, match="no voxel lies in the region"):
            latvox.voxelize(MESH, resolution=9, region=(900, 0, 0, 901, 1, 1), progress=True)
        assert stream.getvalue() == ""
        latvox.voxelize(BUNNY, resolution=2500, progress=True)
    told = [int(number) for number in re.findall(r"(\d+) %", stream.getvalue())]
    assert told and told == sorted(set(told)) and told[0] > 0 and told[-1] <= 100
    assert stream.getvalue().endswith("\r\x1b[K" if kind is Terminal else " %\n")


def test_progress_needs_no_standard_error(capsys):
    with contextlib.redirect_stderr(None):  # as in a program without a console
        latvox.voxelize(BUNNY, resolution=2500, progress=True)
    assert capsys.readouterr() == ("", "")


def test_timeout():
    with pytest.raises(latvox.DeadlineExceeded) as caught:
        latvox.voxelize(BUNNY, timeout=0.2, **LONG)
    assert isinstance(caught.value, TimeoutError)


def test_other_threads_run_meanwhile():
    counted, stop = [0], threading.Event()

    def count():
        while not stop.wait(0.001):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    latvox.voxelize(BUNNY, resolution=1500)
    stop.set()
    thread.join()
    assert counted[0] > 20


def test_errors_can_be_pickled():
    with pytest.raises(latvox.InvalidArgument) as caught:
        latvox.voxelize(MESH, resolution=1)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.field, type(again)) == (str(caught.value), "resolution", latvox.InvalidArgument)
    warning = pickle.loads(pickle.dumps(latvox.VoxelizeWarning("text", "CODE", "")))
    assert (str(warning), warning.code) == ("text", "CODE")


SIGNALLED = """
import latvox, os, sys, time
latvox.voxelize(os.environ["BUNNY"], resolution=9)
print("ready", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    print(len(latvox.voxelize(os.environ["BUNNY"], resolution=9)) > 0, flush=True)
"""


@pytest.mark.parametrize(
    "call",
    [
        "latvox.voxelize(os.environ['BUNNY'], resolution=6000, verify=True)",
        "[time.sleep(1) for _ in latvox.stream(os.environ['BUNNY'], resolution=6000, verify=True)]",
        "os.mkfifo('pipe.obj') or latvox.voxelize('pipe.obj')",
        "list(latvox.voxelize_many([os.environ['BUNNY']] * 4, jobs=2, resolution=4000, verify=True))",
    ],
)
def test_an_interrupt_cancels_the_call(run, call):
    process = run(SIGNALLED.format(call=call))
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.5)
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert time.monotonic() - start < 3
    assert process.communicate(timeout=30) == ("True\n", "")
    assert process.returncode == 0


# On one core, because on many a file may be complete before the first look at it.
WRITING = """
import os
os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
import latvox
v = latvox.voxelize(os.environ["BUNNY"], resolution={resolution}, fields="distance")
v.save("full{extension}")
os.mkdir("out")
print(os.stat("full{extension}").st_size, flush=True)
try:
    v.save("out/o{extension}")
except KeyboardInterrupt:
    print(os.listdir("out"), len(v.ijk) > 0, flush=True)
"""


@pytest.mark.parametrize(("extension", "resolution"), [(".npz", 900), (".cells.vtu", 400)])
def test_an_interrupt_ends_the_writing_of_a_file(run, extension, resolution):
    """It comes when an eighth is written, and what follows is less than the rest."""
    process = run(WRITING.format(extension=extension, resolution=resolution))
    size, before = int(process.stdout.readline()), harness.bytes_written(process.pid)
    harness.await_true("an eighth is written", lambda: harness.bytes_written(process.pid) > before + size / 8)
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "[] True\n"
    assert harness.bytes_written(process.pid) < before + size * 3 / 4
    assert process.communicate(timeout=60) == ("", "") and process.returncode == 0


DAEMON = """
import latvox, os, threading, time
begin = threading.Event()

def work():
    for share in ({call}):
        pass

threading.Thread(target=work, daemon=True).start()
assert begin.wait(50), "no call began"
"""


@pytest.mark.parametrize(
    "call",
    [
        "[latvox.voxelize(os.environ['BUNNY'], resolution=6000, verify=True, progress=lambda _: begin.set())]",
        "(begin.set() for _ in latvox.stream(os.environ['BUNNY'], resolution=6000, verify=True))",
        "(begin.set() or latvox.voxelize(os.environ['BUNNY'], resolution=9) for _ in iter(int, 1))",
    ],
)
def test_a_program_ends_in_spite_of_daemon_threads(run, call):
    process = run(DAEMON.format(call=call))
    _, error = process.communicate(timeout=60)
    assert process.returncode == 0, error
    assert "terminate" not in error


def test_a_killed_process_leaves_no_server(run):
    process = run(SIGNALLED.format(call="latvox.voxelize(os.environ['BUNNY'], resolution=6000, verify=True)"))
    assert process.stdout.readline() == "ready\n"
    (server,) = servers_of(process.pid)
    process.kill()
    harness.await_true("the server goes on", lambda: ended(server))


def test_a_process_that_ends_leaves_no_server(run):
    process = run("import latvox, os\nlatvox.voxelize(os.environ['BUNNY'], resolution=9)\nprint(os.getpid(), flush=True)\ninput()")
    process.stdout.readline()
    (server,) = servers_of(process.pid)
    process.communicate()
    harness.await_true("the server goes on", lambda: ended(server))


FORKED = """
import latvox, os, sys, warnings
mesh = os.environ["BUNNY"]
{before}
warnings.filterwarnings("ignore", ".* is multi-threaded", DeprecationWarning)  # Python from 3.12 on
pid = os.fork()
if pid == 0:
    try:
        print(len(latvox.voxelize(mesh, resolution=9)), flush=True)
    except latvox.FailedPrecondition as error:
        print(error, flush=True)
    sys.exit(0)
assert os.waitpid(pid, 0) == (pid, 0)
print(len(latvox.voxelize(mesh, resolution=9)))
"""


def test_a_fork_before_the_first_call_has_its_own_server(run):
    out, error = run(FORKED.format(before="")).communicate(timeout=20)
    lines = out.split()
    assert error == "" and len(lines) == 2 and lines[0] == lines[1]


def test_a_fork_after_a_grid_was_saved_ends(run):
    saved = "with tempfile.TemporaryDirectory() as folder: v.save(folder + '/v.vdb')"
    process = run(FORKED.format(before=f"import tempfile\nv = latvox.voxelize(mesh, resolution=9)\n{saved}"))
    out, error = process.communicate(timeout=20)
    assert error == "" and process.returncode == 0 and len(out.splitlines()) == 2, (out, error)


def test_a_fork_after_a_call_cannot_use_files_either(run, tmp_path):
    before = "v = latvox.voxelize(mesh, resolution=9, out='v.vdb')"
    calls = ["v.save('w.npy')", "latvox.open('v.vdb')", "latvox.convert('v.vdb', 'w.npy')", "latvox.merge(['v.vdb'], 'w.vdb')"]
    program = FORKED.format(before=f"{before}\ncalls = {calls}").replace(
        "print(len(latvox.voxelize(mesh, resolution=9)), flush=True)",
        "for call in calls:\n            try:\n                eval(call)\n            except latvox.FailedPrecondition as error:"
        "\n                print(error, flush=True)",
        1,
    )
    process = run(program)
    out, error = process.communicate(timeout=60)
    assert error == "" and process.returncode == 0, (out, error)
    refusals = out.splitlines()[:-1]
    assert len(refusals) == len(calls) and all(f"is a fork of process {process.pid}" in each for each in refusals), out
    assert [path.name for path in tmp_path.iterdir()] == ["v.vdb"]


def test_a_fork_after_only_a_file_was_read_refuses(run, tmp_path):
    latvox.voxelize(MESH, resolution=9, out=tmp_path / "v.vdb")
    out, error = run(FORKED.format(before="latvox.open('v.vdb')")).communicate(timeout=60)
    assert error == "" and "which had used latvox before" in out.splitlines()[0], (out, error)


def test_a_fork_after_a_call_refuses_and_leaves_the_parents_server_alone(run):
    before = "client, v = latvox.Client(), latvox.voxelize(mesh, resolution=9)\nstream = client.stream(mesh, resolution=900)"
    process = run(FORKED.format(before=before))
    out, error = process.communicate(timeout=20)
    assert error == "" and process.returncode == 0, (out, error)
    refusal, count = out.splitlines()
    assert f"is a fork of process {process.pid}, which had used latvox before" in refusal and count.isdigit()
