"""A fresh Debian in a directory, made from the packages of this machine's own sources, with the power to start it.

    bootstrap(tar, *options)   makes an archive of a fresh Debian, of RELEASE or another one
    archive(tar, *options)     the same, unless it is there already and not old
                               Both skip the test if the packages are out of reach, or raise Unreachable with skips=False.
    Root(directory, archive)   unpacks it; runs commands in it; starts and stops systemd in it
    require_systemd(archive)   skips the test where that does not start
"""

import contextlib
import os
import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402
from harness import await_true  # noqa: E402

STATE = pathlib.Path(os.environ["LATVOX_BUILD_DIR"]) / "deploy"
OWN_RELEASE = platform.freedesktop_os_release()["VERSION_CODENAME"]
RELEASE = os.environ.get("LATVOX_DEBIAN", OWN_RELEASE)  # of the fresh Debian
SKIPPED = 77
DAYS = 30  # until Debian's updates count as missed


def skip(reason):
    print(f"SKIPPED: {reason}", file=sys.stderr)
    sys.exit(SKIPPED)


def require_programs(group, *programs):
    """Skips the test without root, or without one of the programs, which this group of deploy/packages has."""
    if os.geteuid() != 0:
        skip("containers with networks and limits of their own need root")
    for program in programs:
        if shutil.which(program) is None:
            skip(f"{program} is not installed; deploy/install-packages {group}")


def run(*command, check=True, timeout=120, **options):
    command = [str(word) for word in command]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL, **options)
    if check and done.returncode != 0:
        raise AssertionError(f"{' '.join(command)}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done


class Unreachable(Exception):
    pass


def bootstrap(tar, *options, release=RELEASE, skips=True):
    """Makes an archive of a fresh Debian from this machine's package sources. `options` are mmdebstrap's."""
    work = STATE / "work"
    work.mkdir(parents=True, exist_ok=True)
    unfinished = work / f"part-{pathlib.Path(tar).name}"  # a later run would take a part for the whole
    command = [ROOT / "deploy/packaging/bootstrap", release, unfinished, "--variant=minbase", *options]
    done = run(*command, check=False, timeout=1800)
    if done.returncode == 0:
        unfinished.rename(tar)
    else:
        unfinished.unlink(missing_ok=True)
        reason = f"mmdebstrap cannot fetch packages of {release} here: {done.stderr.strip()[-500:]}"
        if skips:
            skip(reason)
        raise Unreachable(reason)


def is_recent(path):
    """Whether the file is there and was written in the last DAYS."""
    return path.exists() and time.time() - path.stat().st_mtime < DAYS * 86400


def archive(tar, *options, release=RELEASE, skips=True):
    """Returns the archive. Makes it unless an equal call made it in the last DAYS."""
    made, wanted = tar.with_suffix(".made"), "\n".join([release, *options])
    if not (tar.exists() and is_recent(made) and made.read_text() == wanted):
        bootstrap(tar, *options, release=release, skips=skips)
        made.write_text(wanted)
    return tar


# Without systemd in the root: /proc and processes of its own, and this machine's network, which apt needs.
ENTER = 'mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" && exec chroot "$0" "$@"'


class SystemdDoesNotStart(Exception):
    pass


class Root:
    def __init__(self, directory, archive):
        self.path = pathlib.Path(directory)
        self.path.mkdir()
        run("tar", "--extract", "--file", archive, "--directory", self.path)
        self.inside = None  # while systemd runs: a prefix for commands

    def run(self, *command, **options):
        enter = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", ENTER, self.path]
        environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C.UTF-8"}
        return run(*(self.inside or enter), *command, env=environment, **options)

    def shell(self, script, **options):
        return self.run("bash", "-e", "-c", script, **options)

    def files(self):
        """Returns the paths of all files, except those in the kernel's own file systems."""
        found = run("find", self.path, "-xdev", "-printf", "/%P\n", timeout=300).stdout.splitlines()
        return {path for path in found if not path.startswith(("/proc/", "/sys/", "/dev/", "/run/", "/tmp/"))}

    @contextlib.contextmanager
    def systemd(self):
        """Runs systemd as process 1, with a loopback network alone. Commands then run beside it."""
        command = ["systemd-nspawn", "--quiet", "--boot", "--register=no", "--keep-unit", "--private-network"]
        command += ["--console=pipe", f"--directory={self.path}", f"--machine=latvox-{os.getpid()}"]
        nspawn = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        try:
            self.inside = ["nsenter", f"--target={self._leader(nspawn)}", "--all", "--"]
            self.run("systemctl", "is-system-running", "--wait", check=False)
            yield
            self.run("systemctl", "poweroff", check=False)
            nspawn.wait(60)
        finally:
            self.inside = None
            nspawn.kill()
            nspawn.communicate()

    def _leader(self, nspawn):
        """Waits for systemd."""
        deadline = time.monotonic() + 60
        while nspawn.poll() is None and time.monotonic() < deadline:
            for child in pathlib.Path(f"/proc/{nspawn.pid}/task/{nspawn.pid}/children").read_text().split():
                inside = ["nsenter", f"--target={child}", "--all", "--", "systemctl", "show-environment"]
                if run(*inside, check=False).returncode == 0:
                    return child
            time.sleep(0.2)
        nspawn.kill()
        raise SystemdDoesNotStart(nspawn.communicate()[0].decode()[-500:])


def require_systemd(archive):
    """Skips the test if systemd does not start in a container, because machines differ in control groups. A test of
    unittest cannot do that by itself: the run would count as passed."""
    with tempfile.TemporaryDirectory(prefix="root-", dir=STATE / "work") as directory:
        root = Root(pathlib.Path(directory) / "debian", archive)
        try:
            with root.systemd():
                pass
        except SystemdDoesNotStart as error:
            skip(f"systemd does not start in a container here: {error}")
