"""The Debian packages of build/packages: judged by lintian, then installed, used, upgraded, removed and purged in a fresh
Debian, with systemd as its process 1. `tests/run --packages` makes the packages first. LATVOX_DEBIAN, if set, is the
release of build/RELEASE/packages. LATVOX_ARCHITECTURE=arm64 are those of build/arm64/packages."""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import debian_root
from debian_root import ROOT, STATE, Root, await_true, run

OWN_ARCHITECTURE = run("dpkg", "--print-architecture").stdout.strip()
ARCHITECTURE = os.environ.get("LATVOX_ARCHITECTURE", OWN_ARCHITECTURE)
PACKAGES = pathlib.Path(ROOT, "build", os.environ.get("LATVOX_DEBIAN", ""), "" if ARCHITECTURE == OWN_ARCHITECTURE else ARCHITECTURE, "packages")
PAGE = (ROOT / "deploy/docs/packages.md").read_text()
NAMES = ("latvox", "latvoxd", "liblatvox-dev", "python3-latvox")
BUNNY = "/usr/share/glmark2/models/bunny.obj"
ADDRESS = "127.0.0.1:50151"
MULTIARCH = run("dpkg-architecture", f"-a{ARCHITECTURE}", "-qDEB_HOST_MULTIARCH").stdout.strip()
UNIT = "/usr/lib/systemd/system/latvoxd.service"
SOCKET = "/usr/lib/systemd/system/latvoxd.socket"
FILES = {
    "latvox": {"/usr/bin/latvox", f"/usr/lib/{MULTIARCH}/latvox/latvox-vdb.so", "/usr/share/man/man1/latvox.1.gz", "/usr/share/bash-completion/completions/latvox",
               "/usr/share/zsh/site-functions/_latvox", "/usr/share/fish/vendor_completions.d/latvox.fish",
               "/usr/bin/latvoxd", "/usr/share/man/man8/latvoxd.8.gz"},
    "latvoxd": {UNIT, SOCKET, "/etc/latvox/latvoxd.toml", "/usr/share/doc/latvoxd/examples/credentials.conf"},
    "liblatvox-dev": {"/usr/include/latvox/client.h", "/usr/share/latvox/proto/latvox/v1/voxelizer.proto"},
    "python3-latvox": {"/usr/lib/python3/dist-packages/latvox/__init__.py"},
}  # fmt: skip
OUTSIDE = "192.0.2.7"  # an address that no machine has
METRICS = "import urllib.request as r; print(r.urlopen('http://127.0.0.1:9464/metrics').read().decode())"
# Files that apt, dpkg, ldconfig and systemd keep for themselves after a package is gone.
THEIRS = r"/var/(cache|log|lib/(apt|dbus|dpkg|systemd))/|/etc/(machine-id|ld\.so\.cache|\.pwd\.lock|hosts)|/(etc|var)/\.updated|.*/__pycache__"


def package(name):
    (found,) = PACKAGES.glob(f"{name}_*.deb")
    return found


def fields(name):
    """Returns the fields of a package's control file."""
    return dict(re.findall(r"^(\S+): (.*)$", run("dpkg-deb", "--field", package(name)).stdout, re.M))


def contents(path):
    """Returns the paths of a package's files: path -> permissions and owner."""
    lines = [line.split(None, 5) for line in run("dpkg-deb", "--contents", path).stdout.splitlines()]
    return {words[5].split(" -> ")[0].removeprefix("."): (words[0], words[1]) for words in lines}


def debian():
    return STATE / f"{debian_root.RELEASE}.tar"


def repacked(name, change, folder, target):
    """Packs a package's files again, after `change` of its unpacked folder and of the text of its control file."""
    tree = folder / name
    run("dpkg-deb", "--raw-extract", package(name), tree)
    control = tree / "DEBIAN/control"
    control.write_text(change(tree, control.read_text()))
    run("dpkg-deb", "-Zgzip", "--build", tree, target, timeout=600)
    shutil.rmtree(tree)


