"""The basis of the fault suite's tests: servers that can be killed, a watch over their memory, clients, and figures.

$LATVOX_FAULTS_SECONDS sets the time of load in the longest tests, and with it the dose. The full dose is 600; continuous
integration uses the default. $LATVOX_FAULTS_SERVER is a latvoxd with a sanitizer, in place of that of $LATVOX_BIN: it
makes no promises of time and memory. Meshes and their expected voxels are made once, by `prepare.py`.
"""

import contextlib
import json
import math
import os
import pathlib
import shlex
import signal
import socket
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "e2e"))

import harness  # noqa: E402
from harness import BIN, Case, latvox  # noqa: E402

SECONDS = float(os.environ.get("LATVOX_FAULTS_SECONDS", "10"))
FULL = SECONDS >= 120  # the full dose, or nearly
SEED = int(os.environ.get("LATVOX_FAULTS_SEED", "1"))
SANITIZED = "LATVOX_FAULTS_SERVER" in os.environ
LATVOXD = pathlib.Path(os.environ.get("LATVOX_FAULTS_SERVER", BIN / "latvoxd"))
MESHES = ROOT / "build" / "faults" / "meshes"
OUT = ROOT / "build" / ("faults-sanitized" if SANITIZED else "faults")
JOBS = MESHES / "jobs.json"
MIB = 1 << 20


def two_cores():
    """The promises hold for this many cores, whatever the machine has. Children inherit it."""
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])


def free_port():
    """Returns a port that is free now. A server that must come back at the same address cannot ask for any port."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def ticks(pid):
    """Returns the processor seconds of one process."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def descendants(pid):
    """Returns the process and its descendants."""
    pids = [pid]
    for parent in pids:
        for task in pathlib.Path(f"/proc/{parent}/task").glob("*/children"):
            with contextlib.suppress(OSError):
                pids += map(int, task.read_text().split())
    return pids


def memory(pids):
    """Returns the bytes of all processes; shared memory counts once."""
    total = 0
    for pid in pids:
        with contextlib.suppress(OSError):
            for line in pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
                if line.startswith("Pss:"):
                    total += int(line.split()[1]) * 1024
    return total


class Watch:
    """Watches a server and its decoders every 100 ms: most bytes of the server, of one decoder, of all together."""

    def __init__(self, server):
        self.server = server
        self.peak = self.peak_decoder = self.peak_all = 0
        self.samples = self.most_threads = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self):
        while not self._over.wait(0.1):
            with contextlib.suppress(OSError, AttributeError):
                bytes_of = [memory([pid]) for pid in descendants(self.server.pid)]
                self.peak = max(self.peak, bytes_of[0])
                self.peak_decoder = max([self.peak_decoder, *bytes_of[1:]])
                self.peak_all = max(self.peak_all, sum(bytes_of))
                self.most_threads = max(self.most_threads, self.server.threads())
                self.samples += 1

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()
        assert self.samples, "the server was never seen at work, so nothing is known about it"


class Server:
    """A latvoxd that may be killed and restarted, always at the same address."""

    def __init__(self, directory, *options, name="latvoxd"):
        self.address = f"127.0.0.1:{free_port()}"
        self.options, self.log, self.process = options, directory / f"{name}.log", None
        self.start()

    @property
    def pid(self):
        return self.process.pid

    def start(self):
        with open(self.log, "ab") as log:
            command = [LATVOXD, "--listen", self.address, *self.options]
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        self.process.address = self.address

    def kill(self):
        self.process.kill()
        self.process.wait()

    def threads(self):
        return len(os.listdir(f"/proc/{self.pid}/task"))

    def niceness(self):
        """Returns pairs of name and number for each thread except the first."""
        found = []
        for stat in sorted(pathlib.Path(f"/proc/{self.pid}/task").glob("*/stat"), key=lambda path: int(path.parent.name)):
            with contextlib.suppress(OSError):
                name, _, fields = stat.read_text().partition("(")[2].rpartition(")")
                found.append((name, int(fields.split()[16])))
        return [(name, nice - found[0][1]) for name, nice in found]

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.pid}/fd"))

    def workers(self):
        return descendants(self.pid)[1:]

    def cpu(self):
        return sum(ticks(pid) for pid in descendants(self.pid))

    def lines(self, event=None):
        """Returns the log, as dictionaries."""
        parsed = []
        for line in self.log.read_text(errors="replace").splitlines():
            with contextlib.suppress(ValueError):
                fields = dict(word.split("=", 1) for word in shlex.split(line) if "=" in word)
                if event in (None, fields.get("event")):
                    parsed.append(fields)
        return parsed

    def tail(self):
        return "\n".join(self.log.read_text(errors="replace").splitlines()[-20:])


@contextlib.contextmanager
def server(directory, *options, name="latvoxd", healthy_at=None):
    """Runs a server that must be alive in the end, and exit with 0 when told to stop. `healthy_at`: one of its addresses
    in plain text, if the first has TLS."""
    running = Server(directory, *options, name=name)
    running.process.address = healthy_at or running.address
    try:
        harness.wait_until_healthy(running.process)
        yield running
        assert running.process.poll() is None, f"{name} ended with {running.process.returncode}: {running.tail()}"
        running.process.send_signal(signal.SIGTERM)
        code = running.process.wait(harness.PATIENCE)
        assert code == 0, f"{name} exited with {code}: {running.tail()}"
    finally:
        running.kill()


