"""latvoxd with sockets that a service manager has opened: LISTEN_FDS and LISTEN_PID, as systemd sets them."""

import contextlib
import json
import os
import pathlib
import re
import signal
import socket
import ssl
import subprocess
import sys
import unittest
import urllib.request

from harness import BIN, BUNNY, PATIENCE, Case, await_log, await_true, latvox
from tls_test import Authority

# Puts the given descriptors at 3, 4 and so on, and becomes latvoxd, whose number it then knows.
WRAPPER = """
import fcntl, os, sys
fds = [int(fd) for fd in sys.argv[1].split(",") if fd]
own = [fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, 100) for fd in fds]
for fd in fds:
    os.close(fd)
for n, fd in enumerate(own):
    os.dup2(fd, 3 + n)
os.environ.setdefault("LISTEN_PID", str(os.getpid()))
os.environ.setdefault("LISTEN_FDS", str(len(own)))
os.execv(sys.argv[2], sys.argv[2:])
"""
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + b"\0\0\0\4\0\0\0\0\0"
ATTACK = PREFACE + b"\0\0\1\1\x08\0\0\0\1x"  # a header block whose padding is longer than the frame


def address(listener):
    """Returns the name of a socket as latvoxd writes it."""
    name = listener.getsockname()
    if listener.family == socket.AF_UNIX:
        return f"unix:{name}"
    return f"[{name[0]}]:{name[1]}" if listener.family == socket.AF_INET6 else f"{name[0]}:{name[1]}"


class Activated(Case):
    def listener(self, family=socket.AF_INET, name=("127.0.0.1", 0)):
        listener = self.enterContext(socket.socket(family, socket.SOCK_STREAM))
        listener.bind(str(name) if family == socket.AF_UNIX else name)
        listener.listen()
        return listener

    def start(self, sockets, *options, **environment):
        """Starts latvoxd with sockets, or other things that have descriptors."""
        fds = [each.fileno() for each in sockets]
        command = [sys.executable, "-c", WRAPPER, ",".join(map(str, fds)), BIN / "latvoxd", *options]
        (self.dir / "latvoxd.log").write_bytes(b"")
        with open(self.dir / "latvoxd.log", "ab") as log:
            process = subprocess.Popen(command, env=os.environ | environment, pass_fds=fds, stdout=log, stderr=log)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def serve(self, sockets, *options, **environment):
        process = self.start(sockets, *options, **environment)
        await_log(self.dir, "event=listening")
        return process

    def end(self, process):
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(PATIENCE), 0)

    def log(self):
        return (self.dir / "latvoxd.log").read_text()

    def greet(self, connection, payload=PREFACE):
        """Sends the first bytes of HTTP/2. Returns the first of the other side."""
        connection.settimeout(PATIENCE)
        connection.sendall(payload)
        return connection.recv(9)


