"""The messages of latvoxd to systemd, heard by a socket in its place: ready, reloading, alive, stopping."""

import os
import pathlib
import re
import signal
import socket
import subprocess
import unittest
import uuid

from harness import BIN, PATIENCE, Case, await_log


UNIT = pathlib.Path(__file__).resolve().parents[2] / "deploy/packaging/latvoxd.service.in"


class Unit(unittest.TestCase):
    def test_restarts_go_on_but_a_socket_starts_no_loop(self):
        """packages_test.py sees both under systemd."""
        text = UNIT.read_text()
        interval, burst, pause = (int(re.search(rf"^{name}=(\d+)$", text, re.M)[1])
                                  for name in ("StartLimitIntervalSec", "StartLimitBurst", "RestartSec"))  # fmt: skip
        self.assertGreater(burst * pause, interval, "restarts would reach the limit")
        self.assertGreater(interval, burst, "starts that take a second each would not reach it")


class ServiceManager(Case):
    def start(self, name, *options, **environment):
        """Starts latvoxd with a manager that listens at an address of Python's form. Returns process and manager."""
        manager = self.enterContext(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
        manager.bind(name)
        manager.settimeout(PATIENCE)
        command = [BIN / "latvoxd", "--listen", f"unix:{self.dir}/socket", *options]
        variables = os.environ | {"NOTIFY_SOCKET": name.replace("\0", "@")} | environment
        log = self.enterContext(open(self.dir / "latvoxd.log", "ab"))
        process = subprocess.Popen(command, env=variables, stdout=log, stderr=log)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process, manager

    def heard(self, manager):
        return manager.recv(4096).decode()

    def end(self, process, manager):
        process.send_signal(signal.SIGTERM)
        while (message := self.heard(manager)) == "WATCHDOG=1":
            pass
        self.assertEqual(process.wait(PATIENCE), 0)
        return message

    def test_it_tells_ready_reloading_and_stopping(self):
        process, manager = self.start(f"{self.dir}/manager", "--grace", "3")
        self.assertEqual(self.heard(manager), "READY=1")
        self.assertTrue((self.dir / "socket").is_socket(), "it is not ready yet")
        process.send_signal(signal.SIGHUP)
        self.assertRegex(self.heard(manager), r"\ARELOADING=1\nMONOTONIC_USEC=\d+\Z")
        self.assertEqual(self.heard(manager), "READY=1")
        # The grace period and the last resort after it.
        self.assertEqual(self.end(process, manager), "STOPPING=1\nEXTEND_TIMEOUT_USEC=18000000")

    def test_it_tells_the_watchdog_that_it_lives(self):
        process, manager = self.start(f"\0latvox-{uuid.uuid4()}", WATCHDOG_USEC="10000000")
        self.assertEqual(self.heard(manager), "READY=1")
        self.assertEqual([self.heard(manager) for _ in range(2)], ["WATCHDOG=1"] * 2)
        self.end(process, manager)

    def test_the_watchdog_of_another_process_hears_nothing(self):
        process, manager = self.start(f"{self.dir}/manager", WATCHDOG_USEC="10000000", WATCHDOG_PID="1")
        self.assertEqual(self.heard(manager), "READY=1")
        manager.settimeout(2.5)
        with self.assertRaises(TimeoutError):
            self.heard(manager)
        manager.settimeout(PATIENCE)
        self.assertEqual(self.end(process, manager).partition("\n")[0], "STOPPING=1")

    @unittest.skipIf(os.geteuid() != 0, "decoders show their environment to root alone")
    def test_children_do_not_speak_for_it(self):
        process, manager = self.start(f"{self.dir}/manager", WATCHDOG_USEC="10000000")
        self.assertEqual(self.heard(manager), "READY=1")
        threads = pathlib.Path(f"/proc/{process.pid}/task").glob("*/children")
        children = " ".join(thread.read_text() for thread in threads).split()
        self.assertNotEqual(children, [], "there is no decoder process")
        for child in children:
            self.assertNotRegex(pathlib.Path(f"/proc/{child}/environ").read_text(), "NOTIFY_SOCKET|WATCHDOG")
        self.end(process, manager)

    def test_a_manager_that_does_not_listen_is_in_the_log(self):
        process, _ = self.start(f"{self.dir}/manager", NOTIFY_SOCKET=f"{self.dir}/nobody")
        await_log(self.dir, r'event=notify_failed socket=\S+/nobody message="READY=1" error="No such file or directory"')
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(PATIENCE), 0)


if __name__ == "__main__":
    unittest.main()
