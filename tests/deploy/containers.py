"""Containers of the tests' own: podman and buildah with images and state in the build directory, and networks in a
network namespace. The machine's own containers are not touched. No registry is needed, because the base image is made
from the packages of this machine's own sources.

    containers.require(*programs)     ends the test with ctest's "skipped", and says why, if it cannot run here
    containers.podman(*arguments)     and buildah: run it, and return its output
    containers.Container(...)         a running container, removed with the test
"""

import contextlib
import json
import os
import pathlib
import resource
import subprocess
import time
import uuid

from debian_root import ROOT, STATE, await_true, bootstrap, require_programs, run, skip

BASE = "localhost/debian:bookworm-slim"
IMAGE = "localhost/latvox"

# runc, because crun stops on machines with control groups of both versions. cgroupfs and no journal, because systemd
# may not run here. No limits above those of this machine. Two folders are within graphroot, because the podman that
# conmon starts when a container has ended knows only graphroot, and looks there.
ENGINE = """
[containers]
log_driver = "k8s-file"
default_ulimits = ["nofile={files}:{files}", "nproc=4096:4096"]
[engine]
cgroup_manager = "cgroupfs"
events_logger = "file"
runtime = "runc"
image_default_transport = "docker://"
static_dir = "{state}/storage/libpod"
tmp_dir = "{state}/tmp"
volume_path = "{state}/storage/volumes"
[network]
network_backend = "netavark"
network_config_dir = "{state}/networks"
"""
STORAGE = """
[storage]
driver = "overlay"
graphroot = "{state}/storage"
runroot = "{state}/run"
"""


def require(*programs):
    require_programs("deploy", "podman", "buildah", "runc", "mmdebstrap", "ip", "nsenter", *programs)
    configure()
    done = subprocess.run(["podman", "info"], capture_output=True, text=True)
    if done.returncode != 0:
        skip(f"podman does not run here: {done.stderr.strip()}")


def configure():
    """Gives podman and buildah a place of their own."""
    for name, text in {"containers.conf": ENGINE, "storage.conf": STORAGE}.items():
        STATE.joinpath("work").mkdir(parents=True, exist_ok=True)
        STATE.joinpath(name).write_text(text.format(state=STATE, files=resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
    os.environ["CONTAINERS_CONF"] = str(STATE / "containers.conf")
    os.environ["CONTAINERS_STORAGE_CONF"] = str(STATE / "storage.conf")
    os.environ["TMPDIR"] = str(STATE / "work")  # buildah's caches
    os.environ["DISABLE_HC_SYSTEMD"] = "true"  # no timers: the tests check a container's health themselves
    os.environ.pop("XDG_RUNTIME_DIR", None)


def podman(*arguments, **options):
    return run("podman", *arguments, **options).stdout.strip()


def inspect(what):
    return json.loads(podman("inspect", what))[0]


def exists(image):
    return run("podman", "image", "exists", image, check=False).returncode == 0


def debian(name, *options, change=()):
    """Makes an image NAME of Debian 12 from this machine's package sources. `options` are mmdebstrap's; `change` is as
    in a Dockerfile."""
    if exists(name):
        return
    tar = STATE / "work" / "base.tar"
    bootstrap(tar, *options, release="bookworm")
    podman("import", "--quiet", *(f"--change={line}" for line in change), tar, name)
    tar.unlink()


def build(context, image, *options, file="deploy/Dockerfile"):
    """Builds the image as deploy/docs does, but from `debian`'s base. Returns the seconds that it took."""
    command = ["buildah", "bud", "--isolation=chroot", "--layers", "--pull-never", "--format=docker", "--timestamp=0"]
    command += [f"--build-arg=BASE={BASE}", "--file", pathlib.Path(context) / file, "--tag", image, *options]
    started = time.monotonic()
    run(*command, context, timeout=3000)
    return time.monotonic() - started


@contextlib.contextmanager
def network_namespace():
    """Makes a network namespace with a loopback device. Yields a prefix for commands that run in it."""
    name = f"latvox-{uuid.uuid4().hex[:8]}"
    run("ip", "netns", "add", name)
    try:
        inside = ["nsenter", f"--net=/run/netns/{name}", "--"]
        run(*inside, "ip", "link", "set", "lo", "up")
        yield inside
    finally:
        run("ip", "netns", "delete", name)


class Container:
    """A container that `podman run --detach` starts with `options`, then the image and its arguments."""

    def __init__(self, *options, prefix=()):
        self._prefix = prefix
        self.id = run(*prefix, "podman", "run", "--detach", *options).stdout.strip()

    def state(self):
        return inspect(self.id)["State"]

    def logs(self):
        done = run("podman", "logs", self.id)
        return done.stdout + done.stderr

    def wait(self, seconds=60):
        """Waits for the end, and returns the exit status."""
        return int(podman("wait", self.id, timeout=seconds))

    def start(self):
        run(*self._prefix, "podman", "start", self.id)

    def remove(self):
        run("podman", "rm", "--force", "--time", "0", "--volumes", self.id)