def newer(_, control):
    version = re.search(r"^Version: (.*)$", control, re.M)[1]
    return control.replace(version, version + "+1")


def fresh(directory, name):
    """Unpacks a fresh Debian with the packages in /packages."""
    root = Root(pathlib.Path(directory) / name, debian())
    (root.path / "packages").mkdir()
    for each in NAMES:
        shutil.copy(package(each), root.path / "packages")
    return root


def checksums():
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in PACKAGES.glob("*.deb")}


class Packages(unittest.TestCase):
    def test_lintian_finds_no_error_and_no_warning(self):
        done = run("lintian", "--allow-root", "--fail-on", "error,warning", *map(package, NAMES), check=False, timeout=300)
        self.assertEqual((done.returncode, done.stdout), (0, ""))

    def test_equal_commits_make_equal_packages(self):
        """The build is finished, so this packs its files again."""
        before = checksums()
        there = ["deploy/packaging/in-debian", debian_root.RELEASE] if "LATVOX_DEBIAN" in os.environ else []
        architecture = [ARCHITECTURE] if ARCHITECTURE != OWN_ARCHITECTURE else []
        run(*there, "deploy/packaging/build", *architecture, cwd=ROOT, timeout=1800)
        self.assertEqual(checksums(), before, "or these packages are of another commit")

    def test_each_package_has_its_files_and_no_other_has_them(self):
        found = {name: contents(package(name)) for name in NAMES}
        for name in NAMES:
            with self.subTest(name):
                documents = {f"/usr/share/doc/{name}/{file}" for file in ("copyright", "changelog.gz", "changelog.Debian.gz")}
                # No other package has the notices of libraries that are headers. The service is a unit alone.
                documents |= {f"/usr/share/doc/{name}/notices/{library}.gz" for library in ("libcli11-dev", "nlohmann-json3-dev") if name != "latvoxd"}
                self.assertLessEqual(FILES[name] | documents, found[name].keys())
                self.assertEqual({owner for _, owner in found[name].values()}, {"root/root"})
                self.assertEqual({mode[5] + mode[8] for mode, _ in found[name].values() if mode[0] != "l"}, {"--"})
        paths = [path for files in found.values() for path in files if not path.endswith("/")]
        self.assertEqual(len(paths), len(set(paths)))

    def test_dependencies_are_those_of_the_programs(self):
        facts = {name: fields(name) for name in NAMES}
        for name, library in ("latvox", "libopenvdb"), ("latvox", "libgrpc++"), ("python3-latvox", "libgrpc++"):
            self.assertRegex(facts[name]["Depends"], rf"\b{re.escape(library)}\S* \(>= ")
        self.assertNotIn("openvdb", facts["python3-latvox"]["Depends"])  # it has the module of latvox load it
        version = facts["latvox"]["Version"]
        self.assertEqual({each["Version"] for each in facts.values()}, {version})
        self.assertEqual({each["Architecture"] for each in facts.values()}, {ARCHITECTURE})
        self.assertNotIn("latvoxd", facts["latvox"]["Depends"])
        self.assertEqual(facts["latvoxd"]["Depends"], f"latvox (= {version})")
        self.assertIn(f"latvox (= {version})", facts["python3-latvox"]["Depends"])
        self.assertRegex(facts["python3-latvox"]["Depends"], r"python3 \(>= 3\.\d+\), python3 \(<< 3\.\d+\)")


class InRoot(unittest.TestCase):
    # Recommended packages of libraries would stay, because others suggest them.
    install = "apt-get install -y -qq --no-install-recommends /packages/{latvox,latvoxd,python3-latvox}_*.deb"

    @classmethod
    def setUpClass(cls):
        cls.dir = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="root-", dir=STATE / "work")))
        cls.root = fresh(cls.dir, "debian")
        cls.before = cls.root.files()
        cls.root.run("apt-get", "update", "-qq")
        cls.root.shell(cls.install, timeout=1200)


