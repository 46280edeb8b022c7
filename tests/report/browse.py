#!/usr/bin/env python3
"""Uses a report of `fogbow paper` in headless Chromium, through chromedriver.

Usage: browse.py REPORT.html [FOLDER]       (screenshots go to FOLDER)"""

import base64
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import urllib.request

FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --hide-scrollbars --window-size=1240,1600"
).split()


class Browser:
    """A session of chromedriver (https://www.w3.org/TR/webdriver2/)."""

    def __init__(self, profile):
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, text=True)
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                self.root = "http://127.0.0.1:" + line.rstrip(".\n").rsplit(" ", 1)[1]
                break
        options = {"args": [*FLAGS, f"--user-data-dir={profile}"]}
        wanted = {"capabilities": {"alwaysMatch": {"goog:chromeOptions": options}}}
        try:
            self.root += "/session/" + self.post("/session", wanted)["sessionId"]
        except OSError as error:
            self.driver.kill()
            sys.exit(f"FAILED: Chromium cannot be started: {error}")

    def post(self, path, body):
        request = urllib.request.Request(
            self.root + path, json.dumps(body).encode(), {"Content-Type": "application/json"}
        )
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.loads(answer.read())["value"]

    def run(self, script, *arguments):
        return self.post("/execute/sync", {"script": script, "args": list(arguments)})

    def shoot(self, path):
        with urllib.request.urlopen(self.root + "/screenshot", timeout=60) as answer:
            path.write_bytes(base64.b64decode(json.loads(answer.read())["value"]))

    def close(self):
        try:
            urllib.request.urlopen(urllib.request.Request(self.root, method="DELETE"), timeout=60).close()
        finally:
            self.driver.terminate()
            self.driver.wait()


# The viewer of the item called by the first argument, and a number that stands for what a canvas shows.
TOOLS = """
const figure = document.querySelector(`#${arguments[0]} .gallery`), viewer = figure.viewer;
const sum = (canvas) => {
  const bytes = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  return bytes.reduce((sum, byte, i) => (31 * sum + byte * (1 + i % 7)) % 1000003, 7);
};
const click = (text) => [...figure.querySelectorAll("button")].find((button) => button.textContent === text).click();
const move = (x, y) => {
  const box = viewer.canvas.getBoundingClientRect();
  const at = { clientX: box.left + x * box.width, clientY: box.top + y * box.height, bubbles: true };
  viewer.view.dispatchEvent(new PointerEvent("pointermove", at));
};
"""


def check(holds, claim):
    if not holds:
        sys.exit(f"FAILED: {claim}")
    print(f"  {claim}")


def use(browser, item):
    """Everything that the viewer of `item` can do."""
    tool = lambda script: browser.run(TOOLS + script, item)  # noqa: E731
    flips = tool("click('flip'); const a = sum(viewer.canvas); click('flip'); return [a, sum(viewer.canvas)];")
    check(flips[0] != flips[1], f"{item}: flip shows one picture and then the other")
    back = tool("click('flip'); return sum(viewer.canvas);")
    check(back == flips[0], f"{item}: and back")
    wipes = tool("click('wipe'); return [0, 0.3, 0.999].map((x) => { move(x, 0.5); return sum(viewer.canvas); });")
    check(len(set(wipes)) == 3, f"{item}: wipe follows the pointer")
    error = tool("click('error map'); return [sum(viewer.canvas), viewer.caption.textContent];")
    check(error[0] not in flips and "minus" in error[1], f"{item}: the error map is another picture")
    same = tool("viewer.choose('b', viewer.a); return [...viewer.canvas.getContext('2d')"
                ".getImageData(0, 0, viewer.canvas.width, viewer.canvas.height).data].every((x) => x >= 245);")
    check(same, f"{item}: no picture differs from itself")
    tool("viewer.choose('b', viewer.pictures.length - 1); click('wipe');")
    insets = tool("return [0.1, 0.8].map((x) => { move(x, 0.4);"
                  "return [sum(viewer.zoom), viewer.reading.innerText]; });")
    check(insets[0] != insets[1] and "pixel" in insets[0][1], f"{item}: the inset shows where the pointer is")
    bright = tool("""
      const mean = () => {
        const { width, height } = viewer.shown[0];
        const { data } = viewer.shown[0].getContext("2d").getImageData(0, 0, width, height);
        return data.reduce((sum, byte) => sum + byte, 0) / data.length;
      };
      return [-2, 0, 2].map((stops) => {
        viewer.slider.value = stops;
        viewer.slider.dispatchEvent(new Event("input"));
        return mean();
      });""")
    check(bright[0] < bright[1] < bright[2], f"{item}: exposure brightens")
    tool("viewer.slider.value = 0; viewer.slider.dispatchEvent(new Event('input')); move(0.5, 0.5);")
    notes = tool("return [...figure.querySelectorAll('.thumb .label')].map((label) => label.innerText);")
    check(all(notes), f"{item}: every picture has its name and note")


def main():
    report = pathlib.Path(sys.argv[1]).resolve()
    shots = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            browser.post("/url", {"url": report.as_uri()})
            for _ in range(300):
                if browser.run("return document.body.dataset.ready || null"):
                    break
                time.sleep(0.1)
            else:
                sys.exit("FAILED: the script of the page does not come to its end")
            loaded = browser.run("return performance.getEntriesByType('resource').map((entry) => entry.name)")
            outside = [name for name in loaded if not name.startswith("data:")]
            check(not outside, f"nothing is loaded from outside the page ({len(outside)} names)")
            broken = browser.run("return [...document.images].filter((image) => !image.complete "
                                 "|| (image.loading !== 'lazy' && image.naturalWidth === 0)).map((image) => image.alt)")
            lazy = browser.run("return [...document.images].filter((image) => image.loading === 'lazy').length")
            check(len(broken) <= lazy, "all pictures can be read")
            items = browser.run("return [...document.querySelectorAll('section')].map((section) => section.id)")
            check(items, f"there are sections: {', '.join(items)}")
            for item in items:
                pictures = browser.run("const viewer = document.querySelector(`#${arguments[0]} .gallery`)?.viewer;"
                                       "return viewer ? viewer.pictures.length : 0", item)
                if pictures > 1:
                    use(browser, item)
            if shots:
                shots.mkdir(parents=True, exist_ok=True)
                browser.shoot(shots / "top.png")
                for item in items:
                    browser.run("document.getElementById(arguments[0]).scrollIntoView()", item)
                    time.sleep(0.3)
                    browser.shoot(shots / f"{item}.png")
        finally:
            browser.close()


if __name__ == "__main__":
    main()