def faults(*arguments, **options):
    """Runs latvox_faults to its end."""
    command = [BIN / "latvox_faults", *map(str, arguments)]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, **options).stdout


class Swarm:
    """latvox_faults swarm, in the background."""

    def __init__(self, directory, address, seconds, *options, clients, roles, jobs=(), name="swarm"):
        self.records_file = directory / f"{name}.jsonl"
        command = [BIN / "latvox_faults", "swarm", "--server", address, "--jobs", JOBS, "--seed", str(SEED)]
        command += ["--records", self.records_file, "--clients", str(clients), "--roles", ",".join(roles)]
        command += ["--seconds", str(seconds), *[w for job in jobs for w in ("--job", job)], *map(str, options)]
        self.before = os.times()
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL)

    def wait(self, seconds):
        """Waits for the end, and returns the records."""
        code = self.process.wait(seconds)
        assert code == 0, f"the swarm exited with {code}"
        return self.records()

    def records(self):
        if not self.records_file.exists():
            return []
        return [json.loads(line) for line in self.records_file.read_text().splitlines() if line.endswith("}")]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()  # its clients die with it
        self.process.wait()


def select(records, outcome=None, **wanted):
    """Returns the records with these values; a tuple is a choice."""
    if outcome:
        wanted["outcome"] = outcome
    return [r for r in records if all(r[k] in v if isinstance(v, tuple) else r[k] == v for k, v in wanted.items())]


def percentile(values, percent):
    """Returns the least value that this percentage of the values does not exceed."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(len(ordered) * percent / 100) - 1)] if ordered else math.nan


def words(value):
    """Formats a figure for readers."""
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"
    return str(value)


def tally(values):
    """Counts each, as words: "3 a, 1 b"."""
    values = list(values)
    return ", ".join(f"{values.count(v)} {v}" for v in sorted(set(values))) or "none"


class Faults(Case):
    """A scenario of the suite. Its figures go into the report even if it fails."""

    scenario = None

    @classmethod
    def setUpClass(cls):
        two_cores()
        cls.figures = []
        cls.began = time.monotonic()
        with contextlib.suppress(FileNotFoundError):
            OUT.joinpath(f"{cls.scenario}.json").unlink()

    @classmethod
    def tearDownClass(cls):
        OUT.mkdir(parents=True, exist_ok=True)
        report = {
            "scenario": cls.scenario,
            "seconds": SECONDS,
            "seed": SEED,
            "took": time.monotonic() - cls.began,
            "figures": cls.figures,
        }
        (OUT / f"{cls.scenario}.json").write_text(json.dumps(report, indent=1) + "\n")

    def figure(self, what, value, unit="", promise="", kept=None):
        """Adds a line to the report. `kept`: whether the promise was kept; if not, the test fails."""
        self._add(what, value, unit, promise, {None: "", True: "yes", False: "no"}[kept])

    def bounded(self, what, value, unit, *, promised=None, fails_over):
        """Adds a line with a figure that noise may move. Above `promised`, the promise counts as missed, and the report
        says so. Only above `fails_over` does the test fail, because no noisy neighbor explains it."""
        if SANITIZED:
            return self._add(what, value, unit, "", "")
        promise = f"<= {promised}; fails over {fails_over}" if promised is not None else f"fails over {fails_over}"
        if not value <= fails_over:
            kept = f"no ({words(value)} > {fails_over})"
        elif promised is None:
            kept = ""
        elif value > promised:
            kept = f"missed ({words(value)} > {promised})"
        else:
            kept = "yes"
        self._add(what, value, unit, promise, kept)

    def _add(self, what, value, unit, promise, kept):
        """`kept`: yes, no or missed, the latter two perhaps with a reason; or nothing."""
        text = f"{words(value)} {unit}".strip()
        type(self).figures.append({"what": what, "value": value, "text": text, "promise": promise, "kept": kept})
        if kept.startswith("no"):
            with self.subTest(what):
                self.fail(f"{what}: {text}; promised: {promise}")

    def assert_serves(self, running, job="small bunny-64-bcc"):
        """A correct request gets the right answer in the end."""
        with Swarm(self.dir, running.address, 0.5, clients=1, roles=["good"], jobs=[job], name="last") as swarm:
            records = swarm.wait(60)
        done = select(records, "done")
        self.figure(
            "good requests afterwards",
            tally(r["outcome"] for r in records),
            "",
            "right",
            bool(done) and len(done) == len(records),
        )

    def all_done(self, records, what=""):
        """No call failed, for any reason."""
        promised = bool(records) and len(select(records, "done")) == len(records)
        self.figure(f"{what}calls", tally(r["outcome"] for r in records), "", "done, all of them", promised)

    def nothing_wrong(self, records, what=""):
        wrong = select(records, "wrong")
        lines = sorted({f"{r['role']} {r['job']}: {r['detail'][:200]}" for r in wrong})
        for line in lines[:10]:
            print(line, file=sys.stderr)
        self.figure(f"{what}wrong answers, lost jobs, crashed clients", len(wrong), "", "0", not wrong)