class FirstCommand:
    def test_the_first_command_of_the_readme_makes_its_file(self):
        block, told = re.search(r"^## Three commands$.*?^```sh\n(.*?)^```.*?^```text\n(.*?)^```", (ROOT / "README.md").read_text(), re.M | re.S).groups()
        self.assertIn("-o bunny.vdb", block)
        done = self.root.shell(f"cd /tmp; {block} latvox info bunny.vdb", timeout=60)  # a promise, with time to spare
        digest = re.search(r"digest (\w{32})", told)[1]
        self.assertIn(f"latvox_digest = {digest}", done.stdout)


class WithoutDrivers(FirstCommand, InRoot):
    """The tool and the bunny alone, as the page says."""

    install = "cd /packages; " + re.search(r"^apt-get install( --no-install-recommends ./latvox_\*.deb .*)", PAGE, re.M).expand(r"apt-get install -y\1")

    def test_no_driver_for_graphics_comes_along(self):
        installed = self.root.run("dpkg-query", "-W", "-f=${Package}\n").stdout.split()
        self.assertIn("glmark2-data", installed)
        self.assertEqual([name for name in installed if re.match("glmark2-(?!data)|libegl|libgbm|libgl1|libllvm|mesa-", name)], [])


class AsTheReadmeSays(FirstCommand, InRoot):
    """The tool alone, with apt's own settings."""

    install = "cd /packages; apt-get install -y ./latvox_*.deb"

    def test_the_libraries_that_a_call_loads_late_are_there(self):
        self.root.shell(f"cd /tmp; latvox voxelize {BUNNY} --resolution 64 -o a.h5; latvox info a.h5", timeout=300)
        refused = self.root.run("env", "AWS_MAX_ATTEMPTS=1", "latvox", "voxelize", "http://127.0.0.1:1/a.obj", "-o", "/tmp/a.csv", check=False)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("127.0.0.1", refused.stderr)
        self.assertNotIn("cannot be loaded", refused.stderr)

    def test_the_server_needs_no_other_package(self):
        self.assertIn("latvoxd", self.root.run("latvoxd", "--version").stdout)
        self.assertFalse((self.root.path / UNIT[1:]).exists())


class Moved(InRoot):
    """Older packages, whose latvoxd had the server itself."""

    install = "true"
    moved = ("bin/latvoxd", "share/man/man8/latvoxd.8.gz")

    @staticmethod
    def older(control):
        version = re.search(r"^Version: (.*)$", control, re.M)[1]
        return re.sub(r"^(?:Breaks|Replaces|Recommends): .*\n", "", control.replace(version, "0.0.1-1"), flags=re.M)

    def old_tool(self, tree, control):
        for file in self.moved:
            (self.dir / file).parent.mkdir(parents=True)
            shutil.move(tree / "usr" / file, self.dir / file)
        return self.older(control)

    def old_server(self, tree, control):
        for file in self.moved:
            (tree / "usr" / file).parent.mkdir(parents=True)
            shutil.move(self.dir / file, tree / "usr" / file)
        return self.older(control)

    def test_the_server_moves_in_an_upgrade(self):
        for name, change in ("latvox", self.old_tool), ("latvoxd", self.old_server):
            repacked(name, change, self.dir, self.root.path / f"packages/old-{name}.deb")
        self.root.shell("apt-get install -y -qq --no-install-recommends /packages/old-*.deb", timeout=1200)
        self.assertIn("latvoxd:", self.root.run("dpkg", "--search", "/usr/bin/latvoxd").stdout)
        self.root.shell("apt-get install -y -qq --no-install-recommends /packages/{latvox,latvoxd}_*.deb", timeout=1200)
        self.assertIn("latvox:", self.root.run("dpkg", "--search", "/usr/bin/latvoxd").stdout)
        self.assertEqual(self.root.run("dpkg", "--verify", "latvox", "latvoxd").stdout, "")


