"""TLS and mutual TLS: admitted and rejected clients, certificates that change while the server runs, and no accidental
plain text."""

import contextlib
import os
import signal
import socket
import ssl
import subprocess
import unittest

import harness
from harness import BIN, BUNNY, Case, latvox

OK, OTHER, USAGE, BAD_INPUT, UNREACHABLE, REFUSED = range(6)


def openssl(*arguments):
    subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True)


class Authority:
    """Throw-away certificates, made by openssl in the test's directory."""

    def __init__(self, directory, name):
        self.directory, self.name = directory, name
        self.root = directory / f"{name}.crt"
        openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", 2,
                "-addext", "keyUsage=critical,keyCertSign,cRLSign",  # Python 3.13 believes no other root
                "-subj", f"/CN={name}", "-keyout", directory / f"{name}.key", "-out", self.root)

    def issue(self, name, subject, *extensions):
        """Returns paths of a certificate and its key, signed by this authority."""
        key, request, certificate = (self.directory / f"{name}.{end}" for end in ("key", "csr", "crt"))
        openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-subj", f"/CN={subject}",
                "-keyout", key, "-out", request)
        (self.directory / f"{name}.ext").write_text("\n".join(extensions) + "\n")
        openssl("x509", "-req", "-in", request, "-CA", self.root, "-CAkey", self.directory / f"{self.name}.key",
                "-CAcreateserial", "-days", 2, "-extfile", self.directory / f"{name}.ext", "-out", certificate)
        return certificate, key


class TlsCase(Case):
    def setUp(self):
        super().setUp()
        self.authority = Authority(self.dir, "authority")
        self.certificate, self.key = self.server_certificate("server")
        self.tls = ["--tls-cert", self.certificate, "--tls-key", self.key]

    def server_certificate(self, name, authority=None):
        return (authority or self.authority).issue(name, name, "subjectAltName=IP:127.0.0.1,DNS:localhost")

    @contextlib.contextmanager
    def server(self, *options):
        """Runs a latvoxd that also listens on a port of its own, with TLS if `options` say so."""
        with harness.server(self.dir, "--listen", "127.0.0.1:0", *options) as server:
            server.tcp = self.await_log(r"event=listening address=(127\.0\.0\.1:\d+)")
            yield server

    def serial(self, server):
        """Returns the serial number of the certificate that a new connection sees."""
        with Connection(server.tcp, self.authority.root) as connection:
            return connection.serial

    def log(self):
        return (self.dir / "latvoxd.log").read_text()

    def await_log(self, pattern, count=1):
        return harness.await_log(self.dir, pattern, count)


class Connection(contextlib.ExitStack):
    """TLS with HTTP/2 on it, by hand."""

    def __init__(self, address, root, version=None):
        super().__init__()
        context = ssl.create_default_context(cafile=root)
        context.set_alpn_protocols(["h2"])
        if version:
            context.set_ciphers("ALL:@SECLEVEL=0")
            context.minimum_version = context.maximum_version = version
        host, port = address.split(":")
        plain = self.enter_context(socket.create_connection((host, int(port)), timeout=harness.PATIENCE))
        self.socket = self.enter_context(context.wrap_socket(plain, server_hostname=host))
        self.serial = self.socket.getpeercert()["serialNumber"]
        self.received = b""
        self.socket.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + b"\0\0\0\4\0\0\0\0\0")

    def ping(self, payload):
        """Sends a ping with a payload of eight bytes. Returns whether the other side answers."""
        self.socket.sendall(b"\0\0\x08\x06\0\0\0\0\0" + payload)
        while b"\0\0\x08\x06\x01\0\0\0\0" + payload not in self.received:
            got = self.socket.recv(4096)
            if not got:
                return False
            self.received += got
        return True