class Serving(Activated):
    def test_jobs_run_at_each_socket(self):
        listeners = [self.listener(), self.listener(socket.AF_UNIX, self.dir / "passed")]
        with contextlib.suppress(OSError):  # a machine without IPv6
            listeners.append(self.listener(socket.AF_INET6, ("::1", 0)))
        process = self.serve(listeners)
        for fd, listener in enumerate(listeners, 3):
            with self.subTest(address(listener)):
                await_log(self.dir, f"event=listening address={re.escape(address(listener))} fd={fd}\n")
                summary = self.voxelize(BUNNY, "--resolution", 32, "--server", address(listener))
                self.assertGreater(summary["voxels"], 0)
                self.assertEqual(latvox("health", "--server", address(listener)).stdout, "SERVING\n")
        self.assertRegex(self.log(), r"event=request .*peer=ipv4:127\.0\.0\.1:\d+")
        self.end(process)
        self.assertNotIn("level=warning", self.log())
        self.assertTrue((self.dir / "passed").is_socket(), "it removes the file of another")

    def test_they_take_the_place_of_listen_and_a_warning_says_so(self):
        listener, own = self.listener(), self.dir / "own"
        file = self.dir / "latvoxd.toml"
        for options, environment in (
            (["--listen", f"unix:{own}"], {}),
            ([], {"LATVOX_LISTEN": f"unix:{own}"}),
            (["--config", file], {}),
        ):
            with self.subTest(options, **environment):
                file.write_text(f'listen = ["unix:{own}", "{address(listener)}"]\n')
                process = self.serve([listener], *options, **environment)
                await_log(self.dir, rf"level=warning event=listen_replaced address=unix:{own} by=LISTEN_FDS\n")
                self.assertFalse(own.exists())
                self.assertEqual(latvox("health", "--server", address(listener)).stdout, "SERVING\n")
                self.end(process)
                self.assertEqual(self.log().count("listen_replaced"), 1)
                self.assertEqual(self.log().count("event=listening"), 1)

    def test_an_address_of_listen_that_is_no_address_is_still_refused(self):
        process = self.start([self.listener()], "--listen", "nonsense")
        self.assertEqual(process.wait(PATIENCE), 2)
        self.assertIn('cannot listen on "nonsense"', self.log())

    def test_sockets_of_another_process_are_not_for_this_one(self):
        listener, own = self.listener(), f"unix:{self.dir}/own"
        process = self.serve([listener], "--listen", own, LISTEN_PID="1")
        self.assertEqual(latvox("health", "--server", own).stdout, "SERVING\n")
        self.assertEqual(re.findall(r"event=listening address=(.*)\n", self.log()), [own])
        self.end(process)

    @unittest.skipIf(os.geteuid() != 0, "decoders show their environment to root alone")
    def test_children_get_neither_sockets_nor_variables(self):
        listener = self.listener()
        process = self.serve([listener], LISTEN_FDNAMES="passed")
        inode = os.fstat(listener.fileno()).st_ino
        threads = pathlib.Path(f"/proc/{process.pid}/task").glob("*/children")
        children = " ".join(thread.read_text() for thread in threads).split()
        self.assertNotEqual(children, [], "there is no decoder process")
        for child in children:
            self.assertNotIn("LISTEN_", pathlib.Path(f"/proc/{child}/environ").read_text())
            files = [os.readlink(file) for file in pathlib.Path(f"/proc/{child}/fd").iterdir()]
            self.assertNotIn(f"socket:[{inode}]", files)
        self.end(process)

    def test_a_reload_keeps_them(self):
        listener = self.listener()
        file = self.dir / "latvoxd.toml"
        file.write_text(f'listen = "{address(listener)}"\n')
        process = self.serve([listener], "--config", file)
        process.send_signal(signal.SIGHUP)
        await_log(self.dir, "event=reloaded")
        self.assertEqual(latvox("health", "--server", address(listener)).stdout, "SERVING\n")
        self.end(process)
        self.assertNotIn("level=warning", self.log())

    def test_health_has_its_own_port(self):
        process = self.serve([self.listener()], "--health-listen", "127.0.0.1:0")
        health = await_log(self.dir, r"event=health address=(\S+)")
        self.assertEqual(latvox("health", "--server", health).stdout, "SERVING\n")
        self.end(process)


class Ending(Activated):
    def test_running_jobs_end_and_new_connections_wait_for_the_next_server(self):
        listener = self.listener()
        ports = ["--metrics-listen", "127.0.0.1:0", "--health-listen", "127.0.0.1:0"]
        process = self.serve([listener], "--grace", "100", *ports)
        health = await_log(self.dir, r"event=health address=(\S+)")
        metrics = await_log(self.dir, r"event=metrics address=(\S+)")
        job = [BIN / "latvox", "voxelize", BUNNY, "--resolution", "3000", "--server", address(listener), "--json"]
        client = subprocess.Popen(job, stdout=subprocess.PIPE, text=True)
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        page = f"http://{metrics}/metrics"
        running = "\nlatvox_jobs_running 1\n"
        await_true("the job does not begin", lambda: running in urllib.request.urlopen(page).read().decode())
        process.send_signal(signal.SIGTERM)
        await_log(self.dir, "event=stopping reason=SIGTERM calls=1 ")
        # It says so after it has ceased to accept.
        await_true("it goes on accepting", lambda: "NOT_SERVING" in latvox("health", "--server", health).stderr)
        with socket.create_connection(listener.getsockname()) as late:
            late.sendall(PREFACE)
            out, _ = client.communicate(timeout=PATIENCE)
            self.assertEqual(client.returncode, 0)
            self.assertEqual(json.loads(out)["resumed"], 0)
            self.assertEqual(process.wait(PATIENCE), 0)
            following = self.serve([listener])
            late.settimeout(PATIENCE)
            self.assertEqual(len(late.recv(9)), 9)
        self.end(following)

    def test_two_servers_share_a_socket(self):
        listener = self.listener()
        first = self.serve([listener])
        second = self.serve([listener])
        self.end(first)
        self.assertEqual(latvox("health", "--server", address(listener)).stdout, "SERVING\n")
        self.end(second)