class Sdk(InRoot):
    """The C++ library: used by CMake and by pkg-config, then upgraded and purged."""

    install = "apt-get install -y -qq --no-install-recommends cmake g++ ninja-build glmark2-data"

    def test_the_library(self):
        before = self.root.files()
        self.root.shell("apt-get install -y -qq --no-install-recommends /packages/{latvox,liblatvox-dev}_*.deb", timeout=1200)
        self.it_builds_all_examples()
        self.it_builds_by_pkg_config()
        for name in "latvox", "liblatvox-dev":
            repacked(name, newer, self.dir, self.root.path / f"packages/new-{name}.deb")
        self.root.shell("apt-get install -y -qq --no-install-recommends /packages/new-*.deb", timeout=1200)
        self.assertRegex(self.root.run("dpkg", "--list", "liblatvox-dev").stdout, r"(?m)^ii +liblatvox-dev.*\+1 ")
        self.assertEqual(self.root.run("dpkg", "--verify", "latvox", "liblatvox-dev").stdout, "")
        self.root.shell("apt-get purge -y -qq latvox liblatvox-dev; apt-get autoremove -y -qq --purge "
                        "-o APT::AutoRemove::SuggestsImportant=false", timeout=1200)
        for file in self.root.path.glob("packages/new-*.deb"):
            file.unlink()
        self.assertEqual({path for path in self.root.files() ^ before if not re.match(THEIRS, path)}, set())

    def it_builds_all_examples(self):
        self.root.shell("cmake -S /usr/share/doc/latvox/examples -B /tmp/build -G Ninja -DCMAKE_CXX_FLAGS=-O1; cmake --build /tmp/build",
                        timeout=1800)
        named = set(re.findall(r"[\w/]+", re.search(r"foreach\(example (.*?)\)", (ROOT / "client/examples/CMakeLists.txt").read_text())[1]))
        built = {path.name for path in (self.root.path / "tmp/build").iterdir() if path.is_file() and os.access(path, os.X_OK)}
        self.assertEqual(built, {name.rpartition("/")[2] for name in named} | {"to_vdb"})
        self.lines = self.root.run("/tmp/build/mesh_file", BUNNY, "40").stdout.splitlines()
        self.assertGreater(len(self.lines), 1000)

    def it_builds_by_pkg_config(self):
        for example, name in ("mesh_file", "latvox-mesh-files"), ("to_vdb", "latvox-grid"):
            words = f"g++ -std=c++20 -o /tmp/{example} /usr/share/doc/latvox/examples/{example}.cc"
            self.root.shell(f"{words} $(pkg-config --static --cflags --libs {name})", timeout=1200)
        self.assertEqual(self.root.run("/tmp/mesh_file", BUNNY, "40").stdout.splitlines(), self.lines)