class Tls(TlsCase):
    def test_a_client_with_the_root_is_served_and_others_are_not(self):
        stranger = Authority(self.dir, "stranger")
        with self.server(*self.tls) as server:
            with_root = ["--server", server.tcp, "--tls-ca", self.authority.root]
            self.assertEqual(latvox("health", *with_root).stdout, "SERVING\n")
            self.assertEqual(latvox("limits", *with_root).returncode, OK)
            summary = self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", 32, *with_root)
            self.assertGreater(summary["voxels"], 0)
            for options in ([], ["--tls-ca", stranger.root], ["--tls"]):
                with self.subTest(options):
                    done = latvox("health", "--server", server.tcp, *options)
                    self.assertEqual(done.returncode, UNREACHABLE, done.stderr)
            name = server.tcp.replace("127.0.0.1", "localhost")
            self.assertEqual(latvox("health", "--server", name, "--tls-ca", self.authority.root).returncode, OK)

    def test_a_certificate_for_another_name_is_not_believed(self):
        certificate, key = self.authority.issue("other", "other", "subjectAltName=DNS:other.example")
        with self.server("--tls-cert", certificate, "--tls-key", key) as server:
            done = latvox("health", "--server", server.tcp, "--tls-ca", self.authority.root)
            self.assertEqual(done.returncode, UNREACHABLE, done.stderr)
            self.assertRegex(done.stderr, r"^latvox: cannot reach the server at .*Peer name .* is not in peer certificate\)\n$")

    def test_versions_below_1_2_are_refused(self):
        with self.server(*self.tls) as server:
            for version in (ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3):
                with Connection(server.tcp, self.authority.root, version) as connection:
                    self.assertTrue(connection.ping(b"12345678"))
            for version in (ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1):
                with self.assertWarns(DeprecationWarning), self.assertRaises((ssl.SSLError, ConnectionError)):
                    Connection(server.tcp, self.authority.root, version)

    def test_mutual_tls_wants_a_certificate_of_the_authority_and_knows_the_caller_by_it(self):
        stranger = Authority(self.dir, "stranger")
        good = self.authority.issue("alice", "alice", "extendedKeyUsage=clientAuth")
        bad = stranger.issue("mallory", "alice", "extendedKeyUsage=clientAuth")
        with self.server(*self.tls, "--tls-client-ca", self.authority.root) as server:
            options = ["--server", server.tcp, "--tls-ca", self.authority.root]
            self.voxelize(BUNNY, "--lattice", "bcc", "--resolution", 16, *options, "--tls-cert", good[0], "--tls-key", good[1])
            self.await_log(r"event=request .* caller=alice .*code=OK")
            for wrong in ([], ["--tls-cert", bad[0], "--tls-key", bad[1]]):
                done = latvox("limits", *options, *wrong, "--timeout", 5)
                self.assertNotEqual(done.returncode, OK, wrong)

    def test_new_connections_see_a_new_certificate_and_old_ones_go_on(self):
        with self.server(*self.tls) as server:
            old = self.enterContext(Connection(server.tcp, self.authority.root))
            self.assertEqual(self.serial(server), old.serial)
            certificate, key = self.server_certificate("next")
            os.replace(certificate, self.certificate)
            os.replace(key, self.key)
            self.await_log("event=tls_certificate_read")
            new = self.enterContext(Connection(server.tcp, self.authority.root))
            self.assertNotEqual(new.serial, old.serial)
            self.assertTrue(old.ping(b"old one."))
            self.assertTrue(new.ping(b"new one."))

    def test_files_that_do_not_go_together_change_nothing_until_they_do(self):
        with self.server(*self.tls) as server:
            serial = self.serial(server)
            certificate, key = self.server_certificate("next")
            os.replace(key, self.key)
            self.await_log("level=error event=tls_certificate_kept error=.*the key is not that of the certificate")
            self.assertEqual(self.serial(server), serial)
            os.replace(certificate, self.certificate)
            server.send_signal(signal.SIGHUP)
            self.await_log("event=tls_certificate_read")
            self.assertNotEqual(self.serial(server), serial)

    def test_wrong_files_are_refused_at_the_start_by_name(self):
        other, other_key = self.server_certificate("other")
        (self.dir / "text.pem").write_text("no certificate\n")
        encrypted = self.dir / "encrypted.key"
        openssl("pkey", "-in", self.key, "-aes128", "-passout", "pass:secret", "-out", encrypted)
        truncated = self.dir / "truncated.crt"
        truncated.write_text(self.certificate.read_text() + self.certificate.read_text()[:200])
        for options, says in (
            (["--tls-cert", self.certificate], "--tls-cert needs --tls-key"),
            (["--tls-key", self.key], "--tls-key needs --tls-cert"),
            (["--tls-client-ca", self.authority.root], "--tls-client-ca needs --tls-cert"),
            (["--tls-cert", self.dir / "missing.crt", "--tls-key", self.key], "missing.crt: No such file"),
            (["--tls-cert", self.dir, "--tls-key", self.key], "it is no regular file"),
            (["--tls-cert", self.dir / "text.pem", "--tls-key", self.key], "text.pem: it holds no certificate"),
            (["--tls-cert", truncated, "--tls-key", self.key], "truncated.crt: certificate 2 of the file cannot be read"),
            (["--tls-cert", self.certificate, "--tls-key", self.dir / "text.pem"], "text.pem: it holds no private key"),
            (["--tls-cert", self.certificate, "--tls-key", encrypted], "encrypted.key: .*without a passphrase"),
            (["--tls-cert", self.certificate, "--tls-key", other_key], "other.key: the key is not that of the certificate in .*server.crt"),
            ([*self.tls, "--tls-client-ca", self.key], "server.key: it holds no certificate"),
            ([*self.tls, "--insecure"], "--insecure and --tls-cert contradict"),
        ):
            with self.subTest(says):
                for mode in (["--check-config"], ["--listen", "127.0.0.1:0"]):
                    command = [BIN / "latvoxd", *map(str, options), *mode]
                    done = subprocess.run(command, capture_output=True, text=True, timeout=harness.PATIENCE)
                    self.assertEqual(done.returncode, 2)
                    self.assertRegex(done.stderr, says)

    def test_a_key_that_everybody_can_read_is_warned_of(self):
        self.key.chmod(0o600)
        with self.server(*self.tls):
            self.assertNotIn("tls_key_readable_by_all", self.log())
            self.key.chmod(0o644)
            self.await_log("level=warning event=tls_key_readable_by_all path=.*server.key")