class Guarded(Activated):
    """Connections of these sockets are judged as those of gRPC's own ports are."""

    def closed(self, metrics):
        """Returns how many connections were closed for their header blocks."""
        page = urllib.request.urlopen(f"http://{metrics}/metrics").read().decode()
        return int(re.search(r'^latvox_connections_closed_total\{offense="header_block"\} (\d+)$', page, re.M)[1])

    def assert_attacks_end(self, connect, metrics):
        before = self.closed(metrics)
        with connect() as good:
            self.assertEqual(len(self.greet(good)), 9)
        with connect() as bad, contextlib.suppress(ConnectionError, ssl.SSLError):
            bad.settimeout(PATIENCE)
            bad.sendall(ATTACK)
            while bad.recv(4096):
                pass
        self.assertEqual(self.closed(metrics), before + 1)

    def test_an_attack_in_plain_text(self):
        listeners = [self.listener(), self.listener(socket.AF_UNIX, self.dir / "passed")]
        process = self.serve(listeners, "--metrics-listen", "127.0.0.1:0")
        metrics = await_log(self.dir, r"event=metrics address=(\S+)")
        for listener in listeners:

            def connect(listener=listener):
                connection = socket.socket(listener.family, socket.SOCK_STREAM)
                connection.connect(listener.getsockname())
                return connection

            with self.subTest(address(listener)):
                self.assert_attacks_end(connect, metrics)
        await_log(self.dir, "event=connection_closed offense=header_block")
        self.end(process)

    def test_tls_is_for_all_sockets_but_unix_ones_and_attacks_behind_it_end(self):
        authority = Authority(self.dir, "authority")
        certificate, key = authority.issue("server", "server", "subjectAltName=IP:127.0.0.1")
        listener, local = self.listener(), self.listener(socket.AF_UNIX, self.dir / "passed")
        options = ["--tls-cert", certificate, "--tls-key", key, "--metrics-listen", "127.0.0.1:0"]
        process = self.serve([listener, local], *options)
        metrics = await_log(self.dir, r"event=metrics address=(\S+)")
        with_root = ["--server", address(listener), "--tls-ca", authority.root]
        self.assertGreater(self.voxelize(BUNNY, "--resolution", 32, *with_root)["voxels"], 0)
        self.assertEqual(latvox("health", "--server", address(local)).stdout, "SERVING\n")
        self.assertNotEqual(latvox("health", "--server", address(listener), "--timeout", 5).returncode, 0)
        context = ssl.create_default_context(cafile=authority.root)
        context.set_alpn_protocols(["h2"])

        def connect():
            return context.wrap_socket(socket.create_connection(listener.getsockname()), server_hostname="127.0.0.1")

        self.assert_attacks_end(connect, metrics)
        self.end(process)


class Refused(Activated):
    def assert_refused(self, sockets, message, *options, **environment):
        process = self.start(sockets, *options, **environment)
        self.assertEqual(process.wait(PATIENCE), 2)
        self.assertRegex(self.log(), rf"\Alatvoxd: {message}")

    def test_descriptors_that_cannot_be_served(self):
        good, cannot = self.listener(), "cannot serve file descriptor 4 of LISTEN_FDS: "
        silent = self.enterContext(socket.socket())
        datagrams = self.enterContext(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        file = self.enterContext(open("/dev/null"))
        for bad, fault in (
            (silent, "it does not listen: its unit needs Accept=no"),
            (datagrams, "it is no stream socket: its unit needs ListenStream="),
            (file, "it is no socket"),
        ):
            with self.subTest(fault):
                self.assert_refused([good, bad], cannot + fault)
        self.assert_refused([good], cannot + "it is not open", LISTEN_FDS="2")

    def test_variables_that_are_no_numbers(self):
        rule = "not a number from 1 to 1000"
        self.assert_refused([], f'the environment variable LISTEN_FDS is "0", {rule}')
        self.assert_refused([self.listener()], f'the environment variable LISTEN_FDS is "x", {rule}', LISTEN_FDS="x")
        rule = "not the number of a process"
        self.assert_refused([self.listener()], f'the environment variable LISTEN_PID is "x", {rule}', LISTEN_PID="x")

    def test_plain_text_for_other_machines(self):
        listener = self.listener(name=("0.0.0.0", 0))
        self.assert_refused([listener], f"refusing to listen on {address(listener)} in plain text")
        process = self.serve([listener], "--insecure")
        self.end(process)


if __name__ == "__main__":
    unittest.main()