class Installed(InRoot):
    """Programs in use, without systemd, then the service under systemd."""

    install = InRoot.install + " glmark2-data"

    def test_files_are_as_they_were_packed(self):
        self.assertEqual(self.root.run("dpkg", "--verify", "latvox", "latvoxd", "python3-latvox").stdout, "")

    def test_a_missing_library_is_named_with_its_package(self):
        for words, name in (["http://127.0.0.1:1/a.obj", "-o", "/tmp/a.csv"], "libcurl4"), ([BUNNY, "-o", "/tmp/a.h5"], "libhdf5-"):
            refused = self.root.run("latvox", "voxelize", *words, check=False)
            self.assertNotEqual(refused.returncode, 0)
            self.assertRegex(refused.stderr, rf"cannot be loaded \(.*\(Debian 12: {name}")

    def test_python_voxelizes_and_reads_foreign_files(self):
        script = f"import latvox; v = latvox.voxelize('{BUNNY}', resolution=64); v.save('/tmp/v.vdb'); print(len(v))"
        self.assertGreater(int(self.root.run("python3", "-c", script).stdout), 1000)

    def test_the_unit_is_confined(self):
        self.root.run("systemd-analyze", "verify", "--man=no", UNIT, SOCKET)
        score = self.root.run("systemd-analyze", "security", "--offline=yes", "--no-pager", UNIT).stdout
        exposure = float(re.search(r"Overall exposure level for latvoxd.service: (\S+)", score)[1])
        print(f"packages: systemd-analyze security finds an exposure of {exposure}")
        self.assertLess(exposure, 2.0)

    def test_the_service_under_systemd(self):
        with self.root.systemd():
            for step in (self.it_starts_with_the_first_client, self.it_ends_a_loop_of_starts, self.it_serves, self.it_reloads,
                         self.it_drains, self.it_is_watched, self.it_has_a_folder_for_a_socket, self.it_waits_for_its_address, self.it_has_credentials):  # fmt: skip
                with self.subTest(step.__name__):
                    step()

    def show(self, name, unit="latvoxd"):
        return self.root.run("systemctl", "show", "--value", f"--property={name}", unit).stdout.strip()

    def journal(self):
        return self.root.run("journalctl", "--no-pager", "--unit=latvoxd").stdout

    def drop_in(self, name, text, *how):
        folder = self.root.path / "etc/systemd/system/latvoxd.service.d"
        folder.mkdir(exist_ok=True)
        (folder / name).write_text(text)
        self.addCleanup((folder / name).unlink, missing_ok=True)
        # These starts follow each other faster than systemd lets anybody start the service.
        self.root.shell(f"systemctl daemon-reload; systemctl reset-failed; systemctl restart {' '.join(how)} latvoxd")

    def it_starts_with_the_first_client(self):
        """Its socket outlives it, so no client finds nobody. `latvoxd.toml` has the same address, so there is no warning."""
        ask = ["latvox", "limits", "--server", ADDRESS]
        self.root.run("systemctl", "start", "latvoxd.socket")
        self.assertEqual(self.show("ActiveState"), "inactive")
        for starts in (1, 2):
            self.assertIn("max_jobs", self.root.run(*ask).stdout)
            await_true("the service does not start", lambda: self.show("ActiveState") == "active", 30)
            await_true("no socket", lambda: self.journal().count(f"event=listening address={ADDRESS} fd=3") == starts, 30)
            self.root.run("systemctl", "stop", "latvoxd")
        self.root.run("systemctl", "start", "latvoxd")
        self.root.run("systemctl", "restart", "latvoxd")
        self.root.run("latvox", "voxelize", BUNNY, "--resolution", "64", "--server", ADDRESS, "-o", "/tmp/s.vdb")
        self.root.run("systemctl", "stop", "latvoxd.socket", "latvoxd")
        self.assertEqual(self.show("Result"), "success")
        self.assertNotEqual(self.root.run(*ask, "--timeout", "2", check=False).returncode, 0)

    def it_ends_a_loop_of_starts(self):
        """A client waits at the socket, and the configuration is wrong until somebody corrects it."""
        self.drop_in("wrong.conf", "[Service]\nEnvironment=LATVOX_MAX_JOBS=wrong\n", "--no-block")
        await_true("it does not end", lambda: self.show("ExecMainStatus") == "2", 30)
        self.root.run("systemctl", "start", "latvoxd.socket")
        ask = ["latvox", "limits", "--server", ADDRESS]
        self.assertNotEqual(self.root.run(*ask, "--timeout", "30", check=False).returncode, 0)
        await_true("the loop goes on", lambda: self.show("Result", "latvoxd.socket") == "service-start-limit-hit", 30)
        (self.root.path / "etc/systemd/system/latvoxd.service.d/wrong.conf").unlink()
        self.root.shell("systemctl daemon-reload; sleep 10; systemctl restart latvoxd.socket")
        self.assertIn("max_jobs", self.root.run(*ask).stdout)
        self.root.shell("systemctl stop latvoxd.socket latvoxd; systemctl reset-failed")

    def it_serves(self):
        self.root.run("systemctl", "start", "latvoxd")
        # The mesh goes through a decoder, which confines itself beside the unit's own confinement.
        job = ["latvox", "voxelize", BUNNY, "--resolution", "128", "--server", ADDRESS, "--upload", "draco", "-o", "/tmp/a.vdb"]
        self.root.run(*job)
        status = f"/proc/{self.show('MainPID')}/status"
        uid = int(re.search(r"^Uid:\t(\d+)", self.root.run("cat", status).stdout, re.M)[1])
        self.assertTrue(61184 <= uid <= 65519, uid)  # systemd's range for dynamic users
        self.assertNotIn("level=warning", self.journal())

    def it_reloads(self):
        self.root.run("systemctl", "reload", "latvoxd")  # sends a signal, and does not wait
        await_true("it does not read its configuration", lambda: "event=reloaded" in self.journal())
        self.assertEqual(self.show("ActiveState"), "active")

    def it_drains(self):
        self.drop_in("metrics.conf", "[Service]\nEnvironment=LATVOX_METRICS_LISTEN=127.0.0.1:9464 LATVOX_GRACE=900\n")
        job = f"latvox voxelize {BUNNY} --resolution 10000 --server {ADDRESS} --json"
        client = subprocess.Popen([*self.root.inside, "bash", "-c", job], stdout=subprocess.PIPE, text=True)
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        await_true("the job does not begin", lambda: "\nlatvox_jobs_running 1\n" in self.root.run("python3", "-c", METRICS).stdout)
        self.root.run("systemctl", "stop", "latvoxd", timeout=1000)  # as long as the job takes, on a busy machine as well
        self.assertRegex(self.journal(), r"event=stopping reason=SIGTERM calls=1 ")
        out, _ = client.communicate(timeout=60)
        self.assertEqual(client.returncode, 0)
        self.assertEqual(json.loads(out)["resumed"], 0)
        self.assertEqual(self.show("Result"), "success")

    def it_is_watched(self):
        self.drop_in("watchdog.conf", "[Service]\nWatchdogSec=3\n")
        first = self.show("MainPID")
        self.root.run("bash", "-c", "sleep 5")
        self.assertEqual(self.show("MainPID"), first, "the watchdog ends a server that lives")
        self.root.run("kill", "-STOP", first)
        await_true("a stuck server is not replaced", lambda: self.show("NRestarts") == "1", 30)
        await_true("it does not start again", lambda: self.show("ActiveState") == "active", 30)

    def it_has_credentials(self):
        folder = self.root.path / "etc/latvox"
        run("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2", "-subj",
            "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", folder / "key.pem",
            "-out", folder / "certificate.pem")  # fmt: skip
        (folder / "tokens").write_text("alice 0123456789abcdef\n")
        (folder / "token").write_text("0123456789abcdef\n")
        for secret in ("key.pem", "tokens"):
            (folder / secret).chmod(0o600)
        for name in ("key.pem", "tokens", "token", "certificate.pem"):
            self.addCleanup((folder / name).unlink)
        self.drop_in("credentials.conf", (self.root.path / "usr/share/doc/latvoxd/examples/credentials.conf").read_text())
        ask = f"latvox limits --server {ADDRESS} --tls-ca /etc/latvox/certificate.pem"
        self.assertIn("max_jobs", self.root.shell(f"{ask} --token-file /etc/latvox/token").stdout)
        refused = self.root.run("bash", "-c", ask, check=False)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("token", refused.stderr)

    def it_has_a_folder_for_a_socket(self):
        self.drop_in("listen.conf", "[Service]\nEnvironment=LATVOX_LISTEN=unix:/run/latvoxd/socket\nUMask=0111\n")
        ask = ["latvox", "limits", "--server", "unix:/run/latvoxd/socket"]
        self.assertIn("max_jobs", self.root.run("setpriv", "--reuid=nobody", "--clear-groups", *ask).stdout)

    def it_waits_for_its_address(self):
        """More often than systemd by itself would try."""
        self.drop_in("listen.conf", f"[Service]\nEnvironment=LATVOX_LISTEN={OUTSIDE}:50151 LATVOX_INSECURE=true\n", "--no-block")
        await_true("it gives up", lambda: int(self.show("NRestarts")) >= 6, 240)
        _, leader, *_ = self.root.inside
        run("nsenter", leader, "--net", "ip", "address", "add", f"{OUTSIDE}/32", "dev", "lo")
        await_true("it does not start", lambda: self.show("ActiveState") == "active", 60)
        self.drop_in("listen.conf", "[Service]\nEnvironment=LATVOX_LISTEN=127.0.0.1:50151\n")