class PlainText(TlsCase):
    def run_server(self, *options, **environment):
        command = [BIN / "latvoxd", "--check-config", *map(str, options)]
        return subprocess.run(command, capture_output=True, text=True, env=os.environ | environment)

    def test_others_than_this_machine_are_served_in_plain_text_only_if_that_is_said(self):
        for address in ("0.0.0.0:0", "[::]:0", "192.0.2.1:50151", "example.org:50151", "[::ffff:192.0.2.1]:0", ":0"):
            with self.subTest(address):
                done = self.run_server("--listen", address)
                self.assertEqual(done.returncode, 2)
                self.assertIn(f"refusing to listen on {address} in plain text", done.stderr)
                self.assertIn("--insecure", done.stderr)
                for allowed in (["--insecure"], self.tls):
                    self.assertEqual(self.run_server("--listen", address, *allowed).returncode, OK)
                self.assertEqual(self.run_server("--listen", address, LATVOX_INSECURE="true").returncode, OK)
        for address in ("127.0.0.1:0", "127.1.2.3:0", "localhost:0", "[::1]:0", "[::ffff:127.0.0.1]:0", "unix:x"):
            self.assertEqual(self.run_server("--listen", address).returncode, OK, address)
        started = subprocess.run([BIN / "latvoxd", "--listen", "0.0.0.0:0"], capture_output=True, text=True, timeout=harness.PATIENCE)
        self.assertEqual(started.returncode, 2)
        self.assertIn("refusing to listen on 0.0.0.0:0", started.stderr)

    def test_a_token_does_not_leave_this_machine_in_plain_text(self):
        (self.dir / "token").write_text("alice-0123456789\n")
        for address in ("192.0.2.1:50151", "example.org:50151", "localhost.example.org:1", "127.0.0.1.example.org:1"):
            done = latvox("health", "--server", address, "--token-file", self.dir / "token", "--timeout", 5)
            self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
            self.assertIn(f"not sent in plain text to {address}", done.stderr)


