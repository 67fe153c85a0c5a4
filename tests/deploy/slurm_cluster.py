"""A private Slurm: a controller and four nodes on this host, in a private network. Each node is a process namespace, so
killing it kills everything that runs there, as if the machine died. Needs root."""

import ctypes
import getpass
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402

SLURM = ROOT / "deploy" / "slurm"
SKIPPED = 77  # ctest's code for it
NODES = 4
CLONE_NEWNET = 0x40000000
PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "sinfo", "unshare", "ip"]
FIRST_PORT = 6820

CONFIGURATION = """
ClusterName=test
SlurmctldHost=localhost
SlurmctldPort=6817
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={directory}/munge.socket,cred_expire=5
StateSaveLocation={directory}/state
SlurmctldPidFile={directory}/slurmctld.pid
SlurmdPidFile={directory}/%n.pid
SlurmdSpoolDir={directory}/%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0,bf_interval=1
# A node that does not answer is given up after seconds; real clusters take minutes.
SlurmdTimeout=3
MessageTimeout=2
TCPTimeout=1
MailProg=/bin/true
# Jobs start again only if they ask for it.
JobRequeue=0
NodeName=n[0-{last}] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[{first_port}-{last_port}] CPUs=1
PartitionName=test Nodes=ALL Default=YES
"""


def skip(reason):
    print(f"SKIPPED: {reason}", file=sys.stderr)
    sys.exit(SKIPPED)


def require():
    """Ends the test if there can be no cluster, and says why. Moves this process into a network of its own."""
    absent = [name for name in PROGRAMS if shutil.which(name) is None]
    if absent:
        skip(f"{', '.join(absent)} not found; deploy/install-packages deploy")
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(CLONE_NEWNET) != 0:
        skip(f"no network of its own: {os.strerror(ctypes.get_errno())}")
    # A second address, because names are only resolved if there is one beside 127.0.0.1.
    for command in (["ip", "link", "set", "lo", "up"], ["ip", "address", "add", "198.18.0.1/32", "dev", "lo"]):
        if subprocess.run(command).returncode != 0:
            skip(f"{' '.join(command)} fails")
    if subprocess.run(["unshare", "--pid", "--fork", "--mount-proc", "true"]).returncode != 0:
        skip("no process namespaces")


def latvox(*words):
    done = harness.latvox(*words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def results(directory):
    """Returns the whole lines of the workers' results, by file."""
    return {path.name: [json.loads(line) for line in path.read_text().splitlines(True) if line.endswith("\n")]
            for path in directory.glob("results*.jsonl")}


class Cluster:
    def __init__(self, directory, environment, nodes):
        self.directory, self.processes, self.nodes = directory, [], {}
        self.environment = os.environ | environment | {"SLURM_CONF": str(directory / "slurm.conf")}
        values = {"user": getpass.getuser(), "directory": directory, "last": nodes - 1}
        values |= {"first_port": FIRST_PORT, "last_port": FIRST_PORT + nodes - 1}
        (directory / "slurm.conf").write_text(CONFIGURATION.format(**values))
        (directory / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        (directory / "state").mkdir()
        key = directory / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(1024))
        try:
            self.start_all(nodes)
        except BaseException:
            self.stop()
            raise

    def start_all(self, nodes):
        files = [f"--{name}-file={self.directory}/munge.{name}" for name in ("key", "pid", "log", "seed")]
        # Without --force it rejects a socket whose parent directories others can write: this one is below /tmp.
        self.start("munged", "--foreground", "--force", f"--socket={self.directory}/munge.socket", *files)
        self.wait("munged", lambda: (self.directory / "munge.socket").exists())
        self.start("slurmctld", "-D")
        for n in range(nodes):
            command = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc", "slurmd", "-D", "-N", f"n{n}"]
            self.nodes[f"n{n}"] = self.start(*command)
        self.wait("all nodes idle", lambda: self.run("sinfo", "--noheader", "--format=%t %D") == f"idle {nodes}", 60)

    def start(self, *command):
        log = open(self.directory / "cluster.log", "ab")
        self.processes.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log, cwd=self.directory))
        log.close()
        return self.processes[-1]

    def kill_node(self, name):
        self.nodes[name].kill()
        self.nodes[name].wait()

    def run(self, *command, **options):
        """Returns standard output of a command that must succeed, except sinfo, which asks while the controller starts."""
        options = {"env": self.environment, "capture_output": True, "text": True, "timeout": 120} | options
        done = subprocess.run([str(word) for word in command], **options)
        if done.returncode != 0 and command[0] != "sinfo":
            raise AssertionError(f"{command}: {done.stderr}{self.log()}")
        return done.stdout.strip()

    def jobs(self, job):
        """Returns Slurm's facts about a job, or about each task of an array: a list of field -> value."""
        lines = self.run("scontrol", "--oneliner", "show", "job", job).splitlines()
        return [dict(word.split("=", 1) for word in line.split() if "=" in word) for line in lines]

    def wait_for_job(self, job, seconds=180):
        """Waits until a job has ended, and returns its tasks."""
        ended = {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "OUT_OF_MEMORY"}
        self.wait(f"job {job}", lambda: all(task["JobState"] in ended for task in self.jobs(job)), seconds)
        return self.jobs(job)

    def wait(self, what, condition, seconds=30):
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > deadline:
                raise AssertionError(f"{what}: not within {seconds} s\n{self.log()}")
            time.sleep(0.05)

    def log(self):
        return (self.directory / "cluster.log").read_text(errors="replace")[-4000:]

    def stop(self):
        """Kills nodes first, with everything on them, and munged last, because the others ask it."""
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGKILL if process in self.nodes.values() else signal.SIGTERM)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


class ClusterCase(unittest.TestCase):
    """Tests with a cluster each. Jobs run in self.dir."""

    environment = {}  # of jobs, beside the environment of the test

    def setUp(self):
        self.dir = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="latvox-slurm-")))
        cluster = self.dir / "cluster"
        cluster.mkdir()
        path = f"{harness.BIN}:{os.environ['PATH']}"
        self.cluster = Cluster(cluster, {"PATH": path} | self.environment, NODES)
        self.addCleanup(self.cluster.stop)

    def submit(self, *command):
        """Returns the output of a command that submits a job: usually the job's id."""
        return self.cluster.run(*command, cwd=self.dir)

    def assert_all_completed(self, tasks):
        logs = "\n".join(path.read_text() for path in self.dir.glob("*.log"))
        self.assertEqual({(task["JobState"], task["ExitCode"]) for task in tasks}, {("COMPLETED", "0:0")}, logs)
