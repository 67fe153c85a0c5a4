"""An S3 server on loopback: Debian's OpenStack Swift, all of it in one process, with its files in a folder.

It checks signatures (version 4 of AWS), lengths, Content-MD5 and x-amz-content-sha256. An object appears when it is whole.
After kill -9, a new process with the same folder has the same objects.
Usage: object_store.py FOLDER PORT
"""

import datetime
import hashlib
import hmac
import http.client
import os
import pathlib
import socket
import subprocess
import sys
import time
import urllib.parse

KEY, SECRET, REGION = "test:tester", "not-a-secret/+", "eu-test-7"


def sign(key, text):
    return hmac.new(key, text.encode(), hashlib.sha256).digest()


def presign(method, port, bucket, key, seconds=3600):
    """Returns a URL that lets its reader in, by AWS's description of the signature's version 4."""
    now = datetime.datetime.now(datetime.timezone.utc).strftime("%Y%m%dT%H%M%SZ")
    scope = f"{now[:8]}/{REGION}/s3/aws4_request"
    query = {"X-Amz-Algorithm": "AWS4-HMAC-SHA256", "X-Amz-Credential": f"{KEY}/{scope}", "X-Amz-Date": now,
             "X-Amz-Expires": str(seconds), "X-Amz-SignedHeaders": "host"}
    words = urllib.parse.urlencode(sorted(query.items()), quote_via=urllib.parse.quote, safe="")
    path = urllib.parse.quote(f"/{bucket}/{key}")
    request = f"{method}\n{path}\n{words}\nhost:127.0.0.1:{port}\n\nhost\nUNSIGNED-PAYLOAD"
    secret = f"AWS4{SECRET}".encode()
    for part in scope.split("/"):
        secret = sign(secret, part)
    text = f"AWS4-HMAC-SHA256\n{now}\n{scope}\n{hashlib.sha256(request.encode()).hexdigest()}"
    return f"http://127.0.0.1:{port}{path}?{words}&X-Amz-Signature={sign(secret, text).hex()}"


class ObjectStore:
    """The server as a process of its own."""

    def __init__(self, folder, patience=60):
        self.folder, self.patience = pathlib.Path(folder), patience
        self.folder.mkdir(parents=True, exist_ok=True)
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.process = None

    @property
    def environment(self):
        """Returns the variables with which AWS's tools find it."""
        return {"AWS_ACCESS_KEY_ID": KEY, "AWS_SECRET_ACCESS_KEY": SECRET, "AWS_REGION": REGION,
                "AWS_ENDPOINT_URL_S3": f"http://127.0.0.1:{self.port}"}

    def start(self):
        with open(self.folder / "log", "ab") as log:
            command = ["/usr/bin/python3", "-B", __file__, self.folder, str(self.port)]
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        deadline = time.monotonic() + self.patience
        while time.monotonic() < deadline and self.process.poll() is None:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", self.port)) == 0:
                    return
            time.sleep(0.02)
        raise RuntimeError(f"the store does not start: {(self.folder / 'log').read_text()[-2000:]}")

    def kill(self):
        self.process.kill()
        self.process.wait()

    def call(self, method, path, body=b""):
        """Returns status, headers and body of a call of the test's own."""
        url = presign(method, self.port, *path.lstrip("/").split("/", 1)) if "/" in path.strip("/") else presign(method, self.port, path.strip("/"), "")
        at = urllib.parse.urlsplit(url)
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=self.patience)
        try:
            connection.request(method, f"{at.path}?{at.query}", body)
            answer = connection.getresponse()
            return answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()
        finally:
            connection.close()

    def put(self, path, body):
        status, _, answer = self.call("PUT", path, body)
        assert status == 200, (status, answer)

    def get(self, path):
        """Returns the body, or None."""
        status, _, body = self.call("GET", path)
        assert status in (200, 404), (status, body)
        return body if status == 200 else None

    def notes(self, path):
        return {name: value for name, value in self.call("HEAD", path)[1].items() if name.startswith("x-amz-meta-")}


class Cache:
    """Swift otherwise keeps these values in memcached."""

    def __init__(self):
        self.values = {}

    def get(self, key, **_):
        return self.values.get(key)

    def set(self, key, value, **_):
        self.values[key] = value

    def delete(self, key, **_):
        self.values.pop(key, None)

    def incr(self, key, delta=1, **_):
        self.values[key] = self.values.get(key, 0) + delta
        return self.values[key]


def backends(folder, conf, logger):
    """Returns a listener and an application of each kind, with a ring of one device in the folder."""
    import eventlet
    from swift.account.server import AccountController
    from swift.common.ring import RingBuilder
    from swift.container.server import ContainerController
    from swift.obj.server import ObjectController

    (folder / "devices/disk").mkdir(parents=True, exist_ok=True)
    made = []
    for kind, controller in (("account", AccountController), ("container", ContainerController), ("object", ObjectController)):
        listener = eventlet.listen(("127.0.0.1", 0))
        place = {"ip": "127.0.0.1", "port": listener.getsockname()[1]}
        builder = RingBuilder(1, 1, 0)
        builder.add_dev({"region": 1, "zone": 1, "weight": 1.0, "device": "disk", "meta": "", **place,
                         **{f"replication_{name}": value for name, value in place.items()}})
        builder.rebalance()
        builder.get_ring().save(str(folder / f"{kind}.ring.gz"))
        made.append((listener, controller(conf, logger)))
    return made


def end_with(parent):
    """Ends this process soon after its parent, however that ended."""
    import eventlet

    while os.getppid() == parent:
        eventlet.sleep(0.5)
    os._exit(0)


def serve(folder, port):
    import eventlet

    parent = os.getppid()
    eventlet.monkey_patch()
    import eventlet.wsgi
    from swift.common import utils
    from swift.common.middleware import catch_errors, gatekeeper, slo, tempauth
    from swift.common.middleware.s3api import s3api
    from swift.proxy.server import Application

    utils.HASH_PATH_PREFIX, utils.HASH_PATH_SUFFIX = b"", b"test"
    utils.validate_configuration = lambda: None  # of /etc/swift
    conf = {
        "devices": str(folder / "devices"), "swift_dir": str(folder), "recon_cache_path": str(folder), "mount_check": "false",
        "fallocate_reserve": "0", "disable_fallocate": "true", "account_autocreate": "true", "auth_pipeline_check": "false",
        "user_test_tester": f"{SECRET} .admin", "location": REGION,
    }
    logger = utils.get_logger(conf, "store")
    for listener, application in backends(folder, conf, logger):
        eventlet.spawn(eventlet.wsgi.server, listener, application, log_output=False, debug=False)
    application = Application(conf, logger)
    application._pipeline_final_app = application
    for layer in (slo, tempauth, s3api, gatekeeper, catch_errors):
        application = layer.filter_factory(conf)(application)
    eventlet.spawn(end_with, parent)
    cache = Cache()
    whole = application

    def with_cache(environment, start_response):
        return whole({**environment, "swift.cache": cache}, start_response)

    eventlet.wsgi.server(eventlet.listen(("127.0.0.1", port), reuse_addr=True, reuse_port=False), with_cache, log_output=False, debug=False)


if __name__ == "__main__":
    serve(pathlib.Path(sys.argv[1]), int(sys.argv[2]))
