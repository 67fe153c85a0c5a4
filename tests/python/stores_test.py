"""Meshes and results on other machines: an S3 server on loopback, and its presigned URLs."""

import os
import signal
import socket
import threading

import latvox
import pytest
from harness import PATIENCE, octahedron, write_obj
from object_store import SECRET, ObjectStore, presign


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    folder = tmp_path_factory.mktemp("store")
    started = ObjectStore(folder)
    started.start()
    assert started.call("PUT", "bucket")[0] == 200
    started.put("bucket/mesh 1+.obj", write_obj(folder / "mesh.obj", octahedron()).read_bytes())
    yield started
    started.kill()


@pytest.fixture(autouse=True)
def surroundings(store, tmp_path, monkeypatch):
    """Only the store is known. At the end, no local copy is left."""
    for name in [name for name in os.environ if name.startswith("AWS_") or name.lower().endswith("_proxy")]:
        monkeypatch.delenv(name)
    for name, value in store.environment.items():
        monkeypatch.setenv(name, value)
    copies = tmp_path / "copies"
    copies.mkdir()
    monkeypatch.setenv("TMPDIR", str(copies))
    monkeypatch.setenv("HOME", str(tmp_path))
    yield
    assert list(copies.iterdir()) == []


def local(server, tmp_path):
    return server.voxelize(write_obj(tmp_path / "mesh.obj", octahedron()), resolution=9)


def test_meshes_and_results_of_s3(store, server, tmp_path):
    v = server.voxelize("s3://bucket/mesh 1+.obj", resolution=9, out=["s3://bucket/out.csv", tmp_path / "out.csv"])
    assert v.digest == local(server, tmp_path).digest
    for name in ("csv", "vdb", "npz"):
        v.save(f"s3://bucket/saved.{name}")
        v.save(tmp_path / f"saved.{name}")
        assert store.get(f"bucket/saved.{name}") == (tmp_path / f"saved.{name}").read_bytes()
    assert store.get("bucket/out.csv") == (tmp_path / "out.csv").read_bytes()
    assert store.get("bucket/saved.csv") == store.get("bucket/out.csv")


def test_batches_of_a_stream(server, tmp_path):
    with server.stream("s3://bucket/mesh 1+.obj", resolution=9) as stream:
        assert sum(map(len, stream)) == len(local(server, tmp_path))


def test_presigned_urls_keep_their_secrets(store, server, tmp_path):
    v = server.voxelize(presign("GET", store.port, "bucket", "mesh 1+.obj"), resolution=9)
    assert v.digest == local(server, tmp_path).digest
    assert "X-Amz-" not in str(v.report)
    v.save(presign("PUT", store.port, "bucket", "presigned.csv"))
    assert len(store.get("bucket/presigned.csv")) > 100
    v.save(presign("PUT", store.port, "bucket", "presigned.nrrd"), array="none")
    v.save(tmp_path / "saved.nrrd", array="none")
    assert store.get("bucket/presigned.nrrd") == (tmp_path / "saved.nrrd").read_bytes()
    with pytest.raises(latvox.Error) as refused:
        v.save(presign("GET", store.port, "bucket", "mesh 1+.obj"))
    assert "X-Amz-" not in str(refused.value) and SECRET not in str(refused.value)


def test_what_is_refused_is_named(server, tmp_path):
    with pytest.raises(latvox.NotFound, match="s3://bucket/none.obj") as caught:
        server.voxelize("s3://bucket/none.obj", resolution=9)
    assert (caught.value.field, caught.value.value) == ("mesh", "s3://bucket/none.obj")
    v = local(server, tmp_path)
    with pytest.raises(latvox.InvalidArgument, match=r'"s3://bucket/a.mhd": a .mhd is not one file') as caught:
        v.save("s3://bucket/a.mhd")
    assert (caught.value.reason, caught.value.field, caught.value.value) == ("BAD_SPEC", "path", "s3://bucket/a.mhd")
    for call, field in (
        (lambda name: server.voxelize(name, resolution=9), "mesh"),
        (lambda name: server.voxelize(tmp_path / "mesh.obj", resolution=9, out=name), "out"),
        (v.save, "path"),
    ):
        with pytest.raises(latvox.InvalidArgument, match="is not s3://BUCKET/KEY") as caught:
            call("s3:///a.csv")
        assert (caught.value.reason, caught.value.field, caught.value.value) == ("BAD_SPEC", field, "s3:///a.csv")
    for call, field in (
        (v.save, "path"),
        (lambda name: server.voxelize(tmp_path / "mesh.obj", resolution=9, out=name), "out"),
    ):
        with pytest.raises(latvox.NotFound) as caught:
            call("s3://none/a.csv")
        assert (caught.value.field, caught.value.value) == (field, "s3://none/a.csv")
    with pytest.raises(latvox.InvalidArgument, match="is not one of"):
        v.save("s3://bucket/a.xyz")
    with pytest.raises(latvox.InvalidArgument, match="bucket"):
        server.voxelize("s3:///none.obj", resolution=9)


def test_plain_http_to_other_machines_needs_an_argument(store, server, tmp_path):
    def elsewhere(method, name):
        """For latvox, this spelling of the loopback address is another machine."""
        return presign(method, store.port, "bucket", name).replace("127.0.0.1", "[::ffff:127.0.0.1]")

    v = local(server, tmp_path)
    for call, field in (
        (lambda **more: server.voxelize(elsewhere("GET", "mesh 1+.obj"), resolution=9, **more), "mesh"),
        (lambda **more: v.save(elsewhere("PUT", "a.csv"), **more), "path"),
    ):
        with pytest.raises(latvox.InvalidArgument, match="allow_http") as caught:
            call()
        error = caught.value
        assert (error.reason, error.field, error.limit) == ("BAD_SPEC", field, "https:")
        assert error.value.startswith("http://[")
        # The signature is about another host, so the store refuses: it was asked.
        with pytest.raises(latvox.Error, match="HTTP 403"):
            call(allow_http=True)


def test_an_interrupt_ends_a_save(server, tmp_path):
    v, connections = local(server, tmp_path), []
    with socket.create_server(("127.0.0.1", 0)) as listener:  # never answers

        def interrupt():
            connections.append(listener.accept()[0])
            os.kill(os.getpid(), signal.SIGINT)

        listener.settimeout(PATIENCE)
        thread = threading.Thread(target=interrupt, daemon=True)
        thread.start()
        with pytest.raises(KeyboardInterrupt):
            v.save(f"http://127.0.0.1:{listener.getsockname()[1]}/a.csv")
        thread.join()
    connections[0].close()
