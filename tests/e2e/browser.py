"""One headless Chromium for many pages, through its debugging pipe: no port, no driver, no network."""

import base64
import itertools
import json
import os
import select
import subprocess
import time

import numpy

from harness import PATIENCE

# Draws WebGL in software, without any network.
OPTIONS = [
    "--headless", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND", "--disable-background-networking", "--no-first-run", "--hide-scrollbars",
    "--remote-debugging-pipe",
]  # fmt: skip


class Browser:
    """Reads commands as JSON, terminated by 0, on descriptor 3, and answers on 4."""

    def __init__(self, directory, *options):
        commands, self.commands = os.pipe()
        self.answers, answers = os.pipe()
        words = ["chromium", f"--user-data-dir={directory}/profile", *OPTIONS, *options, "about:blank"]
        environment = {**os.environ, "HOME": str(directory), "XDG_RUNTIME_DIR": str(directory)}
        # The shell puts the pipes where the browser expects them.
        pipes = f'exec "$@" 3<&{commands} 4>&{answers}'
        with open(directory / "chromium.log", "wb") as log:
            self.process = subprocess.Popen(["bash", "-c", pipes, "bash", *words], stdout=log, stderr=log, cwd=directory,
                                            env=environment, pass_fds=(commands, answers))  # fmt: skip
        os.close(commands)
        os.close(answers)
        self.numbers, self.buffer, self.events = itertools.count(1), b"", []

    def close(self):
        self.call("Browser.close")
        self.process.wait(PATIENCE)
        os.close(self.commands)
        os.close(self.answers)

    def call(self, method, session=None, **parameters):
        number = next(self.numbers)
        words = {"id": number, "method": method, "params": parameters, **({"sessionId": session} if session else {})}
        os.write(self.commands, json.dumps(words).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            message = self.take(deadline)
            if message.get("id") == number:
                assert "error" not in message, (method, message["error"])
                return message["result"]
            self.events.append(message)

    def take(self, deadline):
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.answers], [], [], max(0, deadline - time.monotonic()))
            assert ready, "the browser does not answer"
            read = os.read(self.answers, 1 << 20)
            assert read, "the browser has ended"
            self.buffer += read
        message, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(message)


class Tab:
    """A page of the browser. Its console may show no error and no warning."""

    def __init__(self, browser, width, height, scale=1, phone=False, dark=False):
        self.browser = browser
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        if dark:
            self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        if phone:
            self.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
        self.resize(width, height, scale, phone)

    def close(self):
        if self.target:
            self.browser.call("Target.closeTarget", targetId=self.target)
        self.target = None

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def resize(self, width, height, scale=1, phone=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=phone)

    def open(self, url):
        """Returns when the page has drawn, or has said why it cannot."""
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=url)
        self.rest()

    def rest(self):
        """Returns when the page has nothing more to draw, after it had time to begin."""
        self.run("""new Promise((resolve) => {
          const look = () => (document.body?.dataset.busy === "no" ? resolve() : setTimeout(look, 10));
          requestAnimationFrame(() => requestAnimationFrame(look));
        })""")

    def run(self, script):
        """Returns the script's value, or that of the promise that it returns."""
        done = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def key(self, key):
        code = CODES.get(key) or ord(key.upper())
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)

    def touch(self, *places):
        """Moves fingers through these places, each a list of (x, y); then they leave."""
        for n, fingers in enumerate(places):
            points = [{"x": x, "y": y, "id": finger} for finger, (x, y) in enumerate(fingers)]
            self.call("Input.dispatchTouchEvent", type="touchMove" if n else "touchStart", touchPoints=points)
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self):
        """Returns the page's picture: an array of rows of red, green and blue pixels."""
        self.run("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))")
        return decode(self.png())

    def png(self):
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def complaints(self):
        """Returns errors and warnings since the last call, except the one that tests wait for pixels."""
        found = []
        for event in self.browser.events:
            if event["method"] == "Runtime.exceptionThrown":
                found.append(event["params"]["exceptionDetails"])
            entry = event["params"].get("entry", event["params"])
            text = str(entry.get("text") or entry.get("args"))
            if event["method"] in ("Log.entryAdded", "Runtime.consoleAPICalled") and "GPU stall" not in text:
                found.append(text)
        self.browser.events.clear()
        return found


CODES = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Home": 36, "Tab": 9, "+": 187, "-": 189}


def decode(png):
    """ImageMagick reads it."""
    ppm = subprocess.run(["convert", "png:-", "-depth", "8", "ppm:-"], input=png, capture_output=True, check=True).stdout
    kind, size, most, pixels = ppm.split(b"\n", 3)
    assert (kind, most) == (b"P6", b"255"), (kind, most)
    width, height = map(int, size.split())
    return numpy.frombuffer(pixels, numpy.uint8).reshape(height, width, 3)
