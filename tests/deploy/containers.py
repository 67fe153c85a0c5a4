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
import shutil
import subprocess
import sys
import time
import uuid

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402

STATE = pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "deploy"
BASE = "localhost/debian:bookworm-slim"
IMAGE = "localhost/latvox"
SKIPPED = 77

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


def skip(reason):
    print(f"SKIPPED: {reason}", file=sys.stderr)
    sys.exit(SKIPPED)


def require(*programs):
    if os.geteuid() != 0:
        skip("containers with networks and limits of their own need root")
    for program in ("podman", "buildah", "runc", "mmdebstrap", "ip", "nsenter", *programs):
        if shutil.which(program) is None:
            skip(f"{program} is not installed; deploy/install-packages deploy")
    for name, text in {"containers.conf": ENGINE, "storage.conf": STORAGE}.items():
        STATE.joinpath("work").mkdir(parents=True, exist_ok=True)
        STATE.joinpath(name).write_text(text.format(state=STATE, files=resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
    os.environ["CONTAINERS_CONF"] = str(STATE / "containers.conf")
    os.environ["CONTAINERS_STORAGE_CONF"] = str(STATE / "storage.conf")
    os.environ["TMPDIR"] = str(STATE / "work")  # buildah's caches
    os.environ["DISABLE_HC_SYSTEMD"] = "true"  # no timers: the tests check a container's health themselves
    os.environ.pop("XDG_RUNTIME_DIR", None)
    done = subprocess.run(["podman", "info"], capture_output=True, text=True)
    if done.returncode != 0:
        skip(f"podman does not run here: {done.stderr.strip()}")


def run(*command, check=True, timeout=120, **options):
    command = [str(word) for word in command]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL, **options)
    if check and done.returncode != 0:
        raise AssertionError(f"{' '.join(command)}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def podman(*arguments, **options):
    return run("podman", *arguments, **options).stdout.strip()


def inspect(what):
    return json.loads(podman("inspect", what))[0]


def exists(image):
    return run("podman", "image", "exists", image, check=False).returncode == 0


def package_sources():
    """Returns Debian's lines among this machine's own package sources, in the form of sources.list."""
    form = "deb $(REPO_URI) $(CODENAME) $(COMPONENT)"
    listed = run("apt-get", "indextargets", "--format", form, "Created-By: Packages", "Origin: Debian").stdout
    if not listed:
        skip("apt knows no package source of Debian; apt-get update")
    return "".join(f"{line}\n" for line in dict.fromkeys(listed.splitlines()))


def debian(name, *options, change=()):
    """Makes an image NAME of Debian 12 from this machine's package sources. `options` are mmdebstrap's; `change` is as
    in a Dockerfile."""
    if exists(name):
        return
    # The configuration by which this machine reaches its package sources.
    settings = run("apt-config", "dump", "Acquire").stdout.splitlines()
    chosen = [line for line in settings if line.lower().startswith(("acquire::http", "acquire::check"))]
    files = {"sources": package_sources(), "apt.conf": "\n".join(chosen) + "\n"}
    for file, text in files.items():
        (STATE / "work" / file).write_text(text)
    tar = STATE / "work" / "base.tar"
    with open(STATE / "work" / "sources") as sources:
        command = ["mmdebstrap", "--quiet", "--variant=minbase", f"--aptopt={STATE / 'work' / 'apt.conf'}"]
        command += [*options, "bookworm", tar, "-"]
        done = subprocess.run(command, stdin=sources, capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        skip(f"mmdebstrap cannot fetch Debian's packages here: {done.stderr.strip()[-500:]}")
    podman("import", "--quiet", *(f"--change={line}" for line in change), tar, name)
    tar.unlink()


def build(context, image, *options):
    """Builds the image as deploy/docs/image.md does, but from `debian`'s base. Returns the seconds that it took."""
    command = ["buildah", "bud", "--isolation=chroot", "--layers", "--pull-never", "--format=docker", "--timestamp=0"]
    command += [f"--build-arg=BASE={BASE}", "--file", pathlib.Path(context) / "deploy/Dockerfile", "--tag", image, *options]
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


def await_true(what, true, seconds=harness.PATIENCE):
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, what
        time.sleep(0.05)
