"""Headless Chromium for the tests of pages, driven by the WebDriver protocol (https://www.w3.org/TR/webdriver2/).

Needs chromium and chromedriver (Debian: chromium, chromium-driver), and nothing else but Python."""

import base64
import json
import shutil
import subprocess
import sys
import urllib.error
import urllib.request

PATIENCE = 60  # seconds
OPTIONS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --hide-scrollbars"
).split()


class Browser:
    """A window of a browser of its own, whose profile is in a folder."""

    def __init__(self, folder, size="1280,800"):
        self.driver = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        for line in self.driver.stdout:
            if "successfully on port" in line:
                port = line.split("port ")[1].rstrip(".\n")
                self.base = f"http://127.0.0.1:{port}"
                break
        arguments = [*OPTIONS, f"--window-size={size}", f"--user-data-dir={folder}"]
        options = {"args": arguments, "binary": shutil.which("chromium")}
        capabilities = {"browserName": "chrome", "goog:chromeOptions": options}
        capabilities["goog:loggingPrefs"] = {"browser": "ALL"}
        try:
            answer = self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
        except OSError as error:
            self.driver.kill()
            sys.exit(f"FAILED: Chromium cannot be started: {error}")
        self.base += f"/session/{answer['sessionId']}"

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return json.load(answer)["value"]

    def open(self, url):
        self.call("POST", "/url", {"url": url})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def picture(self):
        """What the window shows, as PNG."""
        return base64.b64decode(self.call("GET", "/screenshot"))

    def close(self):
        try:
            self.call("DELETE", "")
        except (urllib.error.URLError, ConnectionError):
            pass
        self.driver.terminate()
        self.driver.wait()