class Health(TlsCase):
    def test_the_health_port_is_plain_and_serves_nothing_else(self):
        with self.server(*self.tls, "--health-listen", "127.0.0.1:0"):
            probe = ["--server", self.await_log(r"event=health address=(\S+)"), "--timeout", 5]
            self.assertEqual(latvox("health", *probe).stdout, "SERVING\n")
            done = latvox("limits", *probe)
            self.assertEqual(done.returncode, OTHER, done.stderr)

    def test_the_health_port_says_not_serving_while_the_server_drains(self):
        address = f"unix:{self.dir}/socket"
        command = [BIN / "latvoxd", "--listen", address, "--health-listen", "127.0.0.1:0", "--grace", "30"]
        with open(self.dir / "latvoxd.log", "wb") as log, subprocess.Popen(command, stderr=log) as server, contextlib.ExitStack() as stack:
            stack.callback(server.kill)  # before the end of `with` waits for it
            probe = ["--server", self.await_log(r"event=health address=(\S+)")]
            with self.long_job(address):
                server.send_signal(signal.SIGTERM)
                self.assertEqual(self.await_log(r"event=stopping reason=SIGTERM calls=(\d+)"), "1")
                done = latvox("health", *probe)
                self.assertEqual(done.returncode, UNREACHABLE)
                self.assertIn("NOT_SERVING", done.stderr)
                self.assertIsNone(server.poll())
            # The client is gone, so the server has nothing left to do.
            self.assertEqual(server.wait(harness.PATIENCE), 0)

    @contextlib.contextmanager
    def long_job(self, address):
        """Starts a voxelization of minutes, and waits until some of it has arrived."""
        command = ["voxelize", BUNNY, "-o", self.dir / "long.csv", "--lattice", "bcc", "--resolution", 30000, "--server", address]
        with subprocess.Popen([BIN / "latvox", *map(str, command)], stderr=subprocess.DEVNULL) as process:
            try:
                harness.await_true("the job does not begin", lambda: any(harness.unfinished_files(process.pid, self.dir)))
                yield
            finally:
                process.kill()


class Tokens(TlsCase):
    def test_a_token_lets_its_caller_in_and_is_named_in_the_log(self):
        token, tokens = self.dir / "token", self.dir / "tokens"
        token.write_text("alice-0123456789\n")
        tokens.write_text("alice alice-0123456789 max-triangles=5\n")
        tokens.chmod(0o600)
        with self.server(*self.tls, "--token-file", tokens) as server:
            remote = ["--server", server.tcp, "--tls-ca", self.authority.root]
            self.assertEqual(latvox("health", *remote).returncode, OK)
            for without in ([], ["--token-file", self.certificate.parent / "wrong"]):
                (self.dir / "wrong").write_text("alice-9876543210")
                done = latvox("limits", *remote, *without)
                self.assertEqual(done.returncode, REFUSED, done.stderr)
                self.assertRegex(done.stderr, "bearer token.*; --token-file names its file\n$")
            remote += ["--token-file", token]
            self.assertIn('"max_triangles": 5', latvox("limits", "--json", *remote).stdout)
            done = latvox("voxelize", BUNNY, "-o", self.dir / "x.csv", "--lattice", "bcc", "--resolution", 9, *remote)
            self.assertEqual(done.returncode, REFUSED)
            self.assertRegex(done.stderr, "triangles 69666 exceeds 5")
            self.await_log("caller=alice .*code=RESOURCE_EXHAUSTED")
            self.await_log("method=GetLimits .*code=UNAUTHENTICATED")
            self.assertNotIn("0123456789", self.log())
            self.assertNotIn("readable_by_all path=" + str(tokens), self.log())
            tokens.chmod(0o644)
            self.await_log("level=warning event=token_file_readable_by_all path=.*tokens")

    def test_a_wrong_token_file_is_named(self):
        (self.dir / "broken").write_text("alice short\n")
        for file, says in ((self.dir / "broken", "broken: line 1: the token has 5 characters"), (self.dir / "none", "cannot read .*none")):
            done = subprocess.run([BIN / "latvoxd", "--token-file", file, "--check-config"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, says)


if __name__ == "__main__":
    unittest.main()
