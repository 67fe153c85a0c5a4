"""A network between latvox and an object store that does what a test says."""

import collections
import http.client
import http.server
import threading
import time

Request = collections.namedtuple("Request", "method path number")  # number: of requests with this method and path, from 1
Passed = collections.namedtuple("Passed", "method path fault status")  # status: of the store, None if it was not asked

# Without "forbid", which does not pass.
FAULTS = ("refuse", "busy", "cut", "short", "lose", "damage", "damage_request")


def damaged(body):
    """Returns the body with one bit changed."""
    return body[: len(body) // 2] + bytes([body[len(body) // 2] ^ 1]) + body[len(body) // 2 + 1 :] if body else body


class Relay:
    """Passes requests on to a store, except for faults. `choose` gets a Request and returns a fault, or None:

    refuse, busy      answers 500, or 503 with a Retry-After, without asking the store
    forbid            answers 403 without asking the store
    cut               closes the connection without asking the store
    lose              asks the store, and closes the connection without an answer
    short             closes the connection in the middle of the answer's body
    damage            changes a bit of the answer's body
    damage_request    changes a bit of the request's body
    """

    def __init__(self, store, choose=lambda request: None, tls=None):
        relay = self
        self.store, self.choose, self.passed = store, choose, []
        self.lock, self.seen = threading.Lock(), collections.Counter()

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"
            timeout = 60

            def answer(self):
                relay.answer(self)

            do_GET = do_HEAD = do_PUT = do_POST = do_DELETE = answer

            def log_message(self, *_):
                pass

        class Server(http.server.ThreadingHTTPServer):
            daemon_threads = True
            request_queue_size = 100

            def handle_error(self, *_):
                pass  # the client has gone

        self.server = Server(("127.0.0.1", 0), Handler)
        if tls:
            self.server.socket = tls.wrap_socket(self.server.socket, server_side=True, do_handshake_on_connect=False)
        self.port = self.server.server_address[1]
        self.thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.02})

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()

    def count(self, method, status=200):
        """Returns how often the store gave this answer to a method, by path."""
        return collections.Counter(p.path for p in self.passed if (p.method, p.status) == (method, status))

    def await_store(self):
        """Waits until no request is on its way to the store or back."""
        while len(self.passed) < self.seen.total():
            time.sleep(0.01)

    def answer(self, handler):
        body = handler.rfile.read(int(handler.headers.get("Content-Length", 0)))
        key = (handler.command, handler.path)
        with self.lock:
            self.seen[key] += 1
            request = Request(*key, self.seen[key])
        fault = self.choose(request)
        handler.close_connection = fault in ("cut", "lose", "short")
        if fault in ("cut", "refuse", "busy", "forbid"):
            self.passed.append(Passed(*key, fault, None))
            if fault != "cut":
                handler.send_response({"refuse": 500, "busy": 503, "forbid": 403}[fault])
                handler.send_header("Content-Length", "0")
                handler.send_header("Retry-After", "1" if fault == "busy" else "0")
                handler.end_headers()
            return
        try:
            answer, content = self.ask(handler, damaged(body) if fault == "damage_request" else body)
        except OSError:  # the store is dead
            self.passed.append(Passed(*key, "dead", None))
            handler.close_connection = True
            return
        self.passed.append(Passed(*key, fault, answer.status))
        if fault == "lose":
            return
        handler.send_response(answer.status)
        for name, value in answer.getheaders():
            if name.lower() not in ("content-length", "transfer-encoding", "connection", "date", "server"):
                handler.send_header(name, value)
        length = answer.getheader("Content-Length", "0") if handler.command == "HEAD" else str(len(content))
        handler.send_header("Content-Length", length)
        handler.end_headers()
        if fault == "damage":
            content = damaged(content)
        handler.wfile.write(content[: len(content) // 2] if fault == "short" else content)

    def ask(self, handler, body):
        connection = http.client.HTTPConnection("127.0.0.1", self.store.port, timeout=60)
        try:
            connection.putrequest(handler.command, handler.path, skip_host=True, skip_accept_encoding=True)
            for name, value in handler.headers.items():
                if name.lower() not in ("expect", "connection"):
                    connection.putheader(name, value)
            connection.endheaders(body)
            answer = connection.getresponse()
            return answer, answer.read()
        except http.client.HTTPException as error:
            raise OSError(str(error)) from error
        finally:
            connection.close()