class Lifecycle(InRoot):
    """Upgraded, removed and purged while the service runs."""

    def test_nothing_is_left(self):
        with self.root.systemd():
            for unit in ("latvoxd.service", "latvoxd.socket"):
                self.assertEqual(self.systemctl("is-enabled", unit), "disabled")
                self.assertEqual(self.systemctl("is-active", unit), "inactive")
            self.root.run("systemctl", "enable", "--now", "latvoxd.socket", "latvoxd.service")
            self.upgrade()
            self.remove()
            self.root.shell("apt-get purge -y -qq latvox latvoxd python3-latvox; apt-get autoremove -y -qq --purge "
                            "-o APT::AutoRemove::SuggestsImportant=false", timeout=1200)
        shutil.rmtree(self.root.path / "packages")
        before = {path for path in self.before if not path.startswith("/packages")}
        after = self.root.files()
        self.assertEqual({path for path in after if "latvox" in path and not path.startswith("/var/log/")}, set())
        self.assertEqual({path for path in after - before if not re.match(THEIRS, path)}, set())
        self.assertEqual({path for path in before - after if not re.match(THEIRS, path)}, set())

    def systemctl(self, question, unit="latvoxd.service"):
        return self.root.run("systemctl", question, unit, check=False).stdout.strip()

    def upgrade(self):
        """To packages that differ by their version alone: a server that runs is a new one, and its configuration stays."""
        settings = self.root.path / "etc/latvox/latvoxd.toml"
        settings.write_text(settings.read_text() + "max-jobs = 7\n")
        for name in ("latvox", "latvoxd", "python3-latvox"):
            repacked(name, newer, self.dir, self.root.path / f"packages/new-{name}.deb")
        first = self.root.run("systemctl", "show", "--value", "--property=MainPID", "latvoxd").stdout
        self.root.shell("apt-get install -y -qq --no-install-recommends /packages/new-*.deb", timeout=1200)
        self.assertNotEqual(self.root.run("systemctl", "show", "--value", "--property=MainPID", "latvoxd").stdout, first)
        self.assertEqual(self.systemctl("is-active"), "active")
        self.assertEqual(self.systemctl("is-active", "latvoxd.socket"), "active")
        self.assertRegex(self.root.run("latvox", "limits", "--server", ADDRESS).stdout, r"max_jobs +7\b")
        for _ in range(2):
            self.root.run("/var/lib/dpkg/info/latvoxd.postinst", "configure", "0")
        self.assertEqual(self.systemctl("is-active"), "active")

    def remove(self):
        """Ends the service and keeps its configuration, with which it comes back."""
        self.root.shell("apt-get remove -y -qq latvox latvoxd python3-latvox", timeout=300)
        self.assertEqual(self.root.run("pgrep", "latvoxd", check=False).stdout, "")
        knock = f": <>/dev/tcp/{ADDRESS.replace(':', '/')}"
        self.assertNotEqual(self.root.run("bash", "-c", knock, check=False).returncode, 0, "the socket is still open")
        self.assertIn("max-jobs = 7", (self.root.path / "etc/latvox/latvoxd.toml").read_text())
        self.root.shell("apt-get install -y -qq --no-install-recommends /packages/new-*.deb; systemctl start latvoxd", timeout=300)
        self.assertRegex(self.root.run("latvox", "limits", "--server", ADDRESS).stdout, r"max_jobs +7\b")


def prepare():
    debian_root.require_programs("package", "mmdebstrap", "lintian", "systemd-nspawn", "nsenter", "unshare", "openssl", "ip")
    if len(list(PACKAGES.glob("*.deb"))) != len(NAMES):
        debian_root.skip(f"{PACKAGES} has not the {len(NAMES)} packages: deploy/packaging/build makes them")
    (STATE / "work").mkdir(parents=True, exist_ok=True)
    debian_root.require_systemd(debian_root.archive(debian(), "--include=systemd,systemd-sysv,dbus,procps"))


if __name__ == "__main__":
    prepare()
    unittest.main()
